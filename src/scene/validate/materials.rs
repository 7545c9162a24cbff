//! Validation of materials.

use std::collections::HashMap;

use super::{At, Problems, check};
use crate::components::{PatternKind, Quantity};
use crate::scene::document::{MaterialDocument, PatternDocument, SceneDocument, Triple};
use crate::scene::quote::short;

/// The purpose of a `/` in names, as a label for messages.
pub(super) const SLASH: &str = "it is for names in parts, as \"car/wheel\"";

pub(super) fn validate(document: &SceneDocument, scene: &At<'_>, problems: &mut Problems) {
    let at = scene.field("materials");
    let mut seen = HashMap::new();
    for (index, (name, material)) in document.materials.0.iter().enumerate() {
        if name.contains('/') {
            let message = "a material's name with a `/` in it";
            problems.add(&at.key(index), message, SLASH, "write another sign, as `-`");
        }
        if seen.insert(name.as_str(), index).is_some() {
            problems.add(
                &at.key(index),
                format!("two materials are called \"{}\"", short(name)),
                "again here",
                "give each its own name",
            );
        }
        self::material(material, &at.index(index), problems);
    }
}

/// Checks the values of a material.
pub(super) fn material(material: &MaterialDocument, at: &At<'_>, problems: &mut Problems) {
    for (name, coefficient) in [("k_a", material.k_a), ("k_d", material.k_d)] {
        if let Some(coefficient) = coefficient {
            check::coefficient(coefficient, name, &at.field(name), problems);
        }
    }
    for (name, color) in [("color", material.color), ("ambient_color", material.ambient_color)] {
        if let Some(color) = color {
            check::color(color.0, &at.field(name), problems);
        }
    }
    if let Some(emission) = material.emission {
        check::intensity(emission, "emission", &at.field("emission"), problems);
    }
    if let Some(specular) = material.specular {
        let at = at.field("specular");
        check::coefficient(specular.k_s, "k_s", &at.field("k_s"), problems);
        check::shininess(specular.shininess, &at.field("shininess"), problems);
    }
    if let Some(reflective) = material.reflective {
        check::coefficient(reflective.k_r, "k_r", &at.field("reflective").field("k_r"), problems);
    }
    let reflects = material.specular.is_some()
        || material.reflective.is_some()
        || material.refractive.is_some_and(|refractive| refractive.fresnel);
    if material.metallic && !reflects {
        problems.add(
            &at.field("metallic"),
            "a metal that reflects nothing",
            "it colours highlights and reflected light",
            "add `reflective: (k_r: 0.8)` or `specular: (k_s: 0.6, shininess: 60)`",
        );
    }
    if let Some(refractive) = material.refractive {
        let at = at.field("refractive");
        check::coefficient(refractive.k_t, "k_t", &at.field("k_t"), problems);
        check::ior(refractive.ior, &at.field("ior"), problems);
        check::absorption(refractive.absorption, &at.field("absorption"), problems);
    }
    if let Some(pattern) = &material.pattern {
        self::pattern(pattern, &at.field("pattern"), problems);
    }
}

fn pattern(pattern: &PatternDocument, at: &At<'_>, problems: &mut Problems) {
    let (PatternDocument::Checker { color, .. }
    | PatternDocument::Stripes { color, .. }
    | PatternDocument::Bricks { color, .. }
    | PatternDocument::Gradient { color, .. }
    | PatternDocument::Noise { color, .. }) = pattern;
    check::color(color.0, &at.field("color"), problems);
    let size_at = at.field("size");
    match *pattern {
        PatternDocument::Checker { size, .. } => {
            check::size(size, "the side of a square", &size_at, problems);
        }
        PatternDocument::Stripes { size, ratio, direction, offset, .. } => {
            check::size(size, "the distance between stripes", &size_at, problems);
            stripe_ratio(ratio, &at.field("ratio"), problems);
            check::direction(direction, "the direction of stripes", &at.field("direction"), problems);
            check::number(offset, &at.field("offset"), problems);
        }
        PatternDocument::Bricks { size, mortar, .. } => {
            brick_size(size, &size_at, problems);
            self::mortar(mortar, &at.field("mortar"), problems);
        }
        PatternDocument::Gradient { size, direction, offset, .. } => {
            check::size(size, "the length of a gradient", &size_at, problems);
            check::direction(direction, "the direction of a gradient", &at.field("direction"), problems);
            check::number(offset, &at.field("offset"), problems);
        }
        PatternDocument::Noise { size, octaves, contrast, .. } => {
            check::size(size, "the size of noise", &size_at, problems);
            let (most, help) =
                (PatternKind::LARGEST_OCTAVES, "1 is smooth, 4 has finer blotches in large ones");
            check::count(octaves, most, "octaves", help, &at.field("octaves"), problems);
            self::contrast(contrast, &at.field("contrast"), problems);
        }
    }
}

pub(super) fn brick_size(size: Triple, at: &At<'_>, problems: &mut Problems) {
    for (index, length) in size.into_iter().enumerate() {
        check::size(length, "the size of bricks", &at.index(index), problems);
    }
}

pub(super) fn stripe_ratio(ratio: f64, at: &At<'_>, problems: &mut Problems) {
    let help = "write the fraction of the surface that has the pattern's colour, as 0.5";
    check::range(ratio, Quantity::StripeRatio.range(), "the ratio of stripes", help, at, problems);
}

pub(super) fn mortar(mortar: f64, at: &At<'_>, problems: &mut Problems) {
    let help = "write the width of the joints between bricks, as 0.02; 0 is none";
    check::range(mortar, Quantity::Mortar.range(), "mortar", help, at, problems);
}

pub(super) fn contrast(contrast: f64, at: &At<'_>, problems: &mut Problems) {
    let help = "1 blends both colours softly, 5 divides them into spots, 0 is an even blend";
    check::range(contrast, Quantity::Contrast.range(), "contrast", help, at, problems);
}
