//! Animated values in the components of an entity.

use std::ops::RangeInclusive;

use glam::{DQuat, DVec3};
use hecs::{Entity, World};

use super::Changes;
use crate::color::Rgb;
use crate::components::{
    Camera, Light, LightKind, Material, Property, Reflective, Refractive, Specular, Transform, View,
};
use crate::timeline::Value;

/// A query for the components that properties are values of, if an entity has them.
pub(super) type PartsQuery<'a> = (
    Option<&'a mut Transform>,
    Option<&'a mut Material>,
    Option<&'a mut Specular>,
    Option<&'a mut Reflective>,
    Option<&'a mut Refractive>,
    Option<&'a mut Light>,
    Option<&'a mut Camera>,
);

/// What an entity has of them.
pub(super) struct Parts<'a> {
    transform: Option<&'a mut Transform>,
    material: Option<&'a mut Material>,
    specular: Option<&'a mut Specular>,
    reflective: Option<&'a mut Reflective>,
    refractive: Option<&'a mut Refractive>,
    light: Option<&'a mut Light>,
    camera: Option<&'a mut Camera>,
}

/// Where a value is, and the range to which it is held: a curve through values of a range may leave it.
enum Place<'a> {
    Number(&'a mut f64, RangeInclusive<f64>),
    Single(&'a mut f32, RangeInclusive<f64>),
    Vector(&'a mut DVec3),
    Rotation(&'a mut DQuat),
    /// 0 or more.
    Color(&'a mut Rgb),
}

const COEFFICIENT: RangeInclusive<f64> = 0.0..=1.0;
const SHININESS: RangeInclusive<f64> = 0.0..=Specular::LARGEST_SHININESS as f64;
const IOR: RangeInclusive<f64> = Refractive::SMALLEST_IOR..=Refractive::LARGEST_IOR;

/// A value of an entity. `None` if the entity lacks it.
///
/// What is not written has the value that takes its place: an ambient colour is the colour, and a camera with a view
/// direction has a target in that direction.
#[must_use]
pub fn value(world: &World, entity: Entity, property: Property) -> Option<Value> {
    /// A copy, so that nothing is written.
    fn copy<T: hecs::Component + Copy>(world: &World, entity: Entity) -> Option<T> {
        world.get::<&T>(entity).ok().map(|component| *component)
    }
    let mut transform = copy(world, entity);
    let mut material = copy(world, entity);
    let mut specular = copy(world, entity);
    let mut reflective = copy(world, entity);
    let mut refractive = copy(world, entity);
    let mut light = copy(world, entity);
    let mut camera = copy(world, entity);
    let mut parts = Parts {
        transform: transform.as_mut(),
        material: material.as_mut(),
        specular: specular.as_mut(),
        reflective: reflective.as_mut(),
        refractive: refractive.as_mut(),
        light: light.as_mut(),
        camera: camera.as_mut(),
    };
    Some(parts.place(property)?.read())
}

impl<'a> Parts<'a> {
    pub(super) fn new(
        (transform, material, specular, reflective, refractive, light, camera): <PartsQuery<'a> as hecs::Query>::Item<'a>,
    ) -> Self {
        Self { transform, material, specular, reflective, refractive, light, camera }
    }

    /// Writes a value, held to its range, and says whether it is different from what it was. Nothing is written if the entity
    /// lacks it, or if it is of another kind.
    pub(super) fn set(&mut self, property: Property, value: Value) -> bool {
        self.place(property).is_some_and(|place| place.write(value))
    }

    fn place(&mut self, property: Property) -> Option<Place<'_>> {
        Some(match property {
            Property::Translation => Place::Vector(&mut self.transform.as_deref_mut()?.translation),
            Property::Rotation => Place::Rotation(&mut self.transform.as_deref_mut()?.rotation),
            Property::Scale => Place::Vector(&mut self.transform.as_deref_mut()?.scale),
            Property::Ka => Place::Single(&mut self.material.as_deref_mut()?.k_a, COEFFICIENT),
            Property::Kd => Place::Single(&mut self.material.as_deref_mut()?.k_d, COEFFICIENT),
            Property::Color => Place::Color(&mut self.material.as_deref_mut()?.color),
            Property::AmbientColor => {
                let material = self.material.as_deref_mut()?;
                Place::Color(material.ambient_color.get_or_insert(material.color))
            }
            Property::Ks => Place::Single(&mut self.specular.as_deref_mut()?.k_s, COEFFICIENT),
            Property::Shininess => Place::Single(&mut self.specular.as_deref_mut()?.shininess, SHININESS),
            Property::Kr => Place::Single(&mut self.reflective.as_deref_mut()?.k_r, COEFFICIENT),
            Property::Kt => Place::Single(&mut self.refractive.as_deref_mut()?.k_t, COEFFICIENT),
            Property::Ior => Place::Number(&mut self.refractive.as_deref_mut()?.ior, IOR),
            Property::Absorption => Place::Color(&mut self.refractive.as_deref_mut()?.absorption),
            Property::Intensity => Place::Color(&mut self.light.as_deref_mut()?.intensity),
            Property::Direction => match &mut self.light.as_deref_mut()?.kind {
                LightKind::Directional { direction } => Place::Vector(direction),
                _ => return None,
            },
            Property::Position => Place::Vector(&mut self.camera.as_deref_mut()?.position),
            Property::Target => Place::Vector(target(self.camera.as_deref_mut()?)),
        })
    }
}

/// The point that a camera looks at; one with a direction is given one.
fn target(camera: &mut Camera) -> &mut DVec3 {
    if let View::Direction(direction) = camera.view {
        camera.view = View::Target(camera.position + direction);
    }
    match &mut camera.view {
        View::Target(point) | View::Direction(point) => point,
    }
}

impl Place<'_> {
    fn read(self) -> Value {
        match self {
            Self::Number(place, _) => Value::Number(*place),
            Self::Single(place, _) => Value::Number(f64::from(*place)),
            Self::Vector(place) => Value::Vector(*place),
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

/// Declares that a property of an entity has another value.
pub(super) fn declare(property: Property, entity: Entity, changes: &mut Changes) {
    match property {
        Property::Translation | Property::Rotation | Property::Scale => changes.transform(entity),
        Property::Ka
        | Property::Kd
        | Property::Color
        | Property::AmbientColor
        | Property::Ks
        | Property::Shininess
        | Property::Kr
        | Property::Kt
        | Property::Ior
        | Property::Absorption => changes.material(entity),
        Property::Intensity | Property::Direction | Property::Position | Property::Target => {
            changes.settings();
        }
    }
}
