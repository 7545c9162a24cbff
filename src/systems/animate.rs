//! Writes what tracks say about a moment.

use hecs::{Entity, World};

use super::Changes;
use crate::color::Rgb;
use crate::components::{
    Animated, Camera, Channel, Light, LightKind, Material, Reflective, Refractive, Specular, Transform, View,
};
use crate::time::Time;

/// The components that channels write to, if an entity has them.
type Targets<'a> = (
    Entity,
    &'a Animated,
    Option<&'a mut Transform>,
    Option<&'a mut Material>,
    Option<&'a mut Specular>,
    Option<&'a mut Reflective>,
    Option<&'a mut Refractive>,
    Option<&'a mut Light>,
    Option<&'a mut Camera>,
);

/// Sets every animated value to its track's value at `time`, and records what really changed.
///
/// A channel whose component the entity lacks does nothing.
pub fn animate(world: &mut World, time: Time, changes: &mut Changes) {
    let seconds = time.seconds();
    for (
        entity,
        animated,
        mut transform,
        mut material,
        mut specular,
        mut reflective,
        mut refractive,
        mut light,
        mut camera,
    ) in world.query_mut::<Targets<'_>>()
    {
        let placed = transform.as_deref().copied();
        let painted = (
            material.as_deref().copied(),
            specular.as_deref().copied(),
            reflective.as_deref().copied(),
            refractive.as_deref().copied(),
        );
        for channel in &animated.0 {
            if let Some(transform) = transform.as_deref_mut() {
                move_entity(transform, channel, seconds);
            }
            if let Some(material) = material.as_deref_mut() {
                paint(material, channel, seconds);
            }
            if let Some(specular) = specular.as_deref_mut() {
                polish(specular, channel, seconds);
            }
            if let (Some(reflective), Channel::Kr(track)) = (reflective.as_deref_mut(), channel) {
                reflective.k_r = coefficient(track.at(seconds));
            }
            if let Some(refractive) = refractive.as_deref_mut() {
                clear(refractive, channel, seconds);
            }
            if let Some(light) = light.as_deref_mut() {
                shine(light, channel, seconds);
            }
            if let Some(camera) = camera.as_deref_mut() {
                film(camera, channel, seconds);
            }
        }
        if transform.as_deref().copied() != placed {
            changes.transform(entity);
        }
        let repainted = (
            material.as_deref().copied(),
            specular.as_deref().copied(),
            reflective.as_deref().copied(),
            refractive.as_deref().copied(),
        );
        if repainted != painted {
            changes.material(entity);
        }
    }
}

fn move_entity(transform: &mut Transform, channel: &Channel, seconds: f64) {
    match channel {
        Channel::Translation(track) => transform.translation = track.at(seconds),
        Channel::Rotation(track) => transform.rotation = track.at(seconds),
        Channel::Scale(track) => transform.scale = track.at(seconds),
        _ => {}
    }
}

fn paint(material: &mut Material, channel: &Channel, seconds: f64) {
    match channel {
        Channel::Ka(track) => material.k_a = coefficient(track.at(seconds)),
        Channel::Kd(track) => material.k_d = coefficient(track.at(seconds)),
        Channel::Color(track) => material.color = track.at(seconds),
        Channel::AmbientColor(track) => material.ambient_color = Some(track.at(seconds)),
        _ => {}
    }
}

fn polish(specular: &mut Specular, channel: &Channel, seconds: f64) {
    match channel {
        Channel::Ks(track) => specular.k_s = coefficient(track.at(seconds)),
        Channel::Shininess(track) => specular.shininess = shininess(track.at(seconds)),
        _ => {}
    }
}

fn clear(refractive: &mut Refractive, channel: &Channel, seconds: f64) {
    match channel {
        Channel::Kt(track) => refractive.k_t = coefficient(track.at(seconds)),
        Channel::Ior(track) => {
            refractive.ior = track.at(seconds).clamp(Refractive::SMALLEST_IOR, Refractive::LARGEST_IOR);
        }
        Channel::Absorption(track) => refractive.absorption = track.at(seconds).max(Rgb::ZERO),
        _ => {}
    }
}

fn shine(light: &mut Light, channel: &Channel, seconds: f64) {
    match channel {
        Channel::Intensity(track) => light.intensity = track.at(seconds),
        Channel::Direction(track) => {
            if let LightKind::Directional { direction } = &mut light.kind {
                *direction = track.at(seconds);
            }
        }
        _ => {}
    }
}

fn film(camera: &mut Camera, channel: &Channel, seconds: f64) {
    match channel {
        Channel::Position(track) => camera.position = track.at(seconds),
        Channel::Target(track) => camera.view = View::Target(track.at(seconds)),
        _ => {}
    }
}

/// A curve through coefficients may leave their range; the value may not.
#[expect(clippy::cast_possible_truncation, reason = "colour is f32")]
fn coefficient(value: f64) -> f32 {
    value.clamp(0.0, 1.0) as f32
}

/// Likewise for exponents of highlights.
#[expect(clippy::cast_possible_truncation, reason = "colour is f32")]
fn shininess(value: f64) -> f32 {
    value.clamp(0.0, f64::from(Specular::LARGEST_SHININESS)) as f32
}
