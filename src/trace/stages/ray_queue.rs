//! The secondary rays of a bounce, before it is decided which of them are traced.

use glam::DVec3;

use crate::color::Rgb;
use crate::trace::math::{LANES, lanes};
use crate::trace::rays::CoincidentHits;
use crate::trace::shading::BranchPacket;

/// A queue of secondary rays, in packets that may have inactive lanes. A packet has at most one ray per slot. Packets are in the order in
/// which light is accumulated: reflected rays precede the refracted rays with the same parents.
#[derive(Clone, Debug, Default)]
pub(super) struct RayQueue {
    /// The packets in use, followed by spare ones whose memory is reused.
    packets: Vec<QueuedPacket>,
    used: usize,
    /// The number of packets already moved to a wavefront.
    pub(super) taken: usize,
}

/// Secondary rays spawned at the surfaces of one packet.
#[derive(Clone, Debug)]
pub(super) struct QueuedPacket {
    pub(super) branches: BranchPacket,
    /// The slots of the camera rays from which they descend.
    pub(super) slots: [u32; LANES],
    /// True if the rays are reflected, false if they are refracted.
    pub(super) mirrored: bool,
}

/// A secondary ray that is not traced.
#[derive(Clone, Copy, Debug)]
pub(super) struct UntracedRay {
    pub(super) direction: DVec3,
    pub(super) throughput: Rgb,
    /// The slot of the camera ray from which it descends.
    pub(super) slot: u32,
}

impl RayQueue {
    /// Removes all rays.
    pub(super) fn clear(&mut self) {
        (self.used, self.taken) = (0, 0);
    }

    /// Returns whether the queue has no packets.
    pub(super) fn is_empty(&self) -> bool {
        self.used == 0
    }

    /// Adds a packet without rays for these slots, and returns its index.
    pub(super) fn add(&mut self, slots: &[u32; LANES], mirrored: bool) -> usize {
        if self.used == self.packets.len() {
            let branches = BranchPacket::EMPTY;
            self.packets.push(QueuedPacket { branches, slots: *slots, mirrored });
        }
        let added = &mut self.packets[self.used];
        added.branches.rays.clear();
        (added.slots, added.mirrored) = (*slots, mirrored);
        self.used += 1;
        self.used - 1
    }

    /// Returns the packets in use.
    pub(super) fn packets(&self) -> &[QueuedPacket] {
        &self.packets[..self.used]
    }

    /// Returns the packets in use, mutably.
    pub(super) fn packets_mut(&mut self) -> &mut [QueuedPacket] {
        &mut self.packets[..self.used]
    }

    /// Returns the packets with these indices: reflected rays and, if given, refracted rays.
    pub(super) fn branches_mut(
        &mut self,
        mirrored: usize,
        refracted: Option<usize>,
    ) -> (&mut BranchPacket, Option<&mut BranchPacket>) {
        let (before, rest) = self.packets.split_at_mut(mirrored + 1);
        let refracted = refracted.map(|refracted| &mut rest[refracted - mirrored - 1].branches);
        (&mut before[mirrored].branches, refracted)
    }

    /// Iterates over the lists of coincident shapes that rays leave, for the rays that have one.
    pub(super) fn ties_mut(&mut self) -> impl Iterator<Item = &mut CoincidentHits> {
        self.packets[..self.used].iter_mut().flat_map(|packet| packet.branches.rays.ties_mut())
    }
}

impl QueuedPacket {
    /// Moves the rays in the lanes `lanes_beyond` to `beyond`: they are not traced.
    pub(super) fn terminate(&mut self, lanes_beyond: u32, beyond: &mut Vec<UntracedRay>) {
        let Self { branches: BranchPacket { rays, paths }, slots, .. } = self;
        beyond.extend(lanes(rays.lanes & lanes_beyond).map(|lane| UntracedRay {
            direction: rays.directions.get(lane),
            throughput: paths.throughputs.get(lane),
            slot: slots[lane],
        }));
        rays.keep(!lanes_beyond);
    }
}
