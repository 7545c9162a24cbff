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
    /// How it weakens with distance, if it does.
    pub falloff: Option<Falloff>,
    /// Is it asked whether anything stands in its way?
    pub casts_shadows: bool,
    /// The light's own shape, which does not stand in its way.
    pub own_shape: Option<Slot>,
}

/// How a light weakens: at distance d, 1 / (c0 + c1 d + c2 d^2) of the intensity is left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Falloff {
    /// c0, greater than 0 and finite.
    pub constant: f64,
    /// c1, 0 or more and finite.
    pub linear: f64,
    /// c2, 0 or more and finite.
    pub quadratic: f64,
}

impl Falloff {
    /// What is left of the intensity at a distance, 0 or more.
    pub(super) fn at(&self, distance: f64) -> f64 {
        // A finite distance times a zero coefficient is zero.
        let distance = distance.min(f64::MAX);
        1.0 / (self.constant + distance * (self.linear + distance * self.quadratic))
    }
}

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightSource {
    /// A point.
    Point(DVec3),
    /// Infinitely far away, in this direction from everywhere; any length but zero.
    Towards(DVec3),
}
