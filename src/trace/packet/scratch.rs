//! What searches with packets keep for its memory.

use super::reciprocals::Reciprocals;
use crate::trace::bvh::{PACKETS, PacketStack};

/// Memory of searches with packets, as many as go together.
#[derive(Clone, Debug)]
pub(crate) struct PacketScratch {
    pub(super) stack: PacketStack,
    pub(super) reciprocals: Box<[Reciprocals; PACKETS]>,
}

impl Default for PacketScratch {
    fn default() -> Self {
        let reciprocals = Box::new([const { Reciprocals::UNKNOWN }; PACKETS]);
        Self { stack: PacketStack::default(), reciprocals }
    }
}
