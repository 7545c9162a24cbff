//! Parses a text that differs little from one that was parsed before.
//!
//! Entities that are written as before are taken over, as long as all changes lie between two of them, before all or after all.
//! The rest is parsed: the text without them, but for the neighbour on each side of the change. So the parser sees every new
//! token, and whatever it refuses is left to a parse of the whole.

use std::ops::Range;
use std::sync::Arc;

use super::document::{EntityDocument, SceneDocument};
use super::parse::read;
use super::spans::{list_items, list_of};

/// The name of an entity that stands for those that are taken over.
const MARK: &str = "those that are written as before";

/// A text that was parsed.
#[derive(Debug)]
pub(super) struct Parsed {
    text: Arc<String>,
    entities: Vec<Arc<EntityDocument>>,
    /// The places of the entities, once they have been looked up.
    list: Option<List>,
}

/// The list of entities in a text.
#[derive(Debug)]
struct List {
    /// The content of its brackets.
    content: Range<usize>,
    items: Vec<Range<usize>>,
}

impl Parsed {
    pub(super) fn new(text: &Arc<String>, document: &SceneDocument) -> Self {
        Self { text: Arc::clone(text), entities: document.entities.clone(), list: None }
    }

    /// Parses another text, which then replaces this one. `None` if it must be parsed as a whole.
    pub(super) fn parse_again(&mut self, text: &Arc<String>) -> Option<SceneDocument> {
        if self.list.is_none() {
            self.list = List::of(&self.text, &self.entities);
        }
        let List { content, items } = self.list.as_ref()?;
        let (head, tail) = same_ends(&self.text, text);
        let moved = |at: usize| at + text.len() - self.text.len();
        let is_at_place = content.start <= head;
        let start = if is_at_place { content.start } else { list_of(text, SceneDocument::ENTITIES)? };
        let end = if content.end < head {
            content.end
        } else if self.text.len() - content.end <= tail {
            moved(content.end)
        } else {
            return None;
        };

        // An item ends with a bracket, whatever follows. Before one there must be the same sign as there was.
        let first = if is_at_place { items.partition_point(|item| item.end <= head) } else { 0 };
        let last = items.partition_point(|item| self.text.len() - item.start >= tail);
        let (before, from) = match first.checked_sub(1).and_then(|before| items.get(before)) {
            Some(neighbour) => (neighbour.start, neighbour.end),
            None => (start, start),
        };
        let (until, next, rest) = match (items.get(last), items.last()) {
            (Some(neighbour), Some(item)) => (moved(neighbour.end), last + 1, moved(item.end)),
            _ => (end, last, end),
        };
        let (above, change, below) = (text.get(..start)?, text.get(before..until)?, text.get(rest..)?);
        let is_cut = last < items.len();
        let mark = format!("(name: {MARK:?})");
        let end_mark = if is_cut { format!(",{mark}") } else { String::new() };
        let mut document = read(&format!("{above}{mark},{change}{end_mark}{below}")).ok()?;

        // What was written may have swallowed the start of a neighbour, or all of it, but then the mark as well.
        let is_mark = |entity: &Arc<EntityDocument>| entity.name.as_deref() == Some(MARK);
        let mut parsed = std::mem::take(&mut document.entities);
        let ends_marked = !is_cut || parsed.len() > 1 && parsed.pop().is_some_and(|last| is_mark(&last));
        if !(ends_marked && parsed.first().is_some_and(is_mark)) {
            return None;
        }
        let changed = parsed.into_iter().skip(if first > 0 { 2 } else { 1 });
        let kept = |range: Range<usize>| self.entities[range].iter().map(Arc::clone);
        document.entities = kept(0..first).chain(changed).chain(kept(next..items.len())).collect();

        let found = list_items(text.get(..until)?, from).0;
        let after = items[next..].iter().map(|item| moved(item.start)..moved(item.end));
        let items = items[..first].iter().cloned().chain(found).chain(after).collect();
        let list = List { content: start..end, items };
        self.list = Some(list).filter(|list| list.are(&document.entities, text));
        self.text = Arc::clone(text);
        self.entities.clone_from(&document.entities);
        Some(document)
    }
}

impl List {
    fn of(text: &str, entities: &[Arc<EntityDocument>]) -> Option<Self> {
        let start = list_of(text, SceneDocument::ENTITIES)?;
        let (items, end) = list_items(text, start);
        Some(Self { content: start..end, items }).filter(|list| list.are(entities, text))
    }

    /// Returns whether the items can be these entities of the text, as far as their number and their brackets tell.
    fn are(&self, entities: &[Arc<EntityDocument>], text: &str) -> bool {
        let is_in_brackets =
            |item: &Range<usize>| text.get(item.clone()).is_some_and(|item| item.ends_with(')'));
        text.as_bytes().get(self.content.end) == Some(&b']')
            && self.items.len() == entities.len()
            && self.items.iter().all(is_in_brackets)
    }
}

/// Returns the lengths of the common start and the common end of two texts, which do not overlap.
fn same_ends(old: &str, new: &str) -> (usize, usize) {
    /// The number of bytes compared at once.
    const BLOCK: usize = 4096;
    let (old, new) = (old.as_bytes(), new.as_bytes());
    let blocks = old.chunks_exact(BLOCK).zip(new.chunks_exact(BLOCK));
    let head = BLOCK * blocks.take_while(|(old, new)| old == new).count();
    let rest = old[head..].iter().zip(&new[head..]);
    let head = head + rest.take_while(|(old, new)| old == new).count();

    let (old, new) = (&old[head..], &new[head..]);
    let blocks = old.rchunks_exact(BLOCK).zip(new.rchunks_exact(BLOCK));
    let tail = BLOCK * blocks.take_while(|(old, new)| old == new).count();
    let rest = old[..old.len() - tail].iter().rev().zip(new[..new.len() - tail].iter().rev());
    (head, tail + rest.take_while(|(old, new)| old == new).count())
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use proptest::collection::vec;
    use proptest::prelude::*;
    use proptest::sample::{Index, select};
    use proptest::test_runner::{Config, TestRunner};

    use super::*;
    use crate::scene::parse::parse;

    const SCENE: &str = r##"// a scene [with (brackets
Scene(
    camera: (position: (0, 0, -5), target: (0, 0, 0)), /* nested /* [ */ */
    materials: { "red": (color: (255, 0, 0)), "r)ed": (k_d: 1) },
    entities: [
        (name: "a", shape: Sphere(radius: 1), material: "red"), // one, (two
        Entity(name: "b]", transform: (translation: (1, 2, 3))),
        (), /* none */ (name: r#"c"("#),
        (name: "d\")", light: Point(intensity: (1, 1, 1))), (shape: Some(Box(size: (1, 1, 1))), material: "r)ed"),
        (name: "ß"),
    ], // */ ],
    ambient: (1, 1, 1), // entities: [()]
    animate: [(target: "a", channel: Translation, track: Keys([(0, (0, 0, 0)), (1, (1, 0, 0))]))],
)
"##;

    /// What may be written anywhere; more often than not, what does no harm.
    const PIECES: [&str; 36] = [
        "",
        " ",
        "\n",
        "1",
        "2",
        "/* ( */",
        "// [\n",
        "(), ",
        "(name: \"new\"), ",
        ", ",
        "(",
        ")",
        "[",
        "]",
        "{",
        "}",
        ",,",
        "\"",
        "'",
        "//",
        "/*",
        "*/",
        "#",
        "r#\"",
        "\"#",
        "x",
        "ß",
        "\u{a0}",
        "\\",
        "entities: [",
        "], entities: [",
        "Entity",
        "#![x]",
        "Some(",
        "0",
        "\u{200e}",
    ];

    fn edited(text: &str, at: &Index, length: usize, piece: &str) -> String {
        let start = text.ceil_char_boundary(at.index(text.len() + 1));
        let end = text.ceil_char_boundary((start + length).min(text.len()));
        format!("{}{piece}{}", &text[..start], &text[end..])
    }

    #[test]
    fn what_is_parsed_again_is_what_a_parse_of_the_whole_gives() {
        let length = select(&[0, 0, 0, 0, 1, 2, 20][..]);
        let edit = (any::<Index>(), length, select(&PIECES[..]));
        let edits = vec(vec(edit, 1..3), 1..8);
        let mut runner = TestRunner::new(Config { cases: 6000, ..Config::default() });
        let (good, again) = (Cell::new(0), Cell::new(0));
        runner
            .run(&edits, |edits| {
                let mut text = Arc::new(SCENE.to_owned());
                let mut parsed = Parsed::new(&text, &parse(&text).unwrap());
                for edit in edits {
                    let mut next = String::clone(&text);
                    for (at, length, piece) in &edit {
                        next = edited(&next, at, *length, piece);
                    }
                    let next = Arc::new(next);
                    let expected = parse(&next).ok();
                    let found = parsed.parse_again(&next);
                    if found.is_some() {
                        // Zeros have signs.
                        prop_assert_eq!(format!("{found:?}"), format!("{expected:?}"), "{}", next);
                        prop_assert_eq!(&parsed.text, &next);
                        again.set(again.get() + 1);
                    } else if let Some(document) = &expected {
                        parsed = Parsed::new(&next, document);
                    }
                    if expected.is_some() {
                        good.set(good.get() + 1);
                        text = next;
                    }
                }
                Ok(())
            })
            .unwrap();
        let (good, again) = (good.get(), again.get());
        assert!(good > 1000 && again * 10 > good * 7, "{again} of {good}");
    }

    #[test]
    fn only_what_an_edit_touches_is_other_than_before() {
        let text = Arc::new(SCENE.to_owned());
        let before = parse(&text).unwrap();
        let kept = |from: &str, to: &str| {
            let edited = Arc::new(SCENE.replacen(from, to, 1));
            let document = Parsed::new(&text, &before).parse_again(&edited).unwrap();
            assert_eq!(document, parse(&edited).unwrap());
            let is_kept = |entity: &Arc<EntityDocument>| {
                before.entities.iter().any(|before| Arc::ptr_eq(before, entity))
            };
            (document.entities.iter().filter(|entity| is_kept(entity)).count(), document.entities.len())
        };
        assert_eq!(kept("", ""), (7, 7));
        assert_eq!(kept("ambient: (1", "ambient: (2"), (7, 7));
        // The one after the edit is parsed again.
        assert_eq!(kept("255", "25"), (6, 7));
        assert_eq!(kept("radius: 1", "radius: 2"), (5, 7));
        assert_eq!(kept("// one, (two", "(name: \"new\"),"), (6, 8));
        assert_eq!(kept("        (name: \"ß\"),\n", ""), (6, 6));
        assert_eq!(kept("entities: [", "entities: [(name: \"new\"),"), (6, 8));
    }

    #[test]
    fn what_looks_like_another_thing_is_not_taken_for_it() {
        let cases = [
            // A list that seems to start within an entity that is the same.
            (
                "(entities: [(name: \"b\" // */ entities: [(name: \"b\"\n)])",
                "(/*[(name: \"b\" // */ entities: [(name: \"b\"\n)])",
            ),
            // A list within a text, as whoever does not know of raw names sees it.
            (
                "(r#ambient: (1,1,1), materials: { r##\"#: 0, entities: [(name: \"fake\")], y: r\"x\"##: (k_d: 1) }, \
                entities: [(name: \"real\")])",
                "(r#ambient: (1,1,1), materials: { r##\"#: 0, entities: [(name: \"fakf\")], y: r\"x\"##: (k_d: 1) }, \
                entities: [(name: \"real\")])",
            ),
            // An entity that swallows the start of the next, and is the same but for the sign of a zero.
            (
                "(entities: [(name: \"p\"), (transform: (translation: (-0.0, 0, 0)) // */\n)])",
                "(entities: [(name: \"p\"),Entity(transform: (translation: (0, 0, 0)) /* (transform: (translation: (-0.0, 0, 0)) // */\n)])",
            ),
            // A list that ends early, before a comment that reaches as far as what was taken for its end.
            (
                "(entities: [(name: \"a\"), (), (name: \"b\"),\n])",
                "(entities: [(name: \"a\")] // (), (name: \"b\"),\n])",
            ),
            (
                "(entities: [(name: \"a\")],\nambient: (1, 1, 1))",
                "(entities: [(name: \"a\")] //],\nambient: (1, 1, 1))",
            ),
            ("(entities: [(), (name: \"a\"), ()\n])", "(entities: [(), // (name: \"a\"), ()\n])"),
            // A comment that swallows all, up to where another one seems to end.
            (
                "(entities: [(name: \"a\"), (name: \"b\"), (name: \"c\")\n], // */ ]\n)",
                "(entities: [/*(name: \"a\"), (name: \"b\"), (name: \"c\")\n], // */ ]\n)",
            ),
            // A character that is a quote.
            (
                "(entities: [(transform: (scale: b''')), (name: \"a\"), (name: \"b\")])",
                "(entities: [(transform: (scale: b''')), (name: \"a\"), (name: \"c\")])",
            ),
            (
                "#![enable(unwrap_newtypes)]\n(entities: [(name: \"a\")])",
                "#![enable(unwrap_newtypes)]\n(entities: [(name: \"b\")])",
            ),
            ("(entities: [\r\n(name: \"a\"),\r\n()])", "(entities: [\r\n(name: \"b\"),\r\n()])"),
            ("(entities: [], ambient: (1, 1, 1))", "(entities: [(), ()], ambient: (1, 1, 1))"),
            ("(entities: [(), ()])", "(entities: [])"),
        ];
        for (old, new) in cases {
            let (old, new) = (Arc::new(old.to_owned()), Arc::new(new.to_owned()));
            let mut parsed =
                Parsed::new(&old, &parse(&old).unwrap_or_else(|error| panic!("{old}: {}", error.message)));
            for text in [&new, &old] {
                if let Some(found) = parsed.parse_again(text) {
                    assert_eq!(format!("{found:?}"), format!("{:?}", parse(text).unwrap()), "{text}");
                }
            }
        }
    }

    #[test]
    fn same_ends_do_not_overlap() {
        let long = "abc".repeat(5000);
        let cases = [
            ("", "", (0, 0)),
            ("aba", "aba", (3, 0)),
            ("aba", "ababa", (3, 0)),
            ("xaby", "xy", (1, 1)),
            (&long, &format!("{long}{long}"), (15_000, 0)),
            (&format!("x{long}"), &long, (0, 15_000)),
            (&format!("{long}x{long}"), &format!("{long}y{long}"), (15_000, 15_000)),
        ];
        for (old, new, expected) in cases {
            assert_eq!(same_ends(old, new), expected, "{} {}", old.len(), new.len());
        }
    }
}
