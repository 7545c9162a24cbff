//! Adaptive sampling: samples go to the pixels that need them, until the picture is as good as it is meant to be.
//!
//! Samples come in `rounds`. After each, every pixel that got some has two means, of the samples from before and of those
//! that are new, as many. Half their difference, in output values, estimates the error of the mean of both, more closely as it is known
//! how errors fall with the number n of samples: as n^-3/4 where an edge runs through a pixel, and as n^-1/2 where much is sampled, as
//! lights, a lens or a shutter (see `math/sampling`). What is known from the rounds before counts half.
//!
//! Where all samples of a pixel agree, they may have missed something: beside an edge, a part of less than 1/n may be on its other side.
//! On average that adds 1/n of the square error of half such a part.
//!
//! The mean square of all pixels' errors is the picture's. To lower it with the fewest samples, those pixels get more whose square
//! error per sample is largest: at the best division it is the same everywhere that has any. How large it may be left is found from the
//! histogram of all pixels, by following what each of them would become with more samples. Where one pixel's estimate is too low by
//! chance, its neighbours' help: they count half.
//!
//! Before pixels have eight samples, they are not told apart: all get more, or the picture is good enough as it is.
//!
//! All of that is done between rounds, for the picture as a whole, in an order that does not depend on threads. So the picture does not
//! either, and the reference path makes the same.
//!
//! For independent samples the best division is that of Neyman, "On the Two Different Aspects of the Representative Method" (1934).

mod output_curve;
mod rounds;

use std::ops::Range;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::color::Transfer;
use crate::trace::scene::{Camera, PreparedScene};
use output_curve::OutputCurve;
pub(crate) use rounds::{Portion, Rounds};

/// How good a picture is meant to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ErrorTarget {
    /// The root of the mean square of all errors, in output values: steps of 8 bits. Greater than 0.
    pub(crate) rms: f64,
    /// How light becomes output values.
    pub(crate) transfer: Transfer,
    pub(crate) convergence: Convergence,
}

/// How fast errors fall with the number n of samples, before it is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Convergence {
    /// As n^-3/4.
    Edges,
    /// As n^-1/2.
    Effects,
}

impl Convergence {
    /// Returns that of a picture of a scene through a camera, at so many instants.
    pub(crate) fn of(scene: &PreparedScene, camera: &Camera, instants: u32) -> Self {
        let has_effects =
            instants > 1 || camera.has_lens() || scene.lights.iter().any(|light| light.source.is_extended());
        if has_effects { Self::Effects } else { Self::Edges }
    }

    /// By what the square of an error is multiplied when the number of samples is doubled.
    fn of_doubling(self) -> f64 {
        match self {
            Self::Edges => 0.353_553_390_593_273_8,
            Self::Effects => 0.5,
        }
    }

    /// How many bins of the histogram the square of an error per sample goes down when the number of samples is doubled.
    fn bins_of_doubling(self) -> usize {
        match self {
            Self::Edges => BINS_OF_OCTAVE * 5 / 2,
            Self::Effects => BINS_OF_OCTAVE * 2,
        }
    }
}

/// Which part of the target is aimed at: estimates scatter, and pixels whose estimate is too low by chance get no more samples.
const AIM: f64 = 0.94;
/// By what the square of an error is multiplied at least and at most when the number of samples is doubled: as n^-1 and as n^-1/2.
const FASTEST: f64 = 0.25;
const SLOWEST: f64 = 0.5;
const BINS_OF_OCTAVE: usize = 8;
/// By exponent and the first three bits of the mantissa.
const BIN_SHIFT: u32 = 23 - BINS_OF_OCTAVE.ilog2();
/// One for each positive number.
const BINS: usize = (f32::INFINITY.to_bits() >> BIN_SHIFT) as usize;

/// What is known of every pixel's error.
#[derive(Clone, Debug)]
pub(crate) struct Adaptive {
    target: ErrorTarget,
    curve: OutputCurve,
    width: usize,
    /// Row by row, as are the others.
    pixels: Vec<PixelError>,
    /// The sums of a pixel's samples after the last round.
    sums: Vec<DVec3>,
    /// The mean square of half of all pixels' differences in the last round in which all had samples.
    spread: f64,
    /// The estimate of the square of the picture's error.
    square: Option<f64>,
}

/// What is known of a pixel's error.
#[derive(Clone, Copy, Debug)]
struct PixelError {
    /// The estimate of its square from how far halves are apart, not yet [scaled](Adaptive::scale), as is the next.
    spread: f32,
    /// The square error by what its neighbours have and its samples may have missed.
    missed: f32,
    /// The number of samples it was left with; 0 while it gets more.
    samples: u32,
}

impl PixelError {
    fn square(self) -> f32 {
        self.spread + self.missed
    }
}

impl Adaptive {
    /// Returns what is known before the first sample.
    pub(crate) fn new((columns, rows): (u32, u32), target: ErrorTarget) -> Self {
        let count = columns as usize * rows as usize;
        let pixels = vec![PixelError { spread: 0.0, missed: 0.0, samples: 0 }; count];
        let curve = OutputCurve::of(target.transfer);
        let width = columns.max(1) as usize;
        Self { target, curve, width, pixels, sums: vec![DVec3::ZERO; count], spread: 0.0, square: None }
    }

    /// Returns the number of samples that a pixel was left with; `None` if it gets more.
    pub(crate) fn left_with(&self, pixel: usize) -> Option<u32> {
        Some(self.pixels[pixel].samples).filter(|samples| *samples > 0)
    }

    /// Returns the estimate of the picture's error, in output values; `None` before two rounds.
    pub(crate) fn error(&self) -> Option<f64> {
        self.square.map(f64::sqrt)
    }

    /// Returns the sum of the square errors that are known of each pixel, on average.
    fn square_of_pixels(&self) -> f64 {
        let squares: f64 = self.pixels.iter().map(|pixel| f64::from(pixel.square())).sum();
        self.scale() * squares / self.pixels.len().max(1) as f64
    }

    /// By what the square of half a pixel's difference is multiplied: with e^2 the square of the error of one half, that is e^2 / 2 if the
    /// halves are independent, and that of both together e^2 times what doubling brings. As halves complete each other, it is less; but
    /// pixels that are left are those that seem good.
    fn scale(&self) -> f64 {
        2.0 * self.target.convergence.of_doubling()
    }

    /// Looks at all pixels after a round; `sum` is that of a pixel's samples. Returns whether another round is needed: pixels that get
    /// nothing from it are noted.
    pub(crate) fn judge(&mut self, rounds: &Rounds, sum: impl Fn(usize) -> DVec3 + Sync) -> bool {
        let (taken, spread) = (rounds.taken().1, self.estimate(rounds, sum));
        if rounds.index() <= rounds.floor_index() {
            self.square = self.square_of_all(rounds, spread);
        } else {
            self.suspect(taken);
            self.square = Some(self.square_of_pixels());
        }
        let aim = AIM * self.target.rms;
        if rounds.is_last() || self.error().is_some_and(|error| error <= aim) {
            self.leave(taken, |_| true);
            return false;
        }
        if rounds.index() < rounds.floor_index() {
            return true;
        }
        if rounds.index() == rounds.floor_index() {
            self.suspect(taken);
        }
        let needs = self.needs();
        let least = self.least_need(&needs, aim * aim / self.scale() * self.pixels.len() as f64);
        self.leave(taken, |pixel| bin(needs[pixel]) < least);
        let goes_on = self.pixels.iter().any(|pixel| pixel.samples == 0);
        if !goes_on {
            self.square = Some(self.square_of_pixels());
        }
        goes_on
    }

    /// Estimates the square of the picture's error while all pixels have as many samples, from the mean square of half of their
    /// differences. With e^2 the square of the error of one half, that of both together is q e^2, where q is what doubling brings; so the
    /// errors of the halves have the product (2 q - 1) e^2 on average, and the square of half their difference is (1 - q) e^2. What doubling
    /// brings is half expected, and half seen in how much less differences have become.
    fn square_of_all(&mut self, rounds: &Rounds, spread: f64) -> Option<f64> {
        let before = std::mem::replace(&mut self.spread, spread);
        let expected = self.target.convergence.of_doubling();
        let is_seen = rounds.index() > 1 && before > 0.0;
        let seen = if is_seen { (spread / before).clamp(FASTEST, SLOWEST) } else { expected };
        let per_doubling = (seen * expected).sqrt();
        (rounds.index() > 0).then(|| per_doubling / (1.0 - per_doubling) * spread)
    }

    /// Estimates the errors of the pixels that had samples in this round. Returns the mean square of half of their differences.
    fn estimate(&mut self, rounds: &Rounds, sum: impl Fn(usize) -> DVec3 + Sync) -> f64 {
        let (per_doubling, (before, after)) = (self.target.convergence.of_doubling(), rounds.taken());
        let (old, new) = (f64::from(before), f64::from(after - before));
        // A quarter, where both are as many.
        let share = old * new / ((old + new) * (old + new));
        let (width, curve) = (self.width, &self.curve);
        let rows = self.pixels.par_chunks_mut(width).zip(self.sums.par_chunks_mut(width));
        let squares = rows.enumerate().map(|(row, (pixels, sums))| {
            let mut squares = 0.0;
            for (column, (pixel, before)) in pixels.iter_mut().zip(sums).enumerate() {
                if pixel.samples > 0 {
                    continue;
                }
                let sum = sum(row * width + column);
                if rounds.index() > 0 {
                    // Beyond what a number can hold all is white.
                    let halves = [*before / old, (sum - *before) / new];
                    let square = if sum.is_finite() { share * curve.mean_square(halves) } else { 0.0 };
                    squares += square;
                    pixel.spread = if rounds.index() == 1 {
                        single(square)
                    } else {
                        single(0.5 * (square + per_doubling * f64::from(pixel.spread)))
                    };
                }
                *before = sum;
            }
            squares
        });
        // In order, whatever the threads do.
        let squares: Vec<f64> = squares.collect();
        squares.iter().sum::<f64>() / self.pixels.len().max(1) as f64
    }

    /// Estimates what the samples of pixels may have missed that had some in this round, and have so many now.
    fn suspect(&mut self, taken: u32) {
        let (width, curve) = (self.width, &self.curve);
        let height = self.pixels.len() / width;
        let count = |pixel: &PixelError| f64::from(if pixel.samples > 0 { pixel.samples } else { taken });
        let pixels = self.pixels.par_iter().zip(&self.sums);
        let mean = |sum: DVec3, count: f64| (sum / count).as_vec3().min(Vec3::MAX);
        let means: Vec<Vec3> = pixels.map(|(pixel, sum)| mean(*sum, count(pixel))).collect();
        // Half of the largest part that may be missed, and the share of pixels in which one is.
        let (part, often) = (0.5 / f64::from(taken), 1.0 / (f64::from(taken) * self.scale()));
        self.pixels.par_chunks_mut(width).enumerate().for_each(|(row, pixels)| {
            for (column, pixel) in pixels.iter_mut().enumerate().filter(|(_, pixel)| pixel.samples == 0) {
                let mean = means[row * width + column];
                let (mut least, mut most) = (mean, mean);
                for row in around(row, height) {
                    for neighbour in &means[row * width..][around(column, width)] {
                        least = least.min(*neighbour);
                        most = most.max(*neighbour);
                    }
                }
                let farther = (mean - least).max(most - mean);
                pixel.missed = single(often * curve.mean_square_near(mean, farther.as_dvec3() * part));
            }
        });
    }

    /// Returns how urgently each pixel that had samples in this round needs more: its square error and that of its neighbourhood, half
    /// each.
    fn needs(&self) -> Vec<f32> {
        let width = self.width;
        let height = self.pixels.len() / width;
        let mut needs = vec![0.0; self.pixels.len()];
        needs.par_chunks_mut(width).enumerate().for_each(|(row, needs)| {
            for (column, need) in needs.iter_mut().enumerate() {
                let pixel = self.pixels[row * width + column];
                if pixel.samples > 0 {
                    continue;
                }
                let (mut sum, mut count) = (0.0, 0.0);
                for row in around(row, height) {
                    for column in around(column, width) {
                        sum += self.pixels[row * width + column].square();
                        count += 1.0;
                    }
                }
                *need = 0.5 * (pixel.square() + sum / count);
            }
        });
        needs
    }

    /// Returns the bin of the least need that must be met for the sum of all square errors to become `most` at last.
    fn least_need(&self, needs: &[f32], most: f64) -> usize {
        let mut left = 0.0;
        let mut squares = vec![0.0; BINS];
        for (pixel, need) in self.pixels.iter().zip(needs) {
            let square = if pixel.samples > 0 { &mut left } else { &mut squares[bin(*need)] };
            *square += f64::from(pixel.square());
        }
        let (per_doubling, bins) =
            (self.target.convergence.of_doubling(), self.target.convergence.bins_of_doubling());
        let becomes = |least: usize| {
            let mut sum = left;
            for (bin, square) in squares.iter().enumerate().filter(|(_, square)| **square > 0.0) {
                let doublings = (bin + bins).saturating_sub(least) / bins;
                sum += square * (0..doublings).fold(1.0, |factor, _| factor * per_doubling);
            }
            sum
        };
        // It falls as less is left.
        let (mut enough, mut too_much) = (1, BINS);
        while enough + 1 < too_much {
            let middle = usize::midpoint(enough, too_much);
            if becomes(middle) <= most { enough = middle } else { too_much = middle }
        }
        enough
    }

    /// Leaves pixels with the samples that they have.
    fn leave(&mut self, samples: u32, done: impl Fn(usize) -> bool) {
        for (index, pixel) in self.pixels.iter_mut().enumerate() {
            if pixel.samples == 0 && done(index) {
                pixel.samples = samples;
            }
        }
    }
}

/// Returns a place among so many with those beside it.
fn around(place: usize, count: usize) -> Range<usize> {
    place.saturating_sub(1)..count.min(place + 2)
}

#[expect(clippy::cast_possible_truncation, reason = "an estimate")]
fn single(square: f64) -> f32 {
    square as f32
}

/// Returns the bin of a number that is not negative: 0 for nothing.
fn bin(number: f32) -> usize {
    ((number.to_bits() >> BIN_SHIFT) as usize).min(BINS - 1)
}

#[cfg(test)]
mod tests;
