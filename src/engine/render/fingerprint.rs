//! The fingerprint of a frame, computed instant by instant.

use crate::systems::Preparation;
use crate::time::Time;
use crate::trace::{FrameConstants, FrameFingerprint, FrameHasher, Lighting};

/// The incremental fingerprint of a frame.
pub(super) struct HashedInstants {
    lighting: Lighting,
    /// The indices of the instants that identify the frame. The first `known` of them are hashed.
    instants: Vec<u32>,
    known: usize,
    hasher: Option<FrameHasher>,
}

impl HashedInstants {
    /// Creates the fingerprint of a frame that is identified by these instants. `lighting` is the most elaborate lighting that is enabled.
    pub(super) fn new(lighting: Lighting, instants: Vec<u32>) -> Self {
        Self { lighting, instants, known: 0, hasher: None }
    }

    /// Returns the indices of the instants that identify the frame.
    pub(super) fn instants(&self) -> &[u32] {
        &self.instants
    }

    /// Hashes an instant of the frame at `time` if it is the next of the identifying instants.
    pub(super) fn note(&mut self, preparation: &Preparation, time: Time, instant: u32) {
        if self.instants.get(self.known) != Some(&instant) {
            return;
        }
        self.known += 1;
        let sampling = preparation.sampling(time);
        let (lighting, instants) = (self.lighting, u32::try_from(self.instants.len()).unwrap_or(u32::MAX));
        let hasher = self.hasher.get_or_insert_with(|| {
            let (transfer, target) = (preparation.film().transfer, preparation.error_target(instants > 1));
            FrameHasher::new(&FrameConstants { transfer, sampling, target, lighting, instants })
        });
        hasher.add(preparation.scene(), preparation.camera(), sampling);
    }

    pub(super) fn finish(self) -> FrameFingerprint {
        self.hasher.map_or_else(FrameFingerprint::of_nothing, |hasher| hasher.finish())
    }
}
