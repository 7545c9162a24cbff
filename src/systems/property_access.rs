//! Accesses the values of properties in the components of an entity, one line per property.

use glam::{DQuat, DVec3};
use hecs::{Entity, World};

use crate::animation::Value;
use crate::animation::limits::SMALLEST;
use crate::color::Rgb;
use crate::components::{
    Ambient, AreaShape, Background, Camera, Emission, Falloff, Fog, Light, LightKind, Material, Pattern,
    PatternKind, Projection, Property, Quantity, Reflective, Refractive, Requirement, Shape, Specular, Stars,
    Sun, Target, Transform, View, Visibility,
};

/// Defines, from lists of the components that hold properties: the query for these components, its result, and functions that read one value
/// of an entity. A list has at most 15 components, as queries of hecs are tuples.
macro_rules! parts {
    ($([$($part:ident: $component:ident,)*])*) => {
        /// A query for the components that hold properties, each of which an entity may lack.
        pub(super) type PartsQuery<'a> = ($(($(Option<&'a mut $component>,)*),)*);

        /// The components of an entity that hold properties.
        pub(super) struct Parts<'a> {
            $($(pub(super) $part: Option<&'a mut $component>,)*)*
        }

        impl<'a> Parts<'a> {
            pub(super) fn new(($(($($part,)*),)*): <PartsQuery<'a> as hecs::Query>::Item<'a>) -> Self {
                Self { $($($part,)*)* }
            }
        }

        /// Returns a value of an entity. `None` if the entity does not have it.
        ///
        /// A value that is not stored is derived: the ambient colour defaults to the colour, and a camera with a view direction has a
        /// target in that direction. All rays see a shape without [`Visibility`].
        #[must_use]
        pub fn value(world: &World, entity: Entity, property: Property) -> Option<Value> {
            value_after(world, entity, property, |_| ())
        }

        /// Returns the value that an entity would have after `write`. Nothing is written to the world, not even to derive the value.
        pub(super) fn value_after(
            world: &World,
            entity: Entity,
            property: Property,
            write: impl FnOnce(&mut Parts<'_>),
        ) -> Option<Value> {
            $($(let mut $part = world.get::<&$component>(entity).ok().map(|found| *found);)*)*
            let mut parts = Parts { $($($part: $part.as_mut(),)*)* };
            write(&mut parts);
            parts.get(property)
        }
    };
}

parts! {
    [
        transform: Transform,
        shape: Shape,
        visibility: Visibility,
        material: Material,
        specular: Specular,
        reflective: Reflective,
        refractive: Refractive,
        pattern: Pattern,
        emission: Emission,
        light: Light,
        camera: Camera,
        target: Target,
    ]
    [
        ambient: Ambient,
        background: Background,
        sun: Sun,
        stars: Stars,
        fog: Fog,
    ]
}

/// A mutable reference to a value, in the component that holds it.
enum ValueMut<'a> {
    Number(&'a mut f64),
    Single(&'a mut f32),
    Vector(&'a mut DVec3),
    Falloff(&'a mut Falloff),
    Rotation(&'a mut DQuat),
    Color(&'a mut Rgb),
    Flag(&'a mut bool),
}

/// Matches a component with a pattern. If it does not match, the calling function returns `None`.
macro_rules! within {
    ($part:expr, $pattern:pat => $value:expr) => {
        match $part {
            $pattern => $value,
            _ => return None,
        }
    };
}

impl Parts<'_> {
    /// Writes a value, clamped to its range, and returns whether it differs from the previous value. Writes nothing if the entity does not
    /// have the value, or if it is of another kind.
    pub(super) fn set(&mut self, property: Property, value: Value) -> bool {
        self.value_mut(property).is_some_and(|stored| stored.write(clamped(value, property.quantity())))
    }

    fn get(&mut self, property: Property) -> Option<Value> {
        if property.part() == Requirement::Shape && self.visibility.is_none() {
            return self.shape.is_some().then_some(Value::Flag(true));
        }
        Some(self.value_mut(property)?.read())
    }

    /// Returns a reference to a value, if the entity has it.
    fn value_mut(&mut self, property: Property) -> Option<ValueMut<'_>> {
        use Property as P;
        match property {
            P::Translation
            | P::Rotation
            | P::Scale
            | P::Radius
            | P::Size
            | P::Normal
            | P::Visible
            | P::CastsShadow
            | P::InReflections => self.shape_value(property),
            P::Ka
            | P::Kd
            | P::Color
            | P::AmbientColor
            | P::Ks
            | P::Shininess
            | P::Kr
            | P::Kt
            | P::Ior
            | P::Absorption
            | P::PatternColor
            | P::PatternSize
            | P::PatternDirection
            | P::PatternOffset
            | P::StripeRatio
            | P::BrickSize
            | P::Mortar
            | P::NoiseContrast
            | P::Emission => self.surface_value(property),
            P::Intensity
            | P::Direction
            | P::Angle
            | P::Softness
            | P::Falloff
            | P::LightRadius
            | P::LightWidth
            | P::LightHeight => self.light_value(property),
            P::Position
            | P::Target
            | P::View
            | P::Up
            | P::Roll
            | P::Fov
            | P::HorizontalFov
            | P::Orthographic
            | P::ScreenDistance
            | P::ScreenWidth
            | P::ScreenHeight
            | P::Aperture
            | P::Focus => self.camera_value(property),
            P::Ambient
            | P::Background
            | P::BackgroundBottom
            | P::BackgroundHorizon
            | P::BackgroundTop
            | P::SunDirection
            | P::SunIntensity
            | P::SunSize
            | P::SunGlow
            | P::SunGlowSize
            | P::StarsIntensity
            | P::StarsSize
            | P::FogColor
            | P::FogDensity
            | P::FogHeight
            | P::FogLevel => self.scene_value(property),
        }
    }

    /// Returns a reference to a value of the transform, the shape or its visibility.
    fn shape_value(&mut self, property: Property) -> Option<ValueMut<'_>> {
        use ValueMut::{Flag, Number, Rotation, Vector};
        Some(match property {
            Property::Translation => Vector(&mut self.transform.as_mut()?.translation),
            Property::Rotation => Rotation(&mut self.transform.as_mut()?.rotation),
            Property::Scale => Vector(&mut self.transform.as_mut()?.scale),
            Property::Radius => within!(
                self.shape.as_mut()?,
                Shape::Sphere { radius } | Shape::Cylinder { radius, .. } | Shape::Capsule { radius, .. } => Number(radius)
            ),
            Property::Size => within!(self.shape.as_mut()?, Shape::Box { size } => Vector(size)),
            Property::Normal => within!(self.shape.as_mut()?, Shape::Plane { normal } => Vector(normal)),
            Property::Visible => Flag(&mut self.visibility.as_mut()?.camera),
            Property::CastsShadow => Flag(&mut self.visibility.as_mut()?.shadow),
            Property::InReflections => Flag(&mut self.visibility.as_mut()?.secondary),
            _ => return None,
        })
    }

    /// Returns a reference to a value of the surface.
    fn surface_value(&mut self, property: Property) -> Option<ValueMut<'_>> {
        use ValueMut::{Color, Number, Single};
        Some(match property {
            Property::Ka => Single(&mut self.material.as_mut()?.k_a),
            Property::Kd => Single(&mut self.material.as_mut()?.k_d),
            Property::Color => Color(&mut self.material.as_mut()?.color),
            Property::AmbientColor => Color(ambient_color(self.material.as_mut()?)),
            Property::Ks => Single(&mut self.specular.as_mut()?.k_s),
            Property::Shininess => Single(&mut self.specular.as_mut()?.shininess),
            Property::Kr => Single(&mut self.reflective.as_mut()?.k_r),
            Property::Kt => Single(&mut self.refractive.as_mut()?.k_t),
            Property::Ior => Number(&mut self.refractive.as_mut()?.ior),
            Property::Absorption => Color(&mut self.refractive.as_mut()?.absorption),
            Property::Emission => Color(&mut self.emission.as_mut()?.0),
            _ => return self.pattern_value(property),
        })
    }

    /// Returns a reference to a value of the surface's pattern.
    fn pattern_value(&mut self, property: Property) -> Option<ValueMut<'_>> {
        use PatternKind::{Bricks, Checker, Gradient, Noise, Stripes};
        use ValueMut::{Color, Number, Vector};
        let Pattern { color, kind } = &mut **self.pattern.as_mut()?;
        Some(match property {
            Property::PatternColor => Color(color),
            Property::PatternSize => within!(
                kind,
                Checker { size } | Stripes { size, .. } | Gradient { size, .. } | Noise { size, .. } => Number(size)
            ),
            Property::PatternDirection => {
                within!(kind, Stripes { direction, .. } | Gradient { direction, .. } => Vector(direction))
            }
            Property::PatternOffset => {
                within!(kind, Stripes { offset, .. } | Gradient { offset, .. } => Number(offset))
            }
            Property::BrickSize => within!(kind, Bricks { size, .. } => Vector(size)),
            Property::Mortar => within!(kind, Bricks { mortar, .. } => Number(mortar)),
            Property::NoiseContrast => within!(kind, Noise { contrast, .. } => Number(contrast)),
            Property::StripeRatio => within!(kind, Stripes { ratio, .. } => Number(ratio)),
            _ => return None,
        })
    }

    /// Returns a reference to a value of the light.
    fn light_value(&mut self, property: Property) -> Option<ValueMut<'_>> {
        use AreaShape::Rectangle;
        use LightKind::{Directional, Spot};
        use ValueMut::{Color, Number, Vector};
        Some(match property {
            Property::Intensity => Color(&mut self.light.as_mut()?.intensity),
            Property::Direction => {
                within!(self.light_kind()?, Directional { direction } => Vector(direction))
            }
            Property::Angle => within!(self.light_kind()?, Spot { angle, .. } => Number(angle)),
            Property::Softness => within!(self.light_kind()?, Spot { softness, .. } => Number(softness)),
            Property::Falloff => ValueMut::Falloff(self.light.as_mut()?.falloff.as_mut()?),
            Property::LightRadius => {
                within!(self.area_shape()?, AreaShape::Sphere { radius } => Number(radius))
            }
            Property::LightWidth => within!(self.area_shape()?, Rectangle { width, .. } => Number(width)),
            Property::LightHeight => within!(self.area_shape()?, Rectangle { height, .. } => Number(height)),
            _ => return None,
        })
    }

    /// Returns a reference to a value of the camera, or the target of an entity without one.
    fn camera_value(&mut self, property: Property) -> Option<ValueMut<'_>> {
        use Projection::{FieldOfView, HorizontalFieldOfView, Orthographic, Screen};
        use ValueMut::{Number, Vector};
        Some(match property {
            Property::Position => Vector(&mut self.camera.as_mut()?.position),
            Property::Target if self.camera.is_none() => Vector(&mut self.target.as_mut()?.0),
            Property::Target => Vector(target(self.camera.as_mut()?)),
            Property::View => Vector(view(self.camera.as_mut()?)),
            Property::Up => Vector(&mut self.camera.as_mut()?.up),
            Property::Roll => Number(&mut self.camera.as_mut()?.roll),
            Property::Fov => within!(self.projection()?, FieldOfView { vertical } => Number(vertical)),
            Property::HorizontalFov => {
                within!(self.projection()?, HorizontalFieldOfView { horizontal } => Number(horizontal))
            }
            Property::Orthographic => within!(self.projection()?, Orthographic { height } => Number(height)),
            Property::ScreenDistance => {
                within!(self.projection()?, Screen { distance, .. } => Number(distance))
            }
            Property::ScreenWidth => {
                within!(self.projection()?, Screen { width: Some(width), .. } => Number(width))
            }
            Property::ScreenHeight => within!(self.projection()?, Screen { height, .. } => Number(height)),
            Property::Aperture => Number(&mut self.camera.as_mut()?.lens.as_mut()?.aperture),
            Property::Focus => Number(&mut self.camera.as_mut()?.lens.as_mut()?.focus),
            _ => return None,
        })
    }

    /// Returns a reference to a value of the scene: ambient light, background, sun, stars or fog.
    fn scene_value(&mut self, property: Property) -> Option<ValueMut<'_>> {
        use Background::{Flat, Gradient};
        use ValueMut::{Color, Number, Vector};
        Some(match property {
            Property::SunDirection => Vector(&mut self.sun.as_mut()?.direction),
            Property::SunIntensity => Color(&mut self.sun.as_mut()?.intensity),
            Property::SunSize => Number(&mut self.sun.as_mut()?.size),
            Property::SunGlow => Number(&mut self.sun.as_mut()?.glow),
            Property::SunGlowSize => Number(&mut self.sun.as_mut()?.glow_size),
            Property::StarsIntensity => Color(&mut self.stars.as_mut()?.intensity),
            Property::StarsSize => Number(&mut self.stars.as_mut()?.size),
            Property::Ambient => Color(&mut self.ambient.as_mut()?.0),
            Property::Background => within!(self.background.as_mut()?, Flat(color) => Color(color)),
            Property::BackgroundBottom => {
                within!(self.background.as_mut()?, Gradient { bottom, .. } => Color(bottom))
            }
            Property::BackgroundHorizon => {
                within!(self.background.as_mut()?, Gradient { horizon: Some(horizon), .. } => Color(horizon))
            }
            Property::BackgroundTop => within!(self.background.as_mut()?, Gradient { top, .. } => Color(top)),
            Property::FogColor => Color(&mut self.fog.as_mut()?.color),
            Property::FogDensity => Number(&mut self.fog.as_mut()?.density),
            Property::FogHeight => Number(self.fog.as_mut()?.height.as_mut()?),
            Property::FogLevel => Number(&mut self.fog.as_mut().filter(|fog| fog.height.is_some())?.level),
            _ => return None,
        })
    }

    fn light_kind(&mut self) -> Option<&mut LightKind> {
        Some(&mut self.light.as_mut()?.kind)
    }

    fn area_shape(&mut self) -> Option<&mut AreaShape> {
        match self.light_kind()? {
            LightKind::Area { shape, .. } => Some(shape),
            _ => None,
        }
    }

    fn projection(&mut self) -> Option<&mut Projection> {
        Some(&mut self.camera.as_mut()?.projection)
    }
}

/// Returns the ambient colour of a material, which is first set to the colour if it is missing.
fn ambient_color(material: &mut Material) -> &mut Rgb {
    material.ambient_color.get_or_insert(material.color)
}

/// Returns the target of a camera. A view direction is first converted to a target.
fn target(camera: &mut Camera) -> &mut DVec3 {
    if let View::Direction(direction) = camera.view {
        camera.view = View::Target(camera.position + direction);
    }
    vector(&mut camera.view)
}

/// Returns the view direction of a camera. A target is first converted to a direction.
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

/// Clamps a value to the range of its quantity: interpolation between values in range can overshoot it.
fn clamped(value: Value, quantity: Quantity) -> Value {
    let range = quantity.range().limits();
    let within = |number: f64| number.clamp(*range.start(), *range.end());
    match value {
        Value::Number(number) => Value::Number(within(number)),
        Value::Vector(vector) => Value::Vector(vector.map(within)),
        Value::Color(color) => Value::Color(color.max(Rgb::ZERO)),
        Value::Rotation(_) | Value::Flag(_) => value,
    }
}

impl ValueMut<'_> {
    fn read(self) -> Value {
        match self {
            Self::Number(stored) => Value::Number(*stored),
            Self::Single(stored) => Value::Number(f64::from(*stored)),
            Self::Vector(stored) => Value::Vector(*stored),
            Self::Falloff(stored) => {
                Value::Vector(DVec3::new(stored.constant, stored.linear, stored.quadratic))
            }
            Self::Rotation(stored) => Value::Rotation(*stored),
            Self::Color(stored) => Value::Color(*stored),
            Self::Flag(stored) => Value::Flag(*stored),
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "coefficients are f32")]
    fn write(self, value: Value) -> bool {
        match (self, value) {
            (Self::Number(stored), Value::Number(value)) => put(stored, value),
            (Self::Single(stored), Value::Number(value)) => put(stored, value as f32),
            (Self::Vector(stored), Value::Vector(value)) => put(stored, value),
            (Self::Falloff(stored), Value::Vector(DVec3 { x, y: linear, z: quadratic })) => {
                put(stored, Falloff { constant: x.clamp(SMALLEST, f64::INFINITY), linear, quadratic })
            }
            (Self::Rotation(stored), Value::Rotation(value)) => put(stored, value),
            (Self::Color(stored), Value::Color(value)) => put(stored, value),
            (Self::Flag(stored), Value::Flag(value)) => put(stored, value),
            _ => false,
        }
    }
}

/// Writes a value, and returns whether it differs from the previous one.
fn put<T: PartialEq>(stored: &mut T, value: T) -> bool {
    let differs = *stored != value;
    *stored = value;
    differs
}
