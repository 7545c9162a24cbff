//! In which lines of a scene's text its parts start.

use super::Place;
use super::spans::{Step, locate};

/// The lines, from 1, in which entities start in the text of a scene; `entities` are places in document order, from 0, as
/// [`Order`](crate::components::Order) has them. One pass over the text serves them all.
///
/// The text must be one that a scene was read from. An entity that is not in it gets the line of the list it would be in.
///
/// ```
/// let text = "Scene(\n  camera: (view: (0, 0, 1)),\n  entities: [\n    (name: \"a\"), (),\n    (),\n  ],\n)";
/// assert_eq!(rayreel::scene::entity_lines(text, &[2, 0, 1]), [5, 4, 4]);
/// ```
#[must_use]
pub fn entity_lines(text: &str, entities: &[usize]) -> Vec<usize> {
    let path = |index: &usize| vec![Step::Field("entities"), Step::Index(*index)];
    lines(text, &entities.iter().map(path).collect::<Vec<_>>())
}

/// The line, from 1, in which the camera starts in the text of a scene.
#[must_use]
pub fn camera_line(text: &str) -> usize {
    lines(text, &[vec![Step::Field("camera")]])[0]
}

fn lines(text: &str, paths: &[Vec<Step>]) -> Vec<usize> {
    // A byte order mark is no part of the scene.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    locate(text, paths).into_iter().map(|span| Place::of(text, span.start).line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_order_mark_and_what_is_missing_move_nothing() {
        let text = "\u{feff}// a comment\n(\n camera: (),\n entities: [\n  (), /* \n */ (),\n ])";
        assert_eq!(camera_line(text), 3);
        assert_eq!(entity_lines(text, &[0, 1, 7]), [5, 6, 4]);
        assert_eq!(entity_lines("()", &[0]), [1]);
        assert_eq!(entity_lines("", &[]), Vec::<usize>::new());
    }
}
