//! The appearance of surfaces.

use glam::DVec3;

use crate::color::Rgb;

/// The ambient and diffuse reflection of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// The ambient reflection coefficient, 0..=1.
    pub k_a: f32,
    /// The diffuse reflection coefficient, 0..=1.
    pub k_d: f32,
    /// The colour in diffuse light, and in ambient light unless `ambient_color` is given.
    pub color: Rgb,
    /// The colour in ambient light, if it differs from `color`.
    pub ambient_color: Option<Rgb>,
    /// True for a metal, whose highlights and reflected light have the colour `color`, each channel of it at most 1.
    pub metallic: bool,
}

impl Material {
    /// Creates a matte material: k_a is 0.3 and k_d is 0.7, so that a surface in white ambient light that faces a light of intensity 1 has
    /// the material's colour.
    ///
    /// ```
    /// use rayreel::color::srgb;
    /// use rayreel::components::Material;
    /// let clay = Material::matte(srgb(230, 100, 50));
    /// let bright = Material { k_d: 0.9, ..clay };
    /// # assert_eq!(bright.k_a, 0.3);
    /// ```
    #[must_use]
    pub const fn matte(color: Rgb) -> Self {
        Self { k_a: 0.3, k_d: 0.7, color, ambient_color: None, metallic: false }
    }
}

impl Default for Material {
    /// Returns a white material with coefficients of 0, for surfaces that only reflect or transmit light.
    ///
    /// ```
    /// use rayreel::World;
    /// use rayreel::components::{Material, Reflective, Refractive, Shape, Transform};
    /// let (mut world, ball) = (World::new(), Shape::Sphere { radius: 1.0 });
    /// world.spawn((ball, Material::default(), Refractive::GLASS, Transform::at(-2.0, 1.0, 0.0)));
    /// world.spawn((ball, Material::default(), Reflective::MIRROR, Transform::at(2.0, 1.0, 0.0)));
    /// ```
    fn default() -> Self {
        Self { k_a: 0.0, k_d: 0.0, color: Rgb::ONE, ambient_color: None, metallic: false }
    }
}

/// Specular highlights of lights on the surface. The presence of this component enables them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular {
    /// The specular reflection coefficient, 0..=1. Highlights have the colour of the light and, on metals, of the material.
    pub k_s: f32,
    /// The exponent of N.H, 0..=[`Self::LARGEST_SHININESS`]. Larger exponents give narrower highlights.
    pub shininess: f32,
}

impl Specular {
    /// The largest exponent, for a highlight a quarter of a degree wide.
    pub const LARGEST_SHININESS: f32 = 1e6;
}

/// Mirror reflection. The presence of this component enables reflection rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflective {
    /// The weight of the reflected ray's light, 0..=1. On metals, it is multiplied by the colour of the material.
    pub k_r: f32,
}

impl Reflective {
    /// A mirror, k_r 0.9. Its [`Material`] may be the default.
    pub const MIRROR: Self = Self { k_r: 0.9 };
}

/// Refraction: the surface transmits and bends light. The presence of this component enables refraction rays.
///
/// With R the reflected and T the transmitted radiance, k_r R + k_t T is added to the radiance of the surface itself. With `fresnel` the
/// sum is k_r R + k_t (F R + (1 - F) T), where F is the Fresnel reflectance of unpolarised light. Under total internal reflection the whole
/// weight k_t goes to R, with or without `fresnel`.
///
/// Spheres and boxes are solids; a plane bounds the half-space behind its normal. Shadow rays pass through transparent objects without
/// bending. They are attenuated by k_t at each crossing of the surface, and by exp(-absorption l) over each length l inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refractive {
    /// The fraction of the light that is transmitted, 0..=1.
    pub k_t: f32,
    /// The refractive index of the inside relative to empty space, [`Self::SMALLEST_IOR`]..=[`Self::LARGEST_IOR`].
    pub ior: f64,
    /// The RGB absorption of the inside per scene unit of length in the world, 0 or more: exp(-absorption l) is transmitted over a length
    /// l.
    pub absorption: Rgb,
    /// True if the reflectance depends on the angle (Fresnel).
    pub fresnel: bool,
}

impl Refractive {
    /// Clear glass: k_t 0.97, refractive index 1.5, no absorption, Fresnel reflectance. Its [`Material`] may be the default.
    pub const GLASS: Self = Self { k_t: 0.97, ior: 1.5, absorption: Rgb::ZERO, fresnel: true };
    /// The smallest refractive index.
    pub const SMALLEST_IOR: f64 = 1e-3;
    /// The largest refractive index.
    pub const LARGEST_IOR: f64 = 1e3;
}

/// Light that a surface gives off by itself, as RGB radiance, 0 or more: 1 is full white. The presence of this component enables it.
///
/// It is added to the other light of the surface on both sides, also where the surface is seen in a mirror or through glass. It lights no
/// other surface: for that, add a [`Light`](super::Light) to the entity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission(pub Rgb);

/// A pattern: a second colour on a part of the surface.
///
/// Patterns are measured in the entity's own units, before its transform, so that they move with it. Spheres are cut out of a solid pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pattern {
    /// The second colour. It replaces [`Material::color`] in diffuse light and, unless there is a [`Material::ambient_color`], in ambient
    /// light.
    pub color: Rgb,
    /// The part of the surface with the second colour.
    pub kind: PatternKind,
}

/// The kind of a pattern. Lengths are in the entity's own units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PatternKind {
    /// Every second square of the surface: on a plane starting at the entity's origin, on each face of a box at the lower corner of the
    /// face. On a sphere, every second one of the cubes from which it is cut.
    Checker {
        /// The side of a square, > 0.
        size: f64,
    },
    /// Parallel stripes. A stripe of the first colour starts at the origin, and one of the second colour follows.
    Stripes {
        /// The distance from a stripe to the next one of its colour, > 0.
        size: f64,
        /// The fraction of the second colour, 0..=1.
        ratio: f64,
        /// The direction across the stripes, of any length but zero.
        direction: DVec3,
        /// The distance by which the stripes are moved along the direction.
        offset: f64,
    },
    /// A wall or a pavement of bricks in the material's colour, with mortar in the second colour. Rows follow each other along y, or along z
    /// on a surface across y; every second row is shifted by half a brick. Bricks start like the squares of a checker.
    Bricks {
        /// The distances from a brick to the next one along the three axes, > 0.
        size: DVec3,
        /// The width of the joints, which is a part of the size, >= 0.
        mortar: f64,
    },
    /// A blend from the material's colour to the second one.
    Gradient {
        /// The length of the blend, > 0.
        size: f64,
        /// The direction from the first colour to the second one, of any length but zero.
        direction: DVec3,
        /// The distance by which the middle of the blend is moved from the origin along the direction.
        offset: f64,
    },
    /// A random blend of both colours in blotches, by fractal noise.
    Noise {
        /// The size of the largest blotches, > 0.
        size: f64,
        /// The number of noises, each with half the size and half the strength of the one before, from 1 to
        /// [`LARGEST_OCTAVES`](Self::LARGEST_OCTAVES).
        octaves: u32,
        /// The factor of the contrast, >= 0.
        contrast: f64,
    },
}

impl PatternKind {
    /// The largest number of octaves.
    pub const LARGEST_OCTAVES: u32 = 16;
}
