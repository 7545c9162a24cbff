//! What sixteen rays carry from the camera.

use super::medium_stack::MediumStack;
use super::secondary::PathState;
use crate::color::Rgb;
use crate::trace::math::{Colors, LANES};

/// A [`PathState`] of every lane.
#[derive(Clone, Debug)]
pub(crate) struct PathPacket {
    pub(crate) throughputs: Colors,
    pub(crate) media: [MediumStack; LANES],
    /// The places in the tree of rays.
    pub(crate) places: [u64; LANES],
}

impl PathPacket {
    /// At the root of trees, outside of all solids.
    pub(crate) const AT_CAMERA: Self =
        Self { throughputs: Colors::splat(Rgb::ONE), media: [MediumStack::NONE; LANES], places: [1; LANES] };

    /// Returns what the ray in a lane carries.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> PathState {
        let lane = lane % LANES;
        PathState {
            throughput: self.throughputs.get(lane),
            medium: self.media[lane],
            path: self.places[lane],
        }
    }

    /// Sets what the ray in a lane carries.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, state: &PathState) {
        let lane = lane % LANES;
        self.throughputs.set(lane, state.throughput);
        self.media[lane] = state.medium;
        self.places[lane] = state.path;
    }
}
