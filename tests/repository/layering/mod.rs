//! Tests of every source file against the table of layers in the crate's documentation, and of import cycles.

mod circles;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::PathBuf;

use crate::{files_in, root};

/// The modules and crates that a layer may use.
#[derive(Debug, Default)]
struct Layer {
    modules: BTreeSet<String>,
    crates: BTreeSet<String>,
}

/// Crates that all layers may use.
const OPEN: [&str; 5] = ["std", "core", "alloc", "thiserror", "libm"];

fn source() -> PathBuf {
    root().join("src")
}

/// Returns the table of layers from the documentation in `lib.rs`.
fn layers(documentation: &str) -> BTreeMap<String, Layer> {
    let list = |cell: &str| -> BTreeSet<String> {
        cell.split(',')
            .map(|name| name.trim().trim_matches('`').to_owned())
            .filter(|name| !name.is_empty())
            .collect()
    };
    let mut layers = BTreeMap::new();
    for line in documentation.lines().filter_map(|line| line.strip_prefix("//! | `")) {
        let cells: Vec<&str> = line.trim_end().trim_end_matches('|').split('|').collect();
        let [names, _, modules, crates] = cells[..] else { panic!("not a row of the table: {line}") };
        for name in list(names) {
            layers.insert(name, Layer { modules: list(modules), crates: list(crates) });
        }
    }
    layers
}

/// Returns the code of a file, without comments, strings, and the unit tests at its end.
fn code(text: &str) -> String {
    // Unit tests end a file; other code for tests may be anywhere.
    let text = &text[..text.find("\nmod tests {").unwrap_or(text.len())];
    let mut code = String::new();
    for line in text.lines() {
        let line = line.split("//").next().unwrap_or_default();
        // Every second part between quotes is a string.
        code.extend(line.split('"').step_by(2));
        code.push('\n');
    }
    code
}

/// Returns the first names of all paths in the code that start at `prefix`, as in `crate::`, or anywhere for an empty prefix.
fn roots(code: &str, prefix: &str) -> BTreeSet<String> {
    let is_word = |character: char| character.is_alphanumeric() || character == '_';
    let mut roots = BTreeSet::new();
    for (at, _) in code.match_indices(if prefix.is_empty() { "::" } else { prefix }) {
        if prefix.is_empty() {
            let before = &code[..at];
            let start = before.rfind(|character| !is_word(character)).map_or(0, |end| end + 1);
            // In an absolute path, no word precedes `::`.
            let absolute = before[..start].strip_suffix("::").map(|outer| !outer.ends_with(is_word));
            if absolute.unwrap_or(true) {
                roots.insert(before[start..].to_owned());
            }
        } else {
            let after = &code[at + prefix.len()..];
            // `use crate::{a::B, c::D}` has several names.
            let group = after.strip_prefix('{').map(|group| {
                let mut depth = 0;
                let end = group.find(|character| {
                    depth += i32::from(character == '{') - i32::from(character == '}');
                    depth < 0
                });
                &group[..end.unwrap_or(group.len())]
            });
            let mut depth = 0;
            let separate = |character: char| {
                depth += i32::from(character == '{') - i32::from(character == '}');
                character == ',' && depth == 0
            };
            let names: Vec<&str> = group.map_or_else(|| vec![after], |group| group.split(separate).collect());
            for name in names {
                let name = name.trim_start();
                let end = name.find(|character| !is_word(character)).unwrap_or(name.len());
                roots.insert(name[..end].to_owned());
            }
        }
    }
    roots.remove("");
    roots
}

/// Returns all dependencies of the package, by their names in code.
fn dependencies() -> BTreeSet<String> {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let sections = manifest.split("\n[").filter_map(|section| section.split_once("]\n"));
    // Includes the dependencies of all platforms.
    let ours = |head: &str| head == "dependencies" || head.starts_with("target.");
    let lines = sections.filter(|(head, _)| ours(head)).flat_map(|(_, section)| section.lines());
    let lines = lines.filter(|line| !line.starts_with('#'));
    lines.filter_map(|line| Some(line.split_once('=')?.0.trim().replace('-', "_"))).collect()
}

/// Returns the forbidden imports of a file of a layer.
fn violations(
    layer: &str,
    text: &str,
    layers: &BTreeMap<String, Layer>,
    dependencies: &BTreeSet<String>,
) -> Vec<String> {
    let Some(allowed) = layers.get(layer) else {
        return vec![format!("`{layer}` is not in the table of layers")];
    };
    let code = code(text);
    let mut wrong = Vec::new();
    let in_binary = ["main", "cli"].contains(&layer);
    for module in roots(&code, "crate::") {
        if module != layer && !allowed.modules.contains(&module) && !in_binary {
            wrong.push(format!("`{layer}` may not import `crate::{module}`"));
        }
    }
    for name in roots(&code, "") {
        let outside = dependencies.contains(&name) || name == "rayreel";
        let open = OPEN.contains(&name.as_str())
            || allowed.crates.contains(&name)
            || allowed.modules.contains(&name);
        if outside && !open {
            wrong.push(format!("`{layer}` may not use the crate `{name}`"));
        }
    }
    wrong
}

#[test]
fn every_file_imports_only_allowed_layers() {
    let layers = layers(&fs::read_to_string(source().join("lib.rs")).unwrap());
    let dependencies = dependencies();
    let paths = files_in(&source(), "rs");
    assert!(layers.len() >= 10 && dependencies.len() >= 10 && paths.len() >= 50);
    let mut wrong = Vec::new();
    for path in paths {
        let relative = path.strip_prefix(source()).unwrap();
        let layer = relative.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs").to_owned();
        if layer == "lib" {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let found = violations(&layer, &text, &layers, &dependencies);
        wrong.extend(found.into_iter().map(|violation| format!("{}: {violation}", path.display())));
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn forbidden_imports_are_found_in_every_syntax() {
    let layers = layers(&fs::read_to_string(source().join("lib.rs")).unwrap());
    let dependencies = dependencies();
    let check = |layer: &str, text: &str| violations(layer, text, &layers, &dependencies);
    for forbidden in [
        "use crate::scene::Scene;",
        "use crate::{color::Rgb, scene::{Scene, LoadError}};",
        "fn f() { crate::engine::Engine::new(w); }",
        "use hecs::World;",
        "use {glam::DVec3, ron::Value};",
        "fn f() -> ::serde::Value {}",
        "pub use crate::components;",
    ] {
        assert_eq!(check("trace", forbidden).len(), 1, "{forbidden}");
    }
    for allowed in [
        "use crate::color::Rgb; use glam::DVec3; use std::fmt;",
        "use crate::trace::Ray;",
        "// use hecs::World;",
        "const A: &str = \"hecs::World\";",
        "use super::Scene;",
    ] {
        assert_eq!(check("trace", allowed), Vec::<String>::new(), "{allowed}");
    }
    assert_eq!(check("drawer", ""), ["`drawer` is not in the table of layers"]);
}

#[test]
fn every_module_has_docs_and_files_are_short() {
    let paths = files_in(&source(), "rs");
    for path in paths {
        let text = fs::read_to_string(&path).unwrap();
        assert!(
            text.starts_with("//!") || text.starts_with("#![doc"),
            "{} does not open with its purpose",
            path.display()
        );
        assert!(text.lines().count() <= 600, "{} is longer than 600 lines", path.display());
    }
}
