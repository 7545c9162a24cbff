//! Comparison of incremental parses with parses of whole texts.

use std::cell::Cell;
use std::sync::Arc;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::{Config, TestRunner};

use super::Parsed;
use super::change::same_ends;
use crate::scene::document::EntityDocument;
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

/// Pieces of text to insert anywhere, most of them harmless.
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
                    // The debug format includes the signs of zeros.
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
        let is_kept =
            |entity: &Arc<EntityDocument>| before.entities.iter().any(|before| Arc::ptr_eq(before, entity));
        (document.entities.iter().filter(|entity| is_kept(entity)).count(), document.entities.len())
    };
    assert_eq!(kept("", ""), (7, 7));
    assert_eq!(kept("ambient: (1", "ambient: (2"), (7, 7));
    // The entity after the edit is parsed again.
    assert_eq!(kept("255", "25"), (6, 7));
    assert_eq!(kept("radius: 1", "radius: 2"), (5, 7));
    assert_eq!(kept("// one, (two", "(name: \"new\"),"), (6, 8));
    assert_eq!(kept("        (name: \"ß\"),\n", ""), (6, 6));
    assert_eq!(kept("entities: [", "entities: [(name: \"new\"),"), (6, 8));
}

/// Pairs of successive texts.
const DECEPTIONS: &[(&str, &str)] = &[
    // A list that seems to start within an unchanged entity.
    (
        "(entities: [(name: \"b\" // */ entities: [(name: \"b\"\n)])",
        "(/*[(name: \"b\" // */ entities: [(name: \"b\"\n)])",
    ),
    // A list within a string, visible to a scanner that does not support raw identifiers.
    (
        "(r#ambient: (1,1,1), materials: { r##\"#: 0, entities: [(name: \"fake\")], y: r\"x\"##: (k_d: 1) }, \
        entities: [(name: \"real\")])",
        "(r#ambient: (1,1,1), materials: { r##\"#: 0, entities: [(name: \"fakf\")], y: r\"x\"##: (k_d: 1) }, \
        entities: [(name: \"real\")])",
    ),
    // An entity that swallows the start of the next one, and differs only in the sign of a zero.
    (
        "(entities: [(name: \"p\"), (transform: (translation: (-0.0, 0, 0)) // */\n)])",
        "(entities: [(name: \"p\"),Entity(transform: (translation: (0, 0, 0)) /* (transform: (translation: (-0.0, 0, 0)) // */\n)])",
    ),
    // A list that ends early, before a comment that extends to its apparent end.
    (
        "(entities: [(name: \"a\"), (), (name: \"b\"),\n])",
        "(entities: [(name: \"a\")] // (), (name: \"b\"),\n])",
    ),
    (
        "(entities: [(name: \"a\")],\nambient: (1, 1, 1))",
        "(entities: [(name: \"a\")] //],\nambient: (1, 1, 1))",
    ),
    ("(entities: [(), (name: \"a\"), ()\n])", "(entities: [(), // (name: \"a\"), ()\n])"),
    // A comment that swallows the text up to the apparent end of another comment.
    (
        "(entities: [(name: \"a\"), (name: \"b\"), (name: \"c\")\n], // */ ]\n)",
        "(entities: [/*(name: \"a\"), (name: \"b\"), (name: \"c\")\n], // */ ]\n)",
    ),
    // A character literal that contains a quote.
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

#[test]
fn what_looks_like_another_thing_is_not_taken_for_it() {
    for (old, new) in DECEPTIONS {
        let (old, new) = (Arc::new((*old).to_owned()), Arc::new((*new).to_owned()));
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
