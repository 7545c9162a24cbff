//! The rays that go through the stages together, in packets.

use glam::DVec3;

use super::generation::{Generation, QueuedRay};
use super::tile::{PACKETS, PIXELS};
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
            origin: None,
        }
    }

    /// Takes rays of a generation, no more than there is room for, in their order.
    pub(super) fn fill(&mut self, generation: &Generation, queued: &[QueuedRay]) {
        self.origin = None;
        self.count = queued.len().div_ceil(LANES);
        for (packet, queued) in queued.chunks(LANES).enumerate() {
            let (rays, paths) = (&mut self.rays[packet], &mut self.paths[packet]);
            for (pixel, queued) in self.pixels[packet].iter_mut().zip(queued) {
                *pixel = queued.pixel;
            }
            if is_whole(queued) {
                let from = generation.packet(queued[0].packet);
                rays.clone_from(&from.rays);
                paths.clone_from(&from.paths);
                continue;
            }
            rays.clear();
            for (lane, queued) in queued.iter().enumerate() {
                let from = generation.packet(queued.packet);
                rays.copy(lane, &from.rays, queued.lane);
                paths.set(lane, &from.paths.get(queued.lane));
            }
        }
    }

    /// Returns the packet of camera rays in whose pixels, lane by lane, the rays of a packet are.
    #[inline(always)]
    pub(super) fn home(&self, packet: usize) -> Option<usize> {
        let pixels = &self.pixels[packet];
        let home = pixels[0] as usize / LANES % PACKETS;
        (*pixels == PIXELS[home]).then_some(home)
    }

    /// Returns how many rays there are.
    pub(super) fn len(&self) -> u32 {
        self.rays[..self.count].iter().map(|packet| packet.lanes.count_ones()).sum()
    }
}

/// Returns whether rays are all of one packet, in its order.
fn is_whole(queued: &[QueuedRay]) -> bool {
    let first = queued[0].packet;
    queued.len() == LANES && queued.iter().zip(0..).all(|(ray, lane)| ray.packet == first && ray.lane == lane)
}
