//! Animated values in the components of an entity.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use glam::{DQuat, DVec3};
use hecs::{Entity, World};

use super::Changes;
use crate::animation::Value;
use crate::animation::limits::SMALLEST;
use crate::color::Rgb;
use crate::components::{
    Ambient, AreaShape, Background, Camera, Checker, Falloff, Fog, Light, LightKind, Material, Projection,
    Property, Reflective, Refractive, Shape, Specular, Transform, View,
};

/// A query for the components that properties are values of, if an entity has them.
pub(super) type PartsQuery<'a> = (
    Option<&'a mut Transform>,
    Option<&'a mut Shape>,
    (
        Option<&'a mut Material>,
        Option<&'a mut Specular>,
        Option<&'a mut Reflective>,
        Option<&'a mut Refractive>,
        Option<&'a mut Checker>,
    ),
    Option<&'a mut Light>,
    Option<&'a mut Camera>,
    (Option<&'a mut Ambient>, Option<&'a mut Background>, Option<&'a mut Fog>),
);

/// What an entity has of them.
#[derive(Default)]
pub(super) struct Parts<'a> {
    transform: Option<&'a mut Transform>,
    shape: Option<&'a mut Shape>,
    material: Option<&'a mut Material>,
    specular: Option<&'a mut Specular>,
    reflective: Option<&'a mut Reflective>,
    refractive: Option<&'a mut Refractive>,
    checker: Option<&'a mut Checker>,
    light: Option<&'a mut Light>,
    camera: Option<&'a mut Camera>,
    ambient: Option<&'a mut Ambient>,
    background: Option<&'a mut Background>,
    fog: Option<&'a mut Fog>,
}

/// Where a value is, and the range to which it is held: a curve through values of a range may leave it.
enum Place<'a> {
    Number(&'a mut f64, RangeInclusive<f64>),
    Single(&'a mut f32, RangeInclusive<f64>),
    Vector(&'a mut DVec3),
    /// [`SIZE`] each.
    Edges(&'a mut DVec3),
    Falloff(&'a mut Falloff),
    Rotation(&'a mut DQuat),
    /// 0 or more.
    Color(&'a mut Rgb),
}

const ANY: RangeInclusive<f64> = f64::NEG_INFINITY..=f64::INFINITY;
const POSITIVE: RangeInclusive<f64> = 0.0..=f64::INFINITY;
/// Greater than 0: as small as the file format allows.
pub(super) const SIZE: RangeInclusive<f64> = SMALLEST..=f64::INFINITY;
const SHARE: RangeInclusive<f64> = 0.0..=1.0;
const SHININESS: RangeInclusive<f64> = 0.0..=Specular::LARGEST_SHININESS as f64;
pub(super) const IOR: RangeInclusive<f64> = Refractive::SMALLEST_IOR..=Refractive::LARGEST_IOR;
/// Of a spot light, from rim to rim.
const ANGLE: RangeInclusive<f64> = SMALLEST..=PI;
/// Of a view: less than half a turn.
const FIELD_OF_VIEW: RangeInclusive<f64> = SMALLEST..=PI.next_down();

/// A value of an entity. `None` if the entity lacks it.
///
/// What is not written has the value that takes its place: an ambient colour is the colour, and a camera with a view
/// direction has a target in that direction.
#[must_use]
pub fn value(world: &World, entity: Entity, property: Property) -> Option<Value> {
    /// Of a copy, so that nothing is written.
    macro_rules! copies {
        ($($part:ident),*) => {{
            $(let mut $part = world.get::<&_>(entity).ok().map(|found| *found);)*
            Parts { $($part: $part.as_mut()),* }.place(property)?.read()
        }};
    }
    Some(copies!(
        transform, shape, material, specular, reflective, refractive, checker, light, camera, ambient,
        background, fog
    ))
}

/// What an entity says of a value, which need not be the value itself.
#[derive(Clone, Copy, Debug)]
pub(super) enum Written {
    Value(Value),
    View(View),
    AmbientColor(Option<Rgb>),
}

impl Written {
    /// `None` if the entity lacks the value.
    pub(super) fn of(world: &World, entity: Entity, property: Property) -> Option<Self> {
        Some(match property {
            Property::Target | Property::View => Self::View(world.get::<&Camera>(entity).ok()?.view),
            Property::AmbientColor => Self::AmbientColor(world.get::<&Material>(entity).ok()?.ambient_color),
            _ => Self::Value(value(world, entity, property)?),
        })
    }
}

/// Which values a value is made of: itself alone, or, where it is not written, those in whose place it stands. `is_driven` are those that
/// will be written before they are read.
pub(super) fn sources(
    world: &World,
    entity: Entity,
    property: Property,
    is_driven: impl Fn(Property) -> bool,
) -> [Property; 2] {
    if is_driven(property) {
        return [property; 2];
    }
    let view = || world.get::<&Camera>(entity).ok().map(|camera| camera.view);
    match property {
        Property::Target if is_driven(Property::View) || matches!(view(), Some(View::Direction(_))) => {
            [Property::View, Property::Position]
        }
        Property::View if is_driven(Property::Target) || matches!(view(), Some(View::Target(_))) => {
            [Property::Target, Property::Position]
        }
        Property::AmbientColor
            if world.get::<&Material>(entity).is_ok_and(|material| material.ambient_color.is_none()) =>
        {
            [Property::Color; 2]
        }
        _ => [property; 2],
    }
}

impl<'a> Parts<'a> {
    pub(super) fn new(found: <PartsQuery<'a> as hecs::Query>::Item<'a>) -> Self {
        let (transform, shape, surface, light, camera, (ambient, background, fog)) = found;
        let (material, specular, reflective, refractive, checker) = surface;
        Self {
            transform,
            shape,
            material,
            specular,
            reflective,
            refractive,
            checker,
            light,
            camera,
            ambient,
            background,
            fog,
        }
    }

    /// Writes a value, held to its range, and says whether it is different from what it was. Nothing is written if the entity
    /// lacks it, or if it is of another kind.
    pub(super) fn set(&mut self, property: Property, value: Value) -> bool {
        self.place(property).is_some_and(|place| place.write(value))
    }

    /// Writes what [was there](Written::of).
    pub(super) fn put_back(&mut self, property: Property, written: Written) {
        match written {
            Written::Value(value) => {
                self.set(property, value);
            }
            Written::View(view) => {
                if let Some(camera) = &mut self.camera {
                    camera.view = view;
                }
            }
            Written::AmbientColor(color) => {
                if let Some(material) = &mut self.material {
                    material.ambient_color = color;
                }
            }
        }
    }

    fn place(&mut self, property: Property) -> Option<Place<'_>> {
        match property {
            Property::Translation | Property::Rotation | Property::Scale => {
                Some(in_transform(self.transform.as_deref_mut()?, property))
            }
            Property::Radius | Property::Size | Property::Normal => {
                in_shape(self.shape.as_deref_mut()?, property)
            }
            Property::Ka | Property::Kd | Property::Color | Property::AmbientColor => {
                Some(in_material(self.material.as_deref_mut()?, property))
            }
            Property::Ks => Some(Place::Single(&mut self.specular.as_deref_mut()?.k_s, SHARE)),
            Property::Shininess => {
                Some(Place::Single(&mut self.specular.as_deref_mut()?.shininess, SHININESS))
            }
            Property::Kr => Some(Place::Single(&mut self.reflective.as_deref_mut()?.k_r, SHARE)),
            Property::Kt => Some(Place::Single(&mut self.refractive.as_deref_mut()?.k_t, SHARE)),
            Property::Ior => Some(Place::Number(&mut self.refractive.as_deref_mut()?.ior, IOR)),
            Property::Absorption => Some(Place::Color(&mut self.refractive.as_deref_mut()?.absorption)),
            Property::CheckerColor => Some(Place::Color(&mut self.checker.as_deref_mut()?.color)),
            Property::CheckerSize => Some(Place::Number(&mut self.checker.as_deref_mut()?.size, SIZE)),
            Property::Intensity
            | Property::Direction
            | Property::Angle
            | Property::Softness
            | Property::Falloff
            | Property::LightRadius
            | Property::LightWidth
            | Property::LightHeight => in_light(self.light.as_deref_mut()?, property),
            Property::Position
            | Property::Target
            | Property::View
            | Property::Up
            | Property::Roll
            | Property::Fov
            | Property::ScreenDistance
            | Property::ScreenWidth
            | Property::ScreenHeight
            | Property::Aperture
            | Property::Focus => in_camera(self.camera.as_deref_mut()?, property),
            Property::Ambient => Some(Place::Color(&mut self.ambient.as_deref_mut()?.0)),
            Property::Background | Property::BackgroundBottom | Property::BackgroundTop => {
                in_background(self.background.as_deref_mut()?, property)
            }
            Property::FogColor => Some(Place::Color(&mut self.fog.as_deref_mut()?.color)),
            Property::FogDensity => Some(Place::Number(&mut self.fog.as_deref_mut()?.density, POSITIVE)),
        }
    }
}

fn in_transform(transform: &mut Transform, property: Property) -> Place<'_> {
    match property {
        Property::Rotation => Place::Rotation(&mut transform.rotation),
        Property::Scale => Place::Vector(&mut transform.scale),
        _ => Place::Vector(&mut transform.translation),
    }
}

fn in_shape(shape: &mut Shape, property: Property) -> Option<Place<'_>> {
    match (property, shape) {
        (Property::Radius, Shape::Sphere { radius }) => Some(Place::Number(radius, SIZE)),
        (Property::Size, Shape::Box { size }) => Some(Place::Edges(size)),
        (Property::Normal, Shape::Plane { normal }) => Some(Place::Vector(normal)),
        _ => None,
    }
}

fn in_material(material: &mut Material, property: Property) -> Place<'_> {
    match property {
        Property::Ka => Place::Single(&mut material.k_a, SHARE),
        Property::Kd => Place::Single(&mut material.k_d, SHARE),
        Property::AmbientColor => Place::Color(material.ambient_color.get_or_insert(material.color)),
        _ => Place::Color(&mut material.color),
    }
}

fn in_light(light: &mut Light, property: Property) -> Option<Place<'_>> {
    match (property, &mut light.kind) {
        (Property::Intensity, _) => Some(Place::Color(&mut light.intensity)),
        (Property::Falloff, _) => light.falloff.as_mut().map(Place::Falloff),
        (Property::Direction, LightKind::Directional { direction }) => Some(Place::Vector(direction)),
        (Property::Angle, LightKind::Spot { angle, .. }) => Some(Place::Number(angle, ANGLE)),
        (Property::Softness, LightKind::Spot { softness, .. }) => Some(Place::Number(softness, SHARE)),
        (_, LightKind::Area { shape, .. }) => in_area(shape, property),
        _ => None,
    }
}

fn in_area(shape: &mut AreaShape, property: Property) -> Option<Place<'_>> {
    let size = match (property, shape) {
        (Property::LightRadius, AreaShape::Sphere { radius }) => radius,
        (Property::LightWidth, AreaShape::Rectangle { width, .. }) => width,
        (Property::LightHeight, AreaShape::Rectangle { height, .. }) => height,
        _ => return None,
    };
    Some(Place::Number(size, SIZE))
}

fn in_camera(camera: &mut Camera, property: Property) -> Option<Place<'_>> {
    match property {
        Property::Position => Some(Place::Vector(&mut camera.position)),
        Property::Target => Some(Place::Vector(target(camera))),
        Property::View => Some(Place::Vector(view(camera))),
        Property::Up => Some(Place::Vector(&mut camera.up)),
        Property::Roll => Some(Place::Number(&mut camera.roll, ANY)),
        Property::Aperture => Some(Place::Number(&mut camera.lens.as_mut()?.aperture, POSITIVE)),
        Property::Focus => Some(Place::Number(&mut camera.lens.as_mut()?.focus, SIZE)),
        _ => in_projection(&mut camera.projection, property),
    }
}

fn in_projection(projection: &mut Projection, property: Property) -> Option<Place<'_>> {
    let size = match (property, projection) {
        (Property::Fov, Projection::FieldOfView { vertical }) => {
            return Some(Place::Number(vertical, FIELD_OF_VIEW));
        }
        (Property::ScreenDistance, Projection::Screen { distance, .. }) => distance,
        (Property::ScreenWidth, Projection::Screen { width: Some(width), .. }) => width,
        (Property::ScreenHeight, Projection::Screen { height, .. }) => height,
        _ => return None,
    };
    Some(Place::Number(size, SIZE))
}

/// The point that a camera looks at; one with a direction is given one.
fn target(camera: &mut Camera) -> &mut DVec3 {
    if let View::Direction(direction) = camera.view {
        camera.view = View::Target(camera.position + direction);
    }
    vector(&mut camera.view)
}

/// The direction in which a camera looks; one with a target is given one.
fn view(camera: &mut Camera) -> &mut DVec3 {
    if let View::Target(point) = camera.view {
        camera.view = View::Direction(point - camera.position);
    }
    vector(&mut camera.view)
}

fn vector(view: &mut View) -> &mut DVec3 {
    match view {
        View::Target(vector) | View::Direction(vector) => vector,
    }
}

fn in_background(background: &mut Background, property: Property) -> Option<Place<'_>> {
    match (property, background) {
        (Property::Background, Background::Flat(color))
        | (Property::BackgroundBottom, Background::Gradient { bottom: color, .. })
        | (Property::BackgroundTop, Background::Gradient { top: color, .. }) => Some(Place::Color(color)),
        _ => None,
    }
}

impl Place<'_> {
    fn read(self) -> Value {
        match self {
            Self::Number(place, _) => Value::Number(*place),
            Self::Single(place, _) => Value::Number(f64::from(*place)),
            Self::Vector(place) | Self::Edges(place) => Value::Vector(*place),
            Self::Falloff(place) => Value::Vector(DVec3::new(place.constant, place.linear, place.quadratic)),
            Self::Rotation(place) => Value::Rotation(*place),
            Self::Color(place) => Value::Color(*place),
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "coefficients are f32")]
    fn write(self, value: Value) -> bool {
        match (self, value) {
            (Self::Number(place, range), Value::Number(value)) => put(place, held(value, &range)),
            (Self::Single(place, range), Value::Number(value)) => put(place, held(value, &range) as f32),
            (Self::Vector(place), Value::Vector(value)) => put(place, value),
            (Self::Edges(place), Value::Vector(value)) => put(place, value.map(|edge| held(edge, &SIZE))),
            (Self::Falloff(place), Value::Vector(value)) => {
                let (constant, linear) = (held(value.x, &SIZE), held(value.y, &POSITIVE));
                put(place, Falloff { constant, linear, quadratic: held(value.z, &POSITIVE) })
            }
            (Self::Rotation(place), Value::Rotation(value)) => put(place, value),
            (Self::Color(place), Value::Color(value)) => put(place, value.max(Rgb::ZERO)),
            _ => false,
        }
    }
}

fn held(value: f64, range: &RangeInclusive<f64>) -> f64 {
    value.clamp(*range.start(), *range.end())
}

/// Is it different from what it was?
fn put<T: PartialEq>(place: &mut T, value: T) -> bool {
    let differs = *place != value;
    *place = value;
    differs
}

/// Declares that a property of an entity has another value. Lights, cameras and settings of the whole scene are read for every
/// moment anyway.
pub(super) fn declare(property: Property, entity: Entity, changes: &mut Changes) {
    match property {
        Property::Translation | Property::Rotation | Property::Scale => changes.transform(entity),
        Property::Radius | Property::Size | Property::Normal => changes.shape(entity),
        Property::Ka
        | Property::Kd
        | Property::Color
        | Property::AmbientColor
        | Property::Ks
        | Property::Shininess
        | Property::Kr
        | Property::Kt
        | Property::Ior
        | Property::Absorption
        | Property::CheckerColor
        | Property::CheckerSize => changes.material(entity),
        _ => changes.settings(),
    }
}
