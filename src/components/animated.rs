//! What moves by tracks.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use crate::color::Rgb;
use crate::timeline::Track;

/// The tracks that drive this entity's values.
#[derive(Clone, Debug, Default)]
pub struct Animated(pub Vec<Channel>);

/// A value of an entity that a track can drive, with the track. Shared materials share their track.
#[derive(Clone, Debug)]
pub enum Channel {
    /// [`Transform::translation`](super::Transform::translation).
    Translation(Arc<Track<DVec3>>),
    /// [`Transform::rotation`](super::Transform::rotation).
    Rotation(Arc<Track<DQuat>>),
    /// [`Transform::scale`](super::Transform::scale).
    Scale(Arc<Track<DVec3>>),
    /// [`Material::k_a`](super::Material::k_a).
    Ka(Arc<Track<f64>>),
    /// [`Material::k_d`](super::Material::k_d).
    Kd(Arc<Track<f64>>),
    /// [`Material::color`](super::Material::color).
    Color(Arc<Track<Rgb>>),
    /// [`Material::ambient_color`](super::Material::ambient_color).
    AmbientColor(Arc<Track<Rgb>>),
    /// [`Specular::k_s`](super::Specular::k_s).
    Ks(Arc<Track<f64>>),
    /// [`Specular::shininess`](super::Specular::shininess).
    Shininess(Arc<Track<f64>>),
    /// [`Reflective::k_r`](super::Reflective::k_r).
    Kr(Arc<Track<f64>>),
    /// [`Refractive::k_t`](super::Refractive::k_t).
    Kt(Arc<Track<f64>>),
    /// [`Refractive::ior`](super::Refractive::ior).
    Ior(Arc<Track<f64>>),
    /// [`Refractive::absorption`](super::Refractive::absorption).
    Absorption(Arc<Track<Rgb>>),
    /// [`Light::intensity`](super::Light::intensity).
    Intensity(Arc<Track<Rgb>>),
    /// [`LightKind::Directional::direction`](super::LightKind).
    Direction(Arc<Track<DVec3>>),
    /// [`Camera::position`](super::Camera::position).
    Position(Arc<Track<DVec3>>),
    /// [`View::Target`](super::View::Target).
    Target(Arc<Track<DVec3>>),
}
