//! How surfaces answer light.

use glam::DVec3;

use super::checker::CheckerPattern;
use super::fingerprint::Fingerprint;
use crate::color::Rgb;
use crate::trace::math::Bytes;

/// How a shape's surface answers light.
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
    /// Whether k_t is shared between the refracted and the mirrored ray as Fresnel's equations say.
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
    pub squares: CheckerPattern,
}

impl SurfaceMaterial {
    /// Returns whether it sends on anything of lights.
    pub(crate) fn scatters(&self) -> bool {
        self.diffuse != Rgb::ZERO || self.specular > 0.0
    }

    /// Returns whether it sends rays on.
    pub(crate) fn continues(&self) -> bool {
        self.reflected > 0.0 || self.refraction.is_some()
    }

    /// Writes the bytes of all that pictures depend on.
    pub(super) fn write(&self, bytes: &mut Bytes) {
        let Self { ambient, diffuse, specular, shininess, reflected, refraction, checker } = self;
        bytes.colors([*ambient, *diffuse]);
        [specular, shininess, reflected].into_iter().for_each(|number| bytes.number((*number).into()));
        bytes.count(refraction.is_some());
        if let Some(Refraction { transmitted, ior, absorption, fresnel }) = refraction {
            [f64::from(*transmitted), *ior].into_iter().for_each(|number| bytes.number(number));
            bytes.colors([*absorption]);
            bytes.count(*fresnel);
        }
        bytes.count(checker.is_some());
        if let Some(checker) = checker {
            let Checker { ambient, diffuse, squares } = &**checker;
            bytes.colors([*ambient, *diffuse]);
            squares.numbers(|number| bytes.number(number));
        }
    }

    /// Returns a number that equal materials have in common, and others hardly ever.
    pub(super) fn fingerprint(&self) -> u64 {
        let Self { ambient, diffuse, specular, shininess, reflected, refraction, checker } = self;
        let mut fingerprint = Fingerprint::default();
        let colors = |fingerprint: &mut Fingerprint, colors: &[Rgb]| {
            colors.iter().flat_map(Rgb::to_array).for_each(|channel| fingerprint.add(channel.into()));
        };
        colors(&mut fingerprint, &[*ambient, *diffuse]);
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

    /// Ambient and diffuse colours at a point of the surface with this outward normal.
    pub(crate) fn colors_at(&self, point: DVec3, normal: DVec3) -> (Rgb, Rgb) {
        match &self.checker {
            Some(checker) if checker.squares.is_second(point, normal) => (checker.ambient, checker.diffuse),
            _ => (self.ambient, self.diffuse),
        }
    }
}
