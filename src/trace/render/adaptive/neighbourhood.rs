//! The 3 by 3 neighbourhoods of the pixels of a packet.

use crate::trace::math::{LANES, WHOLE};

/// A packet and its eight neighbours, row by row; `None` beyond the film.
pub(super) type Around<'a, P> = [[Option<&'a P>; 3]; 3];

/// Pixels in a row of a packet.
pub(super) const SIDE: usize = crate::trace::scene::SIDE as usize;

/// Pixels in a row of a packet with a border of one pixel.
const WIDE: usize = SIDE + 2;

/// Values of a packet's pixels with a border of one pixel, in `PLANES` planes. Values that do not count are NaN.
#[derive(Clone, Copy, Debug)]
pub(super) struct BorderedPacket<const PLANES: usize>([[[f32; WIDE]; WIDE]; PLANES]);

impl<const PLANES: usize> BorderedPacket<PLANES> {
    /// Collects values. `of` returns those of a packet, and the pixels whose values count.
    #[inline(always)]
    pub(super) fn of<P>(around: &Around<'_, P>, of: impl Fn(&P) -> (&[[f32; LANES]; PLANES], u32)) -> Self {
        let packets = around.map(|row| row.map(|packet| packet.map(&of)));
        let mut planes = [[[f32::NAN; WIDE]; WIDE]; PLANES];
        let columns = [(0, 0..1, SIDE - 1..SIDE), (1, 1..WIDE - 1, 0..SIDE), (2, WIDE - 1..WIDE, 0..1)];
        for (row, down) in (0..WIDE).map(|row| (row, row + SIDE - 1)) {
            for (right, places, lanes) in &columns {
                let Some((values, counting)) = packets[down / SIDE][*right] else { continue };
                let first = down % SIDE * SIDE;
                let (places, lanes) = (places.clone(), first + lanes.start..first + lanes.end);
                for (plane, values) in planes.iter_mut().zip(values) {
                    if counting == WHOLE {
                        plane[row][places.clone()].copy_from_slice(&values[lanes.clone()]);
                        continue;
                    }
                    for (place, lane) in places.clone().zip(lanes.clone()) {
                        plane[row][place] = if counting >> lane & 1 == 1 { values[lane] } else { f32::NAN };
                    }
                }
            }
        }
        Self(planes)
    }

    /// Returns the least and the greatest value in each neighbourhood, plane by plane; infinities (least above greatest) without any value.
    #[inline(always)]
    pub(super) fn ranges(&self) -> [[[f32; LANES]; 2]; PLANES] {
        // Comparisons with NaN are false.
        let least = |least: f32, value: f32| if value < least { value } else { least };
        let greatest = |greatest: f32, value: f32| if value > greatest { value } else { greatest };
        self.0
            .map(|plane| [folded(&plane, f32::INFINITY, least), folded(&plane, f32::NEG_INFINITY, greatest)])
    }

    /// Returns the mean of the values in each neighbourhood, plane by plane; 0 without any value.
    #[inline(always)]
    pub(super) fn means(&self) -> [[f32; LANES]; PLANES] {
        let sum = |sum: f32, value: f32| if value >= 0.0 { sum + value } else { sum };
        let count = |count: f32, value: f32| if value >= 0.0 { count + 1.0 } else { count };
        self.0.map(|plane| {
            let (sums, counts) = (folded(&plane, 0.0, sum), folded(&plane, 0.0, count));
            std::array::from_fn(|lane| sums[lane] / f32::max(counts[lane], 1.0))
        })
    }
}

/// Folds the values of each pixel and its eight neighbours.
#[inline(always)]
fn folded(plane: &[[f32; WIDE]; WIDE], first: f32, fold: impl Fn(f32, f32) -> f32) -> [f32; LANES] {
    let mut found = [first; LANES];
    for (row, column) in (0..3).flat_map(|row| (0..3).map(move |column| (row, column))) {
        for (lane, found) in found.iter_mut().enumerate() {
            *found = fold(*found, plane[lane / SIDE + row][lane % SIDE + column]);
        }
    }
    found
}
