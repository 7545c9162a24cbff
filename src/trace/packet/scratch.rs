//! What searches with packets keep for its memory.

use super::reciprocals::Reciprocals;
use crate::trace::bvh::{PARTS, PacketStack};

/// Memory of searches with packets, as many as go together.
#[derive(Clone, Debug)]
pub(crate) struct PacketScratch {
    pub(super) stack: PacketStack,
    pub(super) reciprocals: Box<[Reciprocals; PARTS / 2]>,
}

impl Default for PacketScratch {
    fn default() -> Self {
        let reciprocals = Box::new([const { Reciprocals::UNKNOWN }; PARTS / 2]);
        Self { stack: PacketStack::default(), reciprocals }
    }
}
