//! What gives light.

use glam::DVec3;

use crate::color::Rgb;

/// A light source. It never weakens with distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// From where or which way.
    pub kind: LightKind,
    /// RGB, 0 or more; 1 lights a white, facing, fully diffuse surface to full.
    pub intensity: Rgb,
    /// Can anything stand in its way? A light without shadows reaches every surface that faces it, and costs no shadow rays.
    pub casts_shadows: bool,
}

impl Light {
    /// A light that casts shadows.
    #[must_use]
    pub const fn new(kind: LightKind, intensity: Rgb) -> Self {
        Self { kind, intensity, casts_shadows: true }
    }
}

/// From where the light comes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// From the entity's position, in all directions.
    Point,
    /// From infinitely far away.
    Directional {
        /// The way the light travels, in the entity's own space; any length but zero.
        direction: DVec3,
    },
}
