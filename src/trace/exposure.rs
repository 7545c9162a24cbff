//! The fast path: tiles over all threads.

use std::fmt;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use fearless_simd::dispatch;
use rayon::prelude::*;

use crate::color::{Encoding, Linear, Rgb};
use crate::trace::adaptive::{Adaptive, BAND, BandSums, ErrorTarget, PixelErrors, Portion, Rounds};
use crate::trace::effects::Effects;
use crate::trace::effort::Effort;
use crate::trace::film::{AlphaFilm, Film};
use crate::trace::light::RenderContext;
use crate::trace::math::{Colors, Numbers, Sampling, SimdLevel, Vectors};
use crate::trace::query::{Intersector, Textbook};
use crate::trace::scene::{Camera, Precision, PreparedScene, SIDE};
use crate::trace::stages::{PACKETS, TILE, Tile, TileBuffers, TileLanes, render_sample};
use crate::trace::tile_light::{NO_SUMS, TileLight, TileSamples, TileSums, means};
use crate::trace::work_queue::WorkQueue;

/// What may end tracing before all is traced.
#[derive(Clone, Copy)]
pub struct Signals<'a> {
    /// Once it is true tracing ends at once: samples of tiles that are in hand are lost. It must stay true until then.
    pub cancelled: &'a AtomicBool,
    /// Asked from time to time: is it time to see what there is? Samples in hand are finished.
    pub pause: &'a (dyn Fn() -> bool + Sync),
}

impl<'a> Signals<'a> {
    /// Nothing else but `cancelled`.
    #[must_use]
    pub fn unless(cancelled: &'a AtomicBool) -> Self {
        Self { cancelled, pause: &|| false }
    }
}

impl fmt::Debug for Signals<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Signals").field("cancelled", self.cancelled).finish_non_exhaustive()
    }
}

/// A picture in the making: samples are added to it, moment after moment, and in the end it is developed. What ends before all
/// are added can go on later, to the same bits.
#[derive(Clone, Debug)]
pub struct Exposure<E: Encoding = Linear> {
    width: u32,
    height: u32,
    rounds: Rounds,
    /// Which pixels get more samples, if not all get as many.
    adaptive: Option<Adaptive>,
    tiles: Vec<ExposedTile>,
    /// How the film keeps pixels in the end.
    encoding: E,
    pixels: Pixels<E::Pixel>,
    effort: Effort,
}

/// How far a picture is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExposureProgress {
    /// How many samples pixels have so far, in the mean.
    pub samples: f64,
    /// Which part of all that is, from 0 to 1; `None` where pixels get as many as they need, so that nobody knows.
    pub share: Option<f64>,
}

/// A tile, and how many samples of each of its pixels have come that still gets some.
#[derive(Clone, Copy, Debug)]
struct ExposedTile {
    tile: Tile,
    samples: u32,
    /// The pixels that get more.
    active: TileLanes,
}

/// What has come to the pixels so far.
#[derive(Clone, Debug)]
enum Pixels<Pixel> {
    /// Their only sample; `None` before the first comes.
    Picture(Option<Film<Pixel>>),
    /// What all samples add up to.
    Sums(Sums),
}

/// What the samples of pixels add up to, tile by tile, and in a tile packet by packet of its camera rays; every tile has room for a
/// whole one.
#[derive(Clone, Debug, Default)]
struct Sums {
    all: Vec<Vectors>,
    /// Of the first half of the first round's samples, for adaptive sampling; else none.
    first_half: Vec<Colors>,
    /// Of the samples in which the pixel is covered, if the picture is to have alpha; else none.
    covered: Vec<Vectors>,
    /// How many those are.
    covered_counts: Vec<Numbers>,
}

/// Which samples a picture gets, and what is kept of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SamplePlan {
    pub(crate) rounds: Rounds,
    /// How good the picture is meant to be, if that ends its rounds.
    pub(crate) target: Option<ErrorTarget>,
    /// Whether it is to have alpha: it is then without the background.
    pub(crate) alpha: bool,
}

/// A finished picture.
pub(crate) struct Developed<Pixel> {
    pub(crate) film: Film<Pixel>,
    /// If it was to have any.
    pub(crate) alpha: Option<Film<f32>>,
}

/// The memory of a picture's samples, for the next one: it costs more to get it anew from the system than to use it.
#[derive(Debug, Default)]
pub(crate) struct SampleMemory {
    sums: Sums,
    errors: PixelErrors,
}

impl Sums {
    /// Makes them those of so many tiles without samples.
    fn clear(&mut self, tiles: usize, plan: &SamplePlan) {
        let packets = |asked| if asked { tiles * PACKETS } else { 0 };
        self.all.clear();
        self.all.resize(packets(true), NO_SUMS);
        // Whatever is there, the first sample takes its place.
        self.first_half.resize(packets(plan.target.is_some()), Colors::splat(Rgb::ZERO));
        self.covered.clear();
        self.covered.resize(packets(plan.alpha), NO_SUMS);
        self.covered_counts.clear();
        self.covered_counts.resize(packets(plan.alpha), Numbers::splat(0.0));
    }

    /// Goes through those of all tiles.
    fn tiles_mut(&mut self) -> impl Iterator<Item = TileSums<'_>> {
        let mut first_half = self.first_half.chunks_mut(PACKETS);
        let mut covered = self.covered.chunks_mut(PACKETS);
        let mut covered_counts = self.covered_counts.chunks_mut(PACKETS);
        self.all.chunks_mut(PACKETS).map(move |all| TileSums {
            all,
            first_half: first_half.next().unwrap_or_default(),
            covered: covered.next().unwrap_or_default(),
            covered_counts: covered_counts.next().unwrap_or_default(),
        })
    }
}

impl Exposure {
    /// Of no light so far, to have this many samples in a pixel, and linear light in the end.
    #[doc(hidden)]
    #[must_use]
    pub fn new(resolution: (u32, u32), samples: u32) -> Self {
        let plan = SamplePlan { rounds: Rounds::single(samples, 1), target: None, alpha: false };
        Self::encoded(Linear, resolution, plan, SampleMemory::default())
    }

    /// What there is so far, with its background: pixels are means of the samples that they have. Where they have none, another picture of
    /// the same is seen, of any size.
    #[must_use]
    pub fn develop_over(&self, beneath: &Film) -> Film {
        let mut film = match &self.pixels {
            Pixels::Picture(film) => film.clone().unwrap_or_else(|| Film::new(self.width, self.height)),
            Pixels::Sums(sums) => self.develop_sums(&sums.all).0,
        };
        let nearest = |place: u32, count: u32, of: u32| {
            let nearest = u64::from(place) * u64::from(of) / u64::from(count);
            u32::try_from(nearest).unwrap_or(0)
        };
        for ExposedTile { tile, .. } in self.tiles.iter().filter(|exposed| exposed.samples == 0) {
            for j in tile.j..tile.j + tile.height {
                let row = nearest(j, self.height, beneath.height());
                let pixels = (tile.i..tile.i + tile.width)
                    .map(|i| beneath.pixel(nearest(i, self.width, beneath.width()), row));
                film.store(tile.i, j, pixels);
            }
        }
        film
    }
}

impl<E: Encoding> Exposure<E> {
    /// Of no light so far, to have such samples. Pixels are encoded in the end. It uses the memory of another.
    pub(crate) fn encoded(
        encoding: E,
        (columns, height): (u32, u32),
        plan: SamplePlan,
        SampleMemory { mut sums, errors }: SampleMemory,
    ) -> Self {
        let tiles: Vec<ExposedTile> = (0..height)
            .step_by(TILE as usize)
            .flat_map(|j| (0..columns).step_by(TILE as usize).map(move |i| (i, j)))
            .map(|(i, j)| Tile { i, j, width: TILE.min(columns - i), height: TILE.min(height - j) })
            .map(|tile| ExposedTile { tile, samples: 0, active: TileLanes::ALL })
            .collect();
        let rounds = plan.rounds;
        let pixels = if rounds.samples() == 1 && !plan.alpha {
            Pixels::Picture(None)
        } else {
            sums.clear(tiles.len(), &plan);
            Pixels::Sums(sums)
        };
        let adaptive = plan.target.map(|target| Adaptive::new((columns, height), target, errors));
        let effort = Effort::default();
        Self { width: columns, height, rounds, adaptive, tiles, encoding, pixels, effort }
    }

    /// Adds the present round's samples of an instant, those that are not there yet, on the current rayon pool's threads. The bits do
    /// not depend on how many there are, nor on effects beyond those that the scene calls for. The camera's film must
    /// be as large as this, and those of the instants before must be there.
    ///
    /// Says whether all were added; if not, the same call goes on.
    #[doc(hidden)]
    #[must_use]
    pub fn add(
        &mut self,
        scene: &PreparedScene,
        camera: &Camera,
        sampling: Sampling,
        instant: u32,
        effects: Effects,
        signals: Signals<'_>,
    ) -> bool {
        let portion = self.rounds.portion(instant);
        let context = RenderContext::new(scene, camera, sampling, effects);
        match scene.precision {
            Precision::Guaranteed => self.add_with(&context, scene.geometry(), portion, signals),
            // For comparisons: as it is.
            Precision::TextbookF64 => {
                let shapes = Textbook::<f64>::new(scene.geometry());
                self.add_with(&context, &shapes, portion, signals)
            }
            Precision::TextbookF32 => {
                let shapes = Textbook::<f32>::new(scene.geometry());
                self.add_with(&context, &shapes, portion, signals)
            }
        }
    }

    fn add_with(
        &mut self,
        context: &RenderContext<'_>,
        shapes: &impl Intersector,
        portion: Portion,
        signals: Signals<'_>,
    ) -> bool {
        let (count, tiles) = (self.tiles.len(), self.tiles.iter_mut());
        let (width, height) = (self.width, self.height);
        self.effort += match &mut self.pixels {
            Pixels::Picture(film) => {
                let film = film.get_or_insert_with(|| Film::black(self.encoding, width, height));
                let tiles = tiles.zip(film.tiles_mut(self.encoding));
                add_samples(context, shapes, (tiles, count), portion, signals)
            }
            Pixels::Sums(sums) => {
                let tiles = tiles.zip(sums.tiles_mut());
                add_samples(context, shapes, (tiles, count), portion, signals)
            }
        };
        self.tiles.iter().all(|exposed| exposed.samples >= portion.after())
    }

    /// Goes on to the next round, after the present one, if the picture is not yet as good as it is meant to be. Returns whether there
    /// is one.
    pub(crate) fn next_round(&mut self) -> bool {
        let (Some(adaptive), Pixels::Sums(sums)) = (&mut self.adaptive, &self.pixels) else {
            return false;
        };
        let sums = BandsOfTiles { width: self.width, tiles: &self.tiles, sums };
        if !adaptive.judge(&self.rounds, &sums) {
            return false;
        }
        self.rounds.advance();
        let width = self.width as usize;
        self.tiles.par_iter_mut().filter(|exposed| !exposed.active.are_none()).for_each(|exposed| {
            let Tile { i, j, width: columns, height: rows } = exposed.tile;
            exposed.active = if adaptive.any_gets_more(i..i + columns, j..j + rows) {
                exposed
                    .tile
                    .active_lanes(|i, j| adaptive.left_with(j as usize * width + i as usize).is_none())
            } else {
                TileLanes::NONE
            };
        });
        true
    }

    /// Returns the estimate of the picture's error in output values, if it is meant to have one.
    pub(crate) fn estimated_error(&self) -> Option<f64> {
        self.adaptive.as_ref()?.error()
    }

    /// Returns how far it is.
    #[must_use]
    pub fn progress(&self) -> ExposureProgress {
        let pixels = f64::from(self.width) * f64::from(self.height);
        if self.adaptive.is_some() {
            return ExposureProgress { samples: self.effort.rays.camera as f64 / pixels, share: None };
        }
        let area = |tile: Tile| f64::from(tile.width * tile.height);
        let there: f64 =
            self.tiles.iter().map(|exposed| area(exposed.tile) * f64::from(exposed.samples)).sum();
        let samples = there / pixels;
        ExposureProgress { samples, share: Some(samples / f64::from(self.rounds.samples())) }
    }

    /// Returns which part of its samples is there, 0 to 1; of a picture whose pixels get as many as they need, how many there are as a
    /// multiple of the least that all get.
    pub(crate) fn share(&self) -> f64 {
        let ExposureProgress { samples, share } = self.progress();
        share.unwrap_or_else(|| samples / f64::from(self.rounds.least()))
    }

    /// Returns the picture, and what it took.
    #[doc(hidden)]
    #[must_use]
    pub fn develop(self) -> (Film<E::Pixel>, Effort) {
        let (Developed { film, .. }, effort, _) = self.finish();
        (film, effort)
    }

    /// Returns the picture, what it took, and the memory of its samples.
    pub(crate) fn finish(mut self) -> (Developed<E::Pixel>, Effort, SampleMemory) {
        let mut effort = self.effort;
        match std::mem::replace(&mut self.pixels, Pixels::Picture(None)) {
            Pixels::Picture(film) => {
                let film = film.unwrap_or_else(|| Film::black(self.encoding, self.width, self.height));
                (Developed { film, alpha: None }, effort, SampleMemory::default())
            }
            Pixels::Sums(sums) => {
                let has_alpha = !sums.covered.is_empty();
                let (film, overflowed) = self.develop_sums(if has_alpha { &sums.covered } else { &sums.all });
                effort.escalations.overflowed += overflowed;
                let alpha = has_alpha.then(|| self.develop_alpha(&sums.covered_counts));
                let errors = self.adaptive.map(Adaptive::into_memory).unwrap_or_default();
                (Developed { film, alpha }, effort, SampleMemory { sums, errors })
            }
        }
    }

    /// Returns the means of what samples add up to, and how many had overflowed.
    fn develop_sums(&self, sums: &[Vectors]) -> (Film<E::Pixel>, u64) {
        let mut film = Film::black(self.encoding, self.width, self.height);
        let stored: Vec<_> = film.tiles_mut(self.encoding).collect();
        let tiles = stored.into_par_iter().zip(sums.par_chunks(PACKETS)).zip(&self.tiles);
        let overflowed = tiles.map(|((mut stored, sums), exposed)| {
            dispatch!(SimdLevel::best().level(), simd => {
                let counts = self.sample_counts(exposed);
                let mut pixels = [Colors::splat(Rgb::ZERO); PACKETS];
                for ((pixels, sums), counts) in pixels.iter_mut().zip(sums).zip(&counts) {
                    *pixels = means(simd, sums, counts);
                }
                let (light, active, covered) = (&pixels, TileLanes::ALL, TileLanes::NONE);
                stored.add(simd, &exposed.tile, &TileSamples { light, active, covered })
            })
        });
        let overflowed = overflowed.sum();
        (film, overflowed)
    }

    /// Returns which share of each pixel's samples is covered.
    fn develop_alpha(&self, covered_counts: &[Numbers]) -> Film<f32> {
        let mut alpha = Film::zeros(self.width, self.height);
        let across = self.width.div_ceil(TILE).max(1) as usize;
        let tiles = self.tiles.par_chunks(across).zip(covered_counts.par_chunks(across * PACKETS));
        alpha.bands_mut().zip(tiles).for_each(|(band, (tiles, covered_counts))| {
            for (exposed, covered) in tiles.iter().zip(covered_counts.chunks(PACKETS)) {
                let (Tile { i, width, height, .. }, counts) = (exposed.tile, self.sample_counts(exposed));
                let rows = band.chunks_mut(self.width as usize).take(height as usize);
                for (row, alpha) in rows.enumerate() {
                    for (column, alpha) in alpha[i as usize..(i + width) as usize].iter_mut().enumerate() {
                        let (packet, lane) = Tile::lane_of(column, row);
                        *alpha = AlphaFilm::share(covered[packet].get(lane), counts[packet].get(lane));
                    }
                }
            }
        });
        alpha
    }

    /// Returns how many samples each pixel of a tile has, at least one.
    #[inline(always)]
    fn sample_counts(&self, ExposedTile { tile, samples, .. }: &ExposedTile) -> [Numbers; PACKETS] {
        const LENGTH: usize = SIDE as usize;
        let all = (*samples).max(1);
        let mut counts = [Numbers::splat(f64::from(all)); PACKETS];
        let Some(adaptive) = &self.adaptive else { return counts };
        for row in 0..tile.height {
            let left_with = &adaptive.row_left_with(tile.j + row)[tile.i as usize..][..tile.width as usize];
            let (packet, lane) = Tile::lane_of(0, row as usize);
            for (left_with, counts) in left_with.chunks(LENGTH).zip(&mut counts[packet..]) {
                for (column, samples) in left_with.iter().enumerate() {
                    counts.set(lane + column, f64::from(if *samples > 0 { *samples } else { all }));
                }
            }
        }
        counts
    }
}

/// What the samples of pixels add up to, tile by tile, for a band at a time.
struct BandsOfTiles<'a> {
    width: u32,
    tiles: &'a [ExposedTile],
    sums: &'a Sums,
}

impl BandsOfTiles<'_> {
    /// Goes through the packets in a band, where tiles have pixels that get more: their columns, and their index in the picture.
    #[inline(always)]
    fn packets(&self, band: usize) -> impl Iterator<Item = (Range<usize>, usize)> {
        const LENGTH: usize = TILE as usize;
        let across = self.width.div_ceil(TILE) as usize;
        let row = band * BAND;
        let first = row / LENGTH * across;
        let tiles = self.tiles[first..first + across].iter().enumerate();
        tiles.filter(|(_, exposed)| !exposed.active.are_none()).flat_map(move |(tile, exposed)| {
            let columns = exposed.tile.width as usize;
            (0..columns).step_by(SIDE as usize).map(move |column| {
                let (packet, _) = Tile::lane_of(column, row % LENGTH);
                let last = columns.min(column + SIDE as usize);
                (tile * LENGTH + column..tile * LENGTH + last, (first + tile) * PACKETS + packet)
            })
        })
    }
}

impl BandSums for BandsOfTiles<'_> {
    fn all(&self, band: usize, rows: &mut [[&mut [f32]; 3]]) {
        #[expect(clippy::cast_possible_truncation, reason = "for an estimate")]
        let rounded = |exact: f64| exact as f32;
        dispatch!(SimdLevel::best().level(), _simd => {
            for (columns, packet) in self.packets(band) {
                let sums = &self.sums.all[packet];
                for channel in 0..3 {
                    let row = |row: usize| sums.axis(channel).starting_at(row * SIDE as usize);
                    put_packet(rows, (channel, &columns), row, rounded);
                }
            }
        });
    }

    fn first_half(&self, band: usize, rows: &mut [[&mut [f32]; 3]]) {
        dispatch!(SimdLevel::best().level(), _simd => {
            for (columns, packet) in self.packets(band) {
                let sums = &self.sums.first_half[packet];
                for channel in 0..3 {
                    let row = |row: usize| sums.starting_at(channel, row * SIDE as usize);
                    put_packet(rows, (channel, &columns), row, |sum| sum);
                }
            }
        });
    }
}

/// Puts a channel of a packet's pixels in its columns of rows.
#[inline(always)]
fn put_packet<'a, T: Copy + 'a>(
    rows: &mut [[&mut [f32]; 3]],
    (channel, columns): (usize, &Range<usize>),
    of_row: impl Fn(usize) -> &'a [T],
    number: impl Fn(T) -> f32,
) {
    const LENGTH: usize = SIDE as usize;
    for (index, row) in rows.iter_mut().enumerate() {
        let (places, found) = (&mut row[channel][columns.clone()], of_row(index));
        if let (Some(places), Some(found)) =
            (places.first_chunk_mut::<LENGTH>(), found.first_chunk::<LENGTH>())
        {
            *places = found.map(&number);
        } else {
            places.iter_mut().zip(found).for_each(|(place, found)| *place = number(*found));
        }
    }
}

/// Adds samples of all tiles over all threads. Returns what they took.
fn add_samples<'t, L: TileLight>(
    context: &RenderContext<'_>,
    shapes: &impl Intersector,
    (tiles, count): (impl Iterator<Item = (&'t mut ExposedTile, L)> + Send, usize),
    portion: Portion,
    signals: Signals<'_>,
) -> Effort {
    let threads = rayon::current_num_threads();
    let queue = WorkQueue::new(tiles, count, threads);
    let total = Mutex::new(Effort::default());
    let work = || {
        let (mut share, mut buffers, mut effort) = (Vec::new(), None, Effort::default());
        while queue.take_share(&mut share) {
            let buffers = buffers.get_or_insert_with(|| TileBuffers::new(signals.cancelled));
            for (exposed, mut light) in share.drain(..) {
                effort += add_to_tile(context, shapes, (exposed, &mut light), portion, signals, buffers);
            }
        }
        *total.lock().unwrap_or_else(PoisonError::into_inner) += effort;
    };
    rayon::scope(|scope| (0..threads).for_each(|_| scope.spawn(|_| work())));
    total.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// Adds samples of a tile. Returns what they took.
fn add_to_tile(
    context: &RenderContext<'_>,
    shapes: &impl Intersector,
    (exposed, light): (&mut ExposedTile, &mut impl TileLight),
    portion: Portion,
    signals: Signals<'_>,
    buffers: &mut TileBuffers<'_>,
) -> Effort {
    let mut effort = Effort::default();
    buffers.ask_for_coverage(light.asks_for_coverage());
    if exposed.active.are_none() {
        exposed.samples = portion.after();
    }
    for sample in portion.rest(exposed.samples) {
        if signals.cancelled.load(Ordering::Relaxed) || (signals.pause)() {
            break;
        }
        let whole = render_sample(context, shapes, (exposed.tile, exposed.active, sample), buffers);
        let traced = buffers.take_effort();
        if !whole {
            break;
        }
        effort.escalations.overflowed += dispatch!(context.scene.simd.level(), simd => {
            if sample < portion.halfway {
                light.add_to_first_half(simd, buffers.pixels(), exposed.samples == 0);
            }
            let (active, covered) = (exposed.active, buffers.covered());
            light.add(simd, &exposed.tile, &TileSamples { light: buffers.pixels(), active, covered })
        });
        exposed.samples += 1;
        effort += traced;
    }
    effort
}
