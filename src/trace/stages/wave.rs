//! The rays that go through the stages together, in packets.

use glam::DVec3;

use super::tile::PACKETS;
use crate::trace::light::{MediumStack, PathState, TreeRay};
use crate::trace::math::LANES;
use crate::trace::rays::RayPacket;

/// Rays that go through the stages together, at most: a generation of more is taken in parts, so that memory does not grow with it.
pub(super) const LONGEST_WAVE: usize = PACKETS * LANES;

/// A ray on its way for a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct QueuedRay {
    pub(super) tree: TreeRay,
    /// Index of the pixel in the tile.
    pub(super) pixel: u32,
    /// Whether it is mirrored; else it is refracted.
    pub(super) mirrored: bool,
    /// Whether it is left out, as it could not show.
    pub(super) cut: bool,
}

/// Rays in packets. Of one pixel they are in the order in which their light is added up.
#[derive(Clone, Debug)]
pub(super) struct Wave {
    /// How many packets there are.
    pub(super) count: usize,
    pub(super) rays: Box<[RayPacket; PACKETS]>,
    /// What they carry.
    pub(super) states: Box<[[PathState; LANES]; PACKETS]>,
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
            states: Box::new([[PathState::at_camera(MediumStack::NONE); LANES]; PACKETS]),
            pixels: Box::new([[0; LANES]; PACKETS]),
            origin: None,
        }
    }

    /// Takes as many rays as there is room for, in their order.
    pub(super) fn fill(&mut self, queued: impl Iterator<Item = QueuedRay>) {
        self.origin = None;
        self.count = 0;
        for (index, QueuedRay { tree, pixel, .. }) in queued.take(LONGEST_WAVE).enumerate() {
            let (packet, lane) = (index / LANES, index % LANES);
            if lane == 0 {
                self.count += 1;
                self.rays[packet].clear();
            }
            self.rays[packet].set(lane, &tree.ray);
            self.states[packet][lane] = tree.state;
            self.pixels[packet][lane] = pixel;
        }
    }

    /// Returns how many rays there are.
    pub(super) fn len(&self) -> u32 {
        self.rays[..self.count].iter().map(|packet| packet.lanes.count_ones()).sum()
    }
}
