//! The rays that go through the stages together, in packets.

use glam::DVec3;

use super::generation::{Generation, QueuedRay};
use super::tile::PACKETS;
use crate::trace::light::PathPacket;
use crate::trace::math::LANES;
use crate::trace::rays::RayPacket;

/// Rays that go through the stages together, at most: a generation of more is taken in parts, so that memory does not grow with it.
pub(super) const LONGEST_WAVE: usize = PACKETS * LANES;

/// Rays in packets. Of one pixel they are in the order in which their light is added up.
#[derive(Clone, Debug)]
pub(super) struct Wave {
    /// How many packets there are.
    pub(super) count: usize,
    pub(super) rays: Box<[RayPacket; PACKETS]>,
    /// What they carry.
    pub(super) paths: Box<[PathPacket; PACKETS]>,
    /// The indices of their pixels in the tile.
    pub(super) pixels: Box<[[u32; LANES]; PACKETS]>,
    /// Whether each ray is in the lane of its pixel.
    pub(super) in_place: bool,
    /// Where all of them start, if that is one point.
    pub(super) origin: Option<DVec3>,
}

impl Wave {
    /// Of no ray.
    pub(super) fn new() -> Self {
        Self {
            count: 0,
            rays: Box::new([const { RayPacket::EMPTY }; PACKETS]),
            paths: Box::new([const { PathPacket::AT_CAMERA }; PACKETS]),
            pixels: Box::new([[0; LANES]; PACKETS]),
            in_place: false,
            origin: None,
        }
    }

    /// Takes rays of a generation, no more than there is room for, in their order.
    pub(super) fn fill(&mut self, generation: &Generation, queued: &[QueuedRay]) {
        (self.in_place, self.origin) = (false, None);
        self.count = queued.len().div_ceil(LANES);
        for (packet, queued) in queued.chunks(LANES).enumerate() {
            let (rays, paths) = (&mut self.rays[packet], &mut self.paths[packet]);
            rays.clear();
            for (lane, queued) in queued.iter().enumerate() {
                let from = generation.packet(queued.packet);
                rays.copy(lane, &from.rays, queued.lane);
                paths.set(lane, &from.paths.get(queued.lane));
                self.pixels[packet][lane] = queued.pixel;
            }
        }
    }

    /// Returns how many rays there are.
    pub(super) fn len(&self) -> u32 {
        self.rays[..self.count].iter().map(|packet| packet.lanes.count_ones()).sum()
    }
}
