//! What it costs to be right: the guaranteed leaves beside the textbook's in f64 and f32, per ray and per frame.
//!
//! `cargo bench --bench precision` prints the tables of the kernel's documentation: medians of runs in turns on one thread.
//! `cargo bench --bench precision -- 5` makes five rounds instead of the usual eleven.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a bench prints its table, and may fail loudly")]

use std::path::Path;
use std::time::Instant;

use glam::{DAffine3, DQuat, DVec3};

use rayreel::trace::shapes::{AlignedBox, BoxImage, Plane, Sphere, SphereImage};
use rayreel::trace::{CastRay, Geometry, Precision, PreparedScene, PreparedShape, SurfaceMaterial};
use rayreel::{Engine, Time};

const PRECISIONS: [Precision; 3] = [Precision::TextbookF32, Precision::TextbookF64, Precision::Guaranteed];

fn main() {
    let rounds = std::env::args().find_map(|argument| argument.parse().ok()).unwrap_or(11);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        rays(rounds);
        frames(rounds);
    });
}

/// One shape, rays from all around towards it: about half of them hit.
fn rays(rounds: usize) {
    const COUNT: usize = 200_000;
    let turned = DAffine3::from_scale_rotation_translation(
        DVec3::new(1.0, 0.7, 1.3),
        DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, -0.2),
        DVec3::ZERO,
    );
    let shapes = [
        ("sphere", PreparedShape::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 })),
        ("plane", PreparedShape::Plane(Plane::new(DVec3::ZERO, DVec3::Y).expect("it has a direction"))),
        ("box", PreparedShape::AlignedBox(AlignedBox { min: DVec3::NEG_ONE, max: DVec3::ONE })),
        ("ellipsoid", PreparedShape::SphereImage(SphereImage::new(turned, 1.0))),
        ("turned box", PreparedShape::BoxImage(BoxImage::new(turned, DVec3::ONE).expect("it has an inside"))),
    ];
    let rays: Vec<Option<CastRay>> = (0..COUNT).map(ray).collect();
    println!("| one shape, nanoseconds a ray | hits | textbook f32 | textbook f64 | guaranteed | over f64 |");
    println!("|---|---|---|---|---|---|");
    for (name, shape) in shapes {
        let mut geometry = Geometry::default();
        geometry.push(shape);
        let mut scene = PreparedScene::new(geometry, vec![SurfaceMaterial::default()]);
        let hits = scene.cast_all(&rays).iter().flatten().count() * 100 / COUNT;
        let seconds = medians(rounds, |precision| {
            scene.precision = precision;
            std::hint::black_box(scene.cast_all(&rays));
        });
        let [single, double, ours] = seconds.map(|seconds| seconds * 1e9 / COUNT as f64);
        println!("| {name} | {hits} % | {single:.0} | {double:.0} | {ours:.0} | {:.2} |", ours / double);
    }
    println!();
}

/// The middle frame of every shipped scene.
fn frames(rounds: usize) {
    println!("| a frame, milliseconds of tracing | textbook f32 | textbook f64 | guaranteed | over f64 |");
    println!("|---|---|---|---|---|");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut scenes: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    scenes.retain(|path| path.is_file());
    scenes.sort();
    let mut logarithms = 0.0;
    for path in &scenes {
        let mut engine = Engine::load(path).unwrap();
        // With every effect, so that all precisions do the same work.
        engine.set_full(true);
        let timeline = engine.timeline();
        let middle: Time = timeline.time_of(timeline.frame_count() / 2);
        let seconds = medians(rounds, |precision| {
            engine.set_precision(precision);
            engine.render_at(middle).unwrap();
        });
        let [single, double, ours] = seconds.map(|seconds| seconds * 1e3);
        let name = path.file_stem().unwrap().to_string_lossy();
        logarithms += libm::log(ours / double);
        println!("| {name} | {single:.1} | {double:.1} | {ours:.1} | {:.2} |", ours / double);
    }
    println!("| geometric mean | | | | {:.2} |", libm::exp(logarithms / scenes.len() as f64));
}

/// Median seconds for each precision, of runs in turns.
fn medians(rounds: usize, mut run: impl FnMut(Precision)) -> [f64; 3] {
    let mut seconds = [const { Vec::new() }; 3];
    for _ in 0..=rounds {
        for (precision, seconds) in PRECISIONS.into_iter().zip(&mut seconds) {
            let start = Instant::now();
            run(precision);
            seconds.push(start.elapsed().as_secs_f64());
        }
    }
    seconds.map(|mut seconds| {
        // The first round warms up.
        let mut warm = seconds.split_off(1);
        warm.sort_by(f64::total_cmp);
        warm[warm.len() / 2]
    })
}

/// From a sphere around the shape to a disc across it, spread evenly by golden ratios.
fn ray(index: usize) -> Option<CastRay> {
    let spread = |step: f64| (index as f64 * step).fract() * 2.0 - 1.0;
    let origin = DVec3::new(spread(0.618_033_988_75), spread(0.754_877_666_25), spread(0.569_840_290_99));
    let target = DVec3::new(spread(0.819_172_513_4), spread(0.671_043_606_7), spread(0.549_700_477_9)) * 1.3;
    let origin = origin.normalize_or(DVec3::Z) * 4.0;
    CastRay::new(origin, target - origin)
}
