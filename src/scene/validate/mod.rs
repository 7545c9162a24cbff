//! Does the document make sense? Finds all mistakes of meaning at once.

mod animation;
mod entities;
mod lights;
mod materials;
mod problems;
mod settings;

use super::document::SceneDocument;
pub(super) use problems::Problems;
use problems::{At, Named, check};

/// The largest magnitude of a coordinate or a length: products of four stay finite.
const LARGEST: f64 = 1e60;
/// The smallest size. Written out: the inverse of the largest is rounded to a number just above it.
const SMALLEST: f64 = 1e-60;

/// Everything that is wrong with the document.
pub(super) fn validate(document: &SceneDocument) -> Problems {
    let mut problems = Problems::default();
    let scene = At::scene();
    settings::validate(document, &scene, &mut problems);
    materials::validate(document, &scene, &mut problems);
    entities::validate(document, &scene, &mut problems);
    animation::validate(document, &scene, &mut problems);
    problems
}
