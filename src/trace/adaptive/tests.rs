//! Who gets samples, and whether the picture is then as good as it is meant to be.

use super::*;
use crate::trace::math::{Dimension, PixelSamples};

const SIZE: (u32, u32) = (64, 48);
const COUNT: usize = (SIZE.0 * SIZE.1) as usize;

fn target(rms: f64, convergence: Convergence) -> ErrorTarget {
    ErrorTarget { rms, transfer: Transfer::Classic, convergence }
}

/// Sums of grey samples.
struct Sums<'a> {
    all: &'a [f64],
    first_half: &'a [f64],
}

fn fill(all: &[f64], band: usize, rows: &mut [[&mut [f32]; 3]]) {
    let of_rows = all.chunks(SIZE.0 as usize).skip(band * BAND);
    for (row, all) in rows.iter_mut().zip(of_rows) {
        for sums in row {
            sums.iter_mut().zip(all).for_each(|(sum, exact)| *sum = single(*exact));
        }
    }
}

impl BandSums for Sums<'_> {
    fn all(&self, band: usize, rows: &mut [[&mut [f32]; 3]]) {
        fill(self.all, band, rows);
    }

    fn first_half(&self, band: usize, rows: &mut [[&mut [f32]; 3]]) {
        fill(self.first_half, band, rows);
    }
}

/// Takes samples, of pixels by their index, until no more are needed. Returns the pixels and how many samples each got.
fn rendered(
    target: ErrorTarget,
    most: u32,
    sample: impl Fn(usize, u32) -> f64,
) -> (Vec<f64>, Vec<u32>, Adaptive) {
    rendered_in(PixelErrors::default(), target, most, sample)
}

/// The same, in the memory of another picture.
fn rendered_in(
    memory: PixelErrors,
    target: ErrorTarget,
    most: u32,
    sample: impl Fn(usize, u32) -> f64,
) -> (Vec<f64>, Vec<u32>, Adaptive) {
    let (mut rounds, mut adaptive) = (Rounds::doubling(most, 1), Adaptive::new(SIZE, target, memory));
    let (mut sums, mut first_half) = (vec![0.0; COUNT], vec![0.0; COUNT]);
    loop {
        let portion = rounds.portion(0);
        for pixel in (0..COUNT).filter(|pixel| adaptive.left_with(*pixel).is_none()) {
            for index in portion.from..portion.to {
                let sample = sample(pixel, index);
                sums[pixel] += sample;
                first_half[pixel] += if index < portion.halfway { sample } else { 0.0 };
            }
        }
        if !adaptive.judge(&rounds, &Sums { all: &sums, first_half: &first_half }) {
            break;
        }
        rounds.advance();
    }
    let counts: Vec<u32> = (0..COUNT).map(|pixel| adaptive.left_with(pixel).unwrap()).collect();
    let means = sums.iter().zip(&counts).map(|(sum, count)| sum / f64::from(*count)).collect();
    (means, counts, adaptive)
}

fn rms(pixels: &[f64], truth: impl Fn(usize) -> f64) -> f64 {
    let square = |(index, pixel): (usize, &f64)| {
        let error = 255.0 * (pixel - truth(index));
        error * error
    };
    (pixels.iter().enumerate().map(square).sum::<f64>() / COUNT as f64).sqrt()
}

/// Every eighth column has an edge: what is below y = p + (x - 1/2) / 3 is white. Elsewhere nothing varies.
fn edge(pixel: usize, index: u32) -> f64 {
    let column = pixel % SIZE.0 as usize;
    if !column.is_multiple_of(8) {
        return 0.25;
    }
    let [x, y] = PixelSamples::new(3, u32::try_from(pixel).unwrap(), 0).pair(Dimension::Pixel, index);
    if y < height(pixel) + (x - 0.5) / 3.0 { 1.0 } else { 0.0 }
}

fn height(pixel: usize) -> f64 {
    0.2 + 0.6 * ((pixel * 37 % COUNT) as f64 / COUNT as f64)
}

fn edge_truth(pixel: usize) -> f64 {
    if (pixel % SIZE.0 as usize).is_multiple_of(8) { height(pixel) } else { 0.25 }
}

#[test]
fn edges_get_samples_until_the_picture_is_as_good_as_it_is_meant_to_be() {
    for goal in [4.0, 2.0, 1.0, 0.5, 0.25] {
        let (pixels, counts, adaptive) = rendered(target(goal, Convergence::Edges), 65_536, edge);
        let error = rms(&pixels, edge_truth);
        let mean = counts.iter().map(|count| f64::from(*count)).sum::<f64>() / COUNT as f64;
        assert!(adaptive.error().unwrap() <= goal && error <= 1.05 * goal, "{goal}: {error}");
        // As many for all, so that the picture is as good.
        let uniform = (1..16).map(|exponent| 1_u32 << exponent).find(|count| {
            let mean = |pixel| (0..*count).map(|index| edge(pixel, index)).sum::<f64>() / f64::from(*count);
            rms(&(0..COUNT).map(mean).collect::<Vec<_>>(), edge_truth) <= error
        });
        let gain = f64::from(uniform.unwrap()) / mean;
        assert!(goal > 1.0 || gain > 2.0, "{goal}: {mean} instead of {uniform:?}");
        assert!(goal > 0.3 || gain > 4.0, "{goal}: {mean} instead of {uniform:?}");
        assert!(counts.iter().all(|count| count.is_power_of_two() && *count >= 2));
    }
}

/// Independent samples, uniform in an interval around 1/2 whose width grows with the row.
#[test]
fn noise_gets_samples_by_how_strong_it_is() {
    let width = |pixel: usize| (pixel / SIZE.0 as usize) as f64 / f64::from(SIZE.1);
    let noise = |pixel: usize, index: u32| {
        let random = PixelSamples::new(5, u32::try_from(pixel).unwrap(), index).number(Dimension::Lens, 0);
        0.5 + width(pixel) * (random - 0.5)
    };
    for goal in [8.0, 4.0, 2.0] {
        let (pixels, counts, adaptive) = rendered(target(goal, Convergence::Effects), 65_536, noise);
        let error = rms(&pixels, |_| 0.5);
        assert!(
            adaptive.error().unwrap() <= goal && (0.7 * goal..1.1 * goal).contains(&error),
            "{goal}: {error}"
        );
        let of_rows = |from: usize, to: usize| {
            let counts = &counts[from * SIZE.0 as usize..to * SIZE.0 as usize];
            counts.iter().map(|count| f64::from(*count)).sum::<f64>() / counts.len() as f64
        };
        assert!(of_rows(36, 48) > 1.5 * of_rows(12, 24), "{goal}");
    }
}

#[test]
fn what_is_the_same_everywhere_gets_two_samples() {
    let (pixels, counts, adaptive) = rendered(target(0.01, Convergence::Edges), 65_536, |_, _| 0.3);
    assert!(counts.iter().all(|count| *count == 2) && adaptive.error() == Some(0.0));
    assert!(rms(&pixels, |_| 0.3) < 1e-9);
}

#[test]
fn what_cannot_be_had_ends_with_all_samples() {
    for most in [50, 5] {
        let (_, counts, adaptive) = rendered(target(1e-6, Convergence::Edges), most, edge);
        for (pixel, count) in counts.into_iter().enumerate() {
            match pixel % 8 {
                0 => assert_eq!(count, most),
                3..=5 => assert_eq!(count, 2),
                _ => assert!(count == most || count.is_power_of_two()),
            }
        }
        assert!(adaptive.error().unwrap() > 1e-6);
    }
}

#[test]
fn nothing_is_left_of_the_picture_before() {
    let wild = |pixel: usize, index: u32| {
        let bits = (u32::try_from(pixel).unwrap() ^ index.rotate_left(7)).wrapping_mul(2_654_435_769);
        if bits.is_multiple_of(5) { f64::INFINITY } else { f64::from(bits >> 20) }
    };
    for convergence in [Convergence::Edges, Convergence::Effects] {
        let (.., before) = rendered(target(1e-3, convergence), 16, wild);
        let goal = target(1.0, convergence);
        let (_, counts, fresh) = rendered(goal, 65_536, edge);
        let (_, again, reused) = rendered_in(before.into_memory(), goal, 65_536, edge);
        assert!(counts == again && fresh.error() == reused.error());
    }
}

/// What is clamped in all samples is no error.
#[test]
fn only_what_is_shown_counts() {
    let bright = |pixel: usize, index: u32| 2.0 + 8.0 * edge(pixel, index);
    let (_, counts, _) = rendered(target(0.1, Convergence::Edges), 65_536, bright);
    assert!(counts.iter().all(|count| *count == 2));
}
