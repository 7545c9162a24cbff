//! What there is among a scene's surfaces, in short.

use std::collections::BTreeMap;

use super::material::{Checker, SurfaceMaterial};
use super::material_table::MaterialTable;
use crate::color::Rgb;
use crate::trace::rays::ShapeId;

/// The most of everything among a scene's surfaces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialSummary {
    /// The largest channel of an ambient colour.
    pub ambient: f32,
    /// The largest channel of a diffuse colour.
    pub diffuse: f32,
    /// The largest specular coefficient.
    pub specular: f32,
    /// Those that mirror, by ascending ids.
    pub mirrors: Vec<ShapeId>,
    /// Those that are clear, by ascending ids.
    pub clear: Vec<ShapeId>,
    /// Whether one of the clear ones absorbs.
    pub absorbs: bool,
    /// Whether one of the clear ones shares light out as Fresnel's equations say.
    pub fresnel: bool,
    /// Whether one of the clear ones may send on both a mirrored and a refracted ray.
    pub branches: bool,
    /// Whether there are squares.
    pub checkered: bool,
    /// Materials that send on about as much are one.
    answers: BTreeMap<u32, Answer>,
}

/// At most how some surfaces answer light.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Answer {
    /// Ambient colour.
    pub(crate) ambient: Rgb,
    /// Diffuse colour.
    pub(crate) diffuse: Rgb,
    /// Specular coefficient.
    pub(crate) specular: f32,
    /// Share of light along continuing rays, k_r + k_t.
    pub(crate) followed: f32,
}

impl Answer {
    fn of(material: &SurfaceMaterial) -> Self {
        let transmitted = material.refraction.map_or(0.0, |refraction| refraction.transmitted);
        let second = |color: fn(&Checker) -> Rgb| material.checker.as_deref().map_or(Rgb::ZERO, color);
        Self {
            ambient: material.ambient.max(second(|checker| checker.ambient)),
            diffuse: material.diffuse.max(second(|checker| checker.diffuse)),
            specular: material.specular,
            followed: material.reflected + transmitted,
        }
    }

    /// The same for what sends on as much to 6 bits, or less than a 64th.
    fn key(&self) -> u32 {
        const DROPPED: u32 = f32::MANTISSA_DIGITS - 1 - 6;
        self.followed.max(1.0 / 64.0).to_bits() >> DROPPED
    }

    fn widen(&mut self, other: &Self) {
        self.ambient = self.ambient.max(other.ambient);
        self.diffuse = self.diffuse.max(other.diffuse);
        self.specular = self.specular.max(other.specular);
        self.followed = self.followed.max(other.followed);
    }
}

impl MaterialSummary {
    /// Reads them all.
    #[must_use]
    pub(super) fn of(materials: &MaterialTable) -> Self {
        let mut all = Self::default();
        for material in materials.distinct() {
            let answer = Answer::of(material);
            all.answers.entry(answer.key()).or_default().widen(&answer);
            if let Some(refraction) = &material.refraction {
                all.absorbs |= refraction.absorption.max_element() > 0.0;
                all.fresnel |= refraction.fresnel;
                all.branches |= refraction.fresnel || material.reflected > 0.0;
            }
            all.checkered |= material.checker.is_some();
        }
        for (id, material) in materials.of_shapes() {
            if material.reflected > 0.0 {
                all.mirrors.push(id);
            }
            if material.refraction.is_some() {
                all.clear.push(id);
            }
        }
        for answer in all.answers.values() {
            all.ambient = all.ambient.max(answer.ambient.max_element());
            all.diffuse = all.diffuse.max(answer.diffuse.max_element());
            all.specular = all.specular.max(answer.specular);
        }
        all
    }

    /// At most how they answer light. There are some hundreds of answers at most, however many surfaces there are.
    pub(crate) fn answers(&self) -> impl Iterator<Item = &Answer> {
        self.answers.values()
    }
}
