//! Tests of scenes as files: their worlds and pictures, their includes, and the messages for invalid ones.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

mod extends;
mod foreign;
mod goldens;
mod includes;
mod messages;
#[path = "../engine/reload/model.rs"]
mod model;
mod plain_words;
#[path = "../engine/reload/random.rs"]
mod random;
mod remedies;
mod scene_to_world;
mod schema;
#[path = "../random/splitmix.rs"]
mod splitmix;
mod write_back;

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the paths in a folder of the repository, sorted.
fn paths_in(folder: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join(folder)).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}

fn scenes_in(folder: &str) -> Vec<PathBuf> {
    let mut scenes = paths_in(folder);
    scenes.retain(|path| path.extension().is_some_and(|end| end == "ron"));
    scenes
}
