//! Parallel parsing of the entities of a long scene, in parts.
//!
//! # Division of a text
//!
//! The list `entities` is cut after the closing brackets of some entities: where a line that ends with `),` is followed by a line with the
//! same indentation as the first entity. Each part is parsed as a separate list that ends with a mark. Every part except the first begins
//! with an entity `()`, followed by the comma of the text. The text before the first part and the text after the last one are parsed
//! together, with a mark in place of the parts.
//!
//! ```text
//! text      Scene(.. entities: [ a, b, c, d, e, f ], ..)
//! parsed    (entities: [ a, b, mark])    (entities: [(), c, d, mark])    Scene(.. entities: [ mark, e, f ], ..)
//! ```
//!
//! # Correctness
//!
//! A part that is [plain](super::fast_path) is read by the fast path, with the same result as the parser. The cuts are not assumed to be
//! correct; their correctness follows if all parts are accepted:
//!
//! 1. The mark is the first entity of the scene, so that the parser begins a list of entities there after the text before it. It reads the
//!    first part as it would in the whole text.
//! 2. A part ends with a bracket, directly followed by the mark, which is the last entity of the part. The text before the mark is
//!    therefore neither inside a string, a comment or an entity, nor beyond the end of the list, and the parser has read whole entities.
//! 3. In the whole text, the parser reaches the next part in the same state as after the entity `()`.
//! 4. The meaning of an entity depends on its own text alone: RON has no references, and no list is found in a scene with extensions.
//!
//! If any part is rejected, or a mark is not found, the whole text is parsed.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;
use serde::Deserialize;

use super::fast_path::read_plain;
use super::whole::options;
use crate::scene::document::{EntityDocument, SceneDocument};
use crate::scene::spans::list_of;

/// The name of the marks, which stand for the entities of other parts.
const MARK: &str = "those of other parts";

/// A list of entities and nothing else.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EntityList {
    entities: Vec<Arc<EntityDocument>>,
}

/// Parses a scene's text in at most `parts` parts. `None` if it must be parsed as a whole.
pub(super) fn read_in_parts(text: &str, parts: usize) -> Option<SceneDocument> {
    let start = list_of(text, SceneDocument::ENTITIES)?;
    let ends = cuts(text, start, parts);
    let last = *ends.last()?;
    let (above, below) = (text.get(..start)?, text.get(last..)?);
    // A name might be equal to the mark, literally or by an escape.
    if text.contains(MARK) || text.contains('\\') {
        return None;
    }
    let starts = std::iter::once(start).chain(ends.iter().copied());
    let ranges: Vec<Range<usize>> = starts.zip(&ends).map(|(start, end)| start..*end).collect();
    let rest = || options().from_str::<SceneDocument>(&format!("{above}(name: {MARK:?}){below}")).ok();
    let parse =
        || ranges.par_iter().map(|range| part(text, range.clone(), start)).collect::<Option<Vec<_>>>();
    let (parsed, rest) = rayon::join(parse, rest);
    let mut document = rest?;
    let mut others = std::mem::take(&mut document.entities).into_iter();
    others.next().filter(is_mark)?;
    document.entities = parsed?.into_iter().flatten().chain(others).collect();
    Some(document)
}

fn is_mark(entity: &Arc<EntityDocument>) -> bool {
    entity.name.as_deref() == Some(MARK)
}

/// Parses a part of a list whose content begins at `start`.
fn part(text: &str, range: Range<usize>, start: usize) -> Option<Vec<Arc<EntityDocument>>> {
    let is_first = range.start == start;
    let before = if is_first { "" } else { "()" };
    let part = format!("(entities: [{before}{},(name: {MARK:?})])", text.get(range)?);
    let EntityList { mut entities } = read_plain(&part).or_else(|_| options().from_str(&part)).ok()?;
    entities.pop().filter(is_mark)?;
    if !is_first {
        entities.drain(..1);
    }
    Some(entities)
}

/// Returns roughly even cuts of a list, each at the apparent end of an entity.
fn cuts(text: &str, start: usize, parts: usize) -> Vec<usize> {
    /// Maximum distance of a cut from its even position, in bytes.
    const FARTHEST: usize = 1 << 16;
    let bytes = text.as_bytes();
    let Some(between) = separator(&bytes[start..]) else { return Vec::new() };
    let length = (bytes.len() - start) / parts.max(1);
    let mut cuts: Vec<usize> = Vec::new();
    for part in 1..parts {
        let from = (start + length * part).max(cuts.last().copied().unwrap_or(start));
        let near = &bytes[from..bytes.len().min(from + FARTHEST)];
        if let Some(place) = near.windows(between.len()).position(|window| window == between) {
            cuts.push(from + place + 1);
        }
    }
    cuts.dedup();
    cuts
}

/// Returns the text between two entities, from the closing bracket of one to the opening bracket of the next, if each begins a line like
/// the first. `None` if the first entity does not begin a line.
fn separator(content: &[u8]) -> Option<Vec<u8>> {
    let indent = content.iter().position(|byte| !byte.is_ascii_whitespace())?;
    let line = content[..indent].iter().position(|byte| matches!(byte, b'\n' | b'\r'))?;
    (content[indent] == b'(').then(|| [b"),", &content[line..=indent]].concat())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use proptest::sample::{Index, select};

    use super::super::whole::read_whole;
    use super::*;

    const SCENE: &str = r#"// a scene [with (brackets
Scene(
    materials: { "red": (color: (255, 0, 0)) },
    entities: [
        (name: "a", shape: Sphere(radius: 1), material: "red"),
        (name: "b]", transform: (translation: (-0.0, 2, 3))),
        (),
        (name: "c(", light: Point(intensity: (1, 1, 1))), // one
        (name: "d",
            shape: Box(size: (1, 1, 1)),
        ),
        (name: "e"),
        (name: "f"), /* none */
        (name: "g"),
    ],
    ambient: (1, 1, 1), // entities: [()]
)
"#;

    /// Adversarial pieces of text to insert anywhere.
    const PIECES: [&str; 29] = [
        "",
        " ",
        "\n",
        "1",
        "/* ",
        " */",
        "// ",
        "),\n        (",
        "(name: \"new\"),\n        ",
        ",",
        "(",
        ")",
        "[",
        "]",
        "],",
        "\"",
        "r#\"",
        "\"#",
        "x",
        "\\",
        "entities: [\n        (",
        "#![enable(unwrap_newtypes)]",
        "Entity",
        "Some(",
        "], animate: [",
        "], ambient: (1, 1, 1), animate: [",
        "]) // ",
        "\r",
        "//\r",
    ];

    #[test]
    fn a_list_is_parsed_in_parts() {
        let whole = read_whole(SCENE).unwrap();
        for parts in [2, 3, 7] {
            assert_eq!(read_in_parts(SCENE, parts).as_ref(), Some(&whole));
        }
        assert_eq!(read_in_parts(SCENE, 1), None);
        assert_eq!(read_in_parts("(entities: [])", 4), None);
        // A list and a scene that end early, before a comment.
        let long = "long ".repeat(20);
        let ends = format!(
            "(\n    entities: [\n        (name: \"a\")]) // {long} b),\n        (name: \"c\"),\n        (name: \"d\"),\n    ],\n)"
        );
        assert_eq!((read_in_parts(&ends, 2), read_whole(&ends).is_ok()), (None, false));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(8000))]

        #[test]
        fn what_parts_give_is_what_the_whole_gives(
            edits in prop::collection::vec((any::<Index>(), 0..4_usize, select(&PIECES[..])), 0..4),
            parts in 2..6_usize,
        ) {
            let mut text = SCENE.to_owned();
            for (at, length, piece) in edits {
                let start = text.ceil_char_boundary(at.index(text.len() + 1));
                let end = text.ceil_char_boundary((start + length).min(text.len()));
                text.replace_range(start..end, piece);
            }
            if let Some(found) = read_in_parts(&text, parts) {
                // The debug format includes the signs of zeros.
                prop_assert_eq!(format!("{:?}", Some(found)), format!("{:?}", read_whole(&text).ok()), "{}", text);
            }
        }
    }
}
