//! What searches with packets keep for its memory.

use super::crossings::{CrossedPacket, CrossingScratch};
use super::reciprocals::Reciprocals;
use crate::trace::bvh::{PACKETS, PacketStack};

/// Memory of searches with packets, as many as go together.
#[derive(Clone, Debug)]
pub(crate) struct PacketScratch {
    pub(super) stack: PacketStack,
    pub(super) reciprocals: Box<[Reciprocals; PACKETS]>,
    pub(super) crossing: Box<CrossingScratch>,
    /// The clear shapes in the ways of the shadow rays that were followed last.
    pub(crate) crossed: Vec<CrossedPacket>,
}

impl Default for PacketScratch {
    fn default() -> Self {
        let reciprocals = Box::new([const { Reciprocals::UNKNOWN }; PACKETS]);
        let crossing = Box::new(CrossingScratch::EMPTY);
        Self { stack: PacketStack::default(), reciprocals, crossing, crossed: Vec::new() }
    }
}
