//! The square error of each pixel, from its samples and from what geometry knows of it.

use super::needs::Gain;
use super::output_curve::OutputCurve;
use crate::color::ErrorNorm;
use crate::trace::visibility::{Covering, Feature};

/// The sums of a pixel's samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PixelSums {
    /// The sum of its samples, by channel.
    pub(crate) all: [f64; 3],
    /// The sum of their squares.
    pub(crate) squares: [f64; 3],
    /// The number of samples that the scene covers, if the picture has alpha.
    pub(crate) covered: Option<f64>,
}

/// What is known of a pixel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pixel {
    /// Samples taken.
    pub(super) taken: u32,
    /// Samples that it has after this round.
    pub(super) goal: u32,
    /// The mean of the samples taken.
    pub(super) mean: [f32; 3],
    /// The share of them that the scene covers.
    pub(super) alpha: f32,
    /// The variance of one sample in output values, as far as the mean of them all shows it.
    pub(super) variance: f32,
    /// The square of half the difference between the means of both halves of its samples, in output values; negative where unknown.
    pub(super) apart: f32,
    /// The estimate of the square of its error.
    pub(super) square: f32,
    /// The samples for which that was estimated first.
    pub(super) known: u32,
    pub(super) feature: Feature,
    /// The shape that covered it whole at the last instant that was searched, if any did.
    pub(super) cover: Option<Option<Covering>>,
    /// Whether samples were taken of it that nothing had called for, so that it stands for others.
    pub(super) audited: bool,
}

/// How a pixel's error is estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    /// A single smooth surface shows, as far as geometry knows: what varies is light, mirrors, glass.
    Plain,
    /// Larger surfaces meet.
    Edge,
    /// Something shows that no sample may have met: what is small, moves, or is checkered.
    Small,
}

/// The number of classes.
pub(super) const CLASSES: usize = 3;

/// The part of a pixel on the other side of an edge that samples on one side leave possible, times their number. Of one sample and an edge
/// anywhere, a part p is missed with the mean square p (1 - p), 1/6 = 0.41²; of more, as much less as the gaps between them.
const MISSED: f32 = 0.41;

impl Pixel {
    pub(super) fn class(&self) -> Class {
        match self.feature.area {
            0.0 => Class::Plain,
            _ if self.feature.radiance > 0.0 => Class::Small,
            _ => Class::Edge,
        }
    }

    /// Returns how many samples it has after a round in which it takes some, `most` at most: twice as many.
    pub(super) fn next_goal(&self, most: u32) -> u32 {
        (2 * self.taken).max(FEWEST).min(most)
    }

    /// Returns what more samples of it promise.
    #[inline(always)]
    pub(super) fn gain(&self, norm: ErrorNorm, chance: u32) -> Gain {
        let count = single(f64::from(self.taken.max(1)));
        Gain::of(if norm == ErrorNorm::Rms { self.square / count } else { self.square }, chance)
    }

    /// Takes the samples of a round into account.
    pub(super) fn update(&mut self, curve: OutputCurve, sums: &PixelSums) {
        let (before, count) = (self.taken, f64::from(self.goal));
        let mean = sums.all.map(|sum| sum / count);
        let halves = before > 1 && self.goal == 2 * before;
        let (mut apart, mut variance) = (0.0, 0.0);
        for (channel, all) in mean.into_iter().enumerate() {
            let old = f64::from(self.mean[channel]);
            if halves {
                let difference = curve.value(single(2.0 * all - old)) - curve.value(single(old));
                apart += difference * difference / 12.0;
            }
            if self.goal > 1 {
                let square = (sums.squares[channel] / count - all * all).max(0.0) * count / (count - 1.0);
                variance += curve.variance(single(all), single(square), single(count));
            }
        }
        if let Some(covered) = sums.covered {
            let share = covered / count;
            let differs = single(255.0 * (share - f64::from(self.alpha)));
            // Half of the difference between the halves is what the mean has moved by.
            apart = apart.max(differs * differs);
            variance = variance.max(single(3.0 * 255.0 * 255.0 * share * (1.0 - share)));
            self.alpha = single(share);
        }
        self.apart = if halves { apart } else { -1.0 };
        self.variance = variance / 3.0;
        self.mean = mean.map(single);
        self.taken = self.goal;
    }

    /// Returns the estimate of the square error, not scaled. `edges`: whether errors fall as those of edges do; `alpha`: whether the
    /// error of alpha counts. The variance of one sample in pixels of the same kind nearby counts half, as samples of one pixel may agree by
    /// chance.
    pub(super) fn model(&self, curve: OutputCurve, edges: bool, alpha: bool, neighbours: &Neighbours) -> f32 {
        let count = single(f64::from(self.taken));
        let around = neighbours.variance;
        let variance = f32::midpoint(self.variance, around);
        let falls = if edges { count * count.sqrt() / EDGES } else { count };
        let square = match self.class() {
            Class::Plain if self.taken < FEWEST => around / count,
            Class::Plain => variance / count,
            Class::Edge => {
                let missed = neighbours.change(curve, &self.mean, MISSED / count);
                (variance / falls).max(missed)
            }
            Class::Small => {
                let Feature { area, radiance } = self.feature;
                let missed = neighbours.change(curve, &self.mean, MISSED / count);
                // Until samples have met it, they are as good as independent. It may lie across a corner of four pixels.
                let met = if edges { (0.25 * area * count).max(1.0) } else { 1.0 };
                let falls = count * met.sqrt();
                let part = missed_part(area, count);
                let hidden = self.mean.iter().map(|mean| {
                    // It may be brighter or darker.
                    let brighter = curve.value(mean + part * (radiance - mean)) - curve.value(*mean);
                    let darker = curve.value(*mean) - curve.value(mean * (1.0 - part));
                    let change = if brighter > darker { brighter } else { darker };
                    change * change
                });
                variance / falls + (hidden.sum::<f32>() / 3.0).max(missed)
            }
        };
        if alpha && self.feature != Feature::NONE {
            let missed = 255.0 * missed_part(self.feature.area, count);
            return square.max(missed * missed);
        }
        square
    }
}

/// The square error of the mean of n samples at an edge is that of independent ones over the root of n, times this: 0.3 to
/// 0.7 in the scenes of `benches/hard.rs` with 8 to 64 samples a pixel. It is corrected as soon as samples were doubled.
const EDGES: f32 = 0.7;

/// Returns the root of the mean square of the part of a pixel that a feature covers, missed by all of `count` samples, where the part is
/// anything up to `area`: with z = area count, (2 - exp(-z) (z² + 2 z + 2)) / (area count³).
fn missed_part(area: f32, count: f32) -> f32 {
    let (area, count) = (f64::from(area), f64::from(count));
    let z = area * count;
    let square = if z < 1e-2 {
        area * area / 3.0
    } else {
        (2.0 - libm::exp(-z) * (z * z + 2.0 * z + 2.0)) / (area * count * count * count)
    };
    single(square.max(0.0).sqrt())
}

/// Fewer samples tell nothing of how they vary.
pub(super) const FEWEST: u32 = 4;

/// A pixel and its neighbours: the darkest and the brightest, by channel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbours {
    pub(super) least: [f32; 3],
    pub(super) most: [f32; 3],
    /// The mean variance of one sample among those that more than one surface may show in.
    pub(super) variance: f32,
}

impl Neighbours {
    /// Returns the mean square, over channels, of what the output value of a mean changes by if a part of it becomes that of the farthest
    /// neighbour.
    fn change(&self, curve: OutputCurve, mean: &[f32; 3], part: f32) -> f32 {
        let mut sum = 0.0;
        for (channel, mean) in mean.iter().enumerate() {
            let (least, most) = (self.least[channel], self.most[channel]);
            let farther = if most - mean > mean - least { most } else { least };
            let change = curve.value(mean + part * (farther - mean)) - curve.value(*mean);
            sum += change * change;
        }
        sum / 3.0
    }
}

#[expect(clippy::cast_possible_truncation, reason = "an estimate")]
pub(super) fn single(number: f64) -> f32 {
    number as f32
}
