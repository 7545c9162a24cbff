//! Validation of what is drawn over the picture.

use super::{At, Problems, check};
use crate::components::TextPart;
use crate::scene::document::{CloudDocument, OverlayDocument, SceneDocument};
use crate::scene::files::Scope;
use crate::scene::validate::problems::Named;

pub(super) fn validate(document: &SceneDocument, scope: Scope<'_>, scene: &At<'_>, problems: &mut Problems) {
    let list = scene.field("overlay");
    for (index, item) in document.overlay.iter().enumerate() {
        let at = list.index(index);
        let (_, size, color) = item.look();
        let size_at = at.field("size");
        if check::number(size, &size_at, problems) && !(size > 0.0 && size <= 1.0) {
            let message = "the size of letters is a share of the picture's height: above 0, and at most 1";
            problems.add(&size_at, message, "out of range", "write 0.04 for 25 lines in the picture");
        }
        check::color(color.0, &at.field("color"), problems);
        cloud(item, document, scope, &at, problems);
        match item {
            OverlayDocument::Text { text, cloud, .. } => self::text(text, cloud.is_some(), &at, problems),
            OverlayDocument::ScaleBar { length, at: point, .. } => {
                check::size(*length, "length", &at.field("length"), problems);
                if let Some(point) = point {
                    check::vector(*point, &at.field("at"), problems);
                }
            }
            OverlayDocument::Legend { .. } => {}
        }
    }
}

/// Reports a cloud that does not exist, or one without colours to explain.
fn cloud(
    item: &OverlayDocument,
    document: &SceneDocument,
    scope: Scope<'_>,
    at: &At<'_>,
    problems: &mut Problems,
) {
    let Some(name) = item.cloud() else { return };
    let at = at.field("cloud");
    if scope.entity(name).is_missing() {
        problems.add_unknown(&at, Named::Entity, name, || scope.entity_names());
        return;
    }
    let is_it = |cloud: &&CloudDocument| cloud.name.as_ref() == Some(name);
    let own = document.clouds.iter().find(is_it);
    if document.entities.iter().any(|entity| entity.name.as_ref() == Some(name)) && own.is_none() {
        let help = "name an entry of `clouds`";
        problems.add(&at, format!("{name:?} is no cloud"), "an entity without a data file", help);
    }
    if let (OverlayDocument::Legend { .. }, Some(CloudDocument { color_by: None, .. })) = (item, own) {
        let help = "add `color_by` to the cloud, or remove the legend";
        problems.add(&at, format!("the cloud {name:?} has no colours to explain"), "no `color_by`", help);
    }
}

fn text(text: &str, has_cloud: bool, at: &At<'_>, problems: &mut Problems) {
    let text_at = at.field("text");
    match TextPart::parse(text) {
        Err(wrong) => problems.add(
            &text_at,
            format!("`{wrong}` stands for nothing"),
            "in braces",
            "write `{time}`, `{time:3}` for three decimals, or `{frame}`",
        ),
        Ok(parts) if !has_cloud && parts.contains(&TextPart::Frame) => problems.add(
            &text_at,
            "`{frame}` is the frame of a data file",
            "of no file",
            "add the cloud that shows the file, as `cloud: \"gas\"`",
        ),
        Ok(_) => {}
    }
}
