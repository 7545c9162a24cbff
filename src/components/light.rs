//! Light sources.

use glam::DVec3;

use crate::color::Rgb;

/// A light source. It does not weaken with distance unless it has a falloff.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// The position or direction of the light.
    pub kind: LightKind,
    /// RGB, 0 or more; 1 lights a white, facing, fully diffuse surface to full.
    pub intensity: Rgb,
    /// Whether the light can be occluded. A light without shadows reaches every surface that faces it, and costs no shadow rays.
    pub casts_shadows: bool,
    /// The falloff with distance, if any; ignored for directional lights, which are infinitely far away.
    pub falloff: Option<Falloff>,
}

/// The weakening of a light: at distance d, in scene units of the world, 1 / (c0 + c1 d + c2 d^2) of the intensity is left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Falloff {
    /// c0, greater than 0.
    pub constant: f64,
    /// c1, 0 or more.
    pub linear: f64,
    /// c2, 0 or more.
    pub quadratic: f64,
}

impl Light {
    /// Creates a light that casts shadows and does not weaken.
    #[must_use]
    pub const fn new(kind: LightKind, intensity: Rgb) -> Self {
        Self { kind, intensity, casts_shadows: true, falloff: None }
    }
}

/// Where the light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// From the entity's position, in all directions.
    Point,
    /// From the entity's position, in a cone about its own +z axis, as its world transform turns it.
    ///
    /// With h half the angle and c the cosine between the axis and the direction in which the light leaves, x is (c - cos h) /
    /// (cos((1 - softness) h) - cos h), clamped to 0..=1, and 3 x^2 - 2 x^3 of the intensity leaves: all of it up to (1 -
    /// softness) h from the axis, nothing from h on, save that the rim itself is lit where the softness is 0.
    Spot {
        /// From rim to rim, radians, greater than 0, at most pi.
        angle: f64,
        /// The share of the distance from the rim to the axis over which the light fades, 0..=1.
        softness: f64,
    },
    /// From infinitely far away.
    Directional {
        /// The direction in which the light travels, in the entity's own space; any length but zero.
        direction: DVec3,
    },
    /// From a surface around the entity's position, which is not itself visible: shadows are soft.
    ///
    /// Every lit point receives the mean of the light from several points of the surface, each of which shines like a point
    /// light. The size does not change the intensity.
    Area {
        /// The surface.
        shape: AreaShape,
        /// The number of its points sampled per lit point, 1..=[`AreaShape::LARGEST_SAMPLES`].
        samples: u32,
    },
}

/// The shape of an area light as seen from the points that it lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AreaShape {
    /// A sphere about the entity's position, sampled as the disc that faces the lit point.
    Sphere {
        /// Scene units, > 0; the world transform scales it by the cube root of what it does to volumes.
        radius: f64,
    },
    /// A rectangle about the entity's position, in the entity's own xy-plane, which shines from both sides. The world transform
    /// scales and turns it.
    Rectangle {
        /// Along the own x axis, > 0.
        width: f64,
        /// Along the own y axis, > 0.
        height: f64,
    },
}

impl AreaShape {
    /// The most points of an area light sampled per lit point.
    pub const LARGEST_SAMPLES: u32 = 4096;
}
