//! The choice of a frame's samples.

use std::sync::{Arc, Mutex};

use crate::engine::Engine;
use crate::systems::RenderSettings;
use crate::trace::{Replay, SharedRoundPolicy};

/// The samples of a frame, chosen for an error target or a time limit. The same samples reproduce the same picture.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameSamples {
    /// The maximum number of samples per pixel: [`Sampling::samples`](crate::components::Sampling::samples).
    pub samples: u32,
    /// The error target of the picture; 0 for the same number of samples in all pixels.
    pub max_error: f32,
    /// The least gains of the picture's rounds, if they do not follow from the error target: see [`FrameReport::rounds`](crate::engine::FrameReport::rounds).
    pub rounds: Option<Vec<u32>>,
}

impl FrameSamples {
    /// Returns the samples for an error target, with at most `samples` per pixel.
    #[must_use]
    pub fn for_error(max_error: f32, samples: u32) -> Self {
        Self { samples, max_error, rounds: None }
    }

    /// Configures an engine for pictures with these samples. If there are rounds, they apply to one picture.
    pub fn set_up(&self, engine: &mut Engine) {
        engine.settings = RenderSettings {
            samples: Some(self.samples),
            max_error: Some(self.max_error),
            ..engine.settings
        };
        let replay =
            |rounds: &Vec<u32>| -> SharedRoundPolicy { Arc::new(Mutex::new(Replay::new(rounds.clone()))) };
        engine.round_policy = self.rounds.as_ref().map(replay);
    }
}
