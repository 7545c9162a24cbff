//! Surface materials.

use glam::DVec3;

use super::fingerprint::Fingerprint;
use super::pattern::PatternLayout;
use crate::color::{Rgb, blend};
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
    /// Colour by which highlights and all reflected light are multiplied, up to 1 in each channel; `None` for white.
    pub tint: Option<Rgb>,
    /// Share of the mirrored ray, 0..=1; 0 without reflection.
    pub reflected: f32,
    /// The transparent medium behind the surface; `None` if the surface is opaque.
    pub refraction: Option<Refraction>,
    /// Pattern with other colours, if any.
    pub pattern: Option<Box<PreparedPattern>>,
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

/// A pattern of two colours: the material's own and the second ones.
#[derive(Clone, Debug, PartialEq)]
pub struct PreparedPattern {
    /// The second colour in place of [`SurfaceMaterial::ambient`].
    pub ambient: Rgb,
    /// The second colour in place of [`SurfaceMaterial::diffuse`].
    pub diffuse: Rgb,
    /// The fraction of the second colours at each point.
    pub layout: PatternLayout,
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
        let Self { ambient, diffuse, specular, shininess, tint, reflected, refraction, pattern, emission } =
            self;
        bytes.colors([*ambient, *diffuse]);
        [specular, shininess, reflected].into_iter().for_each(|number| bytes.number((*number).into()));
        bytes.count(refraction.is_some());
        if let Some(Refraction { transmitted, ior, absorption, fresnel }) = refraction {
            [f64::from(*transmitted), *ior].into_iter().for_each(|number| bytes.number(number));
            bytes.colors([*absorption]);
            bytes.count(*fresnel);
        }
        let emits = *emission != Rgb::ZERO;
        let code = pattern.as_ref().map_or(0, |pattern| pattern.layout.code());
        bytes.count(code + 2 * u32::from(emits) + 32 * u32::from(tint.is_some()));
        if let Some(pattern) = pattern {
            let PreparedPattern { ambient, diffuse, layout } = &**pattern;
            bytes.colors([*ambient, *diffuse]);
            layout.numbers(|number| bytes.number(number));
        }
        if emits {
            bytes.colors([*emission]);
        }
        tint.iter().for_each(|tint| bytes.colors([*tint]));
    }

    /// Returns a fingerprint that equal materials share, and different ones hardly ever do.
    pub(super) fn fingerprint(&self) -> u64 {
        let Self { ambient, diffuse, specular, shininess, tint, reflected, refraction, pattern, emission } =
            self;
        let mut fingerprint = Fingerprint::default();
        let colors = |fingerprint: &mut Fingerprint, colors: &[Rgb]| {
            colors.iter().flat_map(Rgb::to_array).for_each(|channel| fingerprint.add(channel.into()));
        };
        colors(&mut fingerprint, &[*ambient, *diffuse, *emission]);
        colors(&mut fingerprint, tint.as_slice());
        [*specular, *shininess, *reflected].into_iter().for_each(|number| fingerprint.add(number.into()));
        if let Some(Refraction { transmitted, ior, absorption, fresnel }) = refraction {
            [f64::from(*transmitted), *ior, f64::from(*fresnel)]
                .into_iter()
                .for_each(|number| fingerprint.add(number));
            colors(&mut fingerprint, &[*absorption]);
        }
        if let Some(pattern) = pattern {
            colors(&mut fingerprint, &[pattern.ambient, pattern.diffuse]);
            fingerprint.add(pattern.layout.code().into());
            pattern.layout.numbers(|number| fingerprint.add(number));
        }
        fingerprint.finish()
    }

    /// Returns the ambient and diffuse colours at a point of the surface with this outward normal.
    pub(crate) fn colors_at(&self, point: DVec3, normal: DVec3) -> (Rgb, Rgb) {
        let Some(pattern) = &self.pattern else { return (self.ambient, self.diffuse) };
        let second = pattern.layout.second_fraction(point, normal);
        (blend(self.ambient, pattern.ambient, second), blend(self.diffuse, pattern.diffuse, second))
    }

    /// Returns the fraction of the pattern's colour at a point of the surface with this outward normal; 0 without a pattern.
    pub(crate) fn pattern_share(&self, point: DVec3, normal: DVec3) -> f32 {
        self.pattern.as_ref().map_or(0.0, |pattern| pattern.layout.second_fraction(point, normal))
    }
}
