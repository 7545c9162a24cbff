//! The rays of a generation, before it is known which of them are traced.

use glam::DVec3;

use crate::color::Rgb;
use crate::trace::light::BranchPacket;
use crate::trace::math::{LANES, lanes};
use crate::trace::rays::Ties;

/// Rays that surfaces send on, in packets with gaps. A packet has no more than one ray of a slot, and packets are in the order in which
/// light is added up: mirrored rays before refracted ones that continue the same rays.
#[derive(Clone, Debug, Default)]
pub(super) struct Generation {
    /// More than are in use; kept for their memory.
    packets: Vec<SentPacket>,
    used: usize,
    /// How many of the packets have gone on.
    pub(super) taken: usize,
}

/// Rays that the surfaces of one packet send on.
#[derive(Clone, Debug)]
pub(super) struct SentPacket {
    pub(super) branches: BranchPacket,
    /// The slots of the camera rays that they continue.
    pub(super) slots: [u32; LANES],
    /// Whether they are mirrored; else they are refracted.
    pub(super) mirrored: bool,
}

/// A ray that is not traced any more.
#[derive(Clone, Copy, Debug)]
pub(super) struct UntracedRay {
    pub(super) direction: DVec3,
    pub(super) throughput: Rgb,
    /// The slot of the camera ray that it continues.
    pub(super) slot: u32,
}

impl Generation {
    /// Forgets all rays.
    pub(super) fn clear(&mut self) {
        (self.used, self.taken) = (0, 0);
    }

    /// Returns whether no packet was added.
    pub(super) fn is_empty(&self) -> bool {
        self.used == 0
    }

    /// Adds a packet without rays, for these slots, and returns its number.
    pub(super) fn add(&mut self, slots: &[u32; LANES], mirrored: bool) -> usize {
        if self.used == self.packets.len() {
            let branches = BranchPacket::EMPTY;
            self.packets.push(SentPacket { branches, slots: *slots, mirrored });
        }
        let added = &mut self.packets[self.used];
        added.branches.rays.clear();
        (added.slots, added.mirrored) = (*slots, mirrored);
        self.used += 1;
        self.used - 1
    }

    /// The packets that were added.
    pub(super) fn packets(&self) -> &[SentPacket] {
        &self.packets[..self.used]
    }

    /// The same, to be changed.
    pub(super) fn packets_mut(&mut self) -> &mut [SentPacket] {
        &mut self.packets[..self.used]
    }

    /// Returns the packets of a surface's mirrored and refracted rays, if there is one of those.
    pub(super) fn branches_mut(
        &mut self,
        mirrored: usize,
        refracted: Option<usize>,
    ) -> (&mut BranchPacket, Option<&mut BranchPacket>) {
        let (before, rest) = self.packets.split_at_mut(mirrored + 1);
        let refracted = refracted.map(|refracted| &mut rest[refracted - mirrored - 1].branches);
        (&mut before[mirrored].branches, refracted)
    }

    /// The lists of what else rays leave, where anything is.
    pub(super) fn ties_mut(&mut self) -> impl Iterator<Item = &mut Ties> {
        self.packets[..self.used].iter_mut().flat_map(|packet| packet.branches.rays.ties_mut())
    }
}

impl SentPacket {
    /// Notes that the rays in some lanes are not traced any more, and takes them out.
    pub(super) fn give_up(&mut self, lanes_beyond: u32, beyond: &mut Vec<UntracedRay>) {
        let Self { branches: BranchPacket { rays, paths }, slots, .. } = self;
        beyond.extend(lanes(rays.lanes & lanes_beyond).map(|lane| UntracedRay {
            direction: rays.directions.get(lane),
            throughput: paths.throughputs.get(lane),
            slot: slots[lane],
        }));
        rays.keep(!lanes_beyond);
    }
}
