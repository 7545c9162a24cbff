//! Lights, as the kernel sees them.

use glam::DVec3;

use super::Slot;
use crate::color::Rgb;

/// A light in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Where the light comes from.
    pub source: LightSource,
    /// RGB, 0 or more.
    pub intensity: Rgb,
    /// Is it asked whether anything stands in its way?
    pub casts_shadows: bool,
    /// The light's own shape, which does not stand in its way.
    pub own_shape: Option<Slot>,
}

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightSource {
    /// A point.
    Point(DVec3),
    /// Infinitely far away, in this direction from everywhere; any length but zero.
    Towards(DVec3),
}
