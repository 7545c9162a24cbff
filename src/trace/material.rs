//! How surfaces answer light.

use glam::{DAffine3, DMat3, DVec3};

use super::Surface;
use super::shapes::inverse;
use crate::color::Rgb;

/// How a slot's surface answers light.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceMaterial {
    /// Ambient coefficient times ambient colour.
    pub ambient: Rgb,
    /// Diffuse coefficient times colour.
    pub diffuse: Rgb,
    /// Specular coefficient, 0..=1; 0 where there are no highlights.
    pub specular: f32,
    /// The exponent of N.H in highlights, 0 or more.
    pub shininess: f32,
    /// Share of the mirrored ray, 0..=1; 0 where nothing is mirrored.
    pub reflected: f32,
    /// What goes through; `None` where nothing does.
    pub refraction: Option<Refraction>,
    /// Squares of other colours, if there are any.
    pub checker: Option<Box<Checker>>,
}

/// A clear medium behind a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refraction {
    /// Share of the refracted ray, k_t, greater than 0, at most 1.
    pub transmitted: f32,
    /// Index of refraction, greater than 0.
    pub ior: f64,
    /// What the medium takes away per unit of length, 0 or more.
    pub absorption: Rgb,
    /// Is k_t shared between the refracted and the mirrored ray as Fresnel's equations say?
    pub fresnel: bool,
}

/// Squares of two colours. The material's own colours are those of the square at the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Checker {
    /// As [`SurfaceMaterial::ambient`], on every second square.
    pub ambient: Rgb,
    /// As [`SurfaceMaterial::diffuse`], on every second square.
    pub diffuse: Rgb,
    /// Where the squares are.
    pub squares: Squares,
}

/// A grid of squares on a surface, in the shape's own space.
#[derive(Clone, Debug, PartialEq)]
pub struct Squares {
    forward: DMat3,
    inverse: DMat3,
    translation: DVec3,
    size: f64,
    surface: Checkered,
}

#[derive(Clone, Debug, PartialEq)]
enum Checkered {
    /// Along two axes through the origin.
    Plane([DVec3; 2]),
    /// On each face, from its lower corner.
    Box(DVec3),
}

impl SurfaceMaterial {
    /// Is anything of lights sent on?
    pub(super) fn scatters(&self) -> bool {
        self.diffuse != Rgb::ZERO || self.specular > 0.0
    }

    /// Does the surface send rays on?
    pub(super) fn continues(&self) -> bool {
        self.reflected > 0.0 || self.refraction.is_some()
    }

    /// Ambient and diffuse colours at a point.
    pub(super) fn colors_at(&self, surface: &Surface) -> (Rgb, Rgb) {
        match &self.checker {
            Some(checker) if checker.squares.is_second(surface.point, surface.normal) => {
                (checker.ambient, checker.diffuse)
            }
            _ => (self.ambient, self.diffuse),
        }
    }
}

impl Squares {
    /// On a plane through the map's translation whose normal, before it is mapped, is this one. The squares lie along the two
    /// world axes that the normal points along least.
    #[must_use]
    pub fn on_plane(map: DAffine3, normal: DVec3, size: f64) -> Self {
        let size_of = normal.abs();
        let [a, b] = if size_of.y >= size_of.x && size_of.y >= size_of.z {
            [DVec3::X, DVec3::Z]
        } else if size_of.z >= size_of.x {
            [DVec3::X, DVec3::Y]
        } else {
            [DVec3::Z, DVec3::Y]
        };
        let normal = normal.normalize_or(DVec3::Y);
        let first = (a - normal * a.dot(normal)).normalize_or(a);
        let second = (b - normal * b.dot(normal) - first * b.dot(first)).normalize_or(b);
        Self::new(map, size, Checkered::Plane([first, second]))
    }

    /// On the faces of a box around the map's translation with these half edge lengths, before it is mapped.
    #[must_use]
    pub fn on_box(map: DAffine3, half: DVec3, size: f64) -> Self {
        Self::new(map, size, Checkered::Box(half))
    }

    fn new(map: DAffine3, size: f64, surface: Checkered) -> Self {
        Self {
            forward: map.matrix3,
            inverse: inverse(map.matrix3),
            translation: map.translation,
            size,
            surface,
        }
    }

    /// Is the point on a square of the second colours?
    fn is_second(&self, point: DVec3, normal: DVec3) -> bool {
        let own = self.inverse * (point - self.translation);
        let [x, y] = match &self.surface {
            Checkered::Plane(axes) => axes.map(|axis| own.dot(axis)),
            Checkered::Box(half) => {
                // A face's normal goes back by the transpose, up to its length.
                let across = (self.forward.transpose() * normal).abs();
                let from_corner = own + *half;
                if across.x >= across.y && across.x >= across.z {
                    [from_corner.y, from_corner.z]
                } else if across.y >= across.z {
                    [from_corner.x, from_corner.z]
                } else {
                    [from_corner.x, from_corner.y]
                }
            }
        };
        let square = |place: f64| (place / self.size).floor();
        (square(x) + square(y)).rem_euclid(2.0) == 1.0
    }
}
