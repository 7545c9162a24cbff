//! Tests of intersections and of light, against exact arithmetic, closed forms, the reference path, and pictures that must be equal.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

mod as_written;
mod closed_forms;
mod coincident;
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
mod ray_visibility;
mod sampling;
#[path = "../random/splitmix.rs"]
mod splitmix;

use rayreel::{Engine, Scene};

/// Returns an engine for the text of a valid scene.
fn engine(text: &str) -> Engine {
    let scene = Scene::from_text("test.ron", text.to_owned());
    Engine::from_scene(scene.unwrap_or_else(|error| panic!("{error}")))
}
