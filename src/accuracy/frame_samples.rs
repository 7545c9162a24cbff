//! The samples of a frame, as they are chosen.

use std::sync::{Arc, Mutex};

use crate::engine::Engine;
use crate::systems::Knobs;
use crate::trace::{Replay, SharedRoundPolicy};

/// The samples of a frame: what is chosen for an error or for a deadline, and what brings back the same picture.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameSamples {
    /// The most samples of a pixel: [`Sampling::samples`](crate::components::Sampling::samples).
    pub samples: u32,
    /// The error that the picture may have, 0 for as many samples everywhere.
    pub max_error: f32,
    /// The least gains of the picture's rounds, if they do not follow from the error: see [`Engine::rounds`].
    pub rounds: Option<Vec<u32>>,
}

impl FrameSamples {
    /// Returns as many samples as it takes for an error, of this many at most.
    #[must_use]
    pub fn for_error(max_error: f32, samples: u32) -> Self {
        Self { samples, max_error, rounds: None }
    }

    /// Sets an engine up for pictures with them: for one picture where there are rounds.
    pub fn set_up(&self, engine: &mut Engine) {
        engine.set_knobs(Knobs {
            samples: Some(self.samples),
            max_error: Some(self.max_error),
            ..Knobs::default()
        });
        let replay =
            |rounds: &Vec<u32>| -> SharedRoundPolicy { Arc::new(Mutex::new(Replay::new(rounds.clone()))) };
        engine.set_round_policy(self.rounds.as_ref().map(replay));
    }
}
