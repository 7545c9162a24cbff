//! Memory that queries need besides the scene, reused so that none allocates.

use std::sync::atomic::{AtomicBool, Ordering};

use super::crossings::{Crossed, CrossedPacket, Crossing, CrossingScratch};
use super::hit::TiedHitLists;
use super::intersector::Intersector;
use super::naive::Naive;
use super::reciprocals::Reciprocals;
use crate::trace::bvh::{PACKETS, PacketStack, Stack};
use crate::trace::rays::TieLists;

/// The memory that ray queries need besides the scene, reused between rays so that no query allocates.
#[derive(Clone, Debug)]
pub(crate) struct Scratch<'a> {
    /// Set on cancellation; results are then unspecified.
    pub(crate) cancelled: &'a AtomicBool,
    pub(crate) stack: Stack,
    pub(crate) intersector: Intersector<'a>,
    /// The coincident shapes at the surface points that rays of this tile have found.
    pub(crate) ties: TieLists,
    /// The other hits at the same `t` as closest hits.
    pub(crate) tied_hits: TiedHitLists,
    /// The transparent shapes on the path of a shadow ray, in any order.
    pub(crate) crossed: Vec<Crossed>,
    /// The crossings of that ray with them.
    pub(crate) crossings: Vec<Crossing>,
}

/// The flag of queries that are never cancelled.
static NEVER: AtomicBool = AtomicBool::new(false);

impl<'a> Scratch<'a> {
    /// Creates the memory of robust queries or, with naive shapes, of naive ones.
    pub(crate) fn new(cancelled: &'a AtomicBool, naive: Option<&'a Naive>) -> Self {
        Self {
            cancelled,
            stack: Stack::default(),
            intersector: Intersector::new(naive),
            ties: TieLists::default(),
            tied_hits: TiedHitLists::default(),
            crossed: Vec::new(),
            crossings: Vec::new(),
        }
    }

    /// Creates the memory of queries that are never cancelled.
    pub(super) fn uncancelled(naive: Option<&'a Naive>) -> Self {
        Self::new(&NEVER, naive)
    }

    /// Returns whether queries are cancelled.
    #[inline(always)]
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

impl Default for Scratch<'_> {
    /// Creates the memory of robust queries that are never cancelled.
    fn default() -> Self {
        Self::uncancelled(None)
    }
}

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
