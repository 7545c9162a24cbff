//! Tests of every scene in `tests/bad_scenes/`, and of every scene of several files in `tests/bad_includes/`, against the exact message in
//! the file next to it.
//!
//! `RAYREEL_BLESS=1 cargo test --test scenes messages` rewrites the messages; review the changes before keeping them.

use std::fs;
use std::path::{Path, PathBuf};

use rayreel::Scene;

use crate::{paths_in, root, scenes_in};

/// Returns the scenes of several files, each in a folder with the files that it includes.
fn bad_includes() -> Vec<PathBuf> {
    paths_in("tests/bad_includes").into_iter().map(|folder| folder.join("scene.ron")).collect()
}

/// Returns the message for a path, with paths relative to the repository.
fn message(path: &Path) -> String {
    let error = Scene::load(path).err().unwrap_or_else(|| panic!("{} is not bad", path.display()));
    error.to_string().replace(&format!("{}/", root().display()), "") + "\n"
}

#[test]
fn every_bad_scene_has_its_message() {
    let (scenes, of_several_files) = (scenes_in("tests/bad_scenes"), bad_includes());
    assert!(scenes.len() >= 30 && of_several_files.len() >= 7);
    let bless = std::env::var_os("RAYREEL_BLESS").is_some();
    let mut wrong = Vec::new();
    for path in scenes.into_iter().chain(of_several_files) {
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
    let path = root().join("tests/bad_scenes/five_mistakes.ron");
    let error = Scene::load(&path).err().unwrap();
    let lines: Vec<usize> = error.mistakes().map(|mistake| mistake.position.unwrap().line).collect();
    assert_eq!(lines, [2, 3, 5, 6, 6]);
    assert!(error.mistakes().all(|mistake| mistake.diagnostic.help.is_some()));
}

#[test]
fn directories_and_missing_files_are_reported() {
    assert_eq!(
        message(&root().join("tests/bad_scenes")),
        "error: `tests/bad_scenes` is a directory\n--> tests/bad_scenes\n = help: name a scene file, such as one that ends in .ron\n"
    );
    assert_eq!(
        message(&root().join("scenes/first_ligth.ron")),
        "error: there is no file `scenes/first_ligth.ron`\n--> scenes/first_ligth.ron\n = help: did you mean `scenes/first_light.ron`?\n"
    );
}
