//! The slots of a tile's camera rays: one sample of one pixel in each lane of its packets.
//!
//! If most pixels take a sample, each sample has the slot of its pixel. Otherwise, slots are compacted: the samples of a pixel have adjacent
//! slots, in as few packets as possible, so that packets are full and their rays are coherent.

use std::ops::Range;

use super::tile::{PACKETS, PIXELS, TILE_PIXELS, Tile};
use crate::trace::math::LANES;
use crate::trace::shading::RenderContext;

/// The input of all stages.
pub(super) struct Sample<'a> {
    pub(super) context: &'a RenderContext<'a>,
    pub(super) tile: Tile,
    /// The samples of the tile's pixels.
    pub(super) slots: &'a Slots,
}

/// The samples that a pixel still takes at one instant: `first`, `first + stride`, and so on, `count` of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Portion {
    /// The pixel's index in its tile.
    pub(crate) pixel: u32,
    pub(crate) first: u32,
    pub(crate) stride: u32,
    pub(crate) count: u32,
}

/// A sample of a pixel for each lane of a tile's packets.
#[derive(Clone, Debug)]
pub(crate) struct Slots {
    /// The number of packets in use.
    pub(crate) count: usize,
    /// By packet and lane: the pixel's index in the tile.
    pub(crate) pixels: Box<[[u32; LANES]; PACKETS]>,
    /// By packet and lane: the index of the sample in its pixel.
    pub(crate) samples: Box<[[u32; LANES]; PACKETS]>,
    /// By packet: the lanes in use, as a bit mask.
    pub(crate) lanes: [u32; PACKETS],
    /// True if every slot has the index of its pixel.
    pub(crate) in_place: bool,
    /// Scratch memory: portions with samples that are not in earlier batches.
    rest: Vec<Portion>,
}

impl Default for Slots {
    fn default() -> Self {
        Self {
            count: PACKETS,
            pixels: Box::new(PIXELS),
            samples: Box::new([[0; LANES]; PACKETS]),
            lanes: [0; PACKETS],
            in_place: true,
            rest: Vec::new(),
        }
    }
}

impl Slots {
    /// Sets one sample of every pixel of a tile.
    pub(crate) fn set_everywhere(&mut self, tile: &Tile, sample: u32) {
        (self.count, *self.pixels, self.in_place) = (PACKETS, PIXELS, true);
        self.samples.fill([sample; LANES]);
        self.lanes = std::array::from_fn(|packet| tile.square(packet).map_or(0, |square| square.lanes()));
    }

    /// Sets batch number `batch` of the pixels' samples. Returns `false` if there is none. While most pixels take a sample, a batch holds one
    /// sample of each, in place; the others are full.
    pub(crate) fn set_batch(&mut self, portions: &[Portion], batch: u32) -> bool {
        let mut rest = std::mem::take(&mut self.rest);
        rest.clear();
        rest.extend_from_slice(portions);
        // Number of batches in place.
        let mut in_place = 0;
        while in_place <= batch && 2 * rest.len() > TILE_PIXELS && !are_sparse(&rest) {
            in_place = rest.iter().map(|portion| portion.count).min().unwrap_or(0);
            if in_place <= batch {
                rest.retain(|portion| portion.count > in_place);
            }
        }
        (self.in_place, self.lanes) = (batch < in_place, [0; PACKETS]);
        if self.in_place {
            (self.count, *self.pixels) = (PACKETS, PIXELS);
            rest.iter().for_each(|portion| self.put(portion.pixel as usize, portion, batch));
        } else {
            self.fill(&rest, (in_place, (batch - in_place).saturating_mul(to_u32(TILE_PIXELS))));
        }
        self.rest = rest;
        self.count > 0
    }

    /// Fills all slots with the samples of portions, from number `from` of each on, without the first `taken` of them.
    fn fill(&mut self, portions: &[Portion], (from, mut taken): (u32, u32)) {
        let samples = portions.iter().flat_map(|portion| {
            let first = from.saturating_add(taken).min(portion.count);
            taken -= first.saturating_sub(from);
            (first..portion.count).map(move |number| (portion, number))
        });
        self.count = 0;
        for (slot, (portion, number)) in samples.take(TILE_PIXELS).enumerate() {
            self.put(slot, portion, number);
            self.count = slot / LANES + 1;
        }
    }

    /// Puts a sample of a portion into a slot.
    #[inline(always)]
    fn put(&mut self, slot: usize, portion: &Portion, number: u32) {
        let (packet, lane) = (slot / LANES % PACKETS, slot % LANES);
        self.pixels[packet][lane] = portion.pixel;
        self.samples[packet][lane] = portion.first + portion.stride * number;
        self.lanes[packet] |= 1 << lane;
    }

    /// Iterates over the pixels of compacted slots: the pixel's index in the tile, and its slots.
    #[inline(always)]
    pub(crate) fn runs(&self) -> impl Iterator<Item = (usize, Range<usize>)> {
        let used: u32 = self.lanes.iter().map(|lanes| lanes.count_ones()).sum();
        let mut end = 0;
        self.pixels.as_flattened()[..used as usize].chunk_by(u32::eq).map(move |run| {
            let first = end;
            end += run.len();
            (run[0] as usize, first..end)
        })
    }

    /// Returns the pixel's index in the tile of a slot, given by its index.
    #[inline(always)]
    pub(super) fn pixel(&self, slot: u32) -> u32 {
        self.pixels[slot as usize / LANES % PACKETS][slot as usize % LANES]
    }

    /// Returns the sample's index in its pixel of a slot, given by its index.
    #[inline(always)]
    pub(super) fn sample(&self, slot: u32) -> u32 {
        self.samples[slot as usize / LANES % PACKETS][slot as usize % LANES]
    }
}

/// Returns whether compaction saves at least a quarter of the packets. Below that, the coherence of rays of neighbouring pixels is worth more:
/// they hit the same shapes.
fn are_sparse(portions: &[Portion]) -> bool {
    let mut used = [false; PACKETS];
    portions.iter().for_each(|portion| used[portion.pixel as usize / LANES % PACKETS] = true);
    let packets = used.into_iter().filter(|used| *used).count();
    4 * portions.len().div_ceil(LANES) <= 3 * packets
}

fn to_u32(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Collects the samples that all batches take, pixel by pixel in the order of slots.
    fn taken(portions: &[Portion]) -> Vec<Vec<u32>> {
        let (mut slots, mut taken) = (Slots::default(), vec![Vec::new(); TILE_PIXELS]);
        for batch in 0.. {
            if !slots.set_batch(portions, batch) {
                break;
            }
            let samples = slots.samples.as_flattened();
            if slots.in_place {
                let used = |slot: &usize| slots.lanes[slot / LANES] >> (slot % LANES) & 1 == 1;
                (0..TILE_PIXELS).filter(used).for_each(|slot| taken[slot].push(samples[slot]));
            } else {
                slots.runs().for_each(|(pixel, run)| taken[pixel].extend_from_slice(&samples[run]));
            }
        }
        taken
    }

    proptest! {
        #[test]
        fn every_sample_of_every_portion_is_taken_once_in_order(
            counts in prop::collection::vec((0_u32..1000, 1_u32..300, prop_oneof![0_u32..3, 0_u32..40]), 0..=TILE_PIXELS),
            keep in 1_usize..9,
        ) {
            let portions: Vec<Portion> = (0..)
                .zip(&counts)
                .step_by(keep)
                .map(|(pixel, (first, stride, count))| Portion { pixel, first: *first, stride: *stride, count: *count })
                .collect();
            let mut expected = vec![Vec::new(); TILE_PIXELS];
            for Portion { pixel, first, stride, count } in &portions {
                expected[*pixel as usize] = (0..*count).map(|number| first + number * stride).collect();
            }
            prop_assert_eq!(taken(&portions), expected);
        }
    }

    #[test]
    fn few_pixels_fill_packets_and_many_stay_in_place() {
        let portions = |pixels: &[u32]| -> Vec<Portion> {
            pixels.iter().map(|pixel| Portion { pixel: *pixel, first: 4, stride: 1, count: 4 }).collect()
        };
        let mut slots = Slots::default();
        assert!(slots.set_batch(&portions(&[3, 200]), 0));
        assert_eq!((slots.count, slots.lanes[0], slots.in_place), (1, 0xff, false));
        assert!(!slots.set_batch(&portions(&[3, 200]), 1));
        assert!(slots.set_batch(&portions(&(0..250).collect::<Vec<_>>()), 3) && slots.in_place);
        let every_other: Vec<u32> = (0..256).filter(|pixel| pixel % 32 < 18).collect();
        for (batch, packets) in [(0, 16), (1, 16), (2, 4)] {
            assert!(slots.set_batch(&portions(&every_other), batch));
            assert_eq!((slots.count, slots.in_place), (packets, false));
        }
        assert!(!slots.set_batch(&portions(&every_other), 3));
    }
}
