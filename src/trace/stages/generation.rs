//! The rays of a generation, before it is known which of them are traced.

use glam::DVec3;

use crate::color::Rgb;
use crate::trace::light::BranchPacket;
use crate::trace::math::LANES;
use crate::trace::rays::Ties;

/// Rays that surfaces send on, in packets with gaps, and in which order they go on.
#[derive(Clone, Debug, Default)]
pub(super) struct Generation {
    /// More than are in use; kept for their memory.
    packets: Vec<BranchPacket>,
    used: usize,
    /// Pixel by pixel, mirrored rays before refracted ones that continue the same ray.
    pub(super) queue: Vec<QueuedRay>,
    /// Kept for its memory.
    sorted: Vec<QueuedRay>,
}

/// A ray in one of a generation's packets.
#[derive(Clone, Copy, Debug)]
pub(super) struct QueuedRay {
    pub(super) packet: usize,
    pub(super) lane: usize,
    /// Index of the pixel in the tile.
    pub(super) pixel: u32,
    /// Whether it is mirrored; else it is refracted.
    pub(super) mirrored: bool,
    /// Whether it is left out, as it could not show.
    pub(super) cut: bool,
}

/// A ray that is not traced any more.
#[derive(Clone, Copy, Debug)]
pub(super) struct UntracedRay {
    pub(super) direction: DVec3,
    pub(super) throughput: Rgb,
    /// Index of the pixel in the tile.
    pub(super) pixel: u32,
}

impl Generation {
    /// Forgets all rays.
    pub(super) fn clear(&mut self) {
        self.used = 0;
        self.queue.clear();
    }

    /// Adds a packet without rays, and returns its number.
    pub(super) fn add(&mut self) -> usize {
        if self.used == self.packets.len() {
            self.packets.push(BranchPacket::EMPTY);
        }
        self.packets[self.used].rays.clear();
        self.used += 1;
        self.used - 1
    }

    pub(super) fn packet(&self, packet: usize) -> &BranchPacket {
        &self.packets[packet]
    }

    /// Returns the packets of a surface's mirrored and refracted rays, if there is one of those.
    pub(super) fn branches_mut(
        &mut self,
        mirrored: usize,
        refracted: Option<usize>,
    ) -> (&mut BranchPacket, Option<&mut BranchPacket>) {
        let (before, rest) = self.packets.split_at_mut(mirrored + 1);
        (&mut before[mirrored], refracted.map(|refracted| &mut rest[refracted - mirrored - 1]))
    }

    /// Queues the ray in a lane of a packet, if there is one.
    #[inline]
    pub(super) fn queue(&mut self, packet: usize, lane: usize, pixel: u32, mirrored: bool) {
        if self.packets[packet].rays.lanes & (1 << lane) != 0 {
            self.queue.push(QueuedRay { packet, lane, pixel, mirrored, cut: false });
        }
    }

    /// Puts rays of whole packets before the others, so that they go on as they are. Pixels may change their order, and so each of them
    /// must have a single ray.
    pub(super) fn whole_packets_first(&mut self) {
        self.sorted.clear();
        for whole in [true, false] {
            let packets = self.queue.chunk_by(|one, other| one.packet == other.packet);
            packets.filter(|rays| (rays.len() == LANES) == whole).for_each(|rays| self.sorted.extend(rays));
        }
        std::mem::swap(&mut self.queue, &mut self.sorted);
    }

    /// The lists of what else rays leave, where anything is.
    pub(super) fn ties_mut(&mut self) -> impl Iterator<Item = &mut Ties> {
        self.packets[..self.used].iter_mut().flat_map(|packet| packet.rays.ties_mut())
    }
}
