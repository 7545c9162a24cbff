//! Policies that choose the pixels to sample in the next round, in place of the error target.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::EstimatedError;
use super::needs::SquaresByGain;

/// Chooses the pixels to sample in each round of a picture. Replaying the choices with [`Replay`] reproduces the picture.
pub trait RoundPolicy: Send {
    /// Returns the minimum gain for doubling a pixel's sample count in the next round; `None` ends the picture. Not called once the
    /// picture's error has reached its target.
    fn least_gain(&mut self, outlook: &Outlook<'_>) -> Option<u32>;

    /// Returns the minimum gains of all rounds if they are known in advance. They then identify the picture.
    fn rounds(&self) -> Option<&[u32]> {
        None
    }
}

/// A policy shared by the renderer that queries it and the caller that configures it.
pub type SharedRoundPolicy = Arc<Mutex<dyn RoundPolicy>>;

/// Locks a policy.
pub(crate) fn locked(policy: &SharedRoundPolicy) -> MutexGuard<'_, dyn RoundPolicy + 'static> {
    policy.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The expected effect of more samples on a picture.
#[derive(Debug)]
pub struct Outlook<'a> {
    pub(super) gains: &'a SquaresByGain,
    pub(super) pixels: f64,
    /// Factor of a pixel's squared error when its sample count is doubled.
    pub(super) falls: f64,
    pub(super) error: EstimatedError,
    pub(super) samples: f64,
}

impl Outlook<'_> {
    /// Returns the estimate of the picture's current error.
    #[must_use]
    pub fn error(&self) -> EstimatedError {
        self.error
    }

    /// Returns the total sample count of all pixels so far.
    #[must_use]
    pub fn samples(&self) -> f64 {
        self.samples
    }

    /// Returns the number of further samples needed to reduce the error to `rms`, if it can be reached.
    #[must_use]
    pub fn samples_for(&self, rms: f64) -> f64 {
        self.gains.least_for(rms * rms * self.pixels, self.falls).1
    }

    /// Returns the minimum gain for doubling sample counts that reduces the error to `rms`.
    #[must_use]
    pub fn least_gain_for(&self, rms: f64) -> u32 {
        self.gains.least_for(rms * rms * self.pixels, self.falls).0.into()
    }

    /// Returns the minimum gain with which the next round takes at most `samples` samples.
    #[must_use]
    pub fn least_gain_within(&self, samples: f64) -> u32 {
        self.gains.least_within(samples).into()
    }
}

/// The minimum gains of a picture's rounds, for rendering it again.
#[derive(Clone, Debug)]
pub struct Replay {
    rounds: Vec<u32>,
    done: usize,
}

impl Replay {
    /// Creates a replay of rounds with these minimum gains, for one picture.
    #[must_use]
    pub fn new(rounds: Vec<u32>) -> Self {
        Self { rounds, done: 0 }
    }
}

impl RoundPolicy for Replay {
    fn least_gain(&mut self, _: &Outlook<'_>) -> Option<u32> {
        self.done += 1;
        self.rounds.get(self.done - 1).copied()
    }

    fn rounds(&self) -> Option<&[u32]> {
        Some(&self.rounds)
    }
}
