//! Adaptive sampling: samples go to the pixels that need them, until the picture is as good as it is meant to be.
//!
//! Samples come in `rounds`. After each, every pixel that got some has two means, of the samples from before and of those
//! that are new, as many; those of the first round are halved. Half their difference, in output values, estimates the error of the mean of
//! both, more closely as it is known how errors fall with the number n of samples: as n^-3/4 where an edge runs through a pixel, and as
//! n^-1/2 where much is sampled, as lights, a lens or a shutter (see `math/sampling`). What is known from the rounds before counts half.
//!
//! Where all samples of a pixel agree, they may have missed something: beside an edge, a part of less than 1/n may be on its other side.
//! On average that adds 1/n of the square error of half such a part.
//!
//! The mean square of all pixels' errors is the picture's. To lower it with the fewest samples, those pixels get more whose square
//! error per sample is largest: at the best division it is the same everywhere that has any. How large it may be left is found from the
//! histogram of all pixels, by following what each of them would become with more samples. Where one pixel's estimate is too low by
//! chance, its neighbours' help: they count half.
//!
//! All of that is done between rounds, for the picture as a whole, in an order that does not depend on threads. So the picture does not
//! either, and the reference path makes the same.
//!
//! For independent samples the best division is that of Neyman, "On the Two Different Aspects of the Representative Method" (1934).

mod needs;
mod output_curve;
mod pixel_errors;
mod rounds;
mod rows;

use std::ops::Range;

use crate::color::Transfer;
use crate::trace::scene::{Camera, PreparedScene, SIDE};
use output_curve::OutputCurve;
pub(crate) use pixel_errors::PixelErrors;
use pixel_errors::{Halves, Missed};
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
}

/// Which part of the target is aimed at: estimates scatter, and pixels whose estimate is too low by chance get no more samples.
const AIM: f64 = 0.94;

/// What pixels' samples add up to, for a band of the picture at a time: of each of its rows, by channel. Where pixels get no more, it may be
/// anything.
pub(crate) trait BandSums: Sync {
    /// Tells the sums of all samples so far, rounded.
    fn all(&self, band: usize, rows: &mut [[&mut [f32]; 3]]);

    /// Tells the sums of the first half of the first round's samples, added up in `f32`.
    fn first_half(&self, band: usize, rows: &mut [[&mut [f32]; 3]]);
}

/// The rows of a band: as many as packets of camera rays have. Bands are counted from the top; the last may have fewer.
pub(crate) const BAND: usize = SIDE as usize;

/// How good a picture is so far, and which of its pixels get more samples.
#[derive(Clone, Debug)]
pub(crate) struct Adaptive {
    target: ErrorTarget,
    curve: OutputCurve,
    pixels: PixelErrors,
    /// The estimate of the square of the picture's error.
    square: Option<f64>,
}

impl Adaptive {
    /// Returns what is known before the first sample, in the memory of what was known of another picture.
    pub(crate) fn new((columns, rows): (u32, u32), target: ErrorTarget, mut pixels: PixelErrors) -> Self {
        pixels.clear((columns.max(1) as usize, rows.max(1) as usize));
        Self { target, curve: OutputCurve::of(target.transfer), pixels, square: None }
    }

    /// Returns the memory.
    pub(crate) fn into_memory(self) -> PixelErrors {
        self.pixels
    }

    /// Returns the number of samples that a pixel was left with; `None` if it gets more.
    pub(crate) fn left_with(&self, pixel: usize) -> Option<u32> {
        Some(self.pixels.samples(pixel)).filter(|samples| *samples > 0)
    }

    /// Returns the numbers of samples that a row's pixels were left with; 0 if they get more.
    pub(crate) fn row_left_with(&self, row: u32) -> &[u32] {
        self.pixels.row(row as usize)
    }

    /// Returns whether any pixel in these columns and rows gets more samples.
    pub(crate) fn any_gets_more(&self, columns: Range<u32>, rows: Range<u32>) -> bool {
        let columns = columns.start as usize..columns.end as usize;
        rows.into_iter().any(|row| self.pixels.row(row as usize)[columns.clone()].contains(&0))
    }

    /// Returns the estimate of the picture's error, in output values; `None` before two samples.
    pub(crate) fn error(&self) -> Option<f64> {
        self.square.map(f64::sqrt)
    }

    /// By what the square of half a pixel's difference is multiplied: with e^2 the square of the error of one half, that is e^2 / 2 if the
    /// halves are independent, and that of both together e^2 times what doubling brings. As halves complete each other, it is less; but
    /// pixels that are left are those that seem good.
    fn scale(&self) -> f64 {
        2.0 * self.target.convergence.of_doubling()
    }

    /// Looks at all pixels after a round. Returns whether another is needed: pixels that get nothing from it are noted.
    pub(crate) fn judge(&mut self, rounds: &Rounds, sums: &impl BandSums) -> bool {
        let (first_half, taken) = (rounds.first_half_taken(), rounds.taken());
        // With a single sample nothing is known.
        if taken > first_half {
            self.estimate(rounds.is_first(), &Halves { old: first_half, new: taken - first_half }, sums);
        }
        let aim = AIM * self.target.rms;
        if rounds.is_last() || self.error().is_some_and(|error| error <= aim) {
            self.pixels.leave_all(taken);
            return false;
        }
        if rounds.is_first() {
            self.suspect(taken);
        }
        let most = aim * aim / self.scale() * self.pixels.count() as f64;
        let least = self.pixels.needs().least_for(most, self.target.convergence);
        let goes_on = self.pixels.leave(taken, least);
        if !goes_on {
            self.square = Some(self.square_of_pixels());
        }
        goes_on
    }

    /// Estimates the errors of the pixels that had samples in this round, and that of the picture.
    ///
    /// After the first round that is known better as a whole, from the mean square of half of all differences. With e^2 the square of the
    /// error of one half, that of both together is q e^2, where q is what doubling brings; so the errors of the halves have the product
    /// (2 q - 1) e^2 on average, and the square of half their difference is (1 - q) e^2.
    fn estimate(&mut self, is_first: bool, halves: &Halves, sums: &impl BandSums) {
        let per_doubling = self.target.convergence.of_doubling();
        if is_first {
            self.pixels.estimate(self.curve, halves, None, sums);
            self.square = Some(per_doubling / (1.0 - per_doubling) * self.mean_of_pixels());
        } else {
            self.pixels.estimate(self.curve, halves, Some(per_doubling), sums);
            self.suspect(halves.old + halves.new);
            self.square = Some(self.square_of_pixels());
        }
    }

    /// Returns the mean of the square errors that are known of each pixel.
    fn square_of_pixels(&self) -> f64 {
        self.scale() * self.mean_of_pixels()
    }

    fn mean_of_pixels(&self) -> f64 {
        self.pixels.sum() / self.pixels.count() as f64
    }

    /// Estimates what the samples of pixels may have missed that get more, and have so many now.
    fn suspect(&mut self, taken: u32) {
        // Half of the largest part that may be missed, and the share of pixels in which one is.
        let (part, often) = (0.5 / f64::from(taken), 1.0 / (f64::from(taken) * self.scale()));
        self.pixels.suspect(self.curve, &Missed { often, part });
    }
}

#[expect(clippy::cast_possible_truncation, reason = "an estimate")]
fn single(number: f64) -> f32 {
    number as f32
}

#[cfg(test)]
mod tests;
