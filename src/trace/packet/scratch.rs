//! Memory reused between packet queries.

use super::crossings::{CrossedPacket, CrossingScratch};
use super::reciprocals::Reciprocals;
use crate::trace::bvh::{PACKETS, PacketStack};

/// Memory of queries with up to [`PACKETS`] packets.
#[derive(Clone, Debug)]
pub(crate) struct PacketScratch {
    pub(super) stack: PacketStack,
    pub(super) reciprocals: Box<[Reciprocals; PACKETS]>,
    pub(super) crossing: Box<CrossingScratch>,
    /// Transparent shapes that the shadow rays of the last query cross.
    pub(crate) crossed: Vec<CrossedPacket>,
}

impl Default for PacketScratch {
    fn default() -> Self {
        let reciprocals = Box::new([const { Reciprocals::UNKNOWN }; PACKETS]);
        let crossing = Box::new(CrossingScratch::EMPTY);
        Self { stack: PacketStack::default(), reciprocals, crossing, crossed: Vec::new() }
    }
}
