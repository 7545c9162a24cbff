//! The rays of a generation, before it is known which of them are traced.

use glam::DVec3;

use crate::color::Rgb;
use crate::trace::light::BranchPacket;
use crate::trace::math::LANES;
use crate::trace::rays::Ties;

/// Rays that surfaces send on, in packets with gaps, and, where pixels may have several, in which order they go on.
#[derive(Clone, Debug, Default)]
pub(super) struct Generation {
    /// More than are in use; kept for their memory.
    packets: Vec<SentPacket>,
    used: usize,
    /// Pixel by pixel, mirrored rays before refracted ones that continue the same ray. Of [chains](super::chains) it is empty.
    pub(super) queue: Vec<QueuedRay>,
    /// How many of the queue have gone on.
    pub(super) taken: usize,
}

/// Rays that the surfaces of one packet send on.
#[derive(Clone, Debug)]
pub(super) struct SentPacket {
    pub(super) branches: BranchPacket,
    /// The indices of their pixels in the tile.
    pub(super) pixels: [u32; LANES],
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
        (self.used, self.taken) = (0, 0);
        self.queue.clear();
    }

    /// Returns whether no packet was added.
    pub(super) fn is_empty(&self) -> bool {
        self.used == 0
    }

    /// Adds a packet without rays, for these pixels, and returns its number.
    pub(super) fn add(&mut self, pixels: &[u32; LANES]) -> usize {
        if self.used == self.packets.len() {
            self.packets.push(SentPacket { branches: BranchPacket::EMPTY, pixels: *pixels });
        }
        let added = &mut self.packets[self.used];
        added.branches.rays.clear();
        added.pixels = *pixels;
        self.used += 1;
        self.used - 1
    }

    pub(super) fn packet(&self, packet: usize) -> &BranchPacket {
        &self.packets[packet].branches
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

    /// Queues the ray in a lane of a packet, if there is one.
    #[inline]
    pub(super) fn queue(&mut self, packet: usize, lane: usize, mirrored: bool) {
        let SentPacket { branches, pixels } = &self.packets[packet];
        if branches.rays.lanes & (1 << lane) != 0 {
            self.queue.push(QueuedRay { packet, lane, pixel: pixels[lane], mirrored, cut: false });
        }
    }

    /// The lists of what else rays leave, where anything is.
    pub(super) fn ties_mut(&mut self) -> impl Iterator<Item = &mut Ties> {
        self.packets[..self.used].iter_mut().flat_map(|packet| packet.branches.rays.ties_mut())
    }
}
