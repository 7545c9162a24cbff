//! Validation of the fields of a scene that extends another.

use super::{At, Problems};
use crate::scene::document::SceneDocument;
use crate::scene::extend::{EXTENDS, WITHOUT};
use crate::scene::files::Scope;

pub(super) fn validate(document: &SceneDocument, scope: Scope<'_>, scene: &At<'_>, problems: &mut Problems) {
    if scope.is_extended() {
        return;
    }
    if document.extends.is_some() {
        add_misplaced_extends(scene, problems);
    } else if !document.without.is_empty() {
        let message = format!("`{WITHOUT}` removes nothing, because the scene extends no other one");
        let help = format!("write `{EXTENDS}: \"FILE.ron\"` as the first field, or remove `{WITHOUT}`");
        problems.add(&scene.field(WITHOUT), message, "there is no scene to leave it out of", help);
    }
}

/// Reports a field `extends` that is not the first one.
pub(in crate::scene) fn add_misplaced_extends(scene: &At<'_>, problems: &mut Problems) {
    let message = format!("`{EXTENDS}` is not the first field of the scene");
    let help = "write it first: everything after it is a change of the scene that it names";
    problems.add(&scene.field(EXTENDS), message, "too late", help);
}
