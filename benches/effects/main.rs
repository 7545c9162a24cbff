//! Costs of effects, absent and present.
//!
//! `cargo bench --bench effects` prints a table of milliseconds. `benches/instructions` counts instructions under valgrind with the same
//! program, by `count planned|full SCENE FRAMES`.
//!
//! Divan is not used, unlike in other benches. Renders with the planned effects alternate with renders with all effects, because ratios of
//! a few per cent matter. Valgrind needs a program that renders a given number of frames and measures nothing.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a bench prints its table, and may fail loudly")]

use std::hint::black_box;
use std::time::Instant;

use rayreel::{Engine, RenderSettings, Scene};

/// The base scene, with placeholders for lines that enable one effect each.
const BASE: &str = include_str!("base.ron");

/// Effects by name, with pairs of a placeholder and its replacement.
const EFFECTS: &[(&str, &[(&str, &str)])] = &[
    ("ambient light only", &[("/* lights */", "")]),
    ("point lights without shadows", &[("/* lights */", UNSHADOWED)]),
    ("point lights with shadows", &[]),
    ("highlights", &[("/* clay */", "specular: (k_s: 0.5, shininess: 50),")]),
    ("spot lights", &[("/* lights */", SPOTS)]),
    ("falloff", &[("/* lights */", FADING)]),
    ("area lights, 4 samples", &[("/* lights */", BALLS)]),
    ("ambient occlusion, 1 sample", &[("/* scene */", "ambient_occlusion: (samples: 1, distance: 3),")]),
    ("ambient occlusion, 4 samples", &[("/* scene */", "ambient_occlusion: (samples: 4, distance: 3),")]),
    ("ambient occlusion, 16 samples", &[("/* scene */", "ambient_occlusion: (samples: 16, distance: 3),")]),
    ("mirrors", &[("/* metal */", "reflective: (k_r: 0.5),")]),
    ("mirrors of metal", &[("/* metal */", "metallic: true, reflective: (k_r: 0.5),")]),
    ("transparent media", &[("/* metal */", "refractive: (k_t: 0.8, ior: 1.5),")]),
    ("transparent media, Fresnel", &[("/* metal */", "refractive: (k_t: 0.8, ior: 1.5, fresnel: true),")]),
    (
        "transparent media, absorption",
        &[("/* metal */", "refractive: (k_t: 0.8, ior: 1.5, absorption: (1, 0.5, 0.2)),")],
    ),
    ("checker", &[("/* clay */", "pattern: Checker(color: (20, 20, 20), size: 1),")]),
    ("emission", &[("/* clay */", "emission: (0.1, 0.1, 0.1),")]),
    ("shapes without shadows", &[("/* entity */", "casts_shadow: false,")]),
    ("fog", &[("/* scene */", "fog: (color: (90, 90, 100), density: 0.05),")]),
    ("gradient", &[("/* scene */", "background: (bottom: (20, 20, 20), top: (80, 120, 200)),")]),
    ("4 samples a pixel", &[("/* scene */", "sampling: (samples: 4),")]),
    (
        "4 samples, a lens",
        &[("/* scene */", "sampling: (samples: 4),"), ("/* camera */", "lens: (aperture: 0.2, focus: 8),")],
    ),
    (
        "4 samples, motion blur",
        &[
            ("/* scene */", "sampling: (samples: 4, instants: 4),"),
            ("/* camera */", "shutter: 0.5,"),
            ("/* end */", MOVING),
        ],
    ),
];

const MOVING: &str = "animate: [(target: \"ball\", channel: Translation, track: Keys([(0, (1, 0.7, -1.5)), (1, (3, 0.7, -1.5))]))],";
const UNSHADOWED: &str =
    "(light: Point(intensity: (0.6, 0.6, 0.6), casts_shadows: false), transform: (translation: (-5, 8, -6))),
    (light: Point(intensity: (0.3, 0.3, 0.3), casts_shadows: false), transform: (translation: (6, 5, -4))),";
const POINTS: &str = "(light: Point(intensity: (0.6, 0.6, 0.6)), transform: (translation: (-5, 8, -6))),
    (light: Point(intensity: (0.3, 0.3, 0.3)), transform: (translation: (6, 5, -4))),";
const SPOTS: &str = "(light: Spot(intensity: (0.6, 0.6, 0.6), angle: 60, softness: 0.3), transform: (translation: (-5, 8, -6), rotation: Euler(45, 40, 0))),
    (light: Spot(intensity: (0.3, 0.3, 0.3), angle: 60, softness: 0.3), transform: (translation: (6, 5, -4), rotation: Euler(35, -55, 0))),";
const FADING: &str = "(light: Point(intensity: (0.9, 0.9, 0.9), falloff: (1, 0.05, 0.001)), transform: (translation: (-5, 8, -6))),
    (light: Point(intensity: (0.5, 0.5, 0.5), falloff: (1, 0.05, 0.001)), transform: (translation: (6, 5, -4))),";
const BALLS: &str = "(light: Area(shape: Sphere(radius: 0.5), samples: 4, intensity: (0.6, 0.6, 0.6)), transform: (translation: (-5, 8, -6))),
    (light: Area(shape: Sphere(radius: 0.5), samples: 4, intensity: (0.3, 0.3, 0.3)), transform: (translation: (6, 5, -4))),";

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| match &arguments[..] {
        [command, kernel, scene, frames] if command == "count" => {
            count(kernel, scene, frames.parse().unwrap());
        }
        [command] if command == "list" => EFFECTS.iter().for_each(|(name, _)| println!("{name}")),
        _ => table(arguments.first().and_then(|rounds| rounds.parse().ok()).unwrap_or(7)),
    });
}

/// Returns the base scene with an effect's lines inserted.
fn scene_text(lines: &[(&str, &str)]) -> String {
    let with = |text: String, (mark, line): &(&str, &str)| text.replace(mark, line);
    let text = lines.iter().fold(BASE.to_owned(), with);
    text.replace("/* lights */", POINTS)
}

fn engine(lines: &[(&str, &str)]) -> Engine {
    Engine::from_scene(Scene::from_text("base.ron", scene_text(lines)).unwrap())
}

/// Renders `frames` frames for counting from outside. Costs that do not depend on the number of frames cancel out.
fn count(kernel: &str, scene: &str, frames: u32) {
    let (_, lines) = EFFECTS.iter().find(|(name, _)| *name == scene).unwrap();
    let mut engine = engine(lines);
    engine.settings = RenderSettings { all_effects: kernel == "full", ..engine.settings };
    for _ in 0..frames {
        drop(black_box(engine.render_frame(0).unwrap()));
    }
}

/// Prints the medians of alternating renders on one thread.
fn table(rounds: usize) {
    let mut engines: Vec<_> = EFFECTS.iter().map(|(name, lines)| (name, engine(lines))).collect();
    let mut times = vec![Vec::new(); engines.len()];
    for _ in 0..rounds {
        for ((_, engine), times) in engines.iter_mut().zip(&mut times) {
            let mut time = |full| {
                engine.settings = RenderSettings { all_effects: full, ..engine.settings };
                let start = Instant::now();
                black_box(engine.render_frame(0).unwrap());
                start.elapsed().as_secs_f64() * 1e3
            };
            times.push((time(false), time(true)));
        }
    }
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    println!("| 480 x 270, milliseconds | planned effects | all effects | all over planned |");
    println!("|---|---|---|---|");
    for ((name, _), times) in engines.iter().zip(times) {
        let planned = median(times.iter().map(|time| time.0).collect());
        let full = median(times.iter().map(|time| time.1).collect());
        println!("| {name} | {planned:.1} | {full:.1} | {:.2} |", full / planned);
    }
}
