//! Shipped scenes as kernel input: at the middle of their timelines, on a film of 480 x 270 pixels.

use std::path::{Path, PathBuf};

use rayreel::components::FilmSettings;
use rayreel::systems::{Preparation, animate, propagate};
use rayreel::{Changes, Scene, Time, World};

/// Scenes of different kinds: many boxes, balls on a plane, a board under a soft sun, transparent objects, mirrors, and spot lights.
pub(crate) const SCENES: [&str; 6] =
    ["box_field", "first_light", "chess_morning", "glass_marbles", "hall_of_mirrors", "stage_lights"];

/// Returns the path of a shipped scene.
pub(crate) fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("ron")
}

/// Returns the world of a shipped scene at the middle of its timeline, and that time.
pub(crate) fn world(name: &str) -> (World, Time) {
    let Scene { mut world, timeline, .. } = Scene::load(&path(name)).expect("shipped scenes are good");
    for film in world.query_mut::<&mut FilmSettings>() {
        *film = FilmSettings { width: 480, height: 270, ..*film };
    }
    let middle = timeline.time_of(timeline.frame_count() / 2);
    animate(&mut world, middle, &mut Changes::default());
    propagate(&mut world, &Changes::all());
    (world, middle)
}

/// Returns the world of a shipped scene, and its kernel arrays.
pub(crate) fn prepared(name: &str) -> (World, Preparation) {
    let (mut world, middle) = world(name);
    let preparation = Preparation::of(&mut world, middle);
    (world, preparation)
}
