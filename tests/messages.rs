//! Every scene under `tests/bad_scenes/` against the exact message it must produce, which stands beside it.
//!
//! `RAYREEL_BLESS=1 cargo test --test messages` writes the messages anew; look at what changed before you keep it.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

use std::fs;
use std::path::{Path, PathBuf};

use rayreel::Scene;

fn bad_scenes() -> Vec<PathBuf> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_scenes");
    let entries = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    let mut scenes: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|end| end == "ron")).collect();
    scenes.sort();
    scenes
}

/// The message for a path, with the path as a reader of the repository would write it.
fn message(path: &Path) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let error = Scene::load(path).err().unwrap_or_else(|| panic!("{} is not bad", path.display()));
    error.to_string().replace(&format!("{}/", root.display()), "") + "\n"
}

#[test]
fn every_bad_scene_says_what_is_wrong_with_it() {
    let scenes = bad_scenes();
    assert!(scenes.len() >= 30);
    let bless = std::env::var_os("RAYREEL_BLESS").is_some();
    let mut wrong = Vec::new();
    for path in scenes {
        let found = message(&path);
        let expected_path = path.with_extension("message");
        if bless {
            fs::write(&expected_path, &found).unwrap();
        }
        let expected = fs::read_to_string(&expected_path).unwrap_or_default();
        if found != expected {
            wrong.push(format!("{}\n--- expected\n{expected}\n--- found\n{found}", path.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn five_mistakes_of_meaning_are_reported_at_once() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_scenes/five_mistakes.ron");
    let error = Scene::load(&path).err().unwrap();
    let lines: Vec<usize> =
        error.diagnostics().iter().map(|diagnostic| error.place(diagnostic).unwrap().line).collect();
    assert_eq!(lines, [2, 3, 5, 6, 6]);
    assert!(error.diagnostics().iter().all(|diagnostic| diagnostic.help.is_some()));
}

#[test]
fn a_directory_and_a_missing_file_are_named() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    assert_eq!(
        message(&root.join("tests/bad_scenes")),
        "error: `tests/bad_scenes` is a directory\n--> tests/bad_scenes\n = help: name a scene file, such as one that ends in .ron\n"
    );
    assert_eq!(
        message(&root.join("scenes/first_ligth.ron")),
        "error: there is no file `scenes/first_ligth.ron`\n--> scenes/first_ligth.ron\n = help: did you mean `scenes/first_light.ron`?\n"
    );
}
