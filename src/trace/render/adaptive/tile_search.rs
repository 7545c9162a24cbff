//! The search for the features of pixels, tile by tile.

use super::evidence::PixelPacket;
use crate::trace::math::{lanes, lanes_where};
use crate::trace::rays::ShapeId;
use crate::trace::render::visibility::{CoverPacket, Feature, KnownFeatures, TileFeatures, UNCOVERED};
use crate::trace::stages::{PACKETS, Tile};

/// The last instant of an open shutter at which a tile was searched.
#[derive(Clone, Debug)]
pub(super) struct LastInstant {
    /// The large shapes in each pixel.
    covers: [CoverPacket; PACKETS],
    /// The digest of the features; 0 before the first search.
    digest: u64,
}

impl LastInstant {
    /// Before the first search.
    pub(super) const NONE: Self = Self { covers: [CoverPacket::all(UNSEEN); PACKETS], digest: 0 };
}

/// The cover of pixels that were not searched yet. No shape has this id.
const UNSEEN: ShapeId = ShapeId(UNCOVERED.0 - 1);

/// A tile that is searched for features, and its part of the sampling state.
#[derive(Debug)]
pub(crate) struct TileSearch<'a> {
    pub(super) tile: Tile,
    pub(super) packets: &'a mut [PixelPacket],
    /// With an open shutter: the last instant.
    pub(super) last: Option<&'a mut LastInstant>,
    /// Maximum sample count of a pixel.
    pub(super) most: u32,
}

impl TileSearch<'_> {
    /// Returns the tile.
    pub(crate) fn tile(&self) -> &Tile {
        &self.tile
    }

    /// Returns what other instants have shown.
    pub(crate) fn known(&self) -> KnownFeatures {
        let mut known = KnownFeatures::NONE;
        if let Some(last) = &self.last {
            known.digest = last.digest;
            let of_packets = known.radiance.iter_mut().zip(self.packets.iter());
            of_packets.for_each(|(radiance, pixels)| *radiance = pixels.radiance_of_whole());
        }
        known
    }

    /// Stores the features of the tile's pixels at an instant.
    pub(crate) fn record(&mut self, found: &TileFeatures) {
        let most = self.most;
        for (packet, pixels) in self.packets.iter_mut().enumerate() {
            let (features, cover) = found.of(packet);
            let has_feature = lanes_where(|lane| features[lane] != Feature::NONE) & pixels.inside();
            lanes(has_feature).for_each(|lane| pixels.join(lane, features[lane], most));
            let Some(last) = &mut self.last else { continue };
            let before = &mut last.covers[packet];
            // A large shape that covers a pixel at one instant but not at the next, or has its border elsewhere, moves through it.
            let changes = |lane: usize| {
                (before.ids[lane] != cover.ids[lane]) | (before.borders[lane] != cover.borders[lane])
            };
            let differs = |lane: usize| changes(lane) & (before.ids[lane] != UNSEEN);
            for lane in lanes(lanes_where(differs) & pixels.inside()) {
                let radiance = before.radiance[lane].max(cover.radiance[lane]);
                pixels.join(lane, Feature { area: 1.0, radiance }, most);
            }
            *before = *cover;
        }
        if let Some(last) = &mut self.last {
            last.digest = found.digest;
        }
    }
}
