//! The square errors of pixels, from their samples and from what geometry knows of them. Loops go through the lanes of a packet, so that
//! compilers make vectors of them.

use super::needs::Gain;
use super::output_curve::OutputCurve;
use crate::color::ErrorNorm;
use crate::trace::math::{LANES, WHOLE, lanes};
use crate::trace::stages::TILE;
use crate::trace::visibility::Feature;

/// The sums of the samples of a packet's pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PacketSums {
    /// The sums of samples, by channel.
    pub(crate) all: [[f64; LANES]; 3],
    /// The sums of their squares.
    pub(crate) squares: [[f64; LANES]; 3],
    /// The numbers of samples that the scene covers, if the picture has alpha.
    pub(crate) covered: Option<[f64; LANES]>,
}

/// The pixels of a packet: what is known of each. Masks have a bit for each lane.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct PixelPacket {
    /// By class: its pixels. Lanes beyond the film have none.
    pub(super) classes: [u32; CLASSES],
    /// Pixels that take samples in this round.
    pub(super) active: u32,
    /// Pixels whose samples were doubled in the round before.
    pub(super) doubled: u32,
    /// Pixels whose estimate is that of fewer samples or another feature.
    pub(super) changed: u32,
    /// Pixels whose samples were taken without a reason, so that they stand for others.
    pub(super) audited: u32,
    /// Samples taken.
    pub(super) taken: [u32; LANES],
    /// Samples after this round.
    pub(super) goal: [u32; LANES],
    /// The means of the samples taken, by channel; no numbers beyond the film.
    mean: [[f32; LANES]; 3],
    /// The share of them that the scene covers.
    alpha: [f32; LANES],
    /// The variance of one sample in output values, as far as the mean of them all shows it.
    pub(super) variance: [f32; LANES],
    /// The square of half the difference between the means of both halves of its samples, in output values; negative where unknown. Then
    /// what it was before the samples were doubled.
    pub(super) apart: [f32; LANES],
    pub(super) apart_before: [f32; LANES],
    /// The estimate of the square of its error.
    pub(super) square: [f32; LANES],
    /// Their features.
    area: [f32; LANES],
    radiance: [f32; LANES],
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

/// Pixels of a packet in a row.
const SIDE: usize = crate::trace::scene::SIDE as usize;

/// One of so many plain pixels of one of so many tiles is audited in every round after the first: a few samples cost nearly as much in a tile
/// as four times as many.
const AUDITED: u32 = 8;
const AUDITED_TILES: u32 = 4;

/// Fewer samples tell nothing of how they vary.
pub(super) const FEWEST: u32 = 4;

/// The part of a pixel on the other side of an edge that samples on one side leave possible, times their number. Of one sample and an edge
/// anywhere, a part p is missed with the mean square p (1 - p), 1/6 = 0.41²; of more, as much less as the gaps between them.
const MISSED: f32 = 0.41;

/// The square error of the mean of n samples at an edge is that of independent ones over the root of n, times this: 0.3 to
/// 0.7 in the scenes of `benches/hard.rs` with 8 to 64 samples a pixel. It is corrected as soon as samples were doubled.
const EDGES: f32 = 0.7;

/// Model of square errors.
#[derive(Clone, Copy, Debug)]
pub(super) struct ErrorModel {
    pub(super) curve: OutputCurve,
    /// Errors fall as those of edges do.
    pub(super) edges: bool,
    /// The error of alpha counts.
    pub(super) alpha: bool,
}

impl PixelPacket {
    /// Creates the pixels in these lanes, which take so many samples in the first round, and one that is audited at least `first`. Its place
    /// follows from the column and the row of the packet's first pixel.
    pub(super) fn new(inside: u32, goal: u32, first: u32, (column, row): (usize, usize)) -> Self {
        let number = |lane: usize| if inside >> lane & 1 == 1 { 0.0 } else { f32::NAN };
        let audited = 1 << (mixed_place((column / SIDE, row / SIDE)) as usize % LANES);
        let audited = inside & if goal < first { audited } else { WHOLE };
        let goal_of = |lane: usize| if audited >> lane & 1 == 1 { goal.max(first) } else { goal };
        Self {
            classes: [inside, 0, 0],
            active: inside,
            doubled: 0,
            changed: inside,
            audited,
            taken: [0; LANES],
            goal: std::array::from_fn(goal_of),
            mean: [std::array::from_fn(number); 3],
            alpha: [0.0; LANES],
            variance: [0.0; LANES],
            apart: [-1.0; LANES],
            apart_before: [-1.0; LANES],
            square: [0.0; LANES],
            area: [Feature::NONE.area; LANES],
            radiance: [Feature::NONE.radiance; LANES],
        }
    }

    /// Returns the pixels of the film.
    pub(super) fn inside(&self) -> u32 {
        self.classes.iter().fold(0, |all, class| all | class)
    }

    /// Returns the pixels that more than one surface may show in.
    pub(super) fn featured(&self) -> u32 {
        self.classes[Class::Edge as usize] | self.classes[Class::Small as usize]
    }

    /// Notes a feature of a pixel, which takes at least `first` samples in the first round then.
    pub(super) fn join(&mut self, lane: usize, feature: Feature, first: u32) {
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
            // Its estimate was that of another class.
            self.changed |= 1 << lane;
            if self.taken[lane] == 0 {
                self.goal[lane] = self.goal[lane].max(first);
            }
        }
    }

    /// Takes the samples of a round into account. Those that were doubled before are forgotten already.
    #[inline(always)]
    pub(super) fn update(&mut self, curve: OutputCurve, sums: &PacketSums) {
        let (mut apart, mut variance) = ([0.0_f32; LANES], [0.0_f32; LANES]);
        let (is_first, is_single) = (self.taken == [0; LANES], self.goal == [1; LANES]);
        let [mut before, mut of_all, mut of_new, mut of_others] = [[0.0; LANES]; 4];
        let [mut count, mut part] = [[0.0_f32; LANES]; 2];
        for lane in 0..LANES {
            let (all, old) = (f64::from(self.goal[lane]), f64::from(self.taken[lane]));
            (before[lane], count[lane]) = (old, single(all));
            of_all[lane] = 1.0 / all;
            of_new[lane] = 1.0 / (all - old);
            of_others[lane] = 1.0 / (all - 1.0);
            part[lane] = single((all - old) * of_all[lane]);
        }
        // Divisions are few and loops short, so that all of them become vectors.
        for ((mean, sums), squares) in self.mean.iter_mut().zip(&sums.all).zip(&sums.squares) {
            let mut all = [0.0; LANES];
            for lane in 0..LANES {
                all[lane] = sums[lane] * of_all[lane];
            }
            if !is_first {
                for lane in 0..LANES {
                    // The mean moves by a part of the way to that of the new samples alone.
                    let new = (sums[lane] - before[lane] * f64::from(mean[lane])) * of_new[lane];
                    let moved = part[lane] * (curve.value(single(new)) - curve.value(mean[lane]));
                    apart[lane] += moved * moved / 3.0;
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
                // Half of the difference between the halves is what the mean has moved by.
                apart[lane] = apart[lane].max(differs * differs);
                variance[lane] = variance[lane].max(single(255.0 * 255.0 * share * (1.0 - share)));
                self.alpha[lane] = single(share);
            }
        }
        for lane in 0..LANES {
            let (before, goal, is_active) = (self.taken[lane], self.goal[lane], self.active >> lane & 1 == 1);
            let is_doubled = before > 1 && goal == 2 * before;
            self.doubled |= u32::from(is_active && is_doubled) << lane;
            let apart = if is_doubled { apart[lane] } else { -1.0 };
            let variance = if goal > 1 { variance[lane] } else { 0.0 };
            self.apart_before[lane] = if is_active { self.apart[lane] } else { self.apart_before[lane] };
            self.apart[lane] = if is_active { apart } else { self.apart[lane] };
            self.variance[lane] = if is_active { variance } else { self.variance[lane] };
            self.taken[lane] = if is_active { goal } else { before };
        }
        self.changed |= self.active;
        self.active = 0;
    }

    /// Returns the estimates of square errors, not scaled, where pixels with audits have this variance of one sample. The variance of one
    /// sample in pixels of the same kind nearby counts half, as samples of one pixel may agree by chance.
    #[inline(always)]
    pub(super) fn errors(
        &self,
        ErrorModel { curve, edges, alpha }: ErrorModel,
        audited: f32,
        around: impl FnOnce() -> Surroundings,
    ) -> [f32; LANES] {
        let count: [f32; LANES] = std::array::from_fn(|lane| single(f64::from(self.taken[lane])));
        let mut errors = [0.0; LANES];
        for lane in 0..LANES {
            let variance =
                if self.taken[lane] < FEWEST { audited } else { 0.5 * (self.variance[lane] + audited) };
            errors[lane] = variance / count[lane];
        }
        let featured = self.featured();
        if featured == 0 {
            return errors;
        }
        let around = around();
        let (mut missed, mut hidden) = ([0.0_f32; LANES], [0.0_f32; LANES]);
        for (channel, mean) in self.mean.iter().enumerate() {
            let (least, most) = (&around.least[channel], &around.most[channel]);
            for lane in 0..LANES {
                // A part becomes as its farthest neighbour.
                let mean = mean[lane];
                let farther = if most[lane] - mean > mean - least[lane] { most[lane] } else { least[lane] };
                let change = curve.value(mean + MISSED / count[lane] * (farther - mean)) - curve.value(mean);
                missed[lane] += change * change / 3.0;
            }
            if self.classes[Class::Small as usize] == 0 {
                continue;
            }
            for lane in 0..LANES {
                // What hides may be brighter or darker.
                let (mean, radiance) = (mean[lane], self.radiance[lane]);
                let part = missed_part(self.area[lane], count[lane]);
                let brighter = curve.value(mean + part * (radiance - mean)) - curve.value(mean);
                let darker = curve.value(mean) - curve.value(mean * (1.0 - part));
                let change = if brighter > darker { brighter } else { darker };
                hidden[lane] += change * change / 3.0;
            }
        }
        for lane in 0..LANES {
            let (count, area, radiance) = (count[lane], self.area[lane], self.radiance[lane]);
            let variance = 0.5 * (self.variance[lane] + around.variance[lane]);
            let falls = if edges { count * count.sqrt() / EDGES } else { count };
            let edge = (variance / falls).max(missed[lane]);
            // Until samples have met it, they are as good as independent. It may lie across a corner of four pixels.
            let met = if edges { (0.25 * area * count).max(1.0) } else { 1.0 };
            let small = variance / (count * met.sqrt()) + hidden[lane].max(missed[lane]);
            let error = if radiance > 0.0 { small } else { edge };
            let part = if alpha { 255.0 * missed_part(area, count) } else { 0.0 };
            errors[lane] = if featured >> lane & 1 == 1 { error.max(part * part) } else { errors[lane] };
        }
        errors
    }

    /// Scales estimates, by class. The scales are those of this round's pixels: others keep what they had, unless their neighbours show more.
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

    /// Returns the sum of the square errors of pixels.
    #[inline(always)]
    pub(super) fn sum_of_squares(&self, pixels: u32) -> f64 {
        if pixels == 0 {
            return 0.0;
        }
        let of = |lane: usize| if pixels >> lane & 1 == 1 { f64::from(self.square[lane]) } else { 0.0 };
        let pairs: [f64; LANES / 2] = std::array::from_fn(|lane| of(lane) + of(lane + LANES / 2));
        pairs.iter().sum()
    }

    /// Returns pixels that have the same estimate and the same number of samples: most of those that were not audited.
    #[inline(always)]
    pub(super) fn alike(&self) -> u32 {
        let first = (!self.audited & WHOLE).trailing_zeros() as usize % LANES;
        let (square, taken) = (self.square[first].to_bits(), self.taken[first]);
        let is_alike = |lane: usize| (self.square[lane].to_bits() == square) & (self.taken[lane] == taken);
        self.inside() & (0..LANES).fold(0, |alike, lane| alike | u32::from(is_alike(lane)) << lane)
    }

    /// Returns what more samples of pixels promise; of their chances, the column and the row of the first decide.
    #[inline(always)]
    pub(super) fn gains(&self, (column, row): (usize, usize), norm: ErrorNorm) -> [Gain; LANES] {
        std::array::from_fn(|lane| {
            let place = (column + lane % SIDE, row + lane / SIDE);
            self.gain(lane, norm, mixed_place(place))
        })
    }

    /// Returns what more samples of a pixel promise.
    #[inline(always)]
    pub(super) fn gain(&self, lane: usize, norm: ErrorNorm, chance: u32) -> Gain {
        let count = if norm == ErrorNorm::Rms { single(f64::from(self.taken[lane].max(1))) } else { 1.0 };
        Gain::of(self.square[lane] / count, chance)
    }

    /// Returns the pixels that more samples make better.
    #[inline(always)]
    pub(super) fn unfinished(&self, most: u32) -> u32 {
        let is = |lane: usize| self.taken[lane] < most && self.square[lane] > 0.0;
        (0..LANES).fold(0, |pixels, lane| pixels | u32::from(is(lane)) << lane)
    }

    /// Chooses the pixels that take samples in the next round: those that promise enough, and some plain ones that were not audited yet.
    /// Returns whether there is a reason for another round.
    #[inline(always)]
    pub(super) fn choose(
        &mut self,
        first: (usize, usize),
        (norm, least): (ErrorNorm, Gain),
        round: u32,
        most: u32,
    ) -> bool {
        let gains = self.gains(first, norm);
        let enough = (0..LANES).fold(0, |pixels, lane| pixels | u32::from(gains[lane] >= least) << lane);
        let enough = enough & self.unfinished(most);
        let block = mixed(mixed_place((first.0 / SIDE, first.1 / SIDE)) ^ round);
        let tile = mixed(mixed_place((first.0 / TILE as usize, first.1 / TILE as usize)) ^ round);
        let audits = if !tile.is_multiple_of(AUDITED_TILES) {
            0
        } else {
            let is = |pixel: u32| mixed(block ^ pixel).is_multiple_of(AUDITED);
            (0..LANES).map(|lane| 1 << lane).filter(|pixel| is(*pixel)).fold(0, |all, pixel| all | pixel)
        };
        let audits = audits & self.classes[Class::Plain as usize] & !self.audited & !enough;
        self.active = enough | audits;
        for lane in 0..LANES {
            let is_active = self.active >> lane & 1 == 1;
            let goal = next_goal(self.taken[lane], most);
            self.goal[lane] = if is_active { goal } else { self.goal[lane] };
            // Those that have all samples take no more.
            self.active &= !(u32::from(is_active && goal <= self.taken[lane]) << lane);
        }
        self.audited |= audits & self.active;
        enough != 0
    }
}

/// Returns how many samples a pixel has after a round in which it takes some, `most` at most: twice as many.
#[inline(always)]
pub(super) fn next_goal(taken: u32, most: u32) -> u32 {
    taken.saturating_mul(2).max(FEWEST).min(most)
}

/// Returns the root of the mean square of the part of a pixel that a feature covers, missed by all of `count` samples, where the part is
/// anything up to `area`: with z = area count, area² (2 - exp(-z) (z² + 2 z + 2)) / z³, up to 4 %.
#[inline(always)]
fn missed_part(area: f32, count: f32) -> f32 {
    let z = area * count;
    area / (3.0 + z * (2.25 + 0.5 * z * z)).sqrt()
}

/// The neighbours of a packet's pixels, each with itself: the darkest and the brightest, by channel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings {
    least: [[f32; LANES]; 3],
    most: [[f32; LANES]; 3],
    /// The mean variance of one sample among those that more than one surface may show in.
    variance: [f32; LANES],
}

impl Surroundings {
    /// Returns those of a packet, given with the eight around it, row by row.
    #[inline(always)]
    pub(super) fn of(packets: [[Option<&PixelPacket>; 3]; 3]) -> Self {
        // The packet and a border of a pixel: three means, then variances, and which of them count.
        let mut patch = [[[f32::NAN; WIDE]; WIDE]; 5];
        let columns = [(0, 0..1, SIDE - 1..SIDE), (1, 1..WIDE - 1, 0..SIDE), (2, WIDE - 1..WIDE, 0..1)];
        for (row, down) in (0..WIDE).map(|row| (row, row + SIDE - 1)) {
            for (right, places, lanes) in &columns {
                let Some(packet) = packets[down / SIDE][*right] else { continue };
                let first = down % SIDE * SIDE;
                let (places, lanes) = (places.clone(), first + lanes.start..first + lanes.end);
                for (plane, mean) in patch.iter_mut().zip(&packet.mean) {
                    plane[row][places.clone()].copy_from_slice(&mean[lanes.clone()]);
                }
                for (place, lane) in places.zip(lanes) {
                    let counts = packet.featured() >> lane & 1 == 1 && packet.taken[lane] > 1;
                    patch[3][row][place] = if counts { packet.variance[lane] } else { 0.0 };
                    patch[4][row][place] = if counts { 1.0 } else { 0.0 };
                }
            }
        }
        // No number is neither less nor more than another.
        let least = |least: f32, number: f32| if number < least { number } else { least };
        let most = |most: f32, number: f32| if number > most { number } else { most };
        let sum = |sum: f32, number: f32| if number > 0.0 { sum + number } else { sum };
        let (sums, counts) = (folded(&patch[3], 0.0, sum), folded(&patch[4], 0.0, sum));
        Self {
            least: [0, 1, 2].map(|channel| folded(&patch[channel], f32::INFINITY, least)),
            most: [0, 1, 2].map(|channel| folded(&patch[channel], f32::NEG_INFINITY, most)),
            variance: std::array::from_fn(|lane| sums[lane] / f32::max(counts[lane], 1.0)),
        }
    }
}

/// Folds the numbers of each pixel and its eight neighbours.
#[inline(always)]
fn folded(patch: &[[f32; WIDE]; WIDE], first: f32, fold: impl Fn(f32, f32) -> f32) -> [f32; LANES] {
    let mut found = [first; LANES];
    for (row, column) in (0..3).flat_map(|row| (0..3).map(move |column| (row, column))) {
        for (lane, found) in found.iter_mut().enumerate() {
            *found = fold(*found, patch[lane / SIDE + row][lane % SIDE + column]);
        }
    }
    found
}

/// Pixels of a packet and its border in a row.
const WIDE: usize = SIDE + 2;

/// Returns a number that is any with equal chances, of a column and a row.
#[inline(always)]
fn mixed_place((column, row): (usize, usize)) -> u32 {
    #[expect(clippy::cast_possible_truncation, reason = "a film's columns and rows")]
    mixed((column as u32) ^ mixed(row as u32))
}

/// Returns a number that is any with equal chances, of another.
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
