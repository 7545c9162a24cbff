//! Data that the batches of a tile's samples share.

use fearless_simd::dispatch;

use super::slots::Slots;
use super::tile::{PACKETS, Tile};
use crate::trace::intersect::{LensCandidates, Scratch};
use crate::trace::math::LANES;
use crate::trace::scene::{PixelKeys, Precision};
use crate::trace::shading::RenderContext;

/// The sampling keys and lens candidates of a tile's slots, reused while batches have the same pixels in the same slots.
#[derive(Debug)]
pub(super) struct TileSampler {
    known: Option<KnownSlots>,
    /// By packet: the sampling keys of its slots.
    pub(super) keys: Box<[PixelKeys; PACKETS]>,
    /// The shapes that rays can hit through the lens, or in an orthographic view.
    pub(super) candidates: LensCandidates,
}

/// The slots that keys were computed for.
#[derive(Debug, PartialEq, Eq)]
struct KnownSlots {
    tile: Tile,
    in_place: bool,
    pixels: [[u32; LANES]; PACKETS],
    lanes: [u32; PACKETS],
}

impl Default for TileSampler {
    fn default() -> Self {
        let keys = Box::new([const { PixelKeys::NONE }; PACKETS]);
        Self { known: None, keys, candidates: LensCandidates::default() }
    }
}

impl TileSampler {
    /// Computes the keys of a tile's slots, unless the last batch had the same slots.
    pub(super) fn prepare(
        &mut self,
        context: &RenderContext<'_>,
        (tile, slots): (Tile, &Slots),
        search: &mut Scratch<'_>,
    ) {
        if self.known.as_ref().is_some_and(|known| known.serves(tile, slots)) {
            self.keys.iter_mut().zip(slots.lanes).for_each(|(keys, lanes)| keys.set_lanes(lanes));
            return;
        }
        let (seed, has_lens) = (context.sampling.seed, context.camera.has_lens());
        let packets = slots.pixels.iter().zip(slots.lanes).take(slots.count);
        let packets = self.keys.iter_mut().zip(packets);
        dispatch!(context.scene.simd.level(), _simd => {
            for (keys, (pixels, lanes)) in packets {
                let mut places = [(0, 0); LANES];
                places.iter_mut().zip(pixels).for_each(|(place, pixel)| *place = tile.pixel(*pixel));
                keys.find(seed, (&places, lanes), has_lens);
            }
        });
        let has_candidates =
            self.known.as_ref().is_some_and(|known| (known.tile, known.in_place) == (tile, slots.in_place));
        if !has_candidates && (has_lens || context.camera.is_orthographic()) {
            self.find_candidates(context, tile, search);
            if !slots.in_place {
                self.candidates.mix_packets();
            }
        }
        let Slots { in_place, lanes, .. } = *slots;
        self.known = Some(KnownSlots { tile, in_place, pixels: *slots.pixels, lanes });
    }

    /// Collects the shapes that rays of a tile's pixels can hit.
    pub(super) fn find_candidates(
        &mut self,
        context: &RenderContext<'_>,
        tile: Tile,
        search: &mut Scratch<'_>,
    ) {
        self.known = None;
        if context.scene.precision == Precision::Robust {
            let squares = std::array::from_fn(|packet| tile.square(packet));
            self.candidates.find(context.scene, context.camera, &squares, search);
        }
    }
}

impl KnownSlots {
    /// Returns whether keys were computed for these slots. The last batch of a tile may leave some slots empty.
    fn serves(&self, tile: Tile, slots: &Slots) -> bool {
        let covers = |(known, needed): (&u32, &u32)| needed & !known == 0;
        (self.tile, self.in_place) == (tile, slots.in_place)
            && self.lanes.iter().zip(&slots.lanes).all(covers)
            && self.pixels[..slots.count] == slots.pixels[..slots.count]
    }
}
