//! What it costs to bring a world of many moving entities to a moment.
//!
//! `cargo bench --bench animate` prints the medians of 101 frames in milliseconds, on one thread and on two; `-- 4` takes
//! one and four.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a bench prints its table, and may fail loudly")]

use std::time::Instant;

use glam::{DQuat, DVec3};

use rayreel::animation::{Ease, Easing, Interpolate, Key, Rotation, Track};
use rayreel::color::Rgb;
use rayreel::components::{Animated, Channel, Material, Order, Property, Shape, Transform};
use rayreel::systems::{animate, propagate};
use rayreel::{Changes, Time, World};

const FRAMES: u64 = 101;

fn main() {
    let threads = std::env::args().find_map(|argument| argument.parse().ok()).unwrap_or(2);
    println!("| milliseconds a frame | threads | animate | propagate | together |");
    println!("|---|---|---|---|---|");
    for (name, count, channels) in [
        ("100 entities, translation", 100, translation as fn(f64) -> Vec<Channel>),
        ("100000 entities, translation", 100_000, translation),
        ("100000 entities, smooth translation", 100_000, smooth_translation),
        ("100000 entities, rotation and colour", 100_000, rotation_and_color),
    ] {
        for threads in [1, threads] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let [animate, propagate] = pool.install(|| medians(world(count, channels)));
            println!("| {name} | {threads} | {animate:.3} | {propagate:.3} | {:.3} |", animate + propagate);
        }
    }
}

fn medians(mut world: World) -> [f64; 2] {
    propagate(&mut world, &Changes::all());
    let mut times = [vec![], vec![]];
    for frame in 0..FRAMES {
        let mut changes = Changes::default();
        let start = Instant::now();
        animate(&mut world, Time::from_ratio(frame, 24).unwrap(), &mut changes);
        let animated = Instant::now();
        std::hint::black_box(propagate(&mut world, &changes));
        times[0].push((animated - start).as_secs_f64() * 1e3);
        times[1].push(animated.elapsed().as_secs_f64() * 1e3);
    }
    times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    })
}

fn world(count: u32, channels: fn(f64) -> Vec<Channel>) -> World {
    let mut world = World::new();
    for index in 0..count {
        let material = Material { k_a: 1.0, k_d: 0.0, color: Rgb::ONE, ambient_color: None };
        let animated = Animated(channels(f64::from(index)));
        let shape = Shape::Sphere { radius: 1.0 };
        world.spawn((Order(index.into()), shape, material, Transform::IDENTITY, animated));
    }
    world
}

/// Five keys, one a second.
fn track<T: Interpolate>(easing: Easing, value: impl Fn(f64) -> T) -> Track<T> {
    let key = |time: f64| Key { time, value: value(time), easing };
    Track::new([0.0, 1.0, 2.0, 3.0, 4.0].map(key).into()).unwrap()
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
