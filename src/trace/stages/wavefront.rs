//! The wavefront: the rays that pass through the stages together, in packets.

use glam::DVec3;

use super::tile::{PACKETS, PIXELS};
use crate::trace::math::LANES;
use crate::trace::rays::RayPacket;
use crate::trace::scene::PreparedScene;
use crate::trace::shading::{BranchPacket, PathPacket, RenderContext};

/// Packets of rays, in the order in which their light is accumulated. A packet has at most one ray per slot. A bounce with more rays than fit
/// is split into several wavefronts, so that memory does not grow with it.
#[derive(Clone, Debug)]
pub(super) struct Wavefront {
    /// The number of packets.
    pub(super) count: usize,
    pub(super) rays: Box<[RayPacket; PACKETS]>,
    /// The paths of the rays.
    pub(super) paths: Box<[PathPacket; PACKETS]>,
    /// The slots of the camera rays from which they descend.
    pub(super) slots: Box<[[u32; LANES]; PACKETS]>,
    pub(super) start: RayOrigin,
}

/// The common origin of a wavefront's rays.
#[derive(Clone, Copy, Debug)]
pub(super) enum RayOrigin {
    /// A single point.
    Eye(DVec3),
    /// The camera's lens, or its plane if its rays are parallel.
    Lens,
    /// Any points: secondary rays.
    Anywhere,
}

impl Wavefront {
    /// Creates a wavefront without rays.
    pub(super) fn new() -> Self {
        Self {
            count: 0,
            rays: Box::new([const { RayPacket::EMPTY }; PACKETS]),
            paths: Box::new([const { PathPacket::AT_CAMERA }; PACKETS]),
            slots: Box::new([[0; LANES]; PACKETS]),
            start: RayOrigin::Anywhere,
        }
    }

    /// Returns the scene as the wavefront's rays see it.
    #[inline]
    pub(super) fn scene<'a>(&self, context: &RenderContext<'a>) -> &'a PreparedScene {
        match self.start {
            RayOrigin::Eye(_) | RayOrigin::Lens => context.scene,
            RayOrigin::Anywhere => context.secondary,
        }
    }

    /// Removes all rays.
    pub(super) fn clear(&mut self) {
        (self.count, self.start) = (0, RayOrigin::Anywhere);
    }

    /// Adds a packet of rays with their slots.
    pub(super) fn add(&mut self, branches: &BranchPacket, slots: &[u32; LANES]) {
        self.rays[self.count].clone_from(&branches.rays);
        self.paths[self.count].clone_from(&branches.paths);
        self.slots[self.count] = *slots;
        self.count += 1;
    }

    /// Adds a packet without rays, and returns its index.
    pub(super) fn add_empty(&mut self) -> usize {
        self.rays[self.count].clear();
        self.count += 1;
        self.count - 1
    }

    /// Copies a ray with its slot into a lane that has no ray.
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

    /// Returns the packet of camera rays from which the rays of a packet descend lane by lane, if there is one.
    #[inline(always)]
    pub(super) fn source_packet(&self, packet: usize) -> Option<usize> {
        let slots = &self.slots[packet];
        let source_packet = slots[0] as usize / LANES % PACKETS;
        (*slots == PIXELS[source_packet]).then_some(source_packet)
    }

    /// Returns the number of rays.
    pub(super) fn len(&self) -> u32 {
        self.rays[..self.count].iter().map(|packet| packet.lanes.count_ones()).sum()
    }
}
