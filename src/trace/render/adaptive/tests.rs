//! Adaptive sampling of synthetic pixels with known true means.

use std::array::from_fn;

use glam::{DAffine3, DVec3};

use super::*;
use crate::color::{Rgb, Transfer};
use crate::trace::math::{Dimension, PixelSamples};
use crate::trace::render::visibility::{Feature, FeatureScratch, FeatureSearch};
use crate::trace::scene::{PatternLayout, PatternedSurface, PreparedCamera, PreparedPattern, PreparedScene};
use crate::trace::shapes::{Plane, Sphere};
use crate::trace::{Geometry, PatternFunction, PreparedShape, SurfaceMaterial};

const SIZE: (u32, u32) = (64, 48);
const COUNT: usize = (SIZE.0 * SIZE.1) as usize;

fn target(error: f64, convergence: Convergence) -> ErrorTarget {
    ErrorTarget { error, norm: ErrorNorm::Rms, least: 1, transfer: Transfer::Classic, convergence }
}

/// Sums of grey samples, and of their squares.
struct GreySums(Vec<(f64, f64)>);

impl SampleSums for GreySums {
    fn have_alpha(&self) -> bool {
        false
    }

    fn of(&self, _: usize, (column, row): (usize, usize)) -> PacketSums {
        let of = |lane: usize| self.0[(row + lane / SIDE) * SIZE.0 as usize + column + lane % SIDE];
        let (all, squares) = (from_fn(|lane| of(lane).0), from_fn(|lane| of(lane).1));
        PacketSums { all: [all; 3], squares: [squares; 3], covered: None }
    }
}

/// Samples pixels, given by index, until the target is met. `edges` returns whether geometry finds an edge in a pixel. Returns the pixels,
/// their sample counts, and the final state.
fn rendered(
    memory: PixelMemory,
    (target, most): (ErrorTarget, u32),
    edges: impl Fn(usize) -> bool,
    sample: impl Fn(usize, u32) -> f64,
) -> (Vec<f64>, Vec<u32>, Adaptive) {
    let order = InstantOrder::new(false);
    let mut adaptive = Adaptive::new(SIZE, (most, order, false), target, memory);
    let tiles_across = adaptive.tiles.0;
    for (packet, pixels) in adaptive.packets.iter_mut().enumerate() {
        let (column, row) = first_pixel(packet, tiles_across);
        for lane in 0..LANES {
            if edges((row + lane / SIDE) * SIZE.0 as usize + column + lane % SIDE) {
                pixels.join(lane, Feature::EDGE, adaptive.most);
            }
        }
    }
    let (mut sums, mut counts) = (GreySums(vec![(0.0, 0.0); COUNT]), vec![0; COUNT]);
    let mut portions = Vec::new();
    loop {
        for tile in Tile::all(SIZE) {
            adaptive.portions(&tile, 0, &mut portions);
            for portion in &portions {
                let (column, row) = tile.pixel(portion.pixel);
                let pixel = (row * SIZE.0 + column) as usize;
                assert_eq!((portion.first, portion.stride), (counts[pixel], 1));
                for index in portion.first..portion.first + portion.count {
                    let sample = sample(pixel, index);
                    sums.0[pixel].0 += sample;
                    sums.0[pixel].1 += sample * sample;
                }
                counts[pixel] += portion.count;
            }
        }
        if !adaptive.judge(&sums, None) {
            break;
        }
    }
    let means = sums.0.iter().zip(&counts).map(|((sum, _), count)| sum / f64::from(*count)).collect();
    (means, counts, adaptive)
}

fn rms(pixels: &[f64], exact: impl Fn(usize) -> f64) -> f64 {
    let square = |(index, pixel): (usize, &f64)| {
        let error = 255.0 * (pixel - exact(index));
        error * error
    };
    (pixels.iter().enumerate().map(square).sum::<f64>() / COUNT as f64).sqrt()
}

fn has_edge(pixel: usize) -> bool {
    (pixel % SIZE.0 as usize).is_multiple_of(8)
}

/// Every eighth column has an edge: white below y = p + (x - 1/2) / 3. The other columns are constant.
fn edge(pixel: usize, index: u32) -> f64 {
    if !has_edge(pixel) {
        return 0.25;
    }
    let [x, y] = PixelSamples::new(3, u32::try_from(pixel).unwrap(), 0).pair(Dimension::Pixel, index);
    if y < height(pixel) + (x - 0.5) / 3.0 { 1.0 } else { 0.0 }
}

fn height(pixel: usize) -> f64 {
    0.2 + 0.6 * ((pixel * 37 % COUNT) as f64 / COUNT as f64)
}

fn edge_truth(pixel: usize) -> f64 {
    if has_edge(pixel) { height(pixel) } else { 0.25 }
}

#[test]
fn edges_take_samples_until_the_target_is_met() {
    for goal in [4.0, 2.0, 1.0, 0.5, 0.25] {
        let with = (target(goal, Convergence::Edges), 65_536);
        let (pixels, counts, adaptive) = rendered(PixelMemory::default(), with, has_edge, edge);
        let error = rms(&pixels, edge_truth);
        let EstimatedError { value: estimate, .. } = adaptive.error().unwrap();
        let mean = counts.iter().map(|count| f64::from(*count)).sum::<f64>() / COUNT as f64;
        assert!(estimate <= goal && error <= goal, "{goal}: {error}, {estimate}");
        assert!((0.8..2.0).contains(&(estimate / error)), "{goal}: {error}, {estimate}");
        let uniform = (0..16).map(|exponent| 1_u32 << exponent).find(|count| {
            let mean = |pixel| (0..*count).map(|index| edge(pixel, index)).sum::<f64>() / f64::from(*count);
            rms(&(0..COUNT).map(mean).collect::<Vec<_>>(), edge_truth) <= error
        });
        let gain = f64::from(uniform.unwrap()) / mean;
        assert!(gain > 3.0, "{goal}: {mean} instead of {uniform:?}");
    }
}

/// Independent samples, uniform in an interval around 1/2 whose width grows with the row. Geometry has no features; audits find the noise.
#[test]
fn audits_find_noise_that_geometry_does_not_know() {
    let width = |pixel: usize| (pixel / SIZE.0 as usize) as f64 / f64::from(SIZE.1);
    let noise = |pixel: usize, index: u32| {
        let random = PixelSamples::new(5, u32::try_from(pixel).unwrap(), index).number(Dimension::Lens, 0);
        0.5 + width(pixel) * (random - 0.5)
    };
    for goal in [8.0, 4.0, 2.0] {
        let with = (target(goal, Convergence::Effects), 65_536);
        let (pixels, counts, adaptive) = rendered(PixelMemory::default(), with, |_| false, noise);
        let (error, estimate) = (rms(&pixels, |_| 0.5), adaptive.error().unwrap().value);
        assert!(
            estimate <= goal && (0.5 * goal..1.05 * goal).contains(&error),
            "{goal}: {error}, {estimate}"
        );
        let of_rows = |from: usize, to: usize| {
            let counts = &counts[from * SIZE.0 as usize..to * SIZE.0 as usize];
            counts.iter().map(|count| f64::from(*count)).sum::<f64>() / counts.len() as f64
        };
        assert!(of_rows(36, 48) > 1.5 * of_rows(0, 12), "{goal}");
    }
}

/// A shadow on a plain surface, whose edge geometry does not know.
struct Shadow<F> {
    seed: u64,
    is_lit: F,
}

impl<F: Fn(f64, f64) -> bool> Shadow<F> {
    fn light(&self, pixel: usize, [x, y]: [f64; 2]) -> f64 {
        let (column, row) = (pixel % SIZE.0 as usize, pixel / SIZE.0 as usize);
        f64::from(u8::from((self.is_lit)(column as f64 + x, row as f64 + y)))
    }

    /// Samples the picture until `goal` is met. Returns the sample counts, the true error, and the estimate.
    fn rendered(&self, goal: f64) -> (Vec<u32>, f64, f64) {
        /// Points per pixel and direction of the exact means.
        const POINTS: u32 = 32;
        let sample = |pixel: usize, index: u32| {
            let samples = PixelSamples::new(self.seed, u32::try_from(pixel).unwrap(), 0);
            self.light(pixel, samples.pair(Dimension::Pixel, index))
        };
        let truth = |pixel: usize| {
            let at = |index: u32| (f64::from(index) + 0.5) / f64::from(POINTS);
            let of_point = |point: u32| self.light(pixel, [at(point % POINTS), at(point / POINTS)]);
            (0..POINTS * POINTS).map(of_point).sum::<f64>() / f64::from(POINTS * POINTS)
        };
        let with = (target(goal, Convergence::Edges), 65_536);
        let (pixels, counts, adaptive) = rendered(PixelMemory::default(), with, |_| false, sample);
        (counts, rms(&pixels, truth), adaptive.error().unwrap().value)
    }
}

/// A small round shadow, which most audits miss.
#[test]
fn edges_between_plain_pixels_are_found() {
    for (seed, goal) in (0..16).flat_map(|seed| [4.0, 2.0].map(|goal| (seed, goal))) {
        let center = [20.0 + 0.7 * seed as f64, 15.0 + 0.3 * seed as f64];
        let shadow = Shadow { seed, is_lit: |x: f64, y: f64| (x - center[0]).hypot(y - center[1]) > 2.8 };
        let (_, error, estimate) = shadow.rendered(goal);
        assert!(estimate <= goal && error <= goal, "{seed}, {goal}: {error}, {estimate}");
    }
}

/// A large shadow, whose edge many audits hit.
#[test]
fn edges_between_plain_pixels_need_samples_only_there() {
    let mut within = 0;
    for (seed, goal) in (0..8).flat_map(|seed| [4.0, 2.0, 1.0, 0.5].map(|goal| (seed, goal))) {
        let (cosine, sine) = (0.9_f64, 0.19_f64.sqrt());
        let height = |x: f64, y: f64| cosine * (x - 32.0) + sine * (y - 24.0 - 0.2 * seed as f64);
        let (counts, error, estimate) = Shadow { seed, is_lit: |x, y| height(x, y) > 0.0 }.rendered(goal);
        assert!(estimate <= goal, "{seed}, {goal}: {estimate}");
        within += u32::from(error <= goal);
        for (pixel, count) in counts.into_iter().enumerate() {
            let [x, y] = [pixel % SIZE.0 as usize, pixel / SIZE.0 as usize].map(|place| place as f64 + 0.5);
            assert!(height(x, y).abs() < 3.0 || count <= 4, "{seed}, {goal}: {count} at {x}, {y}");
        }
    }
    // The errors of some 50 pixels scatter. Targets are met in nine of ten pictures.
    assert!(within >= 29, "{within} of 32");
}

#[test]
fn flat_pictures_take_one_sample_and_an_audit() {
    let with = (target(0.01, Convergence::Edges), 65_536);
    let (pixels, counts, adaptive) = rendered(PixelMemory::default(), with, |_| false, |_, _| 0.3);
    let audited = counts.iter().filter(|count| **count == 4).count();
    assert!(audited == COUNT / 16 && counts.iter().all(|count| [1, 4].contains(count)));
    assert!(adaptive.error().unwrap().value < 1e-3 && rms(&pixels, |_| 0.3) < 1e-9);
}

#[test]
fn impossible_targets_end_with_all_samples_and_say_so() {
    for most in [50, 5] {
        let with = (target(1e-6, Convergence::Edges), most);
        let (_, counts, adaptive) = rendered(PixelMemory::default(), with, has_edge, edge);
        assert!(counts.iter().enumerate().all(|(pixel, count)| !has_edge(pixel) || *count == most));
        assert!(adaptive.error().unwrap().value > 1e-6);
    }
}

#[test]
fn nothing_is_left_of_the_picture_before() {
    let wild = |pixel: usize, index: u32| {
        let bits = (u32::try_from(pixel).unwrap() ^ index.rotate_left(7)).wrapping_mul(2_654_435_769);
        if bits.is_multiple_of(5) { f64::INFINITY } else { f64::from(bits >> 20) }
    };
    for convergence in [Convergence::Edges, Convergence::Effects] {
        let (.., before) = rendered(PixelMemory::default(), (target(1e-3, convergence), 16), has_edge, wild);
        let goal = (target(1.0, convergence), 65_536);
        let (_, counts, fresh) = rendered(PixelMemory::default(), goal, has_edge, edge);
        let (_, again, reused) = rendered(before.into_memory(), goal, has_edge, edge);
        assert!(counts == again && fresh.error() == reused.error());
    }
}

/// Light that is clamped in all samples causes no error.
#[test]
fn only_output_values_count() {
    let bright = |pixel: usize, index: u32| 2.0 + 8.0 * edge(pixel, index);
    let with = (target(0.1, Convergence::Edges), 65_536);
    let (_, counts, _) = rendered(PixelMemory::default(), with, has_edge, bright);
    assert!(counts.iter().all(|count| *count <= 4));
}

/// Independent noise, uniform in an interval whose width grows with the row: errors are nearly normal, so their maximum and percentiles are
/// known.
#[test]
fn other_norms_are_met_and_estimated() {
    let noise = |pixel: usize, index: u32| {
        let [x, _] = PixelSamples::new(5, u32::try_from(pixel).unwrap(), 0).pair(Dimension::Lens, 7 * index);
        0.5 + 0.3 * (x - 0.5) * (pixel / SIZE.0 as usize) as f64 / f64::from(SIZE.1)
    };
    let mut counts_before = 0;
    for norm in [ErrorNorm::Rms, ErrorNorm::P99, ErrorNorm::Max] {
        let with = (ErrorTarget { norm, ..target(2.0, Convergence::Effects) }, 65_536);
        let (pixels, counts, adaptive) = rendered(PixelMemory::default(), with, |_| false, noise);
        let mut errors: Vec<f64> = pixels.iter().map(|pixel| 255.0 * (pixel - 0.5).abs()).collect();
        errors.sort_by(f64::total_cmp);
        let error = match norm {
            ErrorNorm::Rms => rms(&pixels, |_| 0.5),
            ErrorNorm::P99 => errors[COUNT * 99 / 100],
            ErrorNorm::Max => errors[COUNT - 1],
        };
        let estimate = adaptive.error().unwrap().value;
        assert!(error <= 2.0 && estimate <= 2.0, "{norm:?}: {error}, {estimate}");
        assert!((0.7..2.0).contains(&(estimate / error)), "{norm:?}: {error}, {estimate}");
        let sum: u32 = counts.iter().sum();
        assert!(sum > counts_before, "{norm:?}");
        counts_before = sum;
    }
}

#[test]
fn every_pixel_gets_the_fewest_samples() {
    let with = (ErrorTarget { least: 7, ..target(2.0, Convergence::Edges) }, 65_536);
    let (_, counts, _) = rendered(PixelMemory::default(), with, |_| false, |_, _| 0.5);
    assert!(counts.iter().all(|count| *count >= 7));
    let (_, counts, _) = rendered(PixelMemory::default(), (with.0, 5), |_| false, |_, _| 0.5);
    assert!(counts.iter().all(|count| *count == 5));
}

/// The contents of a picture at an instant of an open shutter.
#[derive(Clone, Copy, Default)]
struct Instant {
    eye: f64,
    ball: f64,
    stripes: f64,
}

impl Instant {
    /// Creates two balls, the second of which can move, before a wall with wide stripes.
    fn scene(self) -> PreparedScene {
        let ball = |x: f64| PreparedShape::Sphere(Sphere { center: DVec3::new(x, 0.0, 0.0), radius: 0.5 });
        let wall = PreparedShape::Plane(Plane::new(DVec3::Z, DVec3::Z).unwrap());
        let mut geometry = Geometry::default();
        [ball(-1.0), ball(1.0 + self.ball), wall].into_iter().for_each(|shape| _ = geometry.push(shape));
        let function =
            PatternFunction::Stripes { size: 4.0, ratio: 0.5, direction: DVec3::Y, offset: self.stripes };
        let layout = PatternLayout::new(DAffine3::IDENTITY, PatternedSurface::plane(DVec3::Z), function);
        let pattern = PreparedPattern { ambient: Rgb::ZERO, diffuse: Rgb::ZERO, layout: layout.unwrap() };
        let plain = SurfaceMaterial { emission: Rgb::ONE, ..SurfaceMaterial::default() };
        let striped = SurfaceMaterial { pattern: Some(Box::new(pattern)), ..plain.clone() };
        PreparedScene::new(geometry, vec![plain.clone(), plain, striped])
    }

    fn camera(self) -> PreparedCamera {
        PreparedCamera::new(DVec3::new(self.eye, 0.0, -5.0), DVec3::Z, DVec3::Y, 1.0, (1.0, 0.75), SIZE)
    }
}

/// Checks that with an open shutter, borders of large shapes and of wide stripes are small features where they move, and edges elsewhere.
#[test]
fn only_borders_that_move_can_be_missed() {
    let small_features = |second: Instant| {
        let order = InstantOrder::new(true);
        let target = target(1.0, Convergence::Effects);
        let mut adaptive = Adaptive::new(SIZE, (64, order, false), target, PixelMemory::default());
        let mut scratch = FeatureScratch::default();
        for (index, instant) in (0..).zip([Instant::default(), second]) {
            let (scene, camera) = (instant.scene(), instant.camera());
            let search = FeatureSearch::new(&scene, &camera, true);
            for mut tile in adaptive.tiles_to_search(index) {
                let found = search.reference_features((tile.tile(), &tile.known()), &mut scratch);
                found.into_iter().for_each(|found| tile.record(found));
            }
        }
        let count = |class: Class| {
            let of = |pixels: &PixelPacket| pixels.classes[class as usize].count_ones();
            adaptive.packets.iter().map(of).sum::<u32>()
        };
        (count(Class::Small), count(Class::Edge))
    };
    let (small, edges) = small_features(Instant::default());
    assert!(small == 0 && edges > 100, "nothing moves: {small}, {edges}");
    let moved = [
        Instant { ball: 1e-9, ..Instant::default() },
        Instant { stripes: 1e-9, ..Instant::default() },
        Instant { eye: 1e-9, ..Instant::default() },
    ];
    let [ball, stripes, eye] = moved.map(small_features);
    assert!(ball.0 > 20 && ball.1 > 20 && ball.0 + ball.1 == edges, "{ball:?}");
    assert!(stripes.0 > 20 && stripes.1 > 20 && stripes.0 + stripes.1 == edges, "{stripes:?}");
    assert!(eye == (edges, 0), "{eye:?}");
}
