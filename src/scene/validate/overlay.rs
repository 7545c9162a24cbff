//! Validation of the overlay.

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
        times(item, &at, problems);
        cloud(item, scope, &at, problems);
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

fn times(item: &OverlayDocument, at: &At<'_>, problems: &mut Problems) {
    let (times, fade) = item.times();
    let (times_at, fade_at) = (at.field("times"), at.field("fade"));
    if let Some((first, end)) = times {
        let [is_first, is_end] =
            [(first, 0), (end, 1)].map(|(time, index)| check::number(time, &times_at.index(index), problems));
        if is_first && is_end && first >= end {
            let help = "write `(2, 5)` for 2 to 5 seconds";
            problems.add(&times_at, "the first of the `times` is not before the second", "empty", help);
        }
    }
    if check::number(fade, &fade_at, problems) && fade < 0.0 {
        problems.add(&fade_at, "`fade` is a duration in seconds", "negative", "write 0 or more");
    }
    if fade > 0.0 && times.is_none() {
        let help = "add the times between which the item is shown, as `times: (2, 5)`";
        problems.add(&fade_at, "an item that is always shown does not fade", "without `times`", help);
    }
}

/// Reports a name that is no cloud's, or a cloud without colours to explain.
fn cloud(item: &OverlayDocument, scope: Scope<'_>, at: &At<'_>, problems: &mut Problems) {
    let Some(name) = item.cloud() else { return };
    let (at, known) = (at.field("cloud"), scope.entity(name));
    let is_missing = known.is_missing();
    let cloud = known.found().map(|entity| entity.cloud);
    match (item, cloud) {
        _ if is_missing => problems.add_unknown(&at, Named::Entity, name, || scope.entity_names()),
        (_, Some(None)) => {
            let help = "name an entry of `clouds`";
            problems.add(&at, format!("{name:?} is no cloud"), "without a data file", help);
        }
        (OverlayDocument::Legend { .. }, Some(Some(CloudDocument { color_by: None, .. }))) => {
            let help = "add `color_by` to the cloud, or remove the legend";
            problems.add(&at, format!("the cloud {name:?} has no colours to explain"), "no `color_by`", help);
        }
        _ => {}
    }
}

fn text(text: &str, has_cloud: bool, at: &At<'_>, problems: &mut Problems) {
    let text_at = at.field("text");
    match TextPart::parse(text) {
        Err(wrong) => problems.add(
            &text_at,
            format!("`{wrong}` stands for nothing"),
            "in braces",
            "write `{time}`, `{time:3}` for three decimals, or `{frame}`; an opening brace is `{{`",
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
