//! Whole pictures do not depend on where a scene is and how large it is.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::path::{Path, PathBuf};

use glam::DVec3;

use rayreel::components::{Camera, FilmSettings, Fog, Light, Parent, Refractive, Transform, View};
use rayreel::{Engine, Film};

fn scenes() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")).unwrap();
    let mut scenes: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    scenes.retain(|path| path.is_file());
    scenes.sort();
    scenes
}

/// The scene's middle frame with everything, the camera too, scaled and then moved.
fn picture(path: &Path, scale: f64, offset: DVec3) -> Film {
    let mut engine = Engine::load(path).unwrap();
    for film in engine.world_mut().query_mut::<&mut FilmSettings>() {
        *film = FilmSettings { width: 160, height: 90, ..*film };
    }
    engine.add_system(move |context| {
        for transform in context.world.query_mut::<hecs::Without<&mut Transform, &Parent>>() {
            transform.translation = transform.translation * scale + offset;
            transform.scale *= scale;
        }
        for light in context.world.query_mut::<&mut Light>() {
            if let Some(falloff) = &mut light.falloff {
                falloff.linear /= scale;
                falloff.quadratic /= scale * scale;
            }
        }
        // What has a parent goes along with it.
        for camera in context.world.query_mut::<hecs::Without<&mut Camera, &Parent>>() {
            camera.position = camera.position * scale + offset;
            if let View::Target(target) = &mut camera.view {
                *target = *target * scale + offset;
            }
        }
        for camera in context.world.query_mut::<&mut Camera>() {
            if let Some(lens) = &mut camera.lens {
                lens.aperture *= scale;
                lens.focus *= scale;
            }
        }
        for fog in context.world.query_mut::<&mut Fog>() {
            fog.density /= scale;
        }
        for refractive in context.world.query_mut::<&mut Refractive>() {
            refractive.absorption = (refractive.absorption.as_dvec3() / scale).as_vec3();
        }
    });
    let middle = engine.timeline().frame_count() / 2;
    engine.render_frame(middle).unwrap()
}

/// The share of pixels that differ by more than an output code in any channel.
fn difference(one: &Film, other: &Film) -> f64 {
    let differ =
        |pair: &(&rayreel::Rgb, &rayreel::Rgb)| (*pair.0 - *pair.1).abs().max_element() > 1.0 / 255.0;
    let count = one.pixels().iter().zip(other.pixels()).filter(differ).count();
    count as f64 / one.pixels().len() as f64
}

#[test]
fn a_power_of_two_changes_no_bit() {
    for path in scenes() {
        let plain = picture(&path, 1.0, DVec3::ZERO);
        for exponent in [-60, 60] {
            let scaled = picture(&path, libm::ldexp(1.0, exponent), DVec3::ZERO);
            assert!(scaled == plain, "{} times 2^{exponent}", path.display());
        }
    }
}

#[test]
fn other_scales_and_places_change_next_to_nothing() {
    for path in scenes() {
        let plain = picture(&path, 1.0, DVec3::ZERO);
        for (scale, offset) in [
            (1e-6, DVec3::ZERO),
            (1e9, DVec3::ZERO),
            (1.0, DVec3::new(1e7, -1e7, 1e7)),
            (1.0, DVec3::splat(5e8)),
        ] {
            let share = difference(&plain, &picture(&path, scale, offset));
            assert!(share <= 1e-4, "{} times {scale} plus {offset}: {} %", path.display(), 100.0 * share);
        }
    }
}
