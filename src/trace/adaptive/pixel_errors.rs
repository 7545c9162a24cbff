//! What is known of every pixel's error, and how it is found: pass by pass over rows, and each in vectors.

use std::ops::Range;

use fearless_simd::dispatch;
use rayon::prelude::*;

use super::needs::{Need, SquaresByNeed};
use super::output_curve::OutputCurve;
use super::rows::{Rows, parts_mut};
use super::{BAND, BandSums, single};
use crate::trace::math::SimdLevel;
use crate::trace::stages::TILE;

/// What is known of every pixel's error.
#[derive(Clone, Debug, Default)]
pub(crate) struct PixelErrors {
    size: (usize, usize),
    /// The means of a pixel's samples after its last round, by channel.
    means: Rows<3>,
    /// The estimate of the square of its error from how far halves are apart, and that of what its samples may have missed, as its
    /// neighbours have it. Neither is scaled.
    squares: Rows<2>,
    /// The sums of both, over all pixels.
    sums: [f64; 2],
    /// How many samples each was left with; 0 while it gets more.
    samples: Vec<u32>,
    /// How urgently each needs more.
    needs: Vec<f32>,
}

/// The halves of a pixel's samples.
pub(super) struct Halves {
    /// How many there are in that of which the mean was known before.
    pub(super) old: u32,
    /// How many are in the other.
    pub(super) new: u32,
}

/// How often a pixel's samples may have missed something, and how large a part of it.
pub(super) struct Missed {
    pub(super) often: f64,
    pub(super) part: f64,
}

impl PixelErrors {
    /// Makes it what is known before the first sample of a picture of this size, in the same memory: what the first round finds of all
    /// pixels may be anything before.
    pub(super) fn clear(&mut self, size @ (width, height): (usize, usize)) {
        self.size = size;
        self.means.resize(size);
        self.squares.resize(size);
        self.sums = [0.0; 2];
        self.samples.clear();
        self.samples.resize(width * height, 0);
        self.needs.resize(width * height, 0.0);
    }

    pub(super) fn count(&self) -> usize {
        self.samples.len()
    }

    /// Returns how many samples a pixel was left with; 0 while it gets more.
    pub(super) fn samples(&self, pixel: usize) -> u32 {
        self.samples[pixel]
    }

    /// Returns how many samples a row's pixels were left with; 0 while they get more.
    pub(super) fn row(&self, row: usize) -> &[u32] {
        &self.samples[row * self.size.0..][..self.size.0]
    }

    /// Estimates errors from how far halves are apart, where there are new samples. Of estimates from the rounds before half is kept, times
    /// `falls`; in the first round there are none.
    pub(super) fn estimate(
        &mut self,
        curve: OutputCurve,
        halves: &Halves,
        falls: Option<f64>,
        all: &impl BandSums,
    ) {
        let (width, _) = self.size;
        let samples = self.samples.par_chunks(width * BAND);
        let known = self.means.par_bands_mut(BAND).zip(self.squares.par_bands_mut(BAND));
        let sums = known.zip(samples).enumerate().map_init(
            || vec![0.0; (3 * BAND + 1) * width],
            |scratch, (band, ((mut before, mut estimates), samples))| {
                let (squares, now) = scratch.split_at_mut(width);
                let mut now: Vec<_> =
                    now.chunks_exact_mut(3 * width).map(|row| parts_mut::<3>(row, width)).collect();
                all.all(band, &mut now[..before.len()]);
                if falls.is_none() {
                    all.first_half(band, &mut before);
                }
                let rows = now.iter_mut().zip(&mut before).zip(&mut estimates);
                let rows = rows.zip(samples.chunks_exact(width));
                let sums = rows.map(|(((now, before), [spread, _]), samples)| {
                    estimate_row((curve, halves, falls), (now, before), samples, (&mut *squares, spread));
                    sum(spread)
                });
                sums.sum()
            },
        );
        self.sums[0] = in_order(sums);
    }

    /// Estimates what the samples of pixels that get more may have missed.
    pub(super) fn suspect(&mut self, curve: OutputCurve, missed: &Missed) {
        let (width, _) = self.size;
        let samples = self.samples.par_chunks_exact(width);
        let rows = self.squares.par_iter_mut().zip(samples).enumerate();
        let means = &self.means;
        let sums = rows.map_init(
            || vec![0.0; 3 * width + 4],
            |scratch, (row, ([_, stored], samples))| {
                for span in active_spans(samples) {
                    // With the pixels beside it.
                    let span = span.start.saturating_sub(1)..width.min(span.end + 1);
                    let (squares, extremes) = scratch.split_at_mut(span.len());
                    let (samples, stored) = (&samples[span.clone()], &mut stored[span.clone()]);
                    dispatch!(SimdLevel::best().level(), _simd => {
                        squares.fill(0.0);
                        for (channel, mean) in means.row(row).into_iter().enumerate() {
                            let around = means.around(row).map(|row| &row[channel][span.clone()]);
                            add_missed(curve, missed, (&mean[span.clone()], around), extremes, squares);
                        }
                        note_missed(missed, (squares, samples), stored);
                    });
                }
                sum(stored)
            },
        );
        self.sums[1] = in_order(sums);
    }

    /// Returns the sum of the square errors of all pixels.
    pub(super) fn sum(&self) -> f64 {
        self.sums.iter().sum()
    }

    /// Finds how urgently each pixel that gets samples needs more: its square error and that of its neighbourhood, half each. Returns
    /// the sums of square errors by need.
    pub(super) fn needs(&mut self) -> SquaresByNeed {
        let (width, height) = self.size;
        let samples = self.samples.par_chunks(width * ROWS);
        let parts = self.needs.par_chunks_mut(width * ROWS).zip(samples).enumerate();
        let squares = &self.squares;
        let found = parts.map(|(part, (needs, samples))| {
            let mut found = SquaresByNeed::default();
            let mut columns = vec![0.0; width + 2];
            let rows = needs.chunks_exact_mut(width).zip(samples.chunks_exact(width));
            for (row, (needs, samples)) in (part * ROWS..height).zip(rows) {
                dispatch!(SimdLevel::best().level(), _simd => {
                    let own = squares.row(row);
                    add_neighbours(own, squares.around(row), &mut columns, needs);
                    found.add(own, needs, samples);
                });
            }
            found
        });
        let mut all = SquaresByNeed::default();
        for found in found.collect::<Vec<_>>() {
            all += &found;
        }
        all
    }

    /// Leaves pixels whose need is less with the samples that they have. Returns whether any gets more.
    pub(super) fn leave(&mut self, taken: u32, least: Need) -> bool {
        let (width, _) = self.size;
        let rows = self.samples.par_chunks_exact_mut(width).zip(self.needs.par_chunks_exact(width));
        let any = rows.map(|(samples, needs)| {
            dispatch!(SimdLevel::best().level(), _simd => {
                let mut any = false;
                for (samples, need) in samples.iter_mut().zip(needs) {
                    let leaves = *samples == 0 && Need::of(*need) < least;
                    *samples = if leaves { taken } else { *samples };
                    any |= *samples == 0;
                }
                any
            })
        });
        any.reduce(|| false, |one, other| one | other)
    }

    /// Leaves all pixels with the samples that they have.
    pub(super) fn leave_all(&mut self, taken: u32) {
        self.samples
            .par_iter_mut()
            .for_each(|samples| *samples = if *samples == 0 { taken } else { *samples });
    }
}

/// Goes through the stretches of a row in which pixels get more samples: as many columns as a tile, or several times as many.
fn active_spans(samples: &[u32]) -> impl Iterator<Item = Range<usize>> {
    const LENGTH: usize = TILE as usize;
    let is_active = |place: usize| {
        let end = samples.len().min(place + LENGTH);
        // In the first round the first does; where none does, all are looked at together.
        samples.get(place..end).is_some_and(|samples| {
            samples.first() == Some(&0) || samples.iter().fold(false, |any, samples| any | (*samples == 0))
        })
    };
    let mut place = 0;
    std::iter::from_fn(move || {
        while place < samples.len() && !is_active(place) {
            place += LENGTH;
        }
        let start = place;
        while is_active(place) {
            place += LENGTH;
        }
        (start < place).then(|| start..samples.len().min(place))
    })
}

/// Adds up numbers, whatever threads found them, in their order.
fn in_order(numbers: impl IndexedParallelIterator<Item = f64>) -> f64 {
    numbers.collect::<Vec<_>>().iter().sum()
}

/// Adds up numbers, every sixteenth together first.
fn sum(numbers: &[f32]) -> f64 {
    let (numbers, rest) = numbers.as_chunks::<16>();
    let rest: f64 = rest.iter().copied().map(f64::from).sum();
    dispatch!(SimdLevel::best().level(), _simd => {
        let mut sums = [0.0; 16];
        for numbers in numbers {
            sums.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += f64::from(*number));
        }
        rest + sums.iter().sum::<f64>()
    })
}

/// How many rows' needs are added up before they are put together with others.
const ROWS: usize = 16;

/// Estimates errors of a row's pixels.
fn estimate_row(
    (curve, halves, falls): (OutputCurve, &Halves, Option<f64>),
    (now, before): (&mut [&mut [f32]; 3], &mut [&mut [f32]; 3]),
    samples: &[u32],
    (squares, spread): (&mut [f32], &mut [f32]),
) {
    for span in active_spans(samples) {
        let now = now.each_mut().map(|channel| &mut channel[span.clone()]);
        let mut before = before.each_mut().map(|channel| &mut channel[span.clone()]);
        let (samples, spread) = (&samples[span.clone()], &mut spread[span.clone()]);
        let squares = &mut squares[span];
        dispatch!(SimdLevel::best().level(), _simd => {
            let now = now.map(|channel| {
                divide(channel, halves.old + halves.new);
                &*channel
            });
            if falls.is_none() {
                before.iter_mut().for_each(|channel| divide(channel, halves.old));
            }
            square_differences(curve, halves, (now, samples), before, squares);
            note_differences((halves, falls), (squares, samples), spread);
        });
    }
}

/// Makes means of sums of so many samples.
#[inline(always)]
fn divide(sums: &mut [f32], samples: u32) {
    let share = single(1.0 / f64::from(samples));
    sums.iter_mut().for_each(|sum| *sum *= share);
}

/// Computes the square differences of pixels' halves, all channels together, and stores means.
#[inline(always)]
fn square_differences(
    curve: OutputCurve,
    halves: &Halves,
    (now, samples): ([&[f32]; 3], &[u32]),
    before: [&mut [f32]; 3],
    squares: &mut [f32],
) {
    let (old, new) = (single(f64::from(halves.old)), single(f64::from(halves.new)));
    let (of_now, of_before) = ((old + new) / new, old / new);
    squares.fill(0.0);
    for (now, before) in now.into_iter().zip(before) {
        let pixels = squares.iter_mut().zip(before).zip(now.iter().zip(samples));
        for ((square, before), (now, samples)) in pixels {
            let fresh = of_now * *now - of_before * *before;
            let apart = curve.value(fresh) - curve.value(*before);
            *square += apart * apart;
            *before = if *samples == 0 { *now } else { *before };
        }
    }
}

/// Brings estimates up to date.
#[inline(always)]
fn note_differences(
    (halves, falls): (&Halves, Option<f64>),
    (squares, samples): (&[f32], &[u32]),
    spread: &mut [f32],
) {
    let (old, new) = (f64::from(halves.old), f64::from(halves.new));
    // A quarter, where both are as many; and the mean of the channels.
    let share = single(old * new / ((old + new) * (old + new)) / 3.0);
    let pixels = squares.iter().zip(samples).zip(spread);
    match falls {
        None => pixels.for_each(|((square, _), spread)| *spread = share * square),
        Some(falls) => {
            let of_kept = single(0.5 * falls);
            for ((square, samples), spread) in pixels {
                let both = 0.5 * share * square + of_kept * *spread;
                *spread = if *samples == 0 { both } else { *spread };
            }
        }
    }
}

/// Adds the squares of what a channel's means would change by if a part more of the farthest of their neighbours were in them.
#[inline(always)]
fn add_missed<'a>(
    curve: OutputCurve,
    missed: &Missed,
    (mean, around): (&[f32], impl Iterator<Item = &'a [f32]>),
    extremes: &mut [f32],
    squares: &mut [f32],
) {
    let (part, width) = (single(missed.part), mean.len());
    let [least, most] = parts_mut(extremes, width + 2);
    least[1..=width].copy_from_slice(mean);
    most[1..=width].copy_from_slice(mean);
    for row in around {
        for ((least, most), mean) in least[1..].iter_mut().zip(&mut most[1..]).zip(row) {
            *least = if *mean < *least { *mean } else { *least };
            *most = if *mean > *most { *mean } else { *most };
        }
    }
    for extreme in [&mut *least, &mut *most] {
        (extreme[0], extreme[width + 1]) = (extreme[1], extreme[width]);
    }
    let smaller = |one: f32, other: f32| if one < other { one } else { other };
    let larger = |one: f32, other: f32| if one > other { one } else { other };
    let columns = (0..width).zip(mean).zip(squares);
    for ((column, mean), square) in columns {
        let ([l0, l1, l2], [m0, m1, m2]) = (beside(least, column), beside(most, column));
        let (least, most) = (smaller(smaller(l0, l1), l2), larger(larger(m0, m1), m2));
        let farther = if most - mean > mean - least { most } else { least };
        let apart = curve.value(mean + part * (farther - mean)) - curve.value(*mean);
        *square += apart * apart;
    }
}

/// Stores what may have been missed.
#[inline(always)]
fn note_missed(missed: &Missed, (squares, samples): (&[f32], &[u32]), stored: &mut [f32]) {
    let often = single(missed.often / 3.0);
    for ((square, samples), stored) in squares.iter().zip(samples).zip(stored) {
        *stored = if *samples == 0 { often * square } else { *stored };
    }
}

/// Computes the means of pixels' square errors and those of their neighbourhoods.
#[inline(always)]
fn add_neighbours<'a>(
    [spread, missed]: [&[f32]; 2],
    around: impl Iterator<Item = [&'a [f32]; 2]>,
    columns: &mut [f32],
    needs: &mut [f32],
) {
    columns.fill(0.0);
    let mut rows = 0.0;
    for [spread, missed] in around {
        rows += 1.0;
        for ((column, spread), missed) in columns[1..].iter_mut().zip(spread).zip(missed) {
            *column += spread + missed;
        }
    }
    let last = needs.len() - 1;
    let own = spread.iter().zip(missed);
    for ((column, need), (spread, missed)) in needs.iter_mut().enumerate().zip(own) {
        let [left, here, right] = beside(columns, column);
        let count = rows * (3.0 - f32::from(u8::from(column == 0)) - f32::from(u8::from(column == last)));
        *need = 0.5 * (spread + missed + (left + here + right) / count);
    }
}

/// Returns the numbers of a column and those beside it, where there is one more on both sides.
#[inline(always)]
fn beside(numbers: &[f32], column: usize) -> [f32; 3] {
    [numbers[column], numbers[column + 1], numbers[column + 2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_have_all_pixels_that_get_more() {
        let spans = |width: usize, active: &[usize]| {
            let mut samples = vec![2; width];
            active.iter().for_each(|pixel| samples[*pixel] = 0);
            active_spans(&samples).map(|span| (span.start, span.end)).collect::<Vec<_>>()
        };
        assert_eq!(spans(40, &[]), []);
        assert_eq!(spans(5, &[4]), [(0, 5)]);
        assert_eq!(spans(40, &[15, 39]), [(0, 16), (32, 40)]);
        assert_eq!(spans(64, &[0, 16, 47]), [(0, 48)]);
        assert_eq!(spans(64, &(0..64).collect::<Vec<_>>()), [(0, 64)]);
    }
}
