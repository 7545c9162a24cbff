//! Comparison with parses of whole texts.

use std::cell::Cell;
use std::sync::Arc;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::{Config, TestRunner};

use super::super::read::parse_general;
use super::{PART, ParsedEntities, same_ends};
use crate::scene::document::{EntityDocument, SceneDocument};
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
const PIECES: [&str; 52] = [
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
    "),\n        (",
    "(name: \"new\"),\n        ",
    "],",
    "), (",
    "entities: [\n        (",
    "#![enable(unwrap_newtypes)]",
    "], animate: [",
    "], ambient: (1, 1, 1), animate: [",
    "]) // ",
    "\r",
    "//\r",
    "b'\"'",
    "r#entities: [",
    "name: \"]\", ",
    "br#\"",
    "\"\\\"",
];

fn edited(text: &str, at: &Index, length: usize, piece: &str) -> String {
    let start = text.ceil_char_boundary(at.index(text.len() + 1));
    let end = text.ceil_char_boundary((start + length).min(text.len()));
    format!("{}{piece}{}", &text[..start], &text[end..])
}

fn known(text: &str) -> ParsedEntities {
    let mut known = ParsedEntities::default();
    assert!(known.parse_next(&Arc::new(text.to_owned()), PART).is_some(), "{text}");
    known
}

/// Returns a document for comparison. The debug format includes the signs of zeros.
fn shown(document: Option<&SceneDocument>) -> String {
    format!("{document:?}")
}

/// Compares sequences of edited texts: parsed after the text before, parsed without any knowledge, and parsed as a whole.
#[test]
fn entities_parse_alone_as_in_the_full_text() {
    let length = select(&[0, 0, 0, 0, 1, 2, 20][..]);
    let edit = (any::<Index>(), length, select(&PIECES[..]));
    let edits = (vec(vec(edit, 1..3), 1..8), select(&[1, 40, 150, PART][..]));
    let mut runner = TestRunner::new(Config { cases: 8000, ..Config::default() });
    let (valid, entity_wise) = (Cell::new(0), Cell::new(0));
    runner
        .run(&edits, |(edits, part)| {
            let mut text = Arc::new(SCENE.to_owned());
            let mut entities = known(SCENE);
            for edit in edits {
                let mut next = String::clone(&text);
                for (at, length, piece) in &edit {
                    next = edited(&next, at, *length, piece);
                }
                let next = Arc::new(next);
                let expected = parse_general(&next);
                let reparsed = ParsedEntities::default().parse_next(&next, part);
                let found = entities.parse_next(&next, part);
                prop_assert_eq!(found.is_some(), reparsed.is_some(), "{}", next);
                for document in [found, reparsed].into_iter().flatten() {
                    prop_assert_eq!(shown(Some(&document)), shown(expected.as_ref().ok()), "{}", next);
                    prop_assert_eq!(&entities.text, &next);
                    entity_wise.set(entity_wise.get() + 1);
                }
                match expected {
                    Ok(_) => {
                        valid.set(valid.get() + 2);
                        text = next;
                    }
                    Err(error) => prop_assert_eq!(parse(&next, &mut entities), Err(error), "{}", next),
                }
            }
            Ok(())
        })
        .unwrap();
    let (valid, entity_wise) = (valid.get(), entity_wise.get());
    assert!(valid > 2000 && entity_wise * 100 > valid * 95, "{entity_wise} of {valid}");
}

/// Characters of several bytes at every place: letters, and U+200E, which RON skips as white space.
#[test]
fn explanations_keep_the_boundaries_of_characters() {
    for at in (0..=SCENE.len()).filter(|at| SCENE.is_char_boundary(*at)) {
        for piece in
            ["ß", "ß: (", "\u{200e}material: (", "\u{200e}name\u{200e}:\u{200e}(", "ß\"", "ß#", "\\ß"]
        {
            let text = format!("{}{piece}{}", &SCENE[..at], &SCENE[at..]);
            for mistake in parse_general(&text).err().unwrap_or_default() {
                assert!(mistake.span.is_none_or(|span| text.get(span).is_some()), "{text}");
            }
        }
    }
}

#[test]
fn wrong_part_boundaries_are_detected() {
    let inner = "/*),\n(*/ (name: \"),(\", /* ), ( */ transform: (rotation: Quat(0, 0, 0, 1))), // ),\n(";
    let text = Arc::new(format!("(entities: [{})], animate: [])", [inner; 20].join("),\n")));
    for part in [1, 7, 50, PART] {
        let document = ParsedEntities::default().parse_next(&text, part).unwrap();
        assert_eq!(document.entities.len(), 40);
        assert_eq!(Ok(document), parse_general(&text));
    }
    for without_list in ["()", "(ambient: (1, 1, 1))", "(entities: []", "entities: []", ""] {
        assert_eq!(ParsedEntities::default().parse_next(&Arc::new(without_list.to_owned()), 1), None);
    }
}

#[test]
fn only_edited_entities_are_parsed_again() {
    let kept = |from: &str, to: &str| {
        let mut entities = known(SCENE);
        let before = entities.list.documents.clone();
        let edited = Arc::new(SCENE.replacen(from, to, 1));
        let document = entities.parse_next(&edited, PART).unwrap();
        assert_eq!(Ok(&document), parse_general(&edited).as_ref());
        let is_kept = |entity: &Arc<EntityDocument>| before.iter().any(|before| Arc::ptr_eq(before, entity));
        (document.entities.iter().filter(|entity| is_kept(entity)).count(), document.entities.len())
    };
    assert_eq!(kept("", ""), (7, 7));
    assert_eq!(kept("ambient: (1", "ambient: (2"), (7, 7));
    assert_eq!(kept("255", "25"), (7, 7));
    assert_eq!(kept("radius: 1", "radius: 2"), (6, 7));
    assert_eq!(kept("// one, (two", "(name: \"new\"),"), (7, 8));
    assert_eq!(kept("        (name: \"ß\"),\n", ""), (6, 6));
    assert_eq!(kept("entities: [", "entities: [(name: \"new\"),"), (7, 8));
}

#[test]
fn the_same_rest_is_not_parsed_again() {
    let is_kept = |before: &str, from: &str, to: &str| {
        let mut entities = ParsedEntities::default();
        parse(&Arc::new(before.to_owned()), &mut entities).unwrap();
        let rest = entities.rest.clone().unwrap();
        let edited = Arc::new(before.replacen(from, to, 1));
        assert_eq!(parse(&edited, &mut entities), parse_general(&edited));
        Arc::ptr_eq(&rest, &entities.rest.unwrap())
    };
    assert!(is_kept(SCENE, "", "") && is_kept(SCENE, "radius: 1", "radius: 2"));
    assert!(is_kept(SCENE, "entities: [", "entities: [(name: \"new\"),"));
    assert!(!is_kept(SCENE, "255", "25") && !is_kept(SCENE, "(1, (1, 0, 0))", "(1, (2, 0, 0))"));
    let without_list = "(ambient: (1, 1, 1))";
    assert!(is_kept(without_list, "", "") && !is_kept(without_list, "(1, 1", "(1, 2"));
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
    // A bracket within a name, a guessed end of the list that is wrong.
    (
        "(entities: [(), (name: \"a]\"), ()], ambient: (1, 1, 1))",
        "(entities: [(), (name: \"b]\"), (), ()], ambient: (1, 1, 1))",
    ),
    // A comma too few or too many.
    ("(entities: [(), (), ()])", "(entities: [() (), ()])"),
    ("(entities: [(), (), ()])", "(entities: [(),, (), ()])"),
    ("(entities: [(), (), ()])", "(entities: [,(), (), ()])"),
    // A second list, by its raw name.
    ("(entities: [(), ()], ambient: (1, 1, 1))", "(entities: [(), ()], r#entities: [(), (), ()])"),
    ("(entities: [(), ()], ambient: (1, 1, 1))", "(r#entities: [(), ()], ambient: (1, 1, 1))"),
    ("(entities: [], ambient: (1, 1, 1))", "(entities: [(), ()], ambient: (1, 1, 1))"),
    ("(entities: [(), ()])", "(entities: [])"),
];

#[test]
fn misleading_edits_are_parsed_correctly() {
    for (old, new) in DECEPTIONS {
        let (old, new) = (Arc::new((*old).to_owned()), Arc::new((*new).to_owned()));
        let mut entities = ParsedEntities::default();
        for text in [&old, &new, &old] {
            let expected = parse_general(text);
            if let Some(found) = entities.parse_next(text, 1) {
                assert_eq!(shown(Some(&found)), shown(expected.as_ref().ok()), "{text}");
            }
            assert_eq!(parse(text, &mut entities), expected, "{text}");
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
