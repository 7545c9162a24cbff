//! What all samples of a tile's pixels have in common.

use super::tile::{PACKETS, PIXELS, Tile, TileLanes};
use crate::trace::light::RenderContext;
use crate::trace::math::{LANES, lanes};
use crate::trace::packet::LensCandidates;
use crate::trace::query::Scratch;
use crate::trace::scene::{Precision, SpreadKeys, Square};

/// What is the same for all samples of a tile's pixels, where those have several.
#[derive(Debug)]
pub(super) struct SpreadTile {
    /// For which tile that is known, and which of its pixels.
    known: Option<(Tile, TileLanes)>,
    /// How many packets of rays there are.
    pub(super) count: usize,
    /// By packet: its pixels' indices in the tile.
    pub(super) pixels: Box<[[u32; LANES]; PACKETS]>,
    /// By packet: where samples lie.
    pub(super) keys: Box<[SpreadKeys; PACKETS]>,
    /// What they may meet, if there is a lens.
    pub(super) candidates: LensCandidates,
}

impl Default for SpreadTile {
    fn default() -> Self {
        let keys = Box::new([const { SpreadKeys::NONE }; PACKETS]);
        let candidates = LensCandidates::default();
        Self { known: None, count: 0, pixels: Box::new(PIXELS), keys, candidates }
    }
}

impl SpreadTile {
    /// Finds that of a tile's pixels, unless it is known. Where only a few of them get samples, those are put together in as few packets
    /// as they fit in.
    pub(super) fn find(
        &mut self,
        context: &RenderContext<'_>,
        (tile, active): (Tile, TileLanes),
        search: &mut Scratch<'_>,
    ) {
        if self.known.replace((tile, active)) == Some((tile, active)) {
            return;
        }
        let squares: [Option<Square>; PACKETS] = std::array::from_fn(|packet| tile.square(packet));
        let masks: [u32; PACKETS] = std::array::from_fn(|packet| {
            squares[packet].map_or(0, |square| square.lanes()) & active.of_packet(packet)
        });
        let is_mixed = are_sparse(&masks);
        let masks = if is_mixed { self.mix(&masks) } else { self.keep(masks) };
        let (seed, has_lens) = (context.sampling.seed, context.camera.has_lens());
        for ((keys, pixels), mask) in self.keys.iter_mut().zip(&*self.pixels).zip(masks) {
            keys.find(seed, (&pixels.map(|pixel| tile.pixel(pixel)), mask), has_lens);
        }
        if has_lens && context.scene.precision == Precision::Guaranteed {
            self.candidates.find(context.scene, context.camera, &squares, search);
            if is_mixed {
                self.candidates.mix_packets();
            }
        }
    }

    /// Leaves packets as they are.
    fn keep(&mut self, masks: [u32; PACKETS]) -> [u32; PACKETS] {
        (*self.pixels, self.count) = (PIXELS, PACKETS);
        masks
    }

    /// Puts the pixels of all packets into the first ones. Returns their lanes.
    fn mix(&mut self, masks: &[u32; PACKETS]) -> [u32; PACKETS] {
        let all = masks.iter().enumerate();
        let mut all = all.flat_map(|(packet, mask)| lanes(*mask).map(move |lane| PIXELS[packet][lane]));
        let mut mixed = [0; PACKETS];
        self.count = 0;
        for (pixels, mask) in self.pixels.iter_mut().zip(&mut mixed) {
            for (lane, pixel) in (0..LANES).zip(all.by_ref()) {
                pixels[lane] = pixel;
                *mask |= 1 << lane;
            }
            self.count += usize::from(*mask != 0);
        }
        mixed
    }
}

/// Returns whether packets with these lanes would be so much fewer if they were full that it is worth it: rays side by side meet the
/// same.
fn are_sparse(masks: &[u32; PACKETS]) -> bool {
    let pixels: u32 = masks.iter().map(|mask| mask.count_ones()).sum();
    let packets = masks.iter().filter(|mask| **mask != 0).count();
    4 * (pixels as usize).div_ceil(LANES) <= 3 * packets
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_pixels_are_put_together_and_each_is_there_once() {
        let mut spread = SpreadTile::default();
        let mut masks = [0b1000_0000_0001_0000; PACKETS];
        masks[3] = 0;
        assert!(are_sparse(&masks));
        let mixed = spread.mix(&masks);
        assert_eq!((spread.count, mixed[0], mixed[1], mixed[2]), (2, 0xffff, 0x3fff, 0));
        let found = (0..2).flat_map(|packet| lanes(mixed[packet]).map(move |lane| (packet, lane)));
        let found: Vec<u32> = found.map(|(packet, lane)| spread.pixels[packet][lane]).collect();
        let expected =
            (0..PACKETS).flat_map(|packet| lanes(masks[packet]).map(move |lane| PIXELS[packet][lane]));
        assert!(found.into_iter().eq(expected));
    }

    #[test]
    fn packets_that_are_nearly_full_are_left_as_they_are() {
        assert!(!are_sparse(&[0xffff; PACKETS]));
        assert!(!are_sparse(&[0x7fff; PACKETS]));
        assert!(!are_sparse(&[0; PACKETS].map(|_: u32| 0x3fff)));
        let mut one = [0; PACKETS];
        one[5] = 1;
        assert!(!are_sparse(&one));
    }
}
