//! Tests of the scanner with texts full of brackets, strings and comments.

use super::*;

fn found<'a>(text: &'a str, path: &[PathStep]) -> &'a str {
    &text[locate(text, &[path.to_vec()])[0].clone()]
}

#[test]
fn values_are_found_through_names_lists_maps_and_comments() {
    let text = r##"#![enable(implicit_some)]
        // a comment with (brackets
        Scene(
            title: "a \"quoted\" ) text", raw: r#"un"closed ("#, /* nested /* ( */ */
            materials: { "red": (color: (255, 0, 0)), "green": ( color : "#00ff00" ) },
            entities: [ (shape: Sphere(radius: -1.5e3)), (shape: Some(Box(size: (1, 2, 3))), name: "ß") ],
            keys: Keys([ (0, (1, 2, 3)), (1, (4, 5, 6), EaseIn) ]),
        )"##;
    use PathStep::{Field, Index, Key};
    assert_eq!(found(text, &[Field("materials"), Key(1)]), "\"green\"");
    assert_eq!(found(text, &[Field("materials"), Index(1), Field("color")]), "\"#00ff00\"");
    assert_eq!(found(text, &[Field("materials"), Index(0), Field("color"), Index(0)]), "255");
    assert_eq!(found(text, &[Field("entities"), Index(0), Field("shape"), Field("radius")]), "-1.5e3");
    assert_eq!(found(text, &[Field("entities"), Index(0), Field("shape")]), "Sphere(radius: -1.5e3)");
    assert_eq!(found(text, &[Field("entities"), Index(1), Field("shape"), Field("size"), Index(2)]), "3");
    assert_eq!(found(text, &[Field("entities"), Index(1), Field("name")]), "\"ß\"");
    assert_eq!(found(text, &[Field("keys"), Index(0), Index(1), Index(2)]), "EaseIn");
    assert_eq!(found(text, &[Field("raw")]), "r#\"un\"closed (\"#");
    let text = "(r#type: r#Name(\"#\"), quote: b''', escaped: '\\'', last: 1)";
    assert_eq!(found(text, &[Field("r#type")]), "r#Name(\"#\")");
    assert_eq!(found(text, &[Field("quote")]), "b'''");
    assert_eq!(found(text, &[Field("escaped")]), "'\\''");
    assert_eq!(found(text, &[Field("last")]), "1");
}

#[test]
fn unknown_fields_are_located_at_the_enclosing_value() {
    let text = "(entities: [(shape: Sphere(radius: 1))])";
    let path = [PathStep::Field("entities"), PathStep::Index(0), PathStep::Field("material")];
    assert_eq!(found(text, &path), "(shape: Sphere(radius: 1))");
    assert_eq!(found("", &path), "");
    assert_eq!(found("((((", &path), "((((");
}

#[test]
fn positions_in_strings_map_to_the_file() {
    let text = r###"("a + b", r#"a "+" b"#, "a\tb", b)"###;
    let inside = |index: usize, inside: Range<usize>| {
        let literal = locate(text, &[vec![PathStep::Index(index)]])[0].clone();
        &text[inside_text(text, literal, &inside)]
    };
    assert_eq!(inside(0, 4..5), "b");
    assert_eq!(inside(1, 2..5), "\"+\"");
    assert_eq!(inside(2, 2..3), r#""a\tb""#);
    assert_eq!(inside(0, 4..99), "b\"");
    assert_eq!(inside(3, 0..1), "b");
}

#[test]
fn tokens_are_words_numbers_texts_and_signs() {
    let text = "(a:\u{200e}-1.5e3, // none\n \u{a0}\"t)\" /* none */ b(2/3)";
    let found: Vec<&str> = tokens(text).map(|token| &text[token]).collect();
    let expected = ["(", "a", ":", "-1.5e3", ",", "\u{a0}", "\"t)\"", "b", "(", "2", "/", "3", ")"];
    assert_eq!(found, expected);
}

#[test]
fn unclosed_comments_are_located_at_their_start() {
    assert_eq!(open_comment("(a: \"/*\") // /*\n /* /* */ b"), Some(17));
    assert_eq!(open_comment("/* /*"), Some(0));
    assert_eq!(open_comment("(a)"), None);
}
