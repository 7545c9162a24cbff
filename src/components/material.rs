//! What a surface looks like.

use crate::color::Rgb;

/// How a surface answers ambient and direct light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Ambient reflection coefficient, 0..=1.
    pub k_a: f32,
    /// Diffuse reflection coefficient, 0..=1.
    pub k_d: f32,
    /// The colour in diffuse and, unless there is an own one, in ambient light.
    pub color: Rgb,
    /// The colour in ambient light, where it differs.
    pub ambient_color: Option<Rgb>,
}

/// The surface shows highlights of lights. Presence of this component is what calls for them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular {
    /// Specular reflection coefficient, 0..=1. Highlights have the light's colour, not the material's.
    pub k_s: f32,
    /// How narrow they are: the exponent of N.H, 0..=[`Self::LARGEST_SHININESS`].
    pub shininess: f32,
}

impl Specular {
    /// The largest exponent. A highlight is a quarter of a degree wide then.
    pub const LARGEST_SHININESS: f32 = 1e6;
}

/// The surface mirrors. Presence of this component is what calls for reflection rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflective {
    /// Share of the reflected ray's light, 0..=1.
    pub k_r: f32,
}
