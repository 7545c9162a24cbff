//! What there is among a scene's surfaces, in short.

use super::{Slot, SurfaceMaterial};

/// The most of everything among a scene's surfaces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surfaces {
    /// The largest channel of an ambient colour.
    pub ambient: f32,
    /// The largest channel of a diffuse colour.
    pub diffuse: f32,
    /// The largest specular coefficient.
    pub specular: f32,
    /// The largest share of light along continuing rays, k_r + k_t.
    pub followed: f32,
    /// Those that mirror, in document order.
    pub mirrors: Vec<Slot>,
    /// Those that are clear, in document order.
    pub clear: Vec<Slot>,
    /// Does one of the clear ones absorb?
    pub absorbs: bool,
    /// Does one of the clear ones share light out as Fresnel's equations say?
    pub fresnel: bool,
    /// Are there squares?
    pub checkered: bool,
}

impl Surfaces {
    /// Reads them all.
    #[must_use]
    pub(super) fn of(materials: &[SurfaceMaterial]) -> Self {
        let mut all = Self::default();
        for (slot, material) in (0..).map(Slot).zip(materials) {
            let largest = |most: &mut f32, value: f32| *most = most.max(value);
            largest(&mut all.ambient, material.ambient.max_element());
            largest(&mut all.diffuse, material.diffuse.max_element());
            largest(&mut all.specular, material.specular);
            let transmitted = material.refraction.map_or(0.0, |refraction| refraction.transmitted);
            largest(&mut all.followed, material.reflected + transmitted);
            if material.reflected > 0.0 {
                all.mirrors.push(slot);
            }
            if let Some(refraction) = &material.refraction {
                all.clear.push(slot);
                all.absorbs |= refraction.absorption.max_element() > 0.0;
                all.fresnel |= refraction.fresnel;
            }
            if let Some(checker) = &material.checker {
                largest(&mut all.ambient, checker.ambient.max_element());
                largest(&mut all.diffuse, checker.diffuse.max_element());
                all.checkered = true;
            }
        }
        all
    }
}
