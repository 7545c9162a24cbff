//! Validates documents: finds all mistakes of meaning at once.

mod animation;
mod cameras;
mod channels;
mod easing;
mod entities;
mod includes;
mod lights;
mod materials;
mod paths;
mod problems;
mod settings;

use super::document::SceneDocument;
use super::files::Scope;
pub(super) use problems::{At, Problems, help_for};
use problems::{Named, check};

/// Adds all mistakes of a file's document to `problems`. The scope has the names that may be used in it.
pub(super) fn validate(document: &SceneDocument, scope: Scope<'_>, problems: &mut Problems) {
    let scene = At::scene();
    settings::validate(document, &scene, problems);
    includes::validate(document, scope, &scene, problems);
    cameras::validate(document, scope, &scene, problems);
    materials::validate(document, &scene, problems);
    entities::validate(document, scope, &scene, problems);
    animation::validate(document, scope, &scene, problems);
}
