//! Worlds over time: what animations, cameras, scripts, systems and reloads make of them, and what is wrong in them.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

mod alpha;
mod camera_paths;
mod cameras;
mod crowds;
mod encoded_films;
mod every_channel;
mod faults;
mod own_systems;
mod passes;
mod prepared_changes;
mod reload;
mod sample_counts;
mod scripts;
#[path = "../processor_time/spent.rs"]
mod spent;
#[path = "../random/splitmix.rs"]
mod splitmix;

use rayreel::components::Name;
use rayreel::{Engine, Entity};

fn named(engine: &Engine, name: &str) -> Entity {
    let mut names = engine.world().query::<(&Name, Entity)>();
    names.iter().find(|(known, _)| known.0 == name).unwrap().1
}
