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

/// Light goes through the surface, and is bent. Presence of this component is what calls for refraction rays.
///
/// With R seen in the mirror and T through the surface, k_r R + k_t T is added to what the surface itself shows; with
/// `fresnel`, k_r R + k_t (F R + (1 - F) T), where F is the Fresnel reflectance of unpolarised light. Under total internal
/// reflection the whole share k_t goes to R, with `fresnel` or without.
///
/// Spheres and boxes are solids; a plane bounds the half-space behind its normal. What is clear lets light through to other
/// things: at each crossing of the surface k_t of a shadow ray is left, and of every length l inside exp(-absorption l).
/// Shadow rays are not bent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refractive {
    /// Share of the light that goes through, 0..=1.
    pub k_t: f32,
    /// Refractive index of the inside, that of the empty space being 1; [`Self::SMALLEST_IOR`]..=[`Self::LARGEST_IOR`].
    pub ior: f64,
    /// What the inside swallows, RGB, per scene unit of length in the world, 0 or more: exp(-absorption l) is left after l.
    pub absorption: Rgb,
    /// Does the share that is mirrored depend on the angle?
    pub fresnel: bool,
}

impl Refractive {
    /// The smallest refractive index.
    pub const SMALLEST_IOR: f64 = 1e-3;
    /// The largest refractive index.
    pub const LARGEST_IOR: f64 = 1e3;
}

/// Every second square of the surface has another colour.
///
/// The squares are counted in the entity's own units, before its transform: on a plane from the entity's origin, on every
/// face of a box from the face's lower corner. The pattern is two-dimensional: it does not show on spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checker {
    /// The colour in place of [`Material::color`], in diffuse light and, unless there is a [`Material::ambient_color`], in
    /// ambient light.
    pub color: Rgb,
    /// Side of a square in the entity's own units, > 0.
    pub size: f64,
}
