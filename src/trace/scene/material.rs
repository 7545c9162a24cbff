//! Surface materials.

use glam::DVec3;

use super::checker::CheckerPattern;
use super::fingerprint::Fingerprint;
use crate::color::Rgb;
use crate::trace::math::Bytes;

/// The material of a shape's surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceMaterial {
    /// Ambient coefficient times ambient colour.
    pub ambient: Rgb,
    /// Diffuse coefficient times colour.
    pub diffuse: Rgb,
    /// Specular coefficient, 0..=1; 0 without highlights.
    pub specular: f32,
    /// Exponent of N.H in highlights, 0 or more.
    pub shininess: f32,
    /// Share of the mirrored ray, 0..=1; 0 without reflection.
    pub reflected: f32,
    /// The transparent medium behind the surface; `None` if the surface is opaque.
    pub refraction: Option<Refraction>,
    /// Checker pattern with other colours, if any.
    pub checker: Option<Box<PreparedChecker>>,
    /// Light that the surface gives off, on both sides.
    pub emission: Rgb,
}

/// A transparent medium behind a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refraction {
    /// Share of the refracted ray, k_t, greater than 0, at most 1.
    pub transmitted: f32,
    /// Index of refraction, greater than 0.
    pub ior: f64,
    /// Absorption coefficient of the medium per unit of length, 0 or more.
    pub absorption: Rgb,
    /// True if k_t is divided between the refracted and the mirrored ray by Fresnel's equations.
    pub fresnel: bool,
}

/// A checker pattern of two colours. The material's own colours apply to the square at the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct PreparedChecker {
    /// Replaces [`SurfaceMaterial::ambient`] on every second square.
    pub ambient: Rgb,
    /// Replaces [`SurfaceMaterial::diffuse`] on every second square.
    pub diffuse: Rgb,
    /// The layout of the squares.
    pub squares: CheckerPattern,
}

impl SurfaceMaterial {
    /// Returns whether it scatters light from light sources.
    pub(crate) fn scatters(&self) -> bool {
        self.diffuse != Rgb::ZERO || self.specular > 0.0
    }

    /// Returns whether it spawns reflected or refracted rays.
    pub(crate) fn continues(&self) -> bool {
        self.reflected > 0.0 || self.refraction.is_some()
    }

    /// Writes the bytes of everything that pictures depend on.
    pub(super) fn write(&self, bytes: &mut Bytes) {
        let Self { ambient, diffuse, specular, shininess, reflected, refraction, checker, emission } = self;
        bytes.colors([*ambient, *diffuse]);
        [specular, shininess, reflected].into_iter().for_each(|number| bytes.number((*number).into()));
        bytes.count(refraction.is_some());
        if let Some(Refraction { transmitted, ior, absorption, fresnel }) = refraction {
            [f64::from(*transmitted), *ior].into_iter().for_each(|number| bytes.number(number));
            bytes.colors([*absorption]);
            bytes.count(*fresnel);
        }
        let emits = *emission != Rgb::ZERO;
        bytes.count(u32::from(checker.is_some()) + 2 * u32::from(emits));
        if let Some(checker) = checker {
            let PreparedChecker { ambient, diffuse, squares } = &**checker;
            bytes.colors([*ambient, *diffuse]);
            squares.numbers(|number| bytes.number(number));
        }
        if emits {
            bytes.colors([*emission]);
        }
    }

    /// Returns a fingerprint that equal materials share, and different ones hardly ever do.
    pub(super) fn fingerprint(&self) -> u64 {
        let Self { ambient, diffuse, specular, shininess, reflected, refraction, checker, emission } = self;
        let mut fingerprint = Fingerprint::default();
        let colors = |fingerprint: &mut Fingerprint, colors: &[Rgb]| {
            colors.iter().flat_map(Rgb::to_array).for_each(|channel| fingerprint.add(channel.into()));
        };
        colors(&mut fingerprint, &[*ambient, *diffuse, *emission]);
        [*specular, *shininess, *reflected].into_iter().for_each(|number| fingerprint.add(number.into()));
        if let Some(Refraction { transmitted, ior, absorption, fresnel }) = refraction {
            [f64::from(*transmitted), *ior, f64::from(*fresnel)]
                .into_iter()
                .for_each(|number| fingerprint.add(number));
            colors(&mut fingerprint, &[*absorption]);
        }
        if let Some(checker) = checker {
            colors(&mut fingerprint, &[checker.ambient, checker.diffuse]);
            checker.squares.numbers(|number| fingerprint.add(number));
        }
        fingerprint.finish()
    }

    /// Returns the ambient and diffuse colours at a point of the surface with this outward normal.
    pub(crate) fn colors_at(&self, point: DVec3, normal: DVec3) -> (Rgb, Rgb) {
        match self.second_square(point, normal) {
            Some(checker) => (checker.ambient, checker.diffuse),
            None => (self.ambient, self.diffuse),
        }
    }

    /// Returns the checker pattern, if the point is on one of its second squares.
    pub(crate) fn second_square(&self, point: DVec3, normal: DVec3) -> Option<&PreparedChecker> {
        self.checker.as_deref().filter(|checker| checker.squares.is_second(point, normal))
    }
}
