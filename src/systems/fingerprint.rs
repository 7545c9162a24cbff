//! The fingerprint of a frame, computed instant by instant.

use super::{FrameInstants, PreparedInstant};
use crate::trace::{FrameConstants, FrameFingerprint, FrameHasher};

/// The incremental fingerprint of a frame.
pub(super) struct HashedInstants<'a> {
    frame: &'a FrameInstants,
    /// The identifying instants. The first `known` of them are hashed.
    instants: Vec<u32>,
    known: usize,
    hasher: Option<FrameHasher>,
}

impl<'a> HashedInstants<'a> {
    pub(super) fn new(frame: &'a FrameInstants) -> Self {
        Self { frame, instants: frame.identifying_instants(), known: 0, hasher: None }
    }

    /// Hashes an instant if it is the next of the identifying instants.
    pub(super) fn note(&mut self, instant: PreparedInstant<'_>) {
        if self.instants.get(self.known) != Some(&instant.index) {
            return;
        }
        self.known += 1;
        let data = instant.data;
        let sampling = data.sampling(self.frame.time);
        let hasher = self.hasher.get_or_insert_with(|| {
            let instants = u32::try_from(self.instants.len()).unwrap_or(u32::MAX);
            let (transfer, target) = (data.film().transfer, data.error_target(instants > 1));
            let lighting = self.frame.lighting();
            let mut hasher =
                FrameHasher::new(&FrameConstants { transfer, sampling, target, lighting, instants });
            if let Some(overlay) = data.overlay() {
                hasher.add_overlay(&overlay);
            }
            hasher
        });
        hasher.add(data.scene(), data.camera(), sampling);
    }

    pub(super) fn finish(self) -> FrameFingerprint {
        self.hasher.map_or_else(FrameFingerprint::of_nothing, |hasher| hasher.finish())
    }
}
