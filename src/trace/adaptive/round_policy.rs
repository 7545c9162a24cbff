//! The choice of which pixels get samples in the next round, where it is not the target's.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::EstimatedError;
use super::needs::SquaresByGain;

/// Chooses the samples of each round of a picture. What it has chosen brings back the same picture: see [`Replay`].
pub trait RoundPolicy: Send {
    /// Returns the least gain with which the samples of a pixel are doubled in the next round; `None` to end the picture. It is not called
    /// once the picture's error is as small as its target.
    fn least_gain(&mut self, outlook: &Outlook<'_>) -> Option<u32>;

    /// Returns the least gains of all rounds, if they are known beforehand: the picture is identified by them.
    fn rounds(&self) -> Option<&[u32]> {
        None
    }
}

/// A policy that is asked by what renders, and set up by somebody else.
pub type SharedRoundPolicy = Arc<Mutex<dyn RoundPolicy>>;

/// Locks a policy.
pub(crate) fn locked(policy: &SharedRoundPolicy) -> MutexGuard<'_, dyn RoundPolicy + 'static> {
    policy.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The expected effect of more samples of a picture.
#[derive(Debug)]
pub struct Outlook<'a> {
    pub(super) gains: &'a SquaresByGain,
    pub(super) pixels: f64,
    /// By what doubling its samples multiplies the square error of a pixel.
    pub(super) falls: f64,
    pub(super) error: EstimatedError,
    pub(super) samples: f64,
}

impl Outlook<'_> {
    /// Returns the estimate of the error that the picture has now.
    #[must_use]
    pub fn error(&self) -> EstimatedError {
        self.error
    }

    /// Returns the number of samples of all pixels so far.
    #[must_use]
    pub fn samples(&self) -> f64 {
        self.samples
    }

    /// Returns the number of further samples that it takes for the error to become `rms`, as far as it can.
    #[must_use]
    pub fn samples_for(&self, rms: f64) -> f64 {
        self.gains.least_for(rms * rms * self.pixels, self.falls).1
    }

    /// Returns the least gain with which samples are to be doubled for that.
    #[must_use]
    pub fn least_gain_for(&self, rms: f64) -> u32 {
        self.gains.least_for(rms * rms * self.pixels, self.falls).0.into()
    }

    /// Returns the least gain with which the next round takes at most this many samples.
    #[must_use]
    pub fn least_gain_within(&self, samples: f64) -> u32 {
        self.gains.least_within(samples).into()
    }
}

/// The rounds of a picture that is rendered again.
#[derive(Clone, Debug)]
pub struct Replay {
    rounds: Vec<u32>,
    done: usize,
}

impl Replay {
    /// Returns rounds with these least gains, for one picture.
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
