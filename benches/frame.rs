//! Cost of a frame apart from its rays: advancing a world of many moving entities to a time, and encoding the picture.
//!
//! `cargo bench --bench frame` measures on rayon's default number of threads; `RAYON_NUM_THREADS=1` sets it to one. `-- animate`,
//! `-- scripts`, `-- propagate`, `-- prepare` and `-- encode` measure one part each; `-- --sample-count 5` is quicker.

use std::cell::RefCell;
use std::fmt;

use divan::Bencher;
use divan::counter::ItemsCount;
use glam::{DQuat, DVec3};

use rayreel::animation::{Ease, Easing, Interpolate, Key, Rotation, Track};
use rayreel::color::{Rgb, Transfer};
use rayreel::components::{Animated, Channel, Material, Order, Property, Shape, Transform};
use rayreel::output::{FrameFormat, encode as encode_as, encode_quickly};
use rayreel::systems::{Preparation, animate as run_tracks, propagate as run_propagation};
use rayreel::{Changes, Engine, Entity, Film, Scene, Time, World};

#[expect(dead_code, reason = "the kernel's bench looks at more of it")]
mod shipped;

use shipped::SCENES;

fn main() {
    rayon::ThreadPoolBuilder::new().use_current_thread().build_global().expect("there is none");
    divan::main();
}

/// A number of entities with tracks of one kind.
struct Crowd {
    count: u32,
    name: &'static str,
    channels: fn(f64) -> Vec<Channel>,
}

impl fmt::Display for Crowd {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} x {}", self.count, self.name)
    }
}

const CROWDS: [Crowd; 4] = [
    Crowd { count: 100, name: "translation", channels: translation },
    Crowd { count: 100_000, name: "translation", channels: translation },
    Crowd { count: 100_000, name: "smooth translation", channels: smooth_translation },
    Crowd { count: 100_000, name: "rotation and colour", channels: rotation_and_color },
];

/// Evaluates tracks, frame after frame.
#[divan::bench(args = CROWDS, sample_count = 101, sample_size = 1)]
fn animate(bencher: Bencher<'_, '_>, crowd: &Crowd) {
    let mut world = crowd.world();
    let mut frames = frames();
    bencher
        .counter(ItemsCount::new(crowd.count))
        .with_inputs(|| (frames(), Changes::default()))
        .bench_local_refs(|(time, changes)| run_tracks(&mut world, *time, changes));
}

/// Propagates the transforms that tracks moved, frame after frame.
#[divan::bench(args = CROWDS, sample_count = 101, sample_size = 1)]
fn propagate(bencher: Bencher<'_, '_>, crowd: &Crowd) {
    let world = RefCell::new(crowd.world());
    let mut frames = frames();
    let moved = || moved(&mut world.borrow_mut(), frames());
    bencher
        .counter(ItemsCount::new(crowd.count))
        .with_inputs(moved)
        .bench_local_refs(|changes| run_propagation(&mut world.borrow_mut(), changes));
}

/// Conversion of the world to the kernel's arrays: everything, or only changes since the last frame.
mod prepare {
    use super::*;

    #[divan::bench(args = CROWDS, sample_count = 21, sample_size = 1)]
    fn all(bencher: Bencher<'_, '_>, crowd: &Crowd) {
        let mut world = crowd.world();
        bencher.counter(ItemsCount::new(crowd.count)).bench_local(|| Preparation::of(&mut world, Time::ZERO));
    }

    #[divan::bench(args = CROWDS, sample_count = 21, sample_size = 1)]
    fn moved(bencher: Bencher<'_, '_>, crowd: &Crowd) {
        let mut world = crowd.world();
        let mut preparation = Preparation::of(&mut world, Time::ZERO);
        let world = RefCell::new(world);
        let mut frames = frames();
        let next = || {
            let (world, time) = (&mut *world.borrow_mut(), frames());
            let changes = super::moved(world, time);
            let moved = run_propagation(world, &changes);
            (time, changes, moved)
        };
        bencher.counter(ItemsCount::new(crowd.count)).with_inputs(next).bench_local_refs(
            |(time, changes, moved): &mut (Time, Changes, Vec<Entity>)| {
                preparation.update(&mut world.borrow_mut(), *time, changes, moved)
            },
        );
    }

    #[divan::bench(args = SCENES)]
    fn shipped(bencher: Bencher<'_, '_>, name: &str) {
        let (mut world, middle) = super::shipped::world(name);
        bencher.bench_local(|| Preparation::of(&mut world, middle));
    }
}

/// Returns a function that gives the time of the next frame. It restarts after four seconds, when all tracks have ended.
fn frames() -> impl FnMut() -> Time {
    let mut frames = (0..97).cycle();
    move || Time::from_ratio(frames.next().unwrap_or(0), 24).expect("it is finite")
}

/// Evaluates tracks at a time, and returns the changes.
fn moved(world: &mut World, time: Time) -> Changes {
    let mut changes = Changes::default();
    run_tracks(world, time, &mut changes);
    changes
}

impl Crowd {
    /// Returns a world with these entities, propagated at time 0.
    fn world(&self) -> World {
        let mut world = World::new();
        for index in 0..self.count {
            let material =
                Material { k_a: 1.0, k_d: 0.0, color: Rgb::ONE, ambient_color: None, metallic: false };
            let animated = Animated((self.channels)(f64::from(index)));
            let shape = Shape::Sphere { radius: 1.0 };
            world.spawn((Order(index.into()), shape, material, Transform::IDENTITY, animated));
        }
        run_propagation(&mut world, &Changes::all());
        world
    }
}

/// Returns a track with five keys, one per second.
fn track<T: Interpolate>(easing: Easing, value: impl Fn(f64) -> T) -> Track<T> {
    let key = |time: f64| Key { time, value: value(time), easing };
    Track::new([0.0, 1.0, 2.0, 3.0, 4.0].map(key).into()).expect("times ascend")
}

fn point(index: f64, time: f64) -> DVec3 {
    DVec3::new(index % 100.0, (index / 100.0).floor(), (index * 0.618 + 0.3 * time) % 1.0)
}

fn translation(index: f64) -> Vec<Channel> {
    vec![Channel::new(Property::Translation, track(Easing::Linear, |time| point(index, time)))]
}

fn smooth_translation(index: f64) -> Vec<Channel> {
    vec![Channel::new(Property::Translation, track(Easing::CatmullRom, |time| point(index, time)))]
}

fn rotation_and_color(index: f64) -> Vec<Channel> {
    let turned =
        |time: f64| -> DQuat { Rotation::AxisAngle(DVec3::ONE, (index + time).to_degrees()).quaternion() };
    let painted = |time: f64| DVec3::splat(0.5 + 0.1 * time).as_vec3();
    vec![
        Channel::new(Property::Rotation, track(Easing::InOut(Ease::Sine), turned)),
        Channel::new(Property::Color, track(Easing::Linear, painted)),
    ]
}

/// A name, and a script that drives a thousand values.
struct Script(&'static str, &'static str);

impl fmt::Display for Script {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.0)
    }
}

const SCRIPTS: [Script; 5] = [
    Script("a circle", "[3 * cos(t + index), 1, 3 * sin(t + index)]"),
    Script("a wave over the base", "base + [0, sin(pi * (t + 0.1 * index)), 0]"),
    Script("noise", "base + [noise(t, index), noise(t, index + 0.5), noise(t, index, 3)]"),
    Script("each reads another", "value(`lead`, `Translation`) + [index, 0, 0]"),
    Script("a loop of ten", "let y = 0; for i in 1..11 { y += sin(i * t) / i; } [index, y, 0]"),
];

/// Evaluates a thousand script values, frame after frame. Nothing is rendered.
#[divan::bench(args = SCRIPTS, sample_count = 51, sample_size = 1)]
fn scripts(bencher: Bencher<'_, '_>, Script(_, script): &Script) {
    let entities: String = (0..1000).map(|index| format!("(name: \"e{index}\"),")).collect();
    let animate: String = (0..1000)
        .map(|index| format!("(target: \"e{index}\", channel: Translation, track: Script(\"{script}\")),"))
        .collect();
    let text = format!(
        "(timeline: (duration: 60), camera: (position: (0, 0, -9), target: (0, 0, 0)), materials: {{ \"m\": (k_a: 1) }},
        entities: [(name: \"lead\"), {entities}], animate: [{animate}])"
    );
    let scene = Scene::from_text("scripts.ron", text).unwrap_or_else(|error| panic!("{error}"));
    let mut engine = Engine::from_scene(scene);
    let frames = frames();
    bencher
        .counter(ItemsCount::new(1000_u32))
        .with_inputs(frames)
        .bench_local_values(|time| engine.seek(time).unwrap_or_else(|error| panic!("{error}")));
}

/// Encoding of a picture of 480 x 270 pixels as the bytes of a file.
mod encode {
    use super::*;

    #[divan::bench(args = SCENES)]
    fn png(bencher: Bencher<'_, '_>, name: &str) {
        measure(bencher, name, |film, transfer| encode_as(film, transfer, FrameFormat::default()));
    }

    #[divan::bench(args = SCENES)]
    fn png_quickly(bencher: Bencher<'_, '_>, name: &str) {
        measure(bencher, name, encode_quickly);
    }

    #[divan::bench(args = SCENES)]
    fn ppm(bencher: Bencher<'_, '_>, name: &str) {
        measure(bencher, name, |film, transfer| encode_as(film, transfer, FrameFormat::Ppm));
    }

    fn measure<T, E: fmt::Display>(
        bencher: Bencher<'_, '_>,
        name: &str,
        encode: impl Fn(&Film, Transfer) -> Result<T, E>,
    ) {
        let (world, middle) = super::shipped::world(name);
        let mut engine = Engine::new(world);
        let film = engine.render(middle).unwrap_or_else(|error| panic!("{error}")).film;
        let transfer = engine.effective_settings().film.transfer;
        bencher
            .counter(ItemsCount::new(film.pixels().len()))
            .bench_local(|| encode(&film, transfer).unwrap_or_else(|error| panic!("{error}")));
    }
}
