//! `rayreel render --draft`: reduced settings that keep a scene recognisable.

use rayreel::Engine;
use rayreel::components::{FilmSettings, Light, LightKind, Quality, Sampling};

/// The divisor of the film's width and height.
const SHRINKING: u32 = 3;
/// Maximum ray depth, enough to see through a glass. Lower limits save little time and leave transparent objects black.
const DEPTH: u32 = 5;
/// Maximum number of samples of an area light. Fewer make soft shadows unrecognisable.
const LIGHT_SAMPLES: u32 = 4;

/// Lowers the settings that cost time; raises none.
pub(super) fn apply(engine: &mut Engine) {
    let world = engine.world_mut();
    for film in world.query_mut::<&mut FilmSettings>() {
        let shrunk = |side: u32| (side / SHRINKING).max(1);
        *film = FilmSettings { width: shrunk(film.width), height: shrunk(film.height), ..*film };
    }
    // A single sample is taken at one instant, through the centre of the lens.
    for sampling in world.query_mut::<&mut Sampling>() {
        sampling.samples = 1;
        sampling.max_error = 0.0;
    }
    for quality in world.query_mut::<&mut Quality>() {
        quality.depth = quality.depth.min(DEPTH);
    }
    for light in world.query_mut::<&mut Light>() {
        if let LightKind::Area { samples, .. } = &mut light.kind {
            *samples = (*samples).min(LIGHT_SAMPLES);
        }
    }
}
