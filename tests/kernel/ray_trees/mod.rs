//! Tests of ray trees that grow without end, and of their limits: the depth limit, the cutoff of invisible contributions, and the maximum
//! number of rays of a sample.

mod random;

use std::time::{Duration, Instant};

use rayreel::color::Transfer;
use rayreel::components::{FilmSettings, Quality};
use rayreel::trace::{RayCounts, TreeEnds};
use rayreel::trace::{RayEnd, RayKind};
use rayreel::{Engine, Film, Time};

use crate::engine;

/// Cutoffs in steps of 8 bits.
const CUTOFFS: &[f32] = &[0.25, 2.0, 20.0, 100.0];

const ROOM: &str = include_str!("room.ron");

/// The maximum number of rays traced for a sample: camera rays and spawned rays.
const LARGEST_TREE: u64 = 4096;

fn render(engine: &mut Engine, depth: u32, cutoff: f32) -> Film {
    for quality in engine.world_mut().query_mut::<&mut Quality>() {
        *quality = Quality { depth, cutoff };
    }
    let film = engine.render(Time::ZERO).unwrap().film;
    assert!(film.pixels().iter().all(|pixel| pixel.is_finite() && pixel.min_element() >= 0.0));
    film
}

fn set_film(engine: &mut Engine, settings: FilmSettings) {
    for film in engine.world_mut().query_mut::<&mut FilmSettings>() {
        *film = settings;
    }
}

/// Returns the number of all rays except shadow rays.
fn in_trees(rays: RayCounts) -> u64 {
    rays.camera + rays.reflection + rays.refraction
}

/// Returns the largest difference in any channel of any pixel, in linear light.
fn largest_difference(one: &Film, other: &Film) -> f64 {
    let pixels = one.pixels().iter().zip(other.pixels());
    pixels.map(|(one, other)| f64::from((*one - *other).abs().max_element())).fold(0.0, f64::max)
}

/// Checks that a cutoff of c changes no pixel by more than c steps of 8 bits: c/255 of linear light, or, for sRGB output, whose curve has a
/// slope of 12.92 at black, 12.92 times less. Returns the number of rays in trees, without a cutoff and with each.
///
/// `depth` must be so small that no tree reaches the maximum size.
fn assert_cutoffs_hold(engine: &mut Engine, depth: u32, cutoffs: &[f32], what: &str) -> Vec<u64> {
    let mut counts = Vec::new();
    for (transfer, steepest) in [(Transfer::Classic, 1.0), (Transfer::Srgb, 12.92)] {
        let settings = engine.effective_settings().film;
        set_film(engine, FilmSettings { transfer, ..settings });
        let uncut = render(engine, depth, 0.0);
        assert_eq!(engine.report().ends.cutoff, 0, "{what}");
        counts = vec![in_trees(engine.report().rays)];
        for cutoff in cutoffs.iter().copied() {
            let found = largest_difference(&uncut, &render(engine, depth, cutoff));
            let promised = f64::from(cutoff) / (255.0 * steepest);
            assert!(found <= promised, "{what}, cutoff {cutoff}, {transfer:?}: {found} is over {promised}");
            counts.push(in_trees(engine.report().rays));
        }
    }
    counts
}

/// Checks cutoffs that are far apart: they hold, and a larger one traces fewer rays.
fn assert_cutoffs_hold_and_pay(engine: &mut Engine, depth: u32, what: &str) {
    let counts = assert_cutoffs_hold(engine, depth, CUTOFFS, what);
    println!("{counts:?}");
    assert!(counts.is_sorted_by(|more, fewer| more >= fewer), "{what}: {counts:?}");
    assert!(counts[0] > counts[4], "{what}: {counts:?}");
}

#[test]
fn mirror_and_glass_room_renders_in_finite_time() {
    let start = Instant::now();
    let mut engine = engine(ROOM);
    for (cutoff, width, height) in [(0.25, 32, 18), (0.0, 16, 9)] {
        set_film(&mut engine, FilmSettings { width, height, transfer: Transfer::Classic });
        render(&mut engine, 30, cutoff);
        let report = engine.report();
        println!("cutoff {cutoff}: {:?} {:?} in {:?}", report.rays, report.ends, start.elapsed());
        assert!(in_trees(report.rays) <= LARGEST_TREE * report.rays.camera);
        assert!(report.rays.reflection > report.rays.camera && report.rays.refraction > report.rays.camera);
    }
    assert!(start.elapsed() < Duration::from_secs(60), "{:?}", start.elapsed());
}

/// Checks trees of up to 2^10 - 1 rays per sample, which are all traced without a cutoff.
#[test]
fn the_rooms_cutoffs_hold() {
    assert_cutoffs_hold_and_pay(&mut engine(ROOM), 10, "the room");
}

/// Checks trees that are deep instead of wide, because no surface spawns two rays.
#[test]
fn cutoffs_hold_in_deep_trees() {
    let text = ROOM.replace("fresnel: true", "fresnel: false");
    assert_cutoffs_hold_and_pay(&mut engine(&text), 30, "the room without Fresnel");
    let fewer = render(&mut engine(&text), 30, 0.0);
    assert_ne!(fewer, render(&mut engine(ROOM), 9, 0.0));
}

#[test]
fn cutoffs_hold_in_random_rooms() {
    let mut all = [0; 5];
    for seed in 0..40 {
        let text = random::room(seed);
        let counts = assert_cutoffs_hold(&mut engine(&text), 7, CUTOFFS, &text);
        all.iter_mut().zip(counts).for_each(|(all, count)| *all += count);
    }
    println!("{all:?}");
    assert!(all.is_sorted_by(|more, fewer| more > fewer), "{all:?}");
}

/// Checks scenes in which all light is nearly as bright as possible, so that the light that is cut is nearly the maximum: k_a/(1 - k_r) in
/// a room of mirrors, and white all around a glass ball.
#[test]
fn cutoffs_hold_in_bright_scenes() {
    let many: Vec<f32> = (1..=50).map(|step| 5.0 * step as f32).collect();
    for (k_a, k_r) in [(1.0, 0.5), (0.1, 0.9), (0.5, 0.75)] {
        let mut engine = engine(&format!(
            r#"Scene(film: (width: 4, height: 3, transfer: Classic), camera: (position: (0, 0, 0), view: (0, 0, 1)), ambient: (1, 1, 1),
            background: (1, 1, 1), materials: {{ "m": (k_a: {k_a:?}, reflective: (k_r: {k_r:?})) }},
            entities: [(shape: Box(size: (2, 3, 4)), material: "m")])"#
        ));
        assert_cutoffs_hold(&mut engine, 100, &many, &format!("k_a {k_a}, k_r {k_r}"));
    }
    for (k_r, k_t, fresnel) in [(0.2, 0.6, false), (0.4, 0.5, false), (0.3, 0.69, true), (0.05, 0.9, true)] {
        let mut engine = engine(&format!(
            r#"Scene(film: (width: 16, height: 9, transfer: Classic), camera: (position: (0, 0, -3), view: (0, 0, 1)), background: (254.9, 254.9, 254.9),
            materials: {{ "m": (reflective: (k_r: {k_r:?}), refractive: (k_t: {k_t:?}, ior: 1.5, fresnel: {fresnel})) }},
            entities: [(shape: Sphere(radius: 1), material: "m")])"#
        ));
        assert_cutoffs_hold(&mut engine, 9, &many, &format!("k_r {k_r}, k_t {k_t}, Fresnel {fresnel}"));
    }
}

/// Returns a glass ball on a checkered floor, by day, with shells `inside` it.
fn ball_of_glass(inside: &str) -> Engine {
    engine(&format!(
        r#"Scene(film: (width: 64, height: 36), camera: (position: (0, 1.6, -5), target: (0, 1, 0), fov: 40), ambient: (0.3, 0.3, 0.3),
        background: (bottom: (255, 255, 255), top: (128, 179, 255)), materials: {{
            "floor": (k_a: 0.5, k_d: 0.7, color: (220, 220, 220), pattern: Checker(color: (60, 60, 60), size: 0.5)),
            "glass": (reflective: (k_r: 0.1), refractive: (k_t: 0.9, ior: 1.5, fresnel: true)),
            "water": (reflective: (k_r: 0.1), refractive: (k_t: 0.9, ior: 1.33, fresnel: true)),
            "bubble": (reflective: (k_r: 0.1), refractive: (k_t: 0.9, ior: 1, fresnel: true)) }},
        entities: [(shape: Plane(normal: (0, 1, 0)), material: "floor"),
            (shape: Sphere(radius: 1), material: "glass", transform: (translation: (0, 1, 0))), {inside}
            (light: Point(intensity: (1, 1, 1)), transform: (translation: (4, 6, -4)))])"#
    ))
}

/// Checks the number of rays in trees per camera ray that remain with a cutoff, although trees could reach the maximum size.
#[test]
fn trees_of_glass_are_small() {
    let shells = r#"(shape: Sphere(radius: 0.8), material: "water", transform: (translation: (0, 1, 0))),
        (shape: Sphere(radius: 0.5), material: "bubble", transform: (translation: (0.1, 1, 0))),"#;
    let each = |inside: &str, depth: u32, cutoff: f32| {
        let mut engine = ball_of_glass(inside);
        render(&mut engine, depth, cutoff);
        let rays = engine.report().rays;
        println!("depth {depth}, cutoff {cutoff}: {rays:?}");
        in_trees(rays) as f64 / rays.camera as f64
    };
    let ball = [30, 200, 1000].map(|depth| each("", depth, 0.25));
    assert!(ball[0] < 5.0, "{ball:?}");
    assert!(
        ball[1] <= 1.1 * ball[0] && ball[2] <= 1.1 * ball[0],
        "more generations alone cost no rays: {ball:?}"
    );
    assert!(each(shells, 30, 255.0) < 10.0);
    assert!(each(shells, 30, 20.0) < 150.0);
}

/// Checks that the reported counts are the counts of the trees of all samples.
#[test]
fn tree_ends_match_probe_trees() {
    let mut engine = engine(ROOM);
    set_film(&mut engine, FilmSettings { width: 16, height: 9, transfer: Transfer::Classic });
    for (depth, cutoff) in [(1, 0.0), (2, 0.0), (6, 0.0), (6, 2.0), (30, 2.0), (30, 100.0)] {
        render(&mut engine, depth, cutoff);
        let (mut rays, mut ends) = (RayCounts::default(), TreeEnds::default());
        for (i, j) in (0..9).flat_map(|j| (0..16).map(move |i| (i, j))) {
            for traced in &engine.probe(Time::ZERO, (i, j), 0).unwrap().unwrap().rays {
                ends.cutoff += traced.cut;
                match (&traced.end, traced.kind) {
                    (RayEnd::BeyondDepth(_), _) => {
                        ends.depth += 1;
                        ends.strong += u64::from(traced.throughput.max_element() >= 0.5);
                    }
                    (_, RayKind::Camera) => rays.camera += 1,
                    (_, RayKind::Reflection) => rays.reflection += 1,
                    (_, RayKind::Refraction) => rays.refraction += 1,
                }
            }
        }
        let report = engine.report();
        assert_eq!(report.ends, ends, "depth {depth}, cutoff {cutoff}");
        assert_eq!(RayCounts { shadow: 0, ..report.rays }, rays, "depth {depth}, cutoff {cutoff}");
        assert_eq!(ends.cutoff > 0, cutoff > 0.0);
        // The room is closed: every tree ends at one of the limits.
        assert!(ends.depth + ends.cutoff >= rays.camera);
    }
}

/// Returns a closed room whose walls reflect all light, with a ball that reflects and transmits all light.
fn doubling(depth: u32) -> Engine {
    engine(&format!(
        r#"Scene(film: (width: 8, height: 6, transfer: Classic), quality: (depth: {depth}, cutoff: 0), camera: (position: (0, 0, -3), view: (0, 0, 1)),
        ambient: (1, 1, 1), background: (255, 128, 0),
        materials: {{ "wall": (k_a: 0.5, reflective: (k_r: 1)), "both": (reflective: (k_r: 1), refractive: (k_t: 1, ior: 1.5)) }},
        entities: [(shape: Box(size: (9, 9, 9)), material: "wall"), (shape: Sphere(radius: 2), material: "both")])"#
    ))
}

#[test]
fn samples_respect_the_ray_limit() {
    let start = Instant::now();
    let mut engine = doubling(1000);
    render(&mut engine, 1000, 0.0);
    let report = engine.report();
    println!("{:?} {:?} in {:?}", report.rays, report.ends, start.elapsed());
    assert!(start.elapsed() < Duration::from_secs(30), "{:?}", start.elapsed());
    let largest = in_trees(report.rays);
    assert!(largest <= LARGEST_TREE * 48 && report.ends.depth > 0 && report.ends.cutoff == 0);
    // Rays that hit the ball first, in the middle of the view.
    for (i, j) in [(3, 2), (4, 3)] {
        let tree = engine.probe(Time::ZERO, (i, j), 0).unwrap().unwrap();
        let beyond = tree.rays.iter().filter(|traced| matches!(traced.end, RayEnd::BeyondDepth(_))).count();
        assert_eq!((tree.rays.len() - beyond) as u64, LARGEST_TREE);
        assert!(beyond > 0);
        assert_eq!(engine.probe(Time::ZERO, (i, j), 0).unwrap().unwrap().color(), tree.color());
    }
}

/// Checks light that is trapped in a glass box and doubled at every total reflection: k_r + k_t is 2. Light that exceeds the range of a
/// number is as bright as a number can be, and black stays black.
#[test]
fn unbounded_light_is_clamped() {
    for depth in [2, 11, 1000] {
        let mut engine = engine(
            r#"Scene(film: (width: 1, height: 1, transfer: Classic), camera: (position: (0.1, 0, 0), view: (1, 0, 1)), background: (255, 0, 0),
            materials: { "both": (reflective: (k_r: 1), refractive: (k_t: 1, ior: 1.5)) },
            entities: [(shape: Box(size: (2, 2, 2)), material: "both")])"#,
        );
        let film = render(&mut engine, depth, 0.0);
        let expected = if depth < 128 { libm::exp2f(depth as f32) } else { f32::MAX };
        assert_eq!(film.pixel(0, 0).to_array(), [expected, 0.0, 0.0], "{depth}");
    }
}
