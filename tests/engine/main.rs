//! Tests of worlds over time, with animations, cameras, scripts, systems and reloads, and of faults in worlds.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

mod aiming;
mod alpha;
mod camera_paths;
mod cameras;
mod clouds;
mod coded_worlds;
mod crowds;
mod custom_systems;
mod encoded_films;
mod every_channel;
mod examples;
mod extends;
mod faults;
mod handedness;
mod moments;
mod movies;
mod orthographic;
mod overlay;
mod passes;
mod prepared_changes;
mod reload;
mod reuse;
mod sample_counts;
mod scripts;
#[path = "../processor_time/spent.rs"]
mod spent;
#[path = "../random/splitmix.rs"]
mod splitmix;
mod tile_stats;
mod visibility;
mod warnings;

use rayreel::components::Name;
use rayreel::{Engine, Entity};

fn named(engine: &Engine, name: &str) -> Entity {
    let mut names = engine.world().query::<(&Name, Entity)>();
    names.iter().find(|(known, _)| known.0 == name).unwrap().1
}
