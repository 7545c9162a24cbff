//! The rays that go through the stages together, in packets.

use glam::DVec3;

use super::tile::{PACKETS, PIXELS};
use crate::trace::light::{BranchPacket, PathPacket};
use crate::trace::math::LANES;
use crate::trace::rays::RayPacket;

/// Rays in packets, which have one ray of a slot at most, and are in the order in which their light is added up. A generation of more
/// rays is taken in parts, so that memory does not grow with it.
#[derive(Clone, Debug)]
pub(super) struct Wave {
    /// How many packets there are.
    pub(super) count: usize,
    pub(super) rays: Box<[RayPacket; PACKETS]>,
    /// What they carry.
    pub(super) paths: Box<[PathPacket; PACKETS]>,
    /// The slots of the camera rays that they continue.
    pub(super) slots: Box<[[u32; LANES]; PACKETS]>,
    pub(super) start: Start,
}

/// Where the rays of a wave start.
#[derive(Clone, Copy, Debug)]
pub(super) enum Start {
    /// At one point.
    Eye(DVec3),
    /// On the camera's lens.
    Lens,
    Anywhere,
}

impl Wave {
    /// Of no ray.
    pub(super) fn new() -> Self {
        Self {
            count: 0,
            rays: Box::new([const { RayPacket::EMPTY }; PACKETS]),
            paths: Box::new([const { PathPacket::AT_CAMERA }; PACKETS]),
            slots: Box::new([[0; LANES]; PACKETS]),
            start: Start::Anywhere,
        }
    }

    /// Takes all rays out.
    pub(super) fn clear(&mut self) {
        (self.count, self.start) = (0, Start::Anywhere);
    }

    /// Adds a packet of rays for these slots.
    pub(super) fn add(&mut self, branches: &BranchPacket, slots: &[u32; LANES]) {
        self.rays[self.count].clone_from(&branches.rays);
        self.paths[self.count].clone_from(&branches.paths);
        self.slots[self.count] = *slots;
        self.count += 1;
    }

    /// Adds a packet without rays, and returns its number.
    pub(super) fn add_empty(&mut self) -> usize {
        self.rays[self.count].clear();
        self.count += 1;
        self.count - 1
    }

    /// Copies a ray for a slot into a lane of a packet that has none there.
    #[inline(always)]
    pub(super) fn copy(
        &mut self,
        (packet, lane): (usize, usize),
        (from, from_lane): (&BranchPacket, usize),
        slot: u32,
    ) {
        self.rays[packet].copy(lane, &from.rays, from_lane);
        self.paths[packet].set(lane, &from.paths.get(from_lane));
        self.slots[packet][lane] = slot;
    }

    /// Returns the packet of camera rays that the rays of a packet continue lane by lane.
    #[inline(always)]
    pub(super) fn home(&self, packet: usize) -> Option<usize> {
        let slots = &self.slots[packet];
        let home = slots[0] as usize / LANES % PACKETS;
        (*slots == PIXELS[home]).then_some(home)
    }

    /// Returns how many rays there are.
    pub(super) fn len(&self) -> u32 {
        self.rays[..self.count].iter().map(|packet| packet.lanes.count_ones()).sum()
    }
}
