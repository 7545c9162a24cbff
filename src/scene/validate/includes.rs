//! Validation of includes, and of names defined in several files.

use super::{At, Problems};
use crate::scene::document::SceneDocument;
use crate::scene::files::{Clash, MOST_INCLUDED, Scope};
use crate::scene::quote::short;

pub(super) fn validate(document: &SceneDocument, scope: Scope<'_>, scene: &At<'_>, problems: &mut Problems) {
    let list = scene.field("include");
    for (index, include) in document.include.iter().enumerate() {
        let at = list.index(index);
        if let Some(name) = &include.name {
            super::entities::name(name, &at.field("name"), problems);
        }
        if let Some(transform) = &include.transform {
            super::entities::transform(transform, &at.field("transform"), problems);
        }
    }
    if let Some(space) = document.space
        && space != scope.space()
    {
        problems.add(
            &scene.field("space"),
            format!("a part in a {space:?} space of a scene in a {:?} one", scope.space()),
            "would be mirrored",
            "write the same `space` in both files, or leave it out of a part that has no place of its own",
        );
    }
    let is_too_much = |scope: Scope<'_>| scope.included() > MOST_INCLUDED;
    // Reported once, in the innermost file that exceeds the limit.
    if is_too_much(scope) && !scope.any_part(is_too_much) {
        let message = format!("more than {MOST_INCLUDED} entities, materials and animations are included");
        problems.add(&list, message, "too much", "include less, or fewer times");
    }
    let clashes = scope.clashes();
    for clash in &clashes.listed {
        match clash.include.filter(|_| clash.is_repeated()) {
            Some(index) => repeated(clash, scope, &list.index(index), problems),
            None => taken(clash, scope, scene, problems),
        }
    }
    problems.add_unlisted(clashes.unlisted);
}

/// Reports a file that is included several times without a name, which repeats its names.
fn repeated(clash: &Clash<'_>, scope: Scope<'_>, at: &At<'_>, problems: &mut Problems) {
    let (name, second) = (short(clash.name), clash.second);
    problems.add(
        at,
        format!("`{}` is included twice without a name", scope.file_name(second)),
        format!("brings \"{name}\" once more"),
        format!("give this include a name of its own: as `part` it brings \"part/{name}\""),
    );
}

/// Reports a name defined in several files.
fn taken(clash: &Clash<'_>, scope: Scope<'_>, scene: &At<'_>, problems: &mut Problems) {
    let Clash { first, second, include, .. } = *clash;
    let name = short(clash.name);
    let is_material = second.list == "materials";
    let what = if is_material { "materials" } else { "entities" };
    let message = format!("two {what} are called \"{name}\"");
    // Locations are looked up only if the problem is listed.
    let line = |origin| if problems.is_full() { String::new() } else { scope.file_and_line(origin) };
    let (label, help) = match include {
        Some(_) => (
            format!("one is at {}, one at {}", line(first), line(second)),
            format!("give this include a name of its own: as `part` it brings \"part/{name}\""),
        ),
        None => (
            format!("the other is at {}", line(first)),
            "give each its own name, or give the include one".to_owned(),
        ),
    };
    let list = scene.field(if include.is_some() { "include" } else { second.list });
    match include {
        Some(index) => problems.add(&list.index(index), message, label, help),
        None if is_material => problems.add(&list.key(second.index), message, label, help),
        None => problems.add(&list.index(second.index).field("name"), message, label, help),
    }
}
