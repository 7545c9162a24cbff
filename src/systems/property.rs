//! The stored form of animated values, their sources, and the changes that writes declare.

use hecs::{Entity, World};

use super::Changes;
use super::property_access::{Parts, value};
use crate::animation::Value;
use crate::color::Rgb;
use crate::components::{Camera, Material, Property, Requirement, View};

/// The stored form of a value, which can differ from the value itself.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stored {
    Value(Value),
    View(View),
    AmbientColor(Option<Rgb>),
}

impl Stored {
    /// Returns a value as it is stored. `None` if the entity does not have the value.
    pub(super) fn of(world: &World, entity: Entity, property: Property) -> Option<Self> {
        Some(match property {
            Property::Target | Property::View if world.satisfies::<&Camera>(entity) => {
                Self::View(world.get::<&Camera>(entity).ok()?.view)
            }
            Property::AmbientColor => Self::AmbientColor(world.get::<&Material>(entity).ok()?.ambient_color),
            _ => Self::Value(value(world, entity, property)?),
        })
    }
}

/// Returns the properties from which a value is derived: the property itself or, if it is not stored, the properties that define it.
/// `is_driven` returns true for properties that will be written before they are read.
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

impl Parts<'_> {
    /// Restores a value from its [stored form](Stored::of).
    pub(super) fn put_back(&mut self, property: Property, stored: Stored) {
        match stored {
            Stored::Value(value) => {
                self.set(property, value);
            }
            Stored::View(view) => {
                if let Some(camera) = &mut self.camera {
                    camera.view = view;
                }
            }
            Stored::AmbientColor(color) => {
                if let Some(material) = &mut self.material {
                    material.ambient_color = color;
                }
            }
        }
    }
}

/// Declares that a property of an entity, with or without a camera, has changed. Lights, cameras and settings of the whole scene are read at
/// every moment anyway.
pub(super) fn declare(property: Property, entity: Entity, has_camera: bool, changes: &mut Changes) {
    match property.part() {
        Requirement::Transform | Requirement::Rotation => changes.mark_transform(entity),
        Requirement::Target if !has_camera => changes.mark_transform(entity),
        Requirement::Radius | Requirement::Box | Requirement::Plane | Requirement::Shape => {
            changes.mark_shape(entity);
        }
        Requirement::Material
        | Requirement::Specular
        | Requirement::Reflective
        | Requirement::Refractive
        | Requirement::Pattern
        | Requirement::SizedPattern
        | Requirement::DirectedPattern
        | Requirement::Stripes
        | Requirement::Bricks
        | Requirement::Noise
        | Requirement::Emission => {
            changes.mark_material(entity);
        }
        Requirement::Light
        | Requirement::DirectionalLight
        | Requirement::SpotLight
        | Requirement::Falloff
        | Requirement::SphereLight
        | Requirement::RectangleLight
        | Requirement::Camera
        | Requirement::Target
        | Requirement::View
        | Requirement::FieldOfView
        | Requirement::HorizontalFieldOfView
        | Requirement::Orthographic
        | Requirement::Screen
        | Requirement::ScreenWidth
        | Requirement::Lens
        | Requirement::Focus
        | Requirement::AmbientLight
        | Requirement::FlatBackground
        | Requirement::Gradient
        | Requirement::Horizon
        | Requirement::Sun
        | Requirement::Stars
        | Requirement::Fog
        | Requirement::FogLayer => changes.mark_settings(),
    }
}
