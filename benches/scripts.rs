//! What scripts cost: a frame of a thousand scripted values, and spawning a hundred thousand entities.
//!
//! `cargo bench --bench scripts` prints medians of 51 frames in milliseconds.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a bench prints its table, and may fail loudly")]

use std::time::Instant;

use rayreel::{Engine, Scene};

const FRAMES: u32 = 51;

fn main() {
    println!("| milliseconds | |");
    println!("|---|---|");
    for (name, script) in [
        ("1000 values, a circle", "[3 * cos(t + index), 1, 3 * sin(t + index)]"),
        ("1000 values, a wave over the base", "base + [0, sin(pi * (t + 0.1 * index)), 0]"),
        ("1000 values, noise", "base + [noise(t, index), noise(t, index + 0.5), noise(t, index, 3)]"),
        ("1000 values, each reads another", "value(`lead`, `Translation`) + [index, 0, 0]"),
        ("1000 values, a loop of ten", "let y = 0; for i in 1..11 { y += sin(i * t) / i; } [index, y, 0]"),
    ] {
        println!("| {name} | {:.2} |", median(script));
    }
    let start = Instant::now();
    let script =
        "for i in 0..100000 { spawn(#{ shape: sphere(0.1), material: `m`, translation: [i, 0, 0] }); }";
    load(&format!("spawn: [Script(\"{script}\")]"));
    println!("| 100000 entities spawned | {:.0} |", start.elapsed().as_secs_f64() * 1e3);
}

fn load(rest: &str) -> Engine {
    let text = format!(
        "(timeline: (duration: 60), camera: (position: (0, 0, -9), target: (0, 0, 0)), materials: {{ \"m\": (k_a: 1) }}, {rest})"
    );
    Engine::from_scene(Scene::from_text("bench.ron", text).unwrap())
}

/// Of the time that the world takes to be brought to a moment, without what tracing needs.
fn median(script: &str) -> f64 {
    let entities: String = (0..1000).map(|index| format!("(name: \"e{index}\"),")).collect();
    let animate: String = (0..1000)
        .map(|index| format!("(target: \"e{index}\", channel: Translation, track: Script(\"{script}\")),"))
        .collect();
    let mut engine = load(&format!("entities: [(name: \"lead\"), {entities}], animate: [{animate}]"));
    let mut times = Vec::new();
    for frame in 0..FRAMES {
        engine.seek(engine.timeline().time_of(frame)).unwrap();
        times.push(engine.report().animate.as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
