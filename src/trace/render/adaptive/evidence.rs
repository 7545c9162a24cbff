//! Estimates the squared errors of pixels from their samples and from geometric features. Loops run over the lanes of a packet, so that
//! compilers vectorize them.

use super::feature_light::FeatureLight;
use super::needs::Gain;
use super::neighbourhood::{Around, BorderedPacket, SIDE};
use super::output_curve::OutputCurve;
use crate::color::ErrorNorm;
use crate::trace::math::{LANES, WHOLE, lanes, lanes_where};
use crate::trace::render::visibility::Feature;
use crate::trace::stages::TILE;

/// The sums of the samples of a packet's pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PacketSums {
    /// Sums of the samples, by channel.
    pub(crate) all: [[f64; LANES]; 3],
    /// Sums of the squared samples, by channel.
    pub(crate) squares: [[f64; LANES]; 3],
    /// Number of samples covered by the scene, if the picture has alpha.
    pub(crate) covered: Option<[f64; LANES]>,
}

/// The sampling statistics of the pixels of a packet. Masks have one bit per lane.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct PixelPacket {
    /// Pixels of each class. Lanes beyond the film belong to none.
    pub(super) classes: [u32; CLASSES],
    /// Pixels sampled in this round.
    pub(super) active: u32,
    /// Pixels whose sample count was doubled in the previous round.
    pub(super) doubled: u32,
    /// Pixels whose estimate is outdated: its sample count or feature has changed.
    pub(super) changed: u32,
    /// Audited pixels: sampled independently of any estimate, so that they represent their neighbourhood.
    pub(super) audited: u32,
    /// Sample count so far.
    pub(super) taken: [u32; LANES],
    /// Sample count after this round.
    pub(super) goal: [u32; LANES],
    /// Mean of the samples, by channel; NaN beyond the film.
    mean: [[f32; LANES]; 3],
    /// Least and greatest mean of the plain pixels, by channel. Kept because each packet is compared with eight others.
    range: [[f32; 3]; 2],
    /// Fraction of the samples that the scene covers.
    alpha: [f32; LANES],
    /// Variance of one sample in output values, derived from the deviation of the mean of all samples.
    pub(super) variance: [f32; LANES],
    /// Squared difference between the mean of all samples and that of either half, in output values; negative if unknown.
    pub(super) moved: [f32; LANES],
    /// Value of `moved` before the last round that sampled the pixel.
    pub(super) moved_before: [f32; LANES],
    /// Estimate of the squared error.
    pub(super) square: [f32; LANES],
    /// Area and radiance of each pixel's feature.
    area: [f32; LANES],
    radiance: [f32; LANES],
}

/// The error model of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    /// A single smooth surface, according to geometry. Variation comes from light, mirrors and glass.
    Plain,
    /// Large surfaces meet.
    Edge,
    /// A feature that all samples may have missed: small, moving, or patterned.
    Small,
}

/// The number of classes.
pub(super) const CLASSES: usize = 3;

/// In every round after the first, one in `AUDITED` plain pixels of one in `AUDITED_TILES` tiles is audited: a few samples in a tile cost
/// nearly as much as four times as many.
const AUDITED: u32 = 8;
const AUDITED_TILES: u32 = 4;

/// The range of no values, by channel.
const EMPTY_RANGE: [[f32; 3]; 2] = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];

/// Minimum sample count for a usable variance.
pub(super) const FEWEST: u32 = 4;

/// Minimum variance of samples that differ visibly: a difference of one 8-bit level.
const VISIBLE: f32 = 1.0;

/// RMS fraction of a pixel beyond an edge that samples on one side may miss, times the sample count. For one sample and a uniformly placed
/// edge, a part p is missed with mean square p (1 - p), on average 1/6 = 0.41²; for more samples it shrinks with the gaps between them.
const MISSED: f32 = 0.41;

/// Squared error of the mean of n samples at an edge, relative to the squared error of independent samples divided by the square root of n:
/// 0.3 to 0.7 in the scenes of `benches/hard.rs` with 8 to 64 samples per pixel. Corrected as soon as sample counts have doubled.
const EDGES: f32 = 0.7;

/// Model of squared errors.
#[derive(Clone, Copy, Debug)]
pub(super) struct ErrorModel {
    pub(super) curve: OutputCurve,
    /// True if errors fall as in `Convergence::Edges`.
    pub(super) edges: bool,
    /// Least fraction of a small feature's area in a pixel, or 0 (`Convergence::least_part`).
    pub(super) least_part: f32,
    /// True if the error of alpha counts.
    pub(super) alpha: bool,
    /// The target error in output values.
    pub(super) target: f32,
}

impl PixelPacket {
    /// Creates the pixels of the lanes in `inside`, with `goal` samples in the first round. The audited pixel, selected by the column and row
    /// of the packet's first pixel, takes enough for a variance, but at most `most`.
    pub(super) fn new(inside: u32, goal: u32, most: u32, (column, row): (usize, usize)) -> Self {
        let number = |lane: usize| if inside >> lane & 1 == 1 { 0.0 } else { f32::NAN };
        let audited = 1 << (mixed_place((column / SIDE, row / SIDE)) as usize % LANES);
        let least = next_goal(0, most);
        let audited = inside & if goal < least { audited } else { WHOLE };
        let goal_of = |lane: usize| if audited >> lane & 1 == 1 { goal.max(least) } else { goal };
        Self {
            classes: [inside, 0, 0],
            active: inside,
            doubled: 0,
            changed: inside,
            audited,
            taken: [0; LANES],
            goal: std::array::from_fn(goal_of),
            mean: [std::array::from_fn(number); 3],
            range: EMPTY_RANGE,
            alpha: [0.0; LANES],
            variance: [0.0; LANES],
            moved: [-1.0; LANES],
            moved_before: [-1.0; LANES],
            square: [0.0; LANES],
            area: [Feature::NONE.area; LANES],
            radiance: [Feature::NONE.radiance; LANES],
        }
    }

    /// Returns the pixels inside the film.
    pub(super) fn inside(&self) -> u32 {
        self.classes.iter().fold(0, |all, class| all | class)
    }

    /// Returns the pixels that show a single smooth surface.
    pub(super) fn plain(&self) -> u32 {
        self.classes[Class::Plain as usize]
    }

    /// Returns the pixels in which more than one surface may show.
    pub(super) fn featured(&self) -> u32 {
        self.classes[Class::Edge as usize] | self.classes[Class::Small as usize]
    }

    /// Returns the radiance of features of a pixel's area; negative for smaller features.
    #[inline(always)]
    pub(super) fn radiance_of_whole(&self) -> [f32; LANES] {
        std::array::from_fn(|lane| if self.area[lane] < 1.0 { -1.0 } else { self.radiance[lane] })
    }

    /// Adds a feature to a pixel. In the first round, the pixel then takes enough samples for a variance, but at most `most`.
    pub(super) fn join(&mut self, lane: usize, feature: Feature, most: u32) {
        let before = Feature { area: self.area[lane], radiance: self.radiance[lane] };
        let mut joined = before;
        joined.join(feature);
        if joined != before {
            let Feature { area, radiance } = joined;
            (self.area[lane], self.radiance[lane]) = (area, radiance);
            let class = if radiance > 0.0 { Class::Small } else { Class::Edge };
            let class = if area == 0.0 { Class::Plain } else { class };
            self.classes.iter_mut().for_each(|pixels| *pixels &= !(1 << lane));
            self.classes[class as usize] |= 1 << lane;
            // The estimate belongs to another class.
            self.changed |= 1 << lane;
            if self.taken[lane] == 0 {
                self.goal[lane] = self.goal[lane].max(next_goal(0, most));
            }
        }
    }

    /// Updates the statistics with the samples of a round.
    #[inline(always)]
    pub(super) fn update(&mut self, curve: OutputCurve, sums: &PacketSums) {
        let (mut moved, mut variance) = ([0.0_f32; LANES], [0.0_f32; LANES]);
        let is_single = self.goal == [1; LANES];
        let doubles = |lane: usize| (self.taken[lane] > 1) & (self.goal[lane] == 2 * self.taken[lane]);
        let doubled = self.active & lanes_where(doubles);
        let ([mut of_all, mut of_others], mut count) = ([[0.0; LANES]; 2], [0.0_f32; LANES]);
        for lane in 0..LANES {
            let all = f64::from(self.goal[lane]);
            count[lane] = single(all);
            of_all[lane] = 1.0 / all;
            of_others[lane] = 1.0 / (all - 1.0);
        }
        // Few divisions and short loops, so that every loop is vectorized.
        for ((mean, sums), squares) in self.mean.iter_mut().zip(&sums.all).zip(&sums.squares) {
            let mut all = [0.0; LANES];
            for lane in 0..LANES {
                all[lane] = sums[lane] * of_all[lane];
            }
            if doubled != 0 {
                for lane in 0..LANES {
                    // Both halves have the same distribution, so both differences count.
                    let halves = [mean[lane], single(2.0 * all[lane] - f64::from(mean[lane]))];
                    let of_all = curve.value(single(all[lane]));
                    let [old, new] = halves.map(|half| of_all - curve.value(half));
                    moved[lane] += (old * old + new * new) / 6.0;
                }
            }
            if !is_single {
                for lane in 0..LANES {
                    let square = (squares[lane] - sums[lane] * all[lane]) * of_others[lane];
                    let square = if square > 0.0 { single(square) } else { 0.0 };
                    variance[lane] += curve.variance(single(all[lane]), square, count[lane]) / 3.0;
                }
            }
            for lane in 0..LANES {
                let is_active = self.active >> lane & 1 == 1;
                mean[lane] = if is_active { single(all[lane]) } else { mean[lane] };
            }
        }
        if let Some(covered) = sums.covered {
            for lane in lanes(self.active) {
                let share = covered[lane] / f64::from(self.goal[lane]);
                let differs = single(255.0 * (share - f64::from(self.alpha[lane])));
                moved[lane] = moved[lane].max(differs * differs);
                variance[lane] = variance[lane].max(single(255.0 * 255.0 * share * (1.0 - share)));
                self.alpha[lane] = single(share);
            }
        }
        for lane in 0..LANES {
            let (before, goal, is_active) = (self.taken[lane], self.goal[lane], self.active >> lane & 1 == 1);
            let moved = if doubled >> lane & 1 == 1 { moved[lane] } else { -1.0 };
            let variance = if goal > 1 { variance[lane] } else { 0.0 };
            self.moved_before[lane] = if is_active { self.moved[lane] } else { self.moved_before[lane] };
            self.moved[lane] = if is_active { moved } else { self.moved[lane] };
            self.variance[lane] = if is_active { variance } else { self.variance[lane] };
            self.taken[lane] = if is_active { goal } else { before };
        }
        self.doubled = doubled;
        self.measure_range();
        self.changed |= self.active;
        self.active = 0;
    }

    /// Finds the least and the greatest mean of the plain pixels.
    #[inline(always)]
    fn measure_range(&mut self) {
        let plain = self.plain();
        for (channel, mean) in self.mean.iter().enumerate() {
            let of_plain = |other: f32| -> [f32; LANES] {
                std::array::from_fn(|lane| if plain >> lane & 1 == 1 { mean[lane] } else { other })
            };
            let [darkest, brightest] = EMPTY_RANGE.map(|range| range[channel]);
            self.range[0][channel] = of_plain(darkest).into_iter().fold(darkest, f32::min);
            self.range[1][channel] = of_plain(brightest).into_iter().fold(brightest, f32::max);
        }
    }

    /// Returns the estimates of squared errors, before scaling. `audited` is the variance of one sample in the audited pixels nearby. The
    /// variance of similar pixels nearby has half the weight, as the samples of one pixel may agree by chance. Plain pixels whose samples
    /// vary no more than their neighbours differ are estimated as edges. `before` are the former estimates, if neither these pixels nor
    /// their neighbours have changed since.
    #[inline(always)]
    pub(super) fn errors(
        &self,
        model: ErrorModel,
        (audited, before): (f32, Option<[f32; LANES]>),
        around: Around<'_, Self>,
    ) -> [f32; LANES] {
        let ErrorModel { curve, edges, alpha, target, .. } = model;
        let count: [f32; LANES] = std::array::from_fn(|lane| single(f64::from(self.taken[lane])));
        let (mut missed, mut apart) = ([0.0; LANES], [0.0; LANES]);
        // Missed parts change no pixel by more than its difference from a neighbour: below the target, they alone cannot exceed it.
        if self.plain() != 0 && Self::differ(&around, curve, target) {
            // The edge of a shadow or of an image may lie between the samples of two pixels.
            let ranges = Self::ranges(&around, Self::plain);
            (missed, apart) = (self.missed(curve, &ranges), squared_widths(curve, &ranges));
        }
        let mut errors = [0.0; LANES];
        for lane in 0..LANES {
            let (variance, nearby) = (self.variance[lane], audited / count[lane]);
            let own = variance / count[lane];
            let of_edge = if edges { edge_error(variance, count[lane]) } else { own };
            let is_edge = variance <= apart[lane];
            let shown = if is_edge { of_edge.max(0.5 * nearby) } else { 0.5 * (own + nearby) };
            let shown = if self.taken[lane] < FEWEST { nearby } else { shown };
            errors[lane] = if missed[lane] > shown { missed[lane] } else { shown };
        }
        let featured = self.featured();
        if featured == 0 {
            return errors;
        }
        if let Some(before) = before {
            // Audits tell nothing about features.
            lanes(featured).for_each(|lane| errors[lane] = before[lane]);
            return errors;
        }
        let missed = self.missed(curve, &Self::ranges(&around, Self::inside));
        let sampled = |packet: &Self| packet.featured() & lanes_where(|lane| packet.taken[lane] > 1);
        let [of_similar] =
            BorderedPacket::of(&around, |packet| (std::array::from_ref(&packet.variance), sampled(packet)))
                .means();
        let has_small = self.classes[Class::Small as usize] != 0;
        let hidden = if has_small { self.hidden(curve) } else { [0.0; LANES] };
        for lane in 0..LANES {
            let (count, area, radiance) = (count[lane], self.area[lane], self.radiance[lane]);
            let variance = 0.5 * (self.variance[lane] + of_similar[lane]);
            let shown = self.shown_error(lane, variance, model);
            let small = shown + hidden[lane].max(missed[lane]);
            let error = if radiance > 0.0 { small } else { shown.max(missed[lane]) };
            let part = if alpha { 255.0 * missed_part(area, count) } else { 0.0 };
            errors[lane] = if featured >> lane & 1 == 1 { error.max(part * part) } else { errors[lane] };
        }
        errors
    }

    /// Returns whether the plain pixels of a packet and its neighbours differ by more than `least`, in output values of any channel.
    #[inline(always)]
    fn differ(packets: &Around<'_, Self>, curve: OutputCurve, least: f32) -> bool {
        let [mut darkest, mut brightest] = EMPTY_RANGE;
        for packet in packets.iter().flatten().flatten() {
            for channel in 0..3 {
                darkest[channel] = darkest[channel].min(packet.range[0][channel]);
                brightest[channel] = brightest[channel].max(packet.range[1][channel]);
            }
        }
        darkest.iter().zip(&brightest).any(|(dark, bright)| curve.value(*bright) - curve.value(*dark) > least)
    }

    /// Returns the squared errors of pixels if their samples missed a part that has the colour of the neighbour that differs most.
    #[inline(always)]
    fn missed(&self, curve: OutputCurve, ranges: &[[[f32; LANES]; 2]; 3]) -> [f32; LANES] {
        let mut missed = [0.0_f32; LANES];
        for (mean, [least, most]) in self.mean.iter().zip(ranges) {
            for lane in 0..LANES {
                let (mean, count) = (mean[lane], single(f64::from(self.taken[lane])));
                let farther = if most[lane] - mean > mean - least[lane] { most[lane] } else { least[lane] };
                let change = curve.value(mean + MISSED / count * (farther - mean)) - curve.value(mean);
                missed[lane] += change * change / 3.0;
            }
        }
        missed
    }

    /// Returns the least and the greatest mean in the neighbourhood of each pixel, by channel. `compared` returns the pixels that count.
    #[inline(always)]
    fn ranges(around: &Around<'_, Self>, compared: impl Fn(&Self) -> u32) -> [[[f32; LANES]; 2]; 3] {
        BorderedPacket::of(around, |packet| (&packet.mean, compared(packet))).ranges()
    }

    /// Returns the sum of the variances of audited plain pixels, and their number. A pixel whose samples vary no more than its neighbours
    /// differ is left out: it shows an edge or noise that its neighbours show, too, and tells nothing about others.
    pub(super) fn audit<'a>(
        &self,
        ErrorModel { curve, target, .. }: ErrorModel,
        around: impl FnOnce() -> Around<'a, Self>,
    ) -> (f64, f64) {
        let audited = self.audited & self.plain() & lanes_where(|lane| self.taken[lane] >= FEWEST);
        let varied = audited & lanes_where(|lane| self.variance[lane] > target * target);
        let shown = if varied == 0 {
            0
        } else {
            let apart = squared_widths(curve, &Self::ranges(&around(), Self::plain));
            varied & lanes_where(|lane| self.variance[lane] <= apart[lane])
        };
        let add = |(sum, count), lane: usize| (sum + f64::from(self.variance[lane]), count + 1.0);
        lanes(audited & !shown).fold((0.0, 0.0), add)
    }

    /// Returns the squared errors of pixels if their samples missed the feature, which may be brighter or darker than the mean.
    #[inline(always)]
    fn hidden(&self, curve: OutputCurve) -> [f32; LANES] {
        let mut hidden = [0.0_f32; LANES];
        for mean in &self.mean {
            for lane in 0..LANES {
                let (mean, count) = (mean[lane], single(f64::from(self.taken[lane])));
                let (part, radiance) = (missed_part(self.area[lane], count), self.radiance[lane]);
                let brighter = curve.value(mean + part * (radiance - mean)) - curve.value(mean);
                let darker = curve.value(mean) - curve.value(mean * (1.0 - part));
                let change = if brighter > darker { brighter } else { darker };
                hidden[lane] += change * change / 3.0;
            }
        }
        hidden
    }

    /// Returns the squared error that the samples of a featured pixel show in their mean, given the variance of one sample.
    #[inline(always)]
    pub(super) fn shown_error(&self, lane: usize, variance: f32, model: ErrorModel) -> f32 {
        let (count, area) = (single(f64::from(self.taken[lane])), self.area[lane]);
        let edge = if model.edges { edge_error(variance, count) } else { variance / count };
        // Until samples hit the feature, they behave like independent samples.
        let met = (model.least_part * area * count).max(1.0);
        if self.radiance[lane] > 0.0 { variance / (count * met.sqrt()) } else { edge }
    }

    /// Returns the weight of what a pixel's samples show: of small features the expected number of samples that met it, at most 1. Samples
    /// that can hardly have met a feature tell little about it.
    pub(super) fn met(&self, lane: usize) -> f32 {
        let is_small = self.radiance[lane] > 0.0;
        if is_small { (0.25 * self.area[lane] * single(f64::from(self.taken[lane]))).min(1.0) } else { 1.0 }
    }

    /// Adds the variance of light in the pixels of small features, after their first samples, and its upper bounds.
    pub(super) fn measure_light(&self, sums: &PacketSums, light: &mut FeatureLight) {
        for lane in lanes(self.classes[Class::Small as usize]).filter(|lane| self.taken[*lane] >= FEWEST) {
            let count = f64::from(self.taken[lane]);
            let [area, radiance] = [self.area[lane], self.radiance[lane]].map(f64::from);
            let (mut bound, mut seen) = (0.0, 0.0);
            for (all, squares) in sums.all.iter().zip(&sums.squares) {
                let mean = all[lane] / count;
                let farthest = f64::max(radiance - mean, mean);
                bound += farthest * farthest;
                seen += f64::max(squares[lane] - all[lane] * mean, 0.0) / (count - 1.0);
            }
            // The mean of p (1 - p) for a covered fraction p uniformly distributed up to `area`, of which a feature that straddles the corner
            // of four pixels leaves a quarter.
            let met = f64::from(self.met(lane));
            light.add(self.radiance[lane], met, 0.25 * area * (0.5 - area / 3.0) * bound, seen);
        }
    }

    /// Replaces the upper bounds of the radiance of small features by what was measured.
    pub(super) fn dim(&mut self, light: &FeatureLight) {
        for lane in lanes(self.classes[Class::Small as usize]) {
            // Samples of one colour may have missed the feature, however large it is.
            let is_met = self.met(lane) >= 1.0 && self.variance[lane] > VISIBLE;
            let radiance = self.radiance[lane];
            self.radiance[lane] = single(f64::from(radiance) * light.radiance_fraction(radiance, is_met));
        }
    }

    /// Scales the estimates by the factor of each class. The factors are measured on the pixels of this round. Featured pixels without new
    /// samples or features therefore keep their estimate; a higher estimate from their neighbours raises it, at most to twice its value.
    #[inline(always)]
    pub(super) fn scale(&mut self, errors: &[f32; LANES], factors: [f32; CLASSES]) {
        let kept = self.featured() & !self.changed;
        let [plain, edge, _] = self.classes;
        let inside = self.inside();
        for (lane, square) in self.square.iter_mut().enumerate() {
            let is = |pixels: u32| pixels >> lane & 1 == 1;
            let factor = if is(plain) {
                factors[0]
            } else if is(edge) {
                factors[1]
            } else {
                factors[2]
            };
            let scaled = errors[lane] * factor;
            let within = if scaled > 2.0 * *square { 2.0 * *square } else { scaled };
            let within = if within > *square { within } else { *square };
            let is_kept = is(kept) && self.taken[lane] >= FEWEST;
            let scaled = if is_kept { within } else { scaled };
            *square = if is(inside) { scaled } else { 0.0 };
        }
        self.changed = 0;
    }

    /// Returns the sum of the squared errors of `pixels`.
    #[inline(always)]
    pub(super) fn sum_of_squares(&self, pixels: u32) -> f64 {
        if pixels == 0 {
            return 0.0;
        }
        let of = |lane: usize| if pixels >> lane & 1 == 1 { f64::from(self.square[lane]) } else { 0.0 };
        let pairs: [f64; LANES / 2] = std::array::from_fn(|lane| of(lane) + of(lane + LANES / 2));
        pairs.iter().sum()
    }

    /// Returns the pixels with the same estimate and sample count as the first pixel that is not audited: usually most of those not
    /// audited.
    #[inline(always)]
    pub(super) fn alike(&self) -> u32 {
        let first = (!self.audited & WHOLE).trailing_zeros() as usize % LANES;
        let (square, taken) = (self.square[first].to_bits(), self.taken[first]);
        self.inside()
            & lanes_where(|lane| (self.square[lane].to_bits() == square) & (self.taken[lane] == taken))
    }

    /// Returns the gains of sampling the pixels further. The column and row of the first pixel determine their random parts.
    #[inline(always)]
    pub(super) fn gains(&self, (column, row): (usize, usize), norm: ErrorNorm) -> [Gain; LANES] {
        std::array::from_fn(|lane| {
            let place = (column + lane % SIDE, row + lane / SIDE);
            self.gain(lane, norm, mixed_place(place))
        })
    }

    /// Returns the gain of sampling a pixel further.
    #[inline(always)]
    pub(super) fn gain(&self, lane: usize, norm: ErrorNorm, chance: u32) -> Gain {
        let count = if norm == ErrorNorm::Rms { single(f64::from(self.taken[lane].max(1))) } else { 1.0 };
        Gain::of(self.square[lane] / count, chance)
    }

    /// Returns the pixels that more samples can improve.
    #[inline(always)]
    pub(super) fn unfinished(&self, most: u32) -> u32 {
        lanes_where(|lane| self.taken[lane] < most && self.square[lane] > 0.0)
    }

    /// Chooses the pixels to sample in the next round: those with sufficient gain, and some plain pixels that were not audited yet. Returns
    /// whether any pixel has sufficient gain.
    #[inline(always)]
    pub(super) fn choose(
        &mut self,
        first: (usize, usize),
        (norm, least): (ErrorNorm, Gain),
        round: u32,
        most: u32,
    ) -> bool {
        let gains = self.gains(first, norm);
        let enough = self.unfinished(most) & lanes_where(|lane| gains[lane] >= least);
        let block = mixed(mixed_place((first.0 / SIDE, first.1 / SIDE)) ^ round);
        let tile = mixed(mixed_place((first.0 / TILE as usize, first.1 / TILE as usize)) ^ round);
        let is = |lane: usize| mixed(block ^ 1 << lane).is_multiple_of(AUDITED);
        let audits = if tile.is_multiple_of(AUDITED_TILES) { lanes_where(is) } else { 0 };
        let audits = audits & self.plain() & !self.audited & !enough;
        self.active = enough | audits;
        for lane in 0..LANES {
            let is_active = self.active >> lane & 1 == 1;
            let goal = next_goal(self.taken[lane], most);
            self.goal[lane] = if is_active { goal } else { self.goal[lane] };
            // Pixels at the maximum sample count take no more.
            self.active &= !(u32::from(is_active && goal <= self.taken[lane]) << lane);
        }
        self.audited |= audits & self.active;
        enough != 0
    }
}

/// Returns the sample count of a pixel after its next round: twice the current count and enough for a variance, at most `most`.
#[inline(always)]
pub(super) fn next_goal(taken: u32, most: u32) -> u32 {
    taken.saturating_mul(2).max(FEWEST).min(most)
}

/// Returns the squared error of the mean of `count` samples at an edge, given the variance of one sample.
#[inline(always)]
fn edge_error(variance: f32, count: f32) -> f32 {
    EDGES * variance / (count * count.sqrt())
}

/// Returns the squared widths of ranges of means, in output values: the largest variance between two sides of an edge.
#[inline(always)]
fn squared_widths(curve: OutputCurve, ranges: &[[[f32; LANES]; 2]; 3]) -> [f32; LANES] {
    let mut squares = [0.0_f32; LANES];
    for [least, most] in ranges {
        for lane in 0..LANES {
            let width = curve.value(most[lane]) - curve.value(least[lane]);
            squares[lane] += width * width / 3.0;
        }
    }
    squares
}

/// Returns the RMS fraction of a pixel covered by a feature that all `count` samples miss, for a fraction uniformly distributed up to
/// `area`. With z = area count, the mean square is area² (2 - exp(-z) (z² + 2 z + 2)) / z³; the root is approximated within 5 %.
#[inline(always)]
fn missed_part(area: f32, count: f32) -> f32 {
    let z = area * count;
    area / (3.0 + z * (2.25 + 0.5 * z * z)).sqrt()
}

/// Returns a uniformly distributed hash of a column and a row.
#[inline(always)]
fn mixed_place((column, row): (usize, usize)) -> u32 {
    #[expect(clippy::cast_possible_truncation, reason = "a film's columns and rows")]
    mixed((column as u32) ^ mixed(row as u32))
}

/// Returns a uniformly distributed hash of a number.
#[inline(always)]
fn mixed(number: u32) -> u32 {
    let number = (number ^ number >> 16).wrapping_mul(0x7feb_352d);
    let number = (number ^ number >> 15).wrapping_mul(0x846c_a68b);
    number ^ number >> 16
}

#[expect(clippy::cast_possible_truncation, reason = "an estimate")]
#[inline(always)]
pub(super) fn single(number: f64) -> f32 {
    number as f32
}
