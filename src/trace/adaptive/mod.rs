//! Adaptive sampling: pixels get samples until the estimated RMS error of the picture is at most a target.
//!
//! ```text
//! take a first sample of every pixel, four where more than one surface can show, a lens or a shutter is open, or an audit is due
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
//!
//! Pixels are kept packet by packet, as the sums of their samples are, and loops go through the lanes of a packet: compilers make vectors of
//! them, with the same numbers at every level.

mod evidence;
mod instants;
mod needs;
mod output_curve;
pub(crate) mod round_policy;
mod scale;

use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;

use fearless_simd::dispatch;

use crate::color::{ErrorNorm, Transfer};
use crate::trace::math::{LANES, SimdLevel, lanes};
use crate::trace::rays::ShapeId;
use crate::trace::scene::{Camera, PreparedScene, SIDE};
use crate::trace::stages::{PACKETS, Portion, TILE, Tile};
use crate::trace::visibility::{CoverPacket, Feature, Image, TileFeatures, UNCOVERED};
pub(crate) use evidence::PacketSums;
use evidence::{CLASSES, Class, ErrorModel, FEWEST, PixelPacket, Surroundings, next_goal, single};
pub(crate) use instants::{InstantOrder, block};
use needs::{Gain, SquaresByGain};
use output_curve::OutputCurve;
pub use round_policy::{Outlook, Replay, RoundPolicy, SharedRoundPolicy};
use scale::{Halves, Scale};

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
/// Estimates are to lie below the target by so many of their standard deviations: one normal number in fifteen lies farther out.
const SURE: f64 = 1.5;
/// The tiles whose squares are summed together.
const BAND: usize = 32;
/// The weight of the whole picture's audit in every tile's, in pixels.
const SHARED: f64 = 4.0;

/// Sums of samples, packet by packet.
pub(crate) trait SampleSums: Sync {
    /// Returns whether the picture has alpha.
    fn have_alpha(&self) -> bool;

    /// Returns the sums of a packet by its index: tile by tile, row by row, and in a tile as it has them. Its first pixel is in this column
    /// and row.
    fn of(&self, packet: usize, first: (usize, usize)) -> PacketSums;
}

/// The memory of a picture's pixels.
#[derive(Clone, Debug, Default)]
pub(crate) struct PixelMemory {
    packets: Vec<PixelPacket>,
    errors: Vec<[f32; LANES]>,
}

impl PixelMemory {
    /// Returns how many samples each pixel of the last picture took, row by row; nothing if there was none of this size.
    pub(crate) fn counts(&self, (columns, rows): (u32, u32)) -> Vec<u32> {
        let across = columns.div_ceil(TILE);
        if self.packets.len() != (across * rows.div_ceil(TILE)) as usize * PACKETS {
            return Vec::new();
        }
        let taken = |column: u32, row: u32| {
            let (packet, lane) = Tile::lane_of((column % TILE) as usize, (row % TILE) as usize);
            let tile = (row / TILE * across + column / TILE) as usize;
            self.packets[tile * PACKETS + packet].taken[lane]
        };
        (0..rows).flat_map(|row| (0..columns).map(move |column| taken(column, row))).collect()
    }
}

/// The samples of a picture's pixels: how many each has, and which are next.
#[derive(Clone, Debug)]
pub(crate) struct Adaptive {
    target: ErrorTarget,
    curve: OutputCurve,
    /// Pixels of the film, and tiles in a row and in a column.
    pixels: f64,
    tiles: (usize, usize),
    /// The most samples of a pixel, and the fewest in the first round where they are to show how they vary.
    most: u32,
    first: u32,
    order: InstantOrder,
    /// By instant: the first sample that belongs to it.
    first_samples: Vec<u32>,
    round: u32,
    /// The samples that pixels take in this round are among these.
    range: Range<u32>,
    /// Tile by tile.
    packets: Vec<PixelPacket>,
    /// The estimates of square errors, not scaled.
    errors: Vec<[f32; LANES]>,
    /// While the shutter is open: the shapes that covered pixels whole at the last instant that was searched.
    covers: Vec<CoverPacket>,
    /// By class: by what estimates are multiplied.
    scales: [Scale; CLASSES],
    error: Option<EstimatedError>,
    /// The sums of the squares of errors that images make if they are missed, by quarters of the powers of two of their areas.
    images: Option<BTreeMap<i32, f64>>,
    /// The least gains of the rounds that a policy has chosen.
    rounds: Vec<u32>,
}

impl Adaptive {
    /// Creates the state before the first sample, in the memory of another picture.
    pub(crate) fn new(
        (columns, rows): (u32, u32),
        (most, order, starts_wide): (u32, InstantOrder, bool),
        target: ErrorTarget,
        PixelMemory { mut packets, errors }: PixelMemory,
    ) -> Self {
        let tiles = (columns.div_ceil(TILE) as usize, rows.div_ceil(TILE) as usize);
        let first = FEWEST.min(most);
        let goal = if starts_wide || order.count() > 1 { first } else { 1 };
        let goal = goal.max(target.least).min(most);
        packets.clear();
        packets.reserve(tiles.0 * tiles.1 * PACKETS);
        for tile in Tile::all((columns, rows)) {
            let inside = |packet| tile.square(packet).map_or(0, |square| square.lanes());
            for packet in packets.len()..packets.len() + PACKETS {
                let place = first_pixel(packet, tiles.0);
                packets.push(PixelPacket::new(inside(packet % PACKETS), goal, first, place));
            }
        }
        let falls = [0.5, target.convergence.of_doubling(), 0.5];
        let covered = if order.count() > 1 { packets.len() } else { 0 };
        Self {
            target,
            curve: OutputCurve::of(target.transfer),
            pixels: f64::from(columns) * f64::from(rows),
            tiles,
            most,
            first,
            order,
            round: 0,
            range: 0..goal.max(first),
            packets,
            errors,
            covers: vec![CoverPacket::all(UNSEEN); covered],
            first_samples: order.first_samples(),
            scales: falls.map(Scale::new),
            error: None,
            images: None,
            rounds: Vec::new(),
        }
    }

    /// Returns the memory.
    pub(crate) fn into_memory(self) -> PixelMemory {
        PixelMemory { packets: self.packets, errors: self.errors }
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
        self.round == 0 || (self.is_open() && self.range.end <= self.order.count())
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
            let change = f64::from(self.curve.value(radiance * single(area.min(1.0))));
            *images.entry(size).or_insert(0.0) += count * change * change * area.max(1.0);
        }
        self.images = Some(images);
    }

    /// Returns the mean square of the errors of images that no sample may have met.
    fn hidden_square(&self) -> f64 {
        let Some(images) = self.images.as_ref().filter(|images| !images.is_empty()) else { return 0.0 };
        let (mut pixels, mut samples) = (0.0, 0.0);
        for packet in &self.packets {
            for lane in lanes(packet.classes[Class::Plain as usize]) {
                (pixels, samples) = (pixels + 1.0, samples + f64::from(packet.taken[lane]));
            }
        }
        if pixels == 0.0 {
            return 0.0;
        }
        let missed = |(size, square): (&i32, &f64)| {
            let area = libm::exp2((f64::from(*size) + 0.5) / 4.0);
            square * libm::exp(-area * samples / pixels)
        };
        images.iter().map(missed).sum::<f64>() / self.pixels
    }

    /// Returns whether the shutter is open: shapes may move through pixels.
    pub(crate) fn is_open(&self) -> bool {
        self.order.count() > 1
    }

    /// Returns the instants that this round's samples belong to, in the order of time.
    pub(crate) fn instants(&self) -> Vec<u32> {
        self.order.instants(self.range.clone())
    }

    /// Collects the samples that a tile's pixels take at an instant in this round. Features that were found at this instant count as if they
    /// were noted.
    pub(crate) fn portions(
        &self,
        tile: &Tile,
        instant: u32,
        found: Option<&TileFeatures>,
        portions: &mut Vec<Portion>,
    ) {
        portions.clear();
        let found = found.filter(|_| self.round == 0);
        let sample = self.first_samples[instant as usize];
        let packets = self.packets[self.first_packet(tile)..].iter().zip((0_u32..).step_by(LANES));
        for (packet, (pixels, first_pixel)) in packets.take(PACKETS).enumerate() {
            let found = found.map(|found| found.of(packet).0);
            for (pixel, lane) in (first_pixel..).zip(0..LANES) {
                if pixels.active >> lane & 1 == 1 {
                    let is_plain = found.is_none_or(|found| found[lane] == Feature::NONE);
                    let first = if is_plain { 0 } else { self.first };
                    let samples = pixels.taken[lane]..pixels.goal[lane].max(first);
                    portions.extend(self.order.portion(pixel, samples, sample));
                }
            }
        }
    }

    /// Notes the features of a tile's pixels at an instant.
    pub(crate) fn note_features(&mut self, tile: &Tile, found: &TileFeatures) {
        let (first, wide) = (self.first_packet(tile), self.first);
        let mut covers = self.covers.get_mut(first..).unwrap_or_default().iter_mut();
        for (packet, pixels) in self.packets[first..][..PACKETS].iter_mut().enumerate() {
            let (features, cover) = found.of(packet);
            let is = |lane: &usize| features[*lane] != Feature::NONE;
            lanes(pixels.inside()).filter(is).for_each(|lane| pixels.join(lane, features[lane], wide));
            let Some(before) = covers.next() else { continue };
            // What covers a pixel at one instant and not at another moves through it.
            let differs = |lane: usize| (before.ids[lane] != cover.ids[lane]) & (before.ids[lane] != UNSEEN);
            let moved = (0..LANES).fold(0, |moved, lane| moved | u32::from(differs(lane)) << lane);
            for lane in lanes(moved & pixels.inside()) {
                let radiance = before.radiance[lane].max(cover.radiance[lane]);
                pixels.join(lane, Feature { area: 1.0, radiance }, wide);
            }
            *before = *cover;
        }
    }

    /// Estimates errors after a round, and chooses the samples of the next one: those that the target asks for, or a policy. Returns `false` if
    /// the picture is done.
    pub(crate) fn judge(&mut self, sums: &impl SampleSums, policy: Option<&SharedRoundPolicy>) -> bool {
        self.update(sums);
        self.estimate(sums.have_alpha());
        // A policy knows only one norm.
        let norm = if policy.is_some() { ErrorNorm::Rms } else { self.target.norm };
        let gains = self.scale(norm);
        let goes_on = self.least_gain(&gains, policy).is_some_and(|least| self.choose(norm, least));
        if !goes_on {
            self.range = 0..0;
            self.packets.iter_mut().for_each(|pixels| pixels.active = 0);
        }
        goes_on
    }

    /// Takes the samples of a round into account.
    fn update(&mut self, sums: &impl SampleSums) {
        let (across, curve) = (self.tiles.0, self.curve);
        self.packets.par_chunks_mut(PACKETS).enumerate().for_each(|(tile, packets)| {
            dispatch!(SimdLevel::best().level(), _simd => {
                for (packet, pixels) in (tile * PACKETS..).zip(packets) {
                    pixels.doubled = 0;
                    if pixels.active != 0 {
                        pixels.update(curve, &sums.of(packet, first_pixel(packet, across)));
                    }
                }
            });
        });
    }

    /// Estimates the square errors of all pixels, and how they are to be scaled.
    fn estimate(&mut self, alpha: bool) {
        let edges = self.target.convergence == Convergence::Edges;
        let model = ErrorModel { curve: self.curve, edges, alpha };
        let audited = self.audited_variance();
        let mut errors = std::mem::take(&mut self.errors);
        errors.resize(self.packets.len(), [0.0; LANES]);
        let halves: Vec<[Halves; CLASSES]> = errors
            .par_chunks_mut(PACKETS)
            .zip(audited)
            .enumerate()
            .map(|(tile, (errors, audited))| {
                let mut halves = [Halves::default(); CLASSES];
                dispatch!(SimdLevel::best().level(), _simd => {
                    for (packet, errors) in (tile * PACKETS..).zip(errors) {
                        let pixels = &self.packets[packet];
                        *errors = pixels.errors(model, audited, || Surroundings::of(self.around(packet)));
                        for (class, halves) in pixels.classes.iter().zip(&mut halves) {
                            lanes(class & pixels.doubled).for_each(|lane| halves.add(pixels, lane, errors));
                        }
                    }
                });
                halves
            })
            .collect();
        for (class, scale) in self.scales.iter_mut().enumerate() {
            let mut all = Halves::default();
            halves.iter().for_each(|halves| all += halves[class]);
            scale.correct(&all);
        }
        self.errors = errors;
    }

    /// Scales the estimates of all pixels, and estimates the picture's error. Returns the gains that pixels promise.
    fn scale(&mut self, norm: ErrorNorm) -> SquaresByGain {
        let (most, factors) = (self.most, self.scales.map(|scale| single(scale.factor)));
        let bands = self.packets.par_chunks_mut(BAND * PACKETS).zip(self.errors.par_chunks(BAND * PACKETS));
        let found: Vec<(SquaresByGain, [f64; CLASSES])> = bands
            .map(|(packets, errors)| {
                let (mut gains, mut sums) = (SquaresByGain::default(), [0.0; CLASSES]);
                dispatch!(SimdLevel::best().level(), _simd => {
                    for (pixels, errors) in packets.iter_mut().zip(errors) {
                        pixels.scale(errors, factors);
                        for (sum, class) in sums.iter_mut().zip(pixels.classes) {
                            *sum += pixels.sum_of_squares(class);
                        }
                        let mut add = |lane: usize, count| {
                            let more = next_goal(pixels.taken[lane], most) - pixels.taken[lane];
                            gains.add(pixels.gain(lane, norm, 0), count, pixels.square[lane], more);
                        };
                        let alike = pixels.alike();
                        lanes(alike).take(1).for_each(|lane| add(lane, alike.count_ones()));
                        lanes(pixels.inside() & !alike).for_each(|lane| add(lane, 1));
                    }
                });
                (gains, sums)
            })
            .collect();
        let (mut gains, mut sums) = (SquaresByGain::default(), [0.0; CLASSES]);
        for (band, band_sums) in &found {
            gains += band;
            sums.iter_mut().zip(band_sums).for_each(|(sum, band)| *sum += band);
        }
        self.note_error(norm, &gains, sums);
        gains
    }

    /// Chooses the pixels that take samples in the next round: those that promise enough, and some plain ones. Returns whether there are
    /// any; an audit alone is no reason for another round.
    fn choose(&mut self, norm: ErrorNorm, least: Gain) -> bool {
        let (round, across, most) = (self.round, self.tiles.0, self.most);
        self.round += 1;
        let chosen = self.packets.par_chunks_mut(PACKETS).enumerate().map(|(tile, packets)| {
            let (mut any, mut span) = (false, NO_SAMPLES);
            dispatch!(SimdLevel::best().level(), _simd => {
                for (packet, pixels) in (tile * PACKETS..).zip(packets) {
                    any |= pixels.choose(first_pixel(packet, across), (norm, least), round, most);
                    for lane in lanes(pixels.active) {
                        span = joined(span, (pixels.taken[lane], pixels.goal[lane]));
                    }
                }
            });
            (any, span)
        });
        let join = |(any, span), (other, others)| (any | other, joined(span, others));
        let (any, (first, end)) = chosen.reduce(|| (false, NO_SAMPLES), join);
        self.range = first..end;
        any
    }

    /// Returns the least gain with which samples are doubled in the next round; `None` if there is no further one.
    fn least_gain(&mut self, gains: &SquaresByGain, policy: Option<&SharedRoundPolicy>) -> Option<Gain> {
        let error = self.error?;
        let certain = error.value / (error.value + SURE * error.deviation);
        let aim = AIM.min(certain) * self.target.error;
        if error.value <= aim {
            return None;
        }
        let (falls, pixels) = (self.scales[Class::Edge as usize].falls, self.pixels);
        let Some(policy) = policy else {
            return Some(match beyond(self.target.norm) {
                None => gains.least_for(aim * aim * pixels, falls).0,
                Some(beyond) => gains.least_to_exceed(aim, beyond(pixels)),
            });
        };
        let samples = |pixels: &PixelPacket| {
            lanes(pixels.inside()).map(|lane| f64::from(pixels.taken[lane])).sum::<f64>()
        };
        let samples = self.packets.iter().map(samples).sum();
        let least =
            round_policy::locked(policy).least_gain(&Outlook { gains, pixels, falls, error, samples })?;
        // At least one pixel is sampled: of few, none may have enough by chance.
        let largest = |(packet, pixels): (usize, &PixelPacket)| {
            let gains = pixels.gains(first_pixel(packet, self.tiles.0), ErrorNorm::Rms);
            lanes(pixels.unfinished(self.most)).map(|lane| gains[lane]).max()
        };
        let largest = self.packets.par_iter().enumerate().filter_map(largest).max()?;
        let least = largest.min(least.into());
        self.rounds.push(least.into());
        Some(least)
    }

    /// Returns the variance of one sample of audited pixels around each tile, tile by tile.
    fn audited_variance(&self) -> Vec<f32> {
        let (across, down) = self.tiles;
        let of_tile = |packets: &[PixelPacket]| {
            let (mut sum, mut count) = (0.0, 0.0);
            for pixels in packets {
                for lane in lanes(pixels.audited & pixels.classes[Class::Plain as usize]) {
                    if pixels.taken[lane] >= FEWEST {
                        (sum, count) = (sum + f64::from(pixels.variance[lane]), count + 1.0);
                    }
                }
            }
            (sum, count)
        };
        let tiles: Vec<(f64, f64)> = self.packets.par_chunks(PACKETS).map(of_tile).collect();
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
            single(sum / count)
        };
        (0..tiles.len()).map(around).collect()
    }

    /// Returns a packet and the eight around it, row by row.
    fn around(&self, packet: usize) -> [[Option<&PixelPacket>; 3]; 3] {
        let side = SIDE as usize;
        let (column, row) = first_pixel(packet, self.tiles.0);
        let of = |column: usize, row: usize| {
            // Less than the first is more than the last.
            let (i, j) = (column / TILE as usize, row / TILE as usize);
            let (packet, _) = Tile::lane_of(column % TILE as usize, row % TILE as usize);
            (i < self.tiles.0 && j < self.tiles.1)
                .then(|| &self.packets[(j * self.tiles.0 + i) * PACKETS + packet])
        };
        let near = |place: usize| [place.wrapping_sub(side), place, place + side];
        near(row).map(|row| near(column).map(|column| of(column, row)))
    }

    /// Returns the index of a tile's first packet.
    fn first_packet(&self, tile: &Tile) -> usize {
        ((tile.j / TILE) as usize * self.tiles.0 + (tile.i / TILE) as usize) * PACKETS
    }

    /// Notes the picture's error, where the square errors of pixels of each class have these sums.
    fn note_error(&mut self, norm: ErrorNorm, gains: &SquaresByGain, sums: [f64; CLASSES]) {
        let rms = (sums.iter().sum::<f64>() / self.pixels).sqrt();
        let variance: f64 =
            self.scales.iter().zip(sums).map(|(scale, sum)| scale.uncertain * sum * sum).sum();
        let deviation = if rms > 0.0 { variance.sqrt() / self.pixels / (2.0 * rms) } else { 0.0 };
        let value = beyond(norm).map_or(rms, |beyond| gains.exceeded_by(beyond(self.pixels)));
        let relative = if rms > 0.0 { value / rms } else { 1.0 };
        self.error = Some(EstimatedError { value, deviation: relative * deviation, hidden: 0.0 });
    }
}

/// The cover of pixels that were not searched yet: no shape's.
const UNSEEN: ShapeId = ShapeId(UNCOVERED.0 - 1);

/// A first sample and an end, of no samples.
const NO_SAMPLES: (u32, u32) = (u32::MAX, 0);

/// Returns the least span of samples, a first one and an end, that holds two.
fn joined(one: (u32, u32), other: (u32, u32)) -> (u32, u32) {
    (one.0.min(other.0), one.1.max(other.1))
}

/// Returns the column and the row of a packet's first pixel, where so many tiles are in a row.
fn first_pixel(packet: usize, across: usize) -> (usize, usize) {
    #[expect(clippy::cast_possible_truncation, reason = "below PACKETS")]
    let (column, row) = Tile::place((packet % PACKETS) as u32);
    let (tile, side) = (packet / PACKETS, TILE as usize);
    (tile % across * side + column as usize, tile / across * side + row as usize)
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

#[cfg(test)]
mod tests;
