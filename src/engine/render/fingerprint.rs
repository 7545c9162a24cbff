//! What identifies a frame, found instant by instant.

use crate::systems::Preparation;
use crate::time::Time;
use crate::trace::{FrameConstants, FrameFingerprint, FrameHasher, Lighting};

/// The fingerprint of a frame of which some instants are known.
pub(super) struct HashedInstants {
    lighting: Lighting,
    count: u32,
    hasher: Option<FrameHasher>,
    /// The next instant.
    next: u32,
}

impl HashedInstants {
    /// Returns that of a frame of so many instants before the first, with the most that is asked of lights.
    pub(super) fn new(lighting: Lighting, count: u32) -> Self {
        Self { lighting, count, hasher: None, next: 0 }
    }

    /// Notes an instant of the frame at `time`, unless it is known.
    pub(super) fn note(&mut self, preparation: &Preparation, time: Time, instant: u32) {
        if instant != self.next {
            return;
        }
        self.next += 1;
        let sampling = preparation.sampling(time);
        let (lighting, instants) = (self.lighting, self.count);
        let hasher = self.hasher.get_or_insert_with(|| {
            let (transfer, target) = (preparation.film().transfer, preparation.error_target(instants));
            FrameHasher::new(&FrameConstants { transfer, sampling, target, lighting, instants })
        });
        hasher.add(preparation.scene(), preparation.camera(), sampling);
    }

    /// Returns the fingerprint.
    pub(super) fn finish(self) -> FrameFingerprint {
        self.hasher.map_or_else(FrameFingerprint::of_nothing, |hasher| hasher.finish())
    }
}
