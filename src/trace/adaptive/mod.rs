//! Adaptive sampling: pixels get samples until the estimated RMS error of the picture is at most a target.
//!
//! ```text
//! take a first sample of every pixel (four where a lens or a shutter is open)
//! loop:
//!     estimate the square error of every pixel
//!     stop when their mean is at most the target's square
//!     find the least gain, square error per sample, that reaches the target when every pixel above it is doubled   (`needs`)
//!     double the samples of the pixels above it, and audit some of the others
//! ```
//!
//! A frame decides by itself alone; nothing depends on threads, tiles or other frames. Estimates that follow from a pixel's own samples are
//! biased where samples decide who gets more: pixels whose samples agree by chance would be given up. So:
//!
//! 1. **Geometry** finds the pixels that more than one surface can show in ([`visibility`](super::visibility)). They carry the error that
//!    their contrast and the size of the smallest feature leave possible, whatever their samples say (`evidence`).
//! 2. **The variance of single samples**, not the difference of two halves, says how much a pixel varies: halves of well-spread
//!    samples often agree at an edge, single samples on both sides never do.
//! 3. **Pooled halves** say how errors fall with the number of samples. With e² the square error of the mean of n samples and q e² that of
//!    2 n, the square of half the difference between the halves is (1 - q) e² on average. Summed over all pixels of a class, which were not
//!    chosen by it, it corrects the scale of the class's estimates.
//! 4. **An audit** takes samples of some plain pixels that nothing calls for, one of each 4 by 4 at first and others in every round. Their
//!    variance stands for that of their neighbourhood: it finds reflections, penumbrae and sparks that no sample has met, and enters the
//!    picture's error.

mod evidence;
mod instants;
mod needs;
mod output_curve;
pub(crate) mod round_policy;

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::color::{ErrorNorm, Transfer};
use crate::trace::math::LANES;
use crate::trace::scene::{Camera, PreparedScene};
use crate::trace::stages::{Portion, TILE, TILE_PIXELS, Tile};
use crate::trace::visibility::{Covering, Feature, Image, TileFeatures};
pub(crate) use evidence::PixelSums;
use evidence::{CLASSES, Class, FEWEST, Neighbours, Pixel};
pub(crate) use instants::{InstantOrder, block};
use needs::{Gain, SquaresByGain};
use output_curve::OutputCurve;
pub use round_policy::{Outlook, Replay, RoundPolicy, SharedRoundPolicy};

/// The error that a picture may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ErrorTarget {
    /// In output values: steps of 8 bits. Greater than 0.
    pub(crate) error: f64,
    pub(crate) norm: ErrorNorm,
    /// The fewest samples of a pixel.
    pub(crate) least: u32,
    /// How light becomes output values.
    pub(crate) transfer: Transfer,
    pub(crate) convergence: Convergence,
}

/// How fast errors fall with the number n of samples, before it is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Convergence {
    /// As n^-3/4.
    Edges,
    /// As n^-1/2.
    Effects,
}

impl Convergence {
    /// Returns the convergence of a picture of a scene through a camera, whose shutter may be open.
    pub(crate) fn of(scene: &PreparedScene, camera: &Camera, is_open: bool) -> Self {
        let has_effects =
            is_open || camera.has_lens() || scene.lights.iter().any(|light| light.source.is_extended());
        if has_effects { Self::Effects } else { Self::Edges }
    }

    /// By what a square error is multiplied when the number of samples is doubled.
    fn of_doubling(self) -> f64 {
        match self {
            Self::Edges => 0.353_553_390_593_273_8,
            Self::Effects => 0.5,
        }
    }
}

/// The estimate of a picture's error, in output values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatedError {
    /// In the norm of the target: the root of the mean square over pixels and channels, the largest, or the 99th percentile.
    pub value: f64,
    /// Its standard deviation: how far the estimate may be off.
    pub deviation: f64,
    /// The root of the mean square of the errors that images of small shapes in mirrors and glass may make beside it, if they are where no
    /// sample was taken: the expectation if all of them are in sight. 0 while samples are added.
    pub hidden: f64,
}

/// The part of the target that is aimed at: estimates scatter.
const AIM: f64 = 0.85;
/// One of so many plain pixels is audited first, and one of so many in every later round.
const AUDITED: [u32; 2] = [16, 32];
/// The rows whose squares are summed together.
const BAND: usize = 32;
/// The weight of what is known of a class beforehand, in pixels.
const PRIOR: f64 = 8.0;
/// The weight of the whole picture's audit in every tile's, in pixels.
const SHARED: f64 = 4.0;

/// Sums of samples, pixel by pixel.
pub(crate) trait SampleSums: Sync {
    /// Returns whether the picture has alpha.
    fn have_alpha(&self) -> bool;

    /// Returns the sums of the pixel in a column and a row.
    fn of(&self, column: usize, row: usize) -> PixelSums;
}

/// The memory of a picture's pixels.
#[derive(Clone, Debug, Default)]
pub(crate) struct PixelMemory {
    pixels: Vec<Pixel>,
}

/// The samples of a picture's pixels: how many each has, and which are next.
#[derive(Clone, Debug)]
pub(crate) struct Adaptive {
    target: ErrorTarget,
    curve: OutputCurve,
    size: (usize, usize),
    /// The most samples of a pixel.
    most: u32,
    order: InstantOrder,
    round: u32,
    pixels: Vec<Pixel>,
    /// By class: by what estimates are multiplied.
    scales: [Scale; CLASSES],
    error: Option<EstimatedError>,
    /// The sums of the squares of errors that images make if they are missed, by quarters of the powers of two of their areas.
    images: Option<BTreeMap<i32, f64>>,
    /// The least gains of the rounds that a policy has chosen.
    rounds: Vec<u32>,
}

/// How a class's estimates are corrected.
#[derive(Clone, Copy, Debug)]
struct Scale {
    factor: f64,
    /// By what a square error is multiplied when the number of samples is doubled.
    falls: f64,
    /// The relative variance of the factor.
    uncertain: f64,
}

/// Sums over the pixels of a class whose samples were doubled.
#[derive(Clone, Copy, Debug, Default)]
struct Halves {
    pixels: f64,
    model: f64,
    apart: f64,
    apart_squared: f64,
    /// Of the pixels that were doubled before, too: then and now.
    earlier: f64,
    later: f64,
}

impl Adaptive {
    /// Creates the state before the first sample, in the memory of another picture.
    pub(crate) fn new(
        (columns, rows): (u32, u32),
        (most, order, starts_wide): (u32, InstantOrder, bool),
        target: ErrorTarget,
        PixelMemory { mut pixels }: PixelMemory,
    ) -> Self {
        let size = (columns.max(1) as usize, rows.max(1) as usize);
        let wide = starts_wide || order.count() > 1 || target.least >= FEWEST;
        let goal = (if wide { FEWEST } else { 1 }).max(target.least).min(most);
        pixels.clear();
        pixels.resize(size.0 * size.1, Pixel { goal, apart: -1.0, audited: wide, ..Pixel::default() });
        let falls = [0.5, target.convergence.of_doubling(), 0.5];
        let scales = falls.map(|falls| Scale { factor: 1.0, falls, uncertain: 0.25 });
        let curve = OutputCurve::of(target.transfer);
        Self {
            target,
            curve,
            size,
            most,
            order,
            round: 0,
            pixels,
            scales,
            error: None,
            images: None,
            rounds: Vec::new(),
        }
    }

    /// Returns the memory.
    pub(crate) fn into_memory(self) -> PixelMemory {
        PixelMemory { pixels: self.pixels }
    }

    /// Returns the estimate of the picture's error; `None` before it is known.
    pub(crate) fn error(&self) -> Option<EstimatedError> {
        self.error.map(|error| EstimatedError { hidden: self.hidden_square().sqrt(), ..error })
    }

    /// Returns the least gains of the rounds that a policy has chosen.
    pub(crate) fn rounds(&self) -> &[u32] {
        &self.rounds
    }

    /// Returns whether geometry is to be searched for the features of pixels in this round: while it shows new instants.
    pub(crate) fn wants_features(&self) -> bool {
        self.round == 0 || (self.order.count() > 1 && self.pixels_most() <= self.order.count())
    }

    /// Returns whether images in mirrors and glass are to be searched.
    pub(crate) fn wants_images(&self) -> bool {
        self.images.is_none()
    }

    /// Notes the images in mirrors and glass that the picture may show.
    pub(crate) fn note_images(&mut self, found: &[Image]) {
        let mut images = BTreeMap::new();
        for Image { area, radiance, count } in found {
            #[expect(clippy::cast_possible_truncation, reason = "of a few pixels")]
            let size = libm::floor(4.0 * libm::log2(*area)) as i32;
            let change = f64::from(self.curve.value(radiance * evidence::single(area.min(1.0))));
            *images.entry(size).or_insert(0.0) += count * change * change * area.max(1.0);
        }
        self.images = Some(images);
    }

    /// Returns the mean square of the errors of images that no sample may have met.
    fn hidden_square(&self) -> f64 {
        let Some(images) = self.images.as_ref().filter(|images| !images.is_empty()) else { return 0.0 };
        let (pixels, samples) = self
            .pixels
            .iter()
            .filter(|pixel| pixel.class() == Class::Plain)
            .fold((0.0, 0.0), |(pixels, samples), pixel| (pixels + 1.0, samples + f64::from(pixel.taken)));
        if pixels == 0.0 {
            return 0.0;
        }
        let missed = |(size, square): (&i32, &f64)| {
            let area = libm::exp2((f64::from(*size) + 0.5) / 4.0);
            square * libm::exp(-area * samples / pixels)
        };
        images.iter().map(missed).sum::<f64>() / self.pixels.len() as f64
    }

    fn pixels_most(&self) -> u32 {
        self.pixels.iter().map(|pixel| pixel.goal).max().unwrap_or(0)
    }

    /// Returns whether the shutter is open: shapes may move through pixels.
    pub(crate) fn is_open(&self) -> bool {
        self.order.count() > 1
    }

    /// Returns the instants that this round's samples belong to, in the order of time.
    pub(crate) fn instants(&self) -> Vec<u32> {
        let active = self.pixels.iter().filter(|pixel| pixel.goal > pixel.taken);
        let range = active.fold(None, |range: Option<(u32, u32)>, pixel| {
            let (from, to) = range.unwrap_or((pixel.taken, pixel.goal));
            Some((from.min(pixel.taken), to.max(pixel.goal)))
        });
        range.map_or_else(Vec::new, |(from, to)| self.order.instants(from..to))
    }

    /// Collects the samples that a tile's pixels take at an instant in this round.
    pub(crate) fn portions(&self, tile: &Tile, instant: u32, portions: &mut Vec<Portion>) {
        portions.clear();
        let sample = self.order.sample_of(instant);
        for index in 0..TILE_PIXELS {
            #[expect(clippy::cast_possible_truncation, reason = "a tile's pixels")]
            let index = index as u32;
            let (column, row) = tile.pixel(index);
            if column < tile.i + tile.width && row < tile.j + tile.height {
                let pixel = &self.pixels[row as usize * self.size.0 + column as usize];
                if pixel.goal > pixel.taken {
                    portions.extend(self.order.portion(index, pixel.taken..pixel.goal, sample));
                }
            }
        }
    }

    /// Notes the features of a tile's pixels at an instant.
    pub(crate) fn note_features(&mut self, tile: &Tile, found: &TileFeatures) {
        for row in 0..tile.height {
            for column in 0..tile.width {
                let (packet, lane) = Tile::lane_of(column as usize, row as usize);
                let place = (tile.j + row) as usize * self.size.0 + (tile.i + column) as usize;
                let (feature, cover) = found.of(packet * LANES + lane);
                let pixel = &mut self.pixels[place];
                let before = pixel.feature;
                // What covers a pixel at one instant and not at another moves through it.
                let id = |cover: Option<Covering>| cover.map(|(id, _)| id);
                if let Some(other) = pixel.cover.filter(|other| id(*other) != id(cover)) {
                    let radiance =
                        other.into_iter().chain(cover).map(|(_, radiance)| radiance).fold(0.0, f32::max);
                    pixel.feature.join(Feature { area: 1.0, radiance });
                }
                pixel.feature.join(feature);
                pixel.cover = Some(cover);
                if pixel.feature != before {
                    // Its estimate was that of another kind of pixel.
                    pixel.known = 0;
                }
            }
        }
    }

    /// Estimates errors after a round, and chooses the samples of the next one: those that the target asks for, or a policy. Returns `false` if
    /// the picture is done.
    pub(crate) fn judge(&mut self, sums: &impl SampleSums, policy: Option<&SharedRoundPolicy>) -> bool {
        let (width, curve) = (self.size.0, self.curve);
        let (edges, alpha) = (self.target.convergence == Convergence::Edges, sums.have_alpha());
        // Update pixels, and remember how far their halves were apart before.
        let doubled: Vec<Vec<(usize, f32)>> = self
            .pixels
            .par_chunks_mut(width)
            .enumerate()
            .map(|(row, pixels)| {
                let mut doubled = Vec::new();
                for (column, pixel) in
                    pixels.iter_mut().enumerate().filter(|(_, pixel)| pixel.goal > pixel.taken)
                {
                    let before = pixel.apart;
                    pixel.update(curve, &sums.of(column, row));
                    if pixel.apart >= 0.0 {
                        doubled.push((column, before));
                    }
                }
                doubled
            })
            .collect();
        let around = self.audited_variance();
        let squares: Vec<Vec<f32>> = (0..self.size.1)
            .into_par_iter()
            .map(|row| {
                let tiles = &around[row / TILE as usize * width.div_ceil(TILE as usize)..];
                let pixels = self.pixels[row * width..][..width].iter().enumerate();
                let model = |(column, pixel): (usize, &Pixel)| {
                    let neighbours = match pixel.class() {
                        Class::Plain => {
                            let variance = tiles[column / TILE as usize];
                            Neighbours { least: pixel.mean, most: pixel.mean, variance }
                        }
                        Class::Edge | Class::Small => self.neighbours(column, row),
                    };
                    pixel.model(curve, edges, alpha, &neighbours)
                };
                pixels.map(model).collect()
            })
            .collect();
        self.measure_scales(&doubled, &squares);
        let factors = self.scales.map(|scale| evidence::single(scale.factor));
        let (most, norm) = (self.most, self.norm(policy));
        let bands = self.pixels.par_chunks_mut(width * BAND).zip(squares.par_chunks(BAND));
        let gained: Vec<SquaresByGain> = bands
            .map(|(pixels, squares)| {
                let mut sums = SquaresByGain::default();
                for (pixel, square) in pixels.iter_mut().zip(squares.iter().flatten()) {
                    let square = square * factors[pixel.class() as usize];
                    // The scale is that of this round's pixels: others keep what they had, unless their neighbours show more.
                    let is_known =
                        pixel.class() != Class::Plain && pixel.taken >= FEWEST && pixel.known == pixel.taken;
                    pixel.square =
                        if is_known { pixel.square.max(square.min(2.0 * pixel.square)) } else { square };
                    pixel.known = pixel.taken;
                    sums.add(pixel.gain(norm, 0), pixel.square, pixel.next_goal(most) - pixel.taken);
                }
                sums
            })
            .collect();
        let mut gains = SquaresByGain::default();
        gained.iter().for_each(|band| gains += band);
        self.note_error(norm, &gains);
        let Some(least) = self.least_gain(&gains, policy) else {
            return self.end();
        };
        let (round, part) = (self.round, AUDITED[usize::from(self.round > 0)]);
        self.round += 1;
        let rows = self.pixels.par_chunks_mut(width).enumerate();
        let active: Vec<bool> = rows
            .map(|(row, pixels)| {
                let mut any = false;
                for (column, pixel) in pixels.iter_mut().enumerate().filter(|(_, pixel)| pixel.taken < most) {
                    let gains = pixel.square > 0.0 && pixel.gain(norm, mixed_place((column, row))) >= least;
                    let audits = !gains
                        && pixel.class() == Class::Plain
                        && !pixel.audited
                        && is_audited((column, row), round, part);
                    if gains || audits {
                        pixel.goal = pixel.next_goal(most);
                        pixel.audited |= audits;
                        // An audit alone is no reason for another round, but for the first.
                        any |= gains || round == 0;
                    }
                }
                any
            })
            .collect();
        active.contains(&true) || self.end()
    }

    /// Returns the norm that pixels are chosen by: a policy knows only one.
    fn norm(&self, policy: Option<&SharedRoundPolicy>) -> ErrorNorm {
        if policy.is_some() { ErrorNorm::Rms } else { self.target.norm }
    }

    /// Returns the least gain with which samples are doubled in the next round; `None` if there is no further one.
    fn least_gain(&mut self, gains: &SquaresByGain, policy: Option<&SharedRoundPolicy>) -> Option<Gain> {
        let (error, aim) = (self.error?, AIM * self.target.error);
        if error.value <= aim {
            // The first round is always audited.
            return (self.round == 0).then_some(Gain::BEYOND);
        }
        let falls = self.scales[Class::Edge as usize].falls;
        let pixels = self.pixels.len() as f64;
        let Some(policy) = policy else {
            return Some(match beyond(self.target.norm) {
                None => gains.least_for(aim * aim * pixels, falls).0,
                Some(beyond) => gains.least_to_exceed(aim, beyond(pixels)),
            });
        };
        let samples = self.pixels.iter().map(|pixel| f64::from(pixel.taken)).sum();
        let least =
            round_policy::locked(policy).least_gain(&Outlook { gains, pixels, falls, error, samples })?;
        // At least one pixel is sampled: of few, none may have enough by chance.
        let width = self.size.0;
        let may_get_more = |(_, pixel): &(usize, &Pixel)| pixel.taken < self.most && pixel.square > 0.0;
        let of = |(place, pixel): (usize, &Pixel)| {
            pixel.gain(ErrorNorm::Rms, mixed_place((place % width, place / width)))
        };
        let largest = self.pixels.par_iter().enumerate().filter(may_get_more).map(of).max()?;
        let least = largest.min(least.into());
        self.rounds.push(least.into());
        Some(least)
    }

    /// Ends the picture.
    fn end(&mut self) -> bool {
        self.pixels.par_iter_mut().for_each(|pixel| pixel.goal = pixel.taken);
        false
    }

    /// Returns the variance of one sample of audited pixels around each tile, tile by tile.
    fn audited_variance(&self) -> Vec<f32> {
        let (width, height) = self.size;
        let across = width.div_ceil(TILE as usize);
        let down = height.div_ceil(TILE as usize);
        let mut tiles = vec![(0.0_f64, 0.0_f64); across * down];
        for (row, pixels) in self.pixels.chunks(width).enumerate() {
            for (column, pixel) in pixels.iter().enumerate() {
                if pixel.audited && pixel.taken >= FEWEST && pixel.class() == Class::Plain {
                    let tile = &mut tiles[row / TILE as usize * across + column / TILE as usize];
                    (tile.0, tile.1) = (tile.0 + f64::from(pixel.variance), tile.1 + 1.0);
                }
            }
        }
        let all = tiles.iter().fold((0.0, 0.0), |all, tile| (all.0 + tile.0, all.1 + tile.1));
        let mean = if all.1 > 0.0 { all.0 / all.1 } else { 0.0 };
        let around = |tile: usize| {
            let (i, j) = (tile % across, tile / across);
            let (mut sum, mut count) = (SHARED * mean, SHARED);
            for row in j.saturating_sub(1)..down.min(j + 2) {
                for tile in &tiles[row * across..][i.saturating_sub(1)..across.min(i + 2)] {
                    (sum, count) = (sum + tile.0, count + tile.1);
                }
            }
            evidence::single(sum / count)
        };
        (0..tiles.len()).map(around).collect()
    }

    /// Returns the extremes around a pixel.
    fn neighbours(&self, column: usize, row: usize) -> Neighbours {
        let (width, height) = self.size;
        let mut found = Neighbours { least: [f32::INFINITY; 3], most: [f32::NEG_INFINITY; 3], variance: 0.0 };
        let mut count = 0.0;
        for row in row.saturating_sub(1)..height.min(row + 2) {
            for pixel in &self.pixels[row * width..][column.saturating_sub(1)..width.min(column + 2)] {
                if pixel.class() != Class::Plain && pixel.taken > 1 {
                    (found.variance, count) = (found.variance + pixel.variance, count + 1.0);
                }
                for (channel, mean) in pixel.mean.iter().enumerate() {
                    let (least, most) = (&mut found.least[channel], &mut found.most[channel]);
                    *least = if mean < least { *mean } else { *least };
                    *most = if mean > most { *mean } else { *most };
                }
            }
        }
        found.variance /= f32::max(count, 1.0);
        found
    }

    /// Corrects the scales of classes by how far the halves of their pixels are apart.
    fn measure_scales(&mut self, doubled: &[Vec<(usize, f32)>], squares: &[Vec<f32>]) {
        let mut halves = [Halves::default(); CLASSES];
        for (row, doubled) in doubled.iter().enumerate() {
            for (column, before) in doubled {
                let pixel = &self.pixels[row * self.size.0 + column];
                let (class, apart) = (&mut halves[pixel.class() as usize], f64::from(pixel.apart));
                class.pixels += 1.0;
                class.model += f64::from(squares[row][*column]);
                class.apart += apart;
                class.apart_squared += apart * apart;
                if *before >= 0.0 {
                    class.earlier += f64::from(*before);
                    class.later += apart;
                }
            }
        }
        for (scale, halves) in self.scales.iter_mut().zip(halves).filter(|(_, halves)| halves.pixels > 0.0) {
            let prior = PRIOR * halves.earlier / halves.pixels;
            if halves.earlier > 0.0 {
                let measured = (halves.later + prior * scale.falls) / (halves.earlier + prior);
                scale.falls = measured.clamp(0.2, 0.5);
            }
            let measured = scale.falls / (1.0 - scale.falls) * halves.apart;
            let prior = PRIOR * halves.model / halves.pixels;
            if halves.model > 0.0 {
                scale.factor = ((measured + prior * scale.factor) / (halves.model + prior)).clamp(0.125, 8.0);
            }
            if halves.apart > 0.0 {
                // The square of a normal number has twice the variance of its square.
                scale.uncertain = (halves.apart_squared / (halves.apart * halves.apart)).min(0.25);
            }
        }
    }

    /// Notes the picture's error.
    fn note_error(&mut self, norm: ErrorNorm, gains: &SquaresByGain) {
        let mut sums = [(0.0, 0.0_f64); CLASSES];
        for row in self.pixels.chunks(self.size.0) {
            for pixel in row {
                let (class, square) = (&mut sums[pixel.class() as usize], f64::from(pixel.square));
                (class.0, class.1) = (class.0 + square, class.1.max(square));
            }
        }
        let square = sums.iter().map(|(sum, _)| sum).sum::<f64>() / self.pixels.len() as f64;
        let variance: f64 =
            self.scales.iter().zip(&sums).map(|(scale, (sum, _))| scale.uncertain * sum * sum).sum();
        let rms = square.sqrt();
        let deviation =
            if rms > 0.0 { variance.sqrt() / self.pixels.len() as f64 / (2.0 * rms) } else { 0.0 };
        let value = beyond(norm).map_or(rms, |beyond| gains.exceeded_by(beyond(self.pixels.len() as f64)));
        let relative = if rms > 0.0 { value / rms } else { 1.0 };
        self.error = Some(EstimatedError { value, deviation: relative * deviation, hidden: 0.0 });
    }
}

/// Returns how many of so many pixels may have larger errors; `None` where the mean counts.
fn beyond(norm: ErrorNorm) -> Option<fn(f64) -> f64> {
    match norm {
        ErrorNorm::Rms => None,
        // A fifth on average: none in four of five pictures.
        ErrorNorm::Max => Some(|_| 0.2),
        ErrorNorm::P99 => Some(|pixels| 0.01 * pixels),
    }
}

/// Returns whether a pixel is audited after a round: at first one of each 4 by 4 pixels, then others.
fn is_audited((column, row): (usize, usize), round: u32, part: u32) -> bool {
    let block = mixed(mixed_place((column / 4, row / 4)) ^ round);
    #[expect(clippy::cast_possible_truncation, reason = "0 to 15")]
    let place = (column % 4 + 4 * (row % 4)) as u32;
    if round == 0 { block % part == place } else { mixed(block ^ place).is_multiple_of(part) }
}

/// Returns a number that is any with equal chances, of a column and a row.
fn mixed_place((column, row): (usize, usize)) -> u32 {
    #[expect(clippy::cast_possible_truncation, reason = "a film's columns and rows")]
    mixed((column as u32) ^ mixed(row as u32))
}

/// Returns a number that is any with equal chances, of another.
fn mixed(number: u32) -> u32 {
    let number = (number ^ number >> 16).wrapping_mul(0x7feb_352d);
    let number = (number ^ number >> 15).wrapping_mul(0x846c_a68b);
    number ^ number >> 16
}

#[cfg(test)]
mod tests;
