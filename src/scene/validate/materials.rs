//! Validation of materials.

use std::collections::HashMap;

use super::{At, Problems, check};
use crate::scene::document::{MaterialDocument, SceneDocument};
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
    if let Some(refractive) = material.refractive {
        let at = at.field("refractive");
        check::coefficient(refractive.k_t, "k_t", &at.field("k_t"), problems);
        check::ior(refractive.ior, &at.field("ior"), problems);
        check::absorption(refractive.absorption, &at.field("absorption"), problems);
    }
    if let Some(checker) = material.checker {
        let at = at.field("checker");
        check::color(checker.color.0, &at.field("color"), problems);
        check::size(checker.size, "the side of a square", &at.field("size"), problems);
    }
}
