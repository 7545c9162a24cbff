//! Validates documents: collects all semantic errors at once.

mod animation;
mod cameras;
mod channels;
mod clouds;
mod easing;
mod entities;
mod extends;
mod includes;
mod lights;
mod materials;
mod overlay;
mod paths;
mod problems;
mod settings;

use super::document::SceneDocument;
use super::files::Scope;
pub(super) use clouds::{frame_rate, start_time};
pub(super) use extends::add_misplaced_extends;
pub(super) use problems::{At, ProblemList, Problems, help_for};
use problems::{Named, check};
pub(super) use settings::HIDDEN_LABEL;

/// Adds all semantic errors of a file's document to `problems`. `scope` holds the names that the file can refer to.
pub(super) fn validate(document: &SceneDocument, scope: Scope<'_>, problems: &mut Problems) {
    let scene = At::scene();
    extends::validate(document, scope, &scene, problems);
    settings::validate(document, &scene, problems);
    includes::validate(document, scope, &scene, problems);
    cameras::validate(document, scope, &scene, problems);
    materials::validate(document, &scene, problems);
    entities::validate(document, scope, &scene, problems);
    clouds::validate(document, &scene, problems);
    overlay::validate(document, scope, &scene, problems);
    animation::validate(document, scope, &scene, problems);
}
