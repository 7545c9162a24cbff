//! Path states of sixteen rays.

use super::medium_stack::MediumStack;
use super::secondary::PathState;
use crate::color::Rgb;
use crate::trace::math::{Colors, LANES};

/// A [`PathState`] in every lane.
#[derive(Clone, Debug)]
pub(crate) struct PathPacket {
    pub(crate) throughputs: Colors,
    pub(crate) media: [MediumStack; LANES],
    /// Indices in the ray trees.
    pub(crate) places: [u64; LANES],
}

impl PathPacket {
    /// The states of camera rays that start outside all transparent solids.
    pub(crate) const AT_CAMERA: Self =
        Self { throughputs: Colors::splat(Rgb::ONE), media: [MediumStack::NONE; LANES], places: [1; LANES] };

    /// Returns the path state of a lane.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> PathState {
        let lane = lane % LANES;
        PathState {
            throughput: self.throughputs.get(lane),
            medium: self.media[lane],
            path: self.places[lane],
        }
    }

    /// Sets the path state of a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, state: &PathState) {
        let lane = lane % LANES;
        self.throughputs.set(lane, state.throughput);
        self.media[lane] = state.medium;
        self.places[lane] = state.path;
    }
}
