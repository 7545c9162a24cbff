//! Summary of the materials of a scene.

use std::collections::BTreeMap;

use super::material::{PreparedPattern, SurfaceMaterial};
use super::material_table::MaterialTable;
use crate::color::Rgb;
use crate::trace::rays::ShapeId;

/// The maxima over all materials of a scene, and the shapes with special materials.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct MaterialSummary {
    /// The largest channel of an ambient colour.
    pub ambient: f32,
    /// The largest channel of a diffuse colour.
    pub diffuse: f32,
    /// The largest specular coefficient.
    pub specular: f32,
    /// The largest channel of an emission.
    pub emission: f32,
    /// The shapes that mirror, by ascending ids.
    pub mirrors: Vec<ShapeId>,
    /// The transparent shapes, by ascending ids.
    pub transparent: Vec<ShapeId>,
    /// True if a transparent material absorbs.
    pub absorbs: bool,
    /// True if a transparent material divides light by Fresnel's equations.
    pub fresnel: bool,
    /// True if a transparent material may spawn both a mirrored and a refracted ray.
    pub branches: bool,
    /// True if a material has a pattern.
    pub patterned: bool,
    /// Upper bounds of the coefficients; materials with about the same share of continuing light are merged.
    answers: BTreeMap<u32, CoefficientBounds>,
}

/// Upper bounds of the coefficients of some materials.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct CoefficientBounds {
    /// Ambient colour.
    pub(crate) ambient: Rgb,
    /// Diffuse colour.
    pub(crate) diffuse: Rgb,
    /// Specular coefficient.
    pub(crate) specular: f32,
    /// Light that the surface gives off.
    pub(crate) emission: Rgb,
    /// Share of light along continuing rays, k_r + k_t.
    pub(crate) followed: f32,
}

impl CoefficientBounds {
    fn of(material: &SurfaceMaterial) -> Self {
        let transmitted = material.refraction.map_or(0.0, |refraction| refraction.transmitted);
        let second =
            |color: fn(&PreparedPattern) -> Rgb| material.pattern.as_deref().map_or(Rgb::ZERO, color);
        Self {
            ambient: material.ambient.max(second(|pattern| pattern.ambient)),
            diffuse: material.diffuse.max(second(|pattern| pattern.diffuse)),
            specular: material.specular,
            emission: material.emission,
            followed: material.reflected + transmitted,
        }
    }

    /// Returns a key that materials have in common if their shares of continuing light agree to 6 bits, or are less than a 64th.
    fn key(&self) -> u32 {
        const DROPPED: u32 = f32::MANTISSA_DIGITS - 1 - 6;
        self.followed.max(1.0 / 64.0).to_bits() >> DROPPED
    }

    fn widen(&mut self, other: &Self) {
        self.ambient = self.ambient.max(other.ambient);
        self.diffuse = self.diffuse.max(other.diffuse);
        self.specular = self.specular.max(other.specular);
        self.emission = self.emission.max(other.emission);
        self.followed = self.followed.max(other.followed);
    }
}

impl MaterialSummary {
    /// Summarizes all materials.
    #[must_use]
    pub(super) fn of(materials: &MaterialTable) -> Self {
        let mut all = Self::default();
        for material in materials.distinct() {
            let answer = CoefficientBounds::of(material);
            all.answers.entry(answer.key()).or_default().widen(&answer);
            if let Some(refraction) = &material.refraction {
                all.absorbs |= refraction.absorption.max_element() > 0.0;
                all.fresnel |= refraction.fresnel;
                all.branches |= refraction.fresnel || material.reflected > 0.0;
            }
            all.patterned |= material.pattern.is_some();
        }
        for (id, material) in materials.of_shapes() {
            if material.reflected > 0.0 {
                all.mirrors.push(id);
            }
            if material.refraction.is_some() {
                all.transparent.push(id);
            }
        }
        for answer in all.answers.values() {
            all.ambient = all.ambient.max(answer.ambient.max_element());
            all.diffuse = all.diffuse.max(answer.diffuse.max_element());
            all.specular = all.specular.max(answer.specular);
            all.emission = all.emission.max(answer.emission.max_element());
        }
        all
    }

    /// Returns upper bounds of the coefficients of all materials. There are at most some hundreds, regardless of the number of surfaces.
    pub(crate) fn answers(&self) -> impl Iterator<Item = &CoefficientBounds> {
        self.answers.values()
    }
}
