//! Adaptive sampling: adds samples per pixel until the estimated RMS error of the picture is at most a target.
//!
//! ```text
//! take a first sample of every pixel; four if more than one surface can show, a lens or a shutter is open, or an audit is due
//! loop:
//!     estimate the squared error of every pixel
//!     stop when the mean is at most the squared target
//!     find the least gain (squared error per sample) that reaches the target if every pixel above it is doubled   (`needs`)
//!     double the sample count of the pixels above it; audit some of the others
//! ```
//!
//! Each frame is sampled independently: the result does not depend on threads, tiles or other frames. Estimates from a pixel's own samples
//! are biased if the same samples decide which pixels get more: pixels whose samples agree by chance would stop too early. Six measures
//! counter this bias:
//!
//! 1. **Geometry** finds the pixels in which more than one surface can show, or the image of a small shape in a mirror, or a small highlight
//!    ([`visibility`](super::visibility)). Their error estimate is at least the error possible for their contrast and the size of the
//!    smallest feature, even if all samples agree (`evidence`). With an open shutter, it searches 16 instants before any sample is taken,
//!    and more, up to 256, in tiles where fast shapes would skip pixels between two of them.
//! 2. **Neighbours**: where the means of two plain pixels differ, the edge of a shadow, or of an image in a mirror or in glass, lies in one
//!    of them. Their estimate is at least that of an edge of this contrast, and what their samples show of it falls as at an edge.
//! 3. **The variance of single samples**, not the difference between two halves, measures the variation of a pixel: halves of
//!    well-distributed samples often agree at an edge, single samples on both sides never do.
//! 4. **Pooled first samples** measure the errors at edges (`scale`), and the brightness of small features, which geometry only bounds
//!    (`feature_light`). In one pixel they agree by chance; in the sum over many pixels they do not.
//! 5. **Pooled changes of the mean** measure how errors fall with the sample count. If e² is the squared error of the mean of n samples and
//!    q e² of 2 n samples, the squared difference between the mean of all samples and that of either half is (1 - q) e² on average. (Half the
//!    difference between the halves would be at most half of white, however bright a spark in one of them is.) Summed over all pixels of a
//!    class, which were not selected by this change, it corrects the scale of the class's estimates.
//! 6. **An audit** samples some plain pixels that no estimate selects: one in each 4 by 4 block at first, others in every round. Their
//!    variance represents their neighbourhood, unless the differences of their neighbours show as much. It finds reflections, penumbrae and
//!    fireflies that no other sample has hit, and enters the error of the picture.
//!
//! Pixels are stored packet by packet, like the sums of their samples, and loops run over the lanes of a packet. Compilers vectorize these
//! loops, with identical results at every SIMD level.

mod convergence;
mod error;
mod evidence;
mod feature_light;
mod hidden_images;
mod instants;
mod needs;
mod neighbourhood;
mod output_curve;
mod pixel_memory;
pub(crate) mod round_policy;
mod scale;
mod tile_search;

use std::ops::Range;

use rayon::prelude::*;

use fearless_simd::dispatch;

use crate::color::ErrorNorm;
use crate::trace::math::{LANES, SimdLevel, lanes, lanes_where};
use crate::trace::render::visibility::{Images, MotionTracker};
use crate::trace::scene::{PreparedCamera, PreparedScene};
use crate::trace::stages::{PACKETS, Portion, TILE, Tile};
pub(crate) use convergence::Convergence;
pub(crate) use error::ErrorTarget;
pub use error::EstimatedError;
pub(crate) use evidence::PacketSums;
use evidence::{CLASSES, Class, ErrorModel, FEWEST, PixelPacket, next_goal, single};
use feature_light::FeatureLight;
use hidden_images::HiddenImages;
pub(crate) use instants::{InstantOrder, block};
use needs::{Gain, SquaresByGain, beyond};
use neighbourhood::{Around, SIDE};
use output_curve::OutputCurve;
pub(crate) use pixel_memory::PixelMemory;
pub use round_policy::{Outlook, Replay, RoundPolicy, SharedRoundPolicy};
use scale::{ClassSums, Scale};
use tile_search::LastInstant;
pub(crate) use tile_search::TileSearch;

/// The fraction of the target that sampling aims at, because estimates scatter.
const AIM: f64 = 0.85;
/// Margin between the estimate and the target, in standard deviations of the estimate: one in fifteen normal variates exceeds it.
const SURE: f64 = 1.5;
/// Number of tiles whose squared errors are summed together.
const BAND: usize = 32;
/// Weight of the whole picture's mean audit variance in the estimate of each tile, in pixels.
const SHARED: f64 = 4.0;

/// Sums of samples, packet by packet.
pub(crate) trait SampleSums: Sync {
    /// Returns whether the picture has an alpha channel.
    fn have_alpha(&self) -> bool;

    /// Returns the sums of a packet by its index. Packets are numbered tile by tile, with tiles row by row and packets in the tile's order.
    /// `first` is the column and row of the packet's first pixel.
    fn of(&self, packet: usize, first: (usize, usize)) -> PacketSums;
}

/// The state of adaptive sampling: the sample count of each pixel, and the samples of the current round.
#[derive(Clone, Debug)]
pub(crate) struct Adaptive {
    target: ErrorTarget,
    curve: OutputCurve,
    /// Number of columns and rows of the film, of its pixels, and of tiles per row and per column.
    resolution: (u32, u32),
    pixels: f64,
    tiles: (usize, usize),
    /// Maximum sample count of a pixel.
    most: u32,
    order: InstantOrder,
    /// First sample of each instant.
    first_samples: Vec<u32>,
    /// Number of instants at which all tiles were searched for features.
    searched: u32,
    /// By tile, once the motion of shapes is known: the end of the samples at whose instants it is searched. Empty before.
    searched_until: Vec<u32>,
    round: u32,
    /// With an open shutter, until all instants are chosen that are searched in advance: the motion of shapes.
    motion: Option<MotionTracker>,
    /// Range that holds all samples of the current round.
    range: Range<u32>,
    /// Pixel packets, tile by tile.
    packets: Vec<PixelPacket>,
    /// Estimates of squared errors, before scaling.
    errors: Vec<[f32; LANES]>,
    /// With an open shutter: the last instant at which each tile was searched.
    last_instant: Vec<LastInstant>,
    /// Correction of the estimates of each class.
    scales: [Scale; CLASSES],
    error: Option<EstimatedError>,
    /// Estimated number of all samples of the picture, for the RMS norm.
    expected_samples: Option<f64>,
    /// The images in mirrors and glass, once they were searched.
    images: Option<HiddenImages>,
    /// Minimum gains chosen by the policy, one per round.
    rounds: Vec<u32>,
}

impl Adaptive {
    /// Creates the state before the first sample, reusing the memory of another picture.
    pub(crate) fn new(
        (columns, rows): (u32, u32),
        (most, order, starts_wide): (u32, InstantOrder, bool),
        target: ErrorTarget,
        PixelMemory { mut packets, errors }: PixelMemory,
    ) -> Self {
        let tiles = (columns.div_ceil(TILE) as usize, rows.div_ceil(TILE) as usize);
        let goal = if starts_wide || order.count() > 1 { next_goal(0, most) } else { 1 };
        let goal = goal.max(target.least).min(most);
        packets.clear();
        packets.reserve(tiles.0 * tiles.1 * PACKETS);
        for tile in Tile::all((columns, rows)) {
            let inside = |packet| tile.square(packet).map_or(0, |square| square.lanes());
            for packet in packets.len()..packets.len() + PACKETS {
                let place = first_pixel(packet, tiles.0);
                packets.push(PixelPacket::new(inside(packet % PACKETS), goal, most, place));
            }
        }
        let of_doubling = target.convergence.of_doubling();
        let falls = [of_doubling, of_doubling, 0.5];
        let is_open = order.count() > 1;
        Self {
            target,
            curve: OutputCurve::of(target.transfer),
            resolution: (columns, rows),
            pixels: f64::from(columns) * f64::from(rows),
            tiles,
            most,
            order,
            round: 0,
            range: 0..goal.max(next_goal(0, most)),
            packets,
            errors,
            last_instant: vec![LastInstant::NONE; if is_open { tiles.0 * tiles.1 } else { 0 }],
            first_samples: order.first_samples(),
            searched: 0,
            searched_until: Vec::new(),
            motion: is_open.then(|| MotionTracker::new((columns, rows))),
            scales: falls.map(Scale::new),
            error: None,
            expected_samples: None,
            images: None,
            rounds: Vec::new(),
        }
    }

    /// Returns the memory.
    pub(crate) fn into_memory(self) -> PixelMemory {
        PixelMemory { packets: self.packets, errors: self.errors }
    }

    /// Returns the estimate of the picture's error; `None` before the first estimate.
    pub(crate) fn error(&self) -> Option<EstimatedError> {
        let hidden =
            self.images.as_ref().map_or(0.0, |images| images.square(&self.packets) / self.pixels).sqrt();
        self.error.map(|error| EstimatedError { hidden, ..error })
    }

    /// Returns the estimated RMS error of a tile by its index; `None` before the first estimate.
    pub(crate) fn tile_error(&self, index: usize) -> Option<f32> {
        self.error?;
        let packets = &self.packets[index * PACKETS..][..PACKETS];
        let (mut squares, mut pixels) = (0.0, 0);
        for packet in packets {
            squares += packet.sum_of_squares(packet.inside());
            pixels += packet.inside().count_ones();
        }
        Some(single((squares / f64::from(pixels)).sqrt()))
    }

    /// Returns the estimated number of all samples of the picture. `None` in the first round, for other norms than RMS, and where a policy
    /// chooses the samples.
    pub(crate) fn expected_samples(&self) -> Option<f64> {
        self.expected_samples
    }

    /// Returns the minimum gains chosen by the policy, one per round.
    pub(crate) fn rounds(&self) -> &[u32] {
        &self.rounds
    }

    /// Returns whether no instant was searched for the features of pixels.
    pub(crate) fn is_unsearched(&self) -> bool {
        self.searched == 0
    }

    /// Returns the tiles to search for the features of their pixels at an instant.
    pub(crate) fn tiles_to_search(&mut self, instant: u32) -> Vec<TileSearch<'_>> {
        let Self { most, ref searched_until, resolution, .. } = *self;
        let sample = self.first_samples[instant as usize];
        let last = self.last_instant.iter_mut().map(Some).chain(std::iter::repeat_with(|| None));
        let tiles = Tile::all(resolution).zip(self.packets.chunks_mut(PACKETS)).zip(last).enumerate();
        let is_due = |tile: usize| searched_until.get(tile).is_none_or(|end| sample < *end);
        let tiles = tiles.filter(|(index, _)| is_due(*index));
        tiles.map(|(_, ((tile, packets), last))| TileSearch { tile, packets, last, most }).collect()
    }

    /// Notes that the tiles were searched at an instant. With an open shutter, adds the motion of shapes since the last instant.
    pub(crate) fn end_search(&mut self, (scene, camera): (&PreparedScene, &PreparedCamera)) {
        if self.searched_until.is_empty() {
            self.searched += 1;
        }
        self.motion.iter_mut().for_each(|motion| motion.add(scene, camera));
    }

    /// Returns the instants to search in addition to those that were searched, which are spread evenly: shapes may have skipped pixels of some
    /// tiles between them. Empty from the second call on.
    pub(crate) fn instants_between(&mut self) -> Vec<u32> {
        let Some(motion) = self.motion.take() else { return Vec::new() };
        let (searched, count) = (self.searched, self.order.count());
        let until = |steps: &u32| searched.saturating_mul(*steps).min(count).next_power_of_two();
        self.searched_until = motion.steps().iter().map(until).collect();
        let end = self.searched_until.iter().copied().max().unwrap_or(searched);
        self.order.instants(searched..end.max(searched))
    }

    /// Returns whether images in mirrors and glass have not been searched yet.
    pub(crate) fn wants_images(&self) -> bool {
        self.images.is_none()
    }

    /// Stores the images in mirrors and glass that the picture may show, before the first samples.
    pub(crate) fn record_images(&mut self, Images { placed, hidden }: &Images) {
        self.images = Some(HiddenImages::new(hidden, self.curve));
        let side = TILE as usize;
        for ((column, row), feature) in placed {
            let (column, row) = (*column as usize, *row as usize);
            let (packet, lane) = Tile::lane_of(column % side, row % side);
            let tile = row / side * self.tiles.0 + column / side;
            self.packets[tile * PACKETS + packet].join(lane, *feature, self.most);
        }
    }

    /// Returns whether the shutter is open, so that shapes may move through pixels.
    pub(crate) fn is_open(&self) -> bool {
        self.order.count() > 1
    }

    /// Returns the instants of this round's samples in chronological order.
    pub(crate) fn instants(&self) -> Vec<u32> {
        self.order.instants(self.range.clone())
    }

    /// Collects the samples that a tile's pixels take at an instant in this round.
    pub(crate) fn portions(&self, tile: &Tile, instant: u32, portions: &mut Vec<Portion>) {
        portions.clear();
        let sample = self.first_samples[instant as usize];
        let packets = self.packets[self.first_packet(tile)..].iter().zip((0_u32..).step_by(LANES));
        let packets = packets.take(PACKETS).filter(|(pixels, _)| pixels.active != 0);
        dispatch!(SimdLevel::best().level(), _simd => {
            for (PixelPacket { active, taken, goal, .. }, first_pixel) in packets {
                let due = active & lanes_where(|lane| self.order.next_at(taken[lane], sample) < goal[lane]);
                for (pixel, lane) in (first_pixel..).zip(0..LANES).filter(|(_, lane)| due >> lane & 1 == 1) {
                    portions.extend(self.order.portion(pixel, taken[lane]..goal[lane], sample));
                }
            }
        });
    }

    /// Estimates errors after a round and chooses the samples of the next one, as required by the target or by `policy`. Returns `false` if
    /// the picture is finished.
    pub(crate) fn judge(&mut self, sums: &impl SampleSums, policy: Option<&SharedRoundPolicy>) -> bool {
        self.update(sums);
        self.estimate(sums.have_alpha());
        // Policies support only the RMS norm.
        let norm = if policy.is_some() { ErrorNorm::Rms } else { self.target.norm };
        let gains = self.scale(norm);
        let goes_on = self.least_gain(&gains, policy).is_some_and(|least| self.choose(norm, least));
        if !goes_on {
            self.range = 0..0;
            self.packets.iter_mut().for_each(|pixels| pixels.active = 0);
        }
        goes_on
    }

    /// Updates pixel statistics with the samples of a round.
    fn update(&mut self, sums: &impl SampleSums) {
        let (across, curve) = (self.tiles.0, self.curve);
        // With an open shutter, moving features are known only where they are at the sampled instants.
        let measures_light = self.round == 0 && !self.is_open();
        let chunks = self.packets.par_chunks_mut(PACKETS).enumerate();
        let light = chunks.map(|(tile, packets)| {
            let mut light = FeatureLight::default();
            dispatch!(SimdLevel::best().level(), _simd => {
                for (packet, pixels) in (tile * PACKETS..).zip(packets) {
                    pixels.doubled = 0;
                    if pixels.active != 0 {
                        let sums = sums.of(packet, first_pixel(packet, across));
                        pixels.update(curve, &sums);
                        if measures_light {
                            pixels.measure_light(&sums, &mut light);
                        }
                    }
                }
            });
            light
        });
        // Summed in the order of the tiles, so that the result does not depend on threads.
        let light: Vec<FeatureLight> = light.collect();
        if measures_light {
            let light = light.into_iter().fold(FeatureLight::default(), FeatureLight::merge);
            self.packets.par_iter_mut().for_each(|pixels| pixels.dim(&light));
        }
    }

    /// Estimates the squared errors of all pixels, and corrects the scale of each class.
    fn estimate(&mut self, alpha: bool) {
        let edges = self.target.convergence == Convergence::Edges;
        let least_part = self.target.convergence.least_part();
        let model =
            ErrorModel { curve: self.curve, edges, least_part, alpha, target: single(self.target.error) };
        let (audited, is_first) = (self.audited_variance(model), self.round == 0);
        let mut errors = std::mem::take(&mut self.errors);
        errors.resize(self.packets.len(), [0.0; LANES]);
        let sums: Vec<[ClassSums; CLASSES]> = errors
            .par_chunks_mut(PACKETS)
            .zip(audited)
            .enumerate()
            .map(|(tile, (errors, audited))| {
                let mut sums = [ClassSums::default(); CLASSES];
                dispatch!(SimdLevel::best().level(), _simd => {
                    for (packet, errors) in (tile * PACKETS..).zip(errors) {
                        let pixels = &self.packets[packet];
                        let around = self.around(packet);
                        let is_outdated = around.iter().flatten().flatten().any(|pixels| pixels.changed != 0);
                        let before = if is_outdated { None } else { Some(*errors) };
                        *errors = pixels.errors(model, (audited, before), around);
                        for (class, sums) in pixels.classes.iter().zip(&mut sums) {
                            lanes(class & pixels.doubled).for_each(|lane| sums.add_doubled(pixels, lane, errors));
                        }
                        let edge = Class::Edge as usize;
                        let first = if is_first { pixels.classes[edge] } else { 0 };
                        for lane in lanes(first).filter(|lane| pixels.taken[*lane] >= FEWEST) {
                            let shown = pixels.shown_error(lane, pixels.variance[lane], model);
                            sums[edge].add_first(errors[lane], shown);
                        }
                    }
                });
                sums
            })
            .collect();
        for (class, scale) in self.scales.iter_mut().enumerate() {
            let mut all = ClassSums::default();
            sums.iter().for_each(|sums| all += sums[class]);
            scale.correct(&all);
        }
        self.errors = errors;
    }

    /// Scales the estimates of all pixels, and estimates the picture's error. Returns the histogram of gains.
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
                            let taken = pixels.taken[lane];
                            let more = next_goal(taken, most) - taken;
                            gains.add(pixels.gain(lane, norm, 0), count, pixels.square[lane], more, most - taken);
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
        self.record_error(norm, &gains, sums);
        gains
    }

    /// Chooses the pixels to sample in the next round: those with sufficient gain, and some plain pixels to audit. Returns whether any
    /// pixel has sufficient gain; an audit alone does not justify another round.
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

    /// Returns the minimum gain for doubling a pixel's sample count in the next round; `None` if there is no further round.
    fn least_gain(&mut self, gains: &SquaresByGain, policy: Option<&SharedRoundPolicy>) -> Option<Gain> {
        let error = self.error?;
        let certain = error.value / (error.value + SURE * error.deviation);
        let aim = AIM.min(certain) * self.target.error;
        if error.value <= aim {
            return None;
        }
        let (falls, pixels) = (self.scales[Class::Edge as usize].falls, self.pixels);
        let taken = |pixels: &PixelPacket| {
            lanes(pixels.inside()).map(|lane| u64::from(pixels.taken[lane])).sum::<u64>()
        };
        let samples = self.packets.iter().map(taken).sum::<u64>() as f64;
        let Some(policy) = policy else {
            return Some(match beyond(self.target.norm) {
                None => {
                    let (least, more) = gains.least_for(aim * aim * pixels, falls);
                    self.expected_samples = Some(samples + more);
                    least
                }
                Some(beyond) => gains.least_to_exceed(aim, beyond(pixels)),
            });
        };
        let least =
            round_policy::locked(policy).least_gain(&Outlook { gains, pixels, falls, error, samples })?;
        // Lower the threshold so that at least one pixel is sampled: with few pixels left, the random parts of all gains may lie below it.
        let largest = |(packet, pixels): (usize, &PixelPacket)| {
            let gains = pixels.gains(first_pixel(packet, self.tiles.0), ErrorNorm::Rms);
            lanes(pixels.unfinished(self.most)).map(|lane| gains[lane]).max()
        };
        let largest = self.packets.par_iter().enumerate().filter_map(largest).max()?;
        let least = largest.min(least.into());
        self.rounds.push(least.into());
        Some(least)
    }

    /// Returns the variance of one sample over the [audited](PixelPacket::audit) pixels around each tile, tile by tile.
    fn audited_variance(&self, model: ErrorModel) -> Vec<f32> {
        let (across, down) = self.tiles;
        let add = |all: (f64, f64), some: (f64, f64)| (all.0 + some.0, all.1 + some.1);
        let of_tile = |(tile, packets): (usize, &[PixelPacket])| {
            let packets = (tile * PACKETS..).zip(packets);
            packets.map(|(packet, pixels)| pixels.audit(model, || self.around(packet))).fold((0.0, 0.0), add)
        };
        let tiles: Vec<(f64, f64)> = self.packets.par_chunks(PACKETS).enumerate().map(of_tile).collect();
        let all = tiles.iter().copied().fold((0.0, 0.0), add);
        let mean = if all.1 > 0.0 { all.0 / all.1 } else { 0.0 };
        let around = |tile: usize| {
            let (i, j) = (tile % across, tile / across);
            let (mut sum, mut count) = (SHARED * mean, SHARED);
            for row in j.saturating_sub(1)..down.min(j + 2) {
                for tile in &tiles[row * across..][i.saturating_sub(1)..across.min(i + 2)] {
                    (sum, count) = add((sum, count), *tile);
                }
            }
            single(sum / count)
        };
        (0..tiles.len()).map(around).collect()
    }

    /// Returns a packet and its eight neighbours, row by row.
    fn around(&self, packet: usize) -> Around<'_, PixelPacket> {
        let (column, row) = first_pixel(packet, self.tiles.0);
        let of = |column: usize, row: usize| {
            // Indices below the first wrap to large ones, and fail the bounds check below.
            let (i, j) = (column / TILE as usize, row / TILE as usize);
            let (packet, _) = Tile::lane_of(column % TILE as usize, row % TILE as usize);
            (i < self.tiles.0 && j < self.tiles.1)
                .then(|| &self.packets[(j * self.tiles.0 + i) * PACKETS + packet])
        };
        let near = |place: usize| [place.wrapping_sub(SIDE), place, place + SIDE];
        near(row).map(|row| near(column).map(|column| of(column, row)))
    }

    /// Returns the index of a tile's first packet.
    fn first_packet(&self, tile: &Tile) -> usize {
        ((tile.j / TILE) as usize * self.tiles.0 + (tile.i / TILE) as usize) * PACKETS
    }

    /// Stores the picture's error, given the sum of squared errors of each class.
    fn record_error(&mut self, norm: ErrorNorm, gains: &SquaresByGain, sums: [f64; CLASSES]) {
        let rms = (sums.iter().sum::<f64>() / self.pixels).sqrt();
        let variance: f64 =
            self.scales.iter().zip(sums).map(|(scale, sum)| scale.uncertain * sum * sum).sum();
        let deviation = if rms > 0.0 { variance.sqrt() / self.pixels / (2.0 * rms) } else { 0.0 };
        let value = beyond(norm).map_or(rms, |beyond| gains.exceeded_by(beyond(self.pixels)));
        let relative = if rms > 0.0 { value / rms } else { 1.0 };
        self.error = Some(EstimatedError { value, deviation: relative * deviation, hidden: 0.0 });
    }
}

/// An empty span of samples (first, end).
const NO_SAMPLES: (u32, u32) = (u32::MAX, 0);

/// Returns the smallest span (first, end) that contains both spans.
fn joined(one: (u32, u32), other: (u32, u32)) -> (u32, u32) {
    (one.0.min(other.0), one.1.max(other.1))
}

/// Returns the column and row of a packet's first pixel, with `across` tiles per row.
fn first_pixel(packet: usize, across: usize) -> (usize, usize) {
    #[expect(clippy::cast_possible_truncation, reason = "below PACKETS")]
    let (column, row) = Tile::place((packet % PACKETS) as u32);
    let (tile, side) = (packet / PACKETS, TILE as usize);
    (tile % across * side + column as usize, tile / across * side + row as usize)
}

#[cfg(test)]
mod tests;
