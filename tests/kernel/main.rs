//! What rays meet and what light does, held against exact arithmetic, closed forms, the reference path and pictures that must be
//! the same.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

mod as_written;
mod closed_forms;
mod document_order;
mod fast_path;
mod hard_cases;
mod heaps;
mod invariance;
mod model;
mod numerics;
mod oracle;
mod ray_counts;
mod ray_trees;
mod sampling;
#[path = "../random/splitmix.rs"]
mod splitmix;

use rayreel::{Engine, Scene};

/// The engine of a text that must be a scene.
fn engine(text: &str) -> Engine {
    let scene = Scene::from_text("test.ron", text.to_owned());
    Engine::from_scene(scene.unwrap_or_else(|error| panic!("{error}")))
}
