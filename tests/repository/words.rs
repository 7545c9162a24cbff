//! Tests of the words in the sources: beginnings of docs, and names of types.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::{files_in, root};

/// Words that no doc begins with: an item is named by a noun, or described by a verb.
const BEGINNINGS: [&str; 15] = [
    "What ",
    "Which ",
    "How ",
    "Where ",
    "Who ",
    "Whose ",
    "Whether ",
    "When ",
    "Why ",
    "Of ",
    "By what ",
    "In which ",
    "From where ",
    "Into ",
    "For which ",
];

/// Returns the first lines of doc comments, with their numbers.
fn first_lines(text: &str) -> Vec<(usize, &str)> {
    let text_of = |line: &'_ str| -> Option<usize> {
        let code = line.trim_start();
        (code.starts_with("///") || code.starts_with("//!")).then(|| line.len() - code.len() + 3)
    };
    let mut found = Vec::new();
    let mut is_inside = false;
    for (number, line) in (1..).zip(text.lines()) {
        let start = text_of(line);
        if let Some(start) = start.filter(|_| !is_inside) {
            found.push((number, line[start..].trim()));
        }
        is_inside = start.is_some();
    }
    found
}

/// Returns the name of the type that a line defines, if it defines one. Associated types, which have no name of their own, do not count.
fn defined_type(line: &str) -> Option<&str> {
    let visible = line.trim_start();
    let code = match visible.strip_prefix("pub") {
        Some(rest) => rest.trim_start_matches(|letter: char| !letter.is_whitespace()).trim_start(),
        None => visible,
    };
    let name = ["struct ", "enum ", "union ", "trait "].iter().find_map(|word| code.strip_prefix(word));
    let name = name.or_else(|| code.strip_prefix("type ").filter(|_| visible.len() == line.len()))?;
    name.split(|letter: char| !letter.is_alphanumeric()).next().filter(|name| !name.is_empty())
}

fn sources() -> Vec<(String, String)> {
    let read = |path: &Path| {
        let name = path.strip_prefix(root()).unwrap().to_str().unwrap().to_owned();
        (name, fs::read_to_string(path).unwrap())
    };
    ["src", "tests", "benches"]
        .iter()
        .flat_map(|folder| files_in(&root().join(folder), "rs"))
        .map(|path| read(&path))
        .collect()
}

#[test]
fn docs_begin_with_nouns_and_verbs() {
    let mut wrong = Vec::new();
    for (file, text) in sources() {
        for (number, line) in first_lines(&text) {
            if BEGINNINGS.iter().any(|beginning| line.starts_with(beginning)) {
                wrong.push(format!("{file}:{number}: {line}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_type_name_stands_for_one_type() {
    let mut types = BTreeMap::<String, Vec<String>>::new();
    for (file, text) in sources().into_iter().filter(|(file, _)| file.starts_with("src/")) {
        for name in text.lines().filter_map(defined_type) {
            types.entry(name.to_owned()).or_default().push(file.clone());
        }
    }
    assert!(types.len() > 500 && types["Engine"].len() == 1);
    let twice: Vec<_> = types.iter().filter(|(_, files)| files.len() > 1).collect();
    assert!(twice.is_empty(), "{twice:#?}");
}

#[test]
fn beginnings_and_definitions_are_found() {
    let text = "//! Of files.\n\n/// A type.\n/// What it is.\npub(crate) struct Type;\n    /// Which one.\n";
    assert_eq!(first_lines(text), [(1, "Of files."), (3, "A type."), (6, "Which one.")]);
    let defined = [
        "pub(crate) struct One<'a> {",
        "enum Two {",
        "    struct Three;",
        "type Four = u8;",
        "pub trait Five {",
    ];
    assert_eq!(defined.map(defined_type), ["One", "Two", "Three", "Four", "Five"].map(Some));
    assert_eq!(["    type Target = Ray;", "let structure = 1;", "/// struct"].map(defined_type), [None; 3]);
}
