//! What gives light.

use glam::DVec3;

use crate::color::Rgb;

/// A light source. It does not weaken with distance unless it has a falloff.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// From where or which way.
    pub kind: LightKind,
    /// RGB, 0 or more; 1 lights a white, facing, fully diffuse surface to full.
    pub intensity: Rgb,
    /// Can anything stand in its way? A light without shadows reaches every surface that faces it, and costs no shadow rays.
    pub casts_shadows: bool,
    /// How it weakens with distance, if it does; nothing for directional lights, which are infinitely far away.
    pub falloff: Option<Falloff>,
}

/// How a light weakens: at distance d, in scene units of the world, 1 / (c0 + c1 d + c2 d^2) of the intensity is left.
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
    /// A light that casts shadows and does not weaken.
    #[must_use]
    pub const fn new(kind: LightKind, intensity: Rgb) -> Self {
        Self { kind, intensity, casts_shadows: true, falloff: None }
    }
}

/// From where the light comes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// From the entity's position, in all directions.
    Point,
    /// From the entity's position, in a cone about its own +z axis, as its world transform turns it.
    ///
    /// With h half the angle and c the cosine between the axis and the direction in which the light leaves, x is
    /// (c - cos h) / (cos((1 - softness) h) - cos h), held to 0..=1, and 3 x^2 - 2 x^3 of the intensity leaves: all of it
    /// up to (1 - softness) h from the axis, nothing from h on, save that the rim itself is lit where the softness is 0.
    Spot {
        /// From rim to rim, radians, greater than 0, at most pi.
        angle: f64,
        /// Share of the way from the rim to the axis in which the light fades, 0..=1.
        softness: f64,
    },
    /// From infinitely far away.
    Directional {
        /// The way the light travels, in the entity's own space; any length but zero.
        direction: DVec3,
    },
    /// From a surface around the entity's position, which itself is not seen: shadows are soft.
    ///
    /// Every lit point takes the mean of the light from several points of the surface, each of which shines as a point light
    /// does. The size does not change the intensity.
    Area {
        /// The surface.
        shape: AreaShape,
        /// How many of its points each lit point takes, 1..=[`AreaShape::LARGEST_SAMPLES`].
        samples: u32,
    },
}

/// What an area light looks like from the points that it lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AreaShape {
    /// A sphere about the entity's position, taken as the disc that faces the lit point.
    Sphere {
        /// Scene units, > 0; the world transform scales it by the cube root of what it does to volumes.
        radius: f64,
    },
    /// A rectangle about the entity's position, in the entity's own xy-plane, which shines both ways. The world transform
    /// scales and turns it.
    Rectangle {
        /// Along the own x axis, > 0.
        width: f64,
        /// Along the own y axis, > 0.
        height: f64,
    },
}

impl AreaShape {
    /// The most points of an area light that a lit point takes.
    pub const LARGEST_SAMPLES: u32 = 4096;
}
