//! The appearance of surfaces.

use crate::color::Rgb;

/// How a surface reflects ambient and direct light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Ambient reflection coefficient, 0..=1.
    pub k_a: f32,
    /// Diffuse reflection coefficient, 0..=1.
    pub k_d: f32,
    /// The colour in diffuse and, unless there is a separate one, in ambient light.
    pub color: Rgb,
    /// The colour in ambient light, where it differs.
    pub ambient_color: Option<Rgb>,
}

/// Highlights of lights on the surface. Presence of this component enables them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular {
    /// Specular reflection coefficient, 0..=1. Highlights have the light's colour, not the material's.
    pub k_s: f32,
    /// The exponent of N.H, 0..=[`Self::LARGEST_SHININESS`]: the larger, the narrower the highlight.
    pub shininess: f32,
}

impl Specular {
    /// The largest exponent. A highlight is a quarter of a degree wide then.
    pub const LARGEST_SHININESS: f32 = 1e6;
}

/// Mirror reflection. Presence of this component enables reflection rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflective {
    /// Share of the reflected ray's light, 0..=1.
    pub k_r: f32,
}

/// Refraction: light is transmitted through the surface, and bent. Presence of this component enables refraction rays.
///
/// With R seen by reflection and T through the surface, k_r R + k_t T is added to what the surface itself shows; with `fresnel`,
/// k_r R + k_t (F R + (1 - F) T), where F is the Fresnel reflectance of unpolarised light. Under total internal reflection the
/// whole share k_t goes to R, with `fresnel` or without.
///
/// Spheres and boxes are solids; a plane bounds the half-space behind its normal. Transparent objects let light through to
/// others: at each crossing of the surface k_t of a shadow ray is left, and of every length l inside exp(-absorption l). Shadow
/// rays are not bent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refractive {
    /// The share of the light that is transmitted, 0..=1.
    pub k_t: f32,
    /// The refractive index of the inside, that of empty space being 1; [`Self::SMALLEST_IOR`]..=[`Self::LARGEST_IOR`].
    pub ior: f64,
    /// The absorption of the inside, RGB, per scene unit of length in the world, 0 or more: exp(-absorption l) is left after l.
    pub absorption: Rgb,
    /// Whether the reflected share depends on the angle.
    pub fresnel: bool,
}

impl Refractive {
    /// The smallest refractive index.
    pub const SMALLEST_IOR: f64 = 1e-3;
    /// The largest refractive index.
    pub const LARGEST_IOR: f64 = 1e3;
}

/// A checker pattern: every second square of the surface has another colour.
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
