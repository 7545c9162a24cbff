//! Whether pictures are as good as they are asked to be, and at what price.
//!
//! `cargo bench --bench targets` renders frames of six scenes, of 480 by 270 pixels, for four errors, as `render --max-error` does, compares
//! them with long references, and times them beside every number of samples from 1 to 64 and every error that the sweep of `rayreel
//! accuracy` has. Then it tells how many samples pictures take that have as many in all pixels, compared with those that have
//! as many as each pixel needs, for the same error. It takes from one minute a scene to ten or more; the name of a scene after `--`
//! measures that alone.

#![allow(
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "a bench prints its table, and no bits depend on it"
)]

use std::path::Path;
use std::time::Instant;

use rayreel::accuracy::{Converged, FilmError, FrameSamples, Spread};
use rayreel::components::{FilmSettings, Sampling};
use rayreel::{Engine, Knobs, Time};

const SCENES: [&str; 6] =
    ["first_light", "chess_morning", "hall_of_mirrors", "stage_lights", "box_field", "robot_arm"];
const ERRORS: [f32; 4] = [4.0, 2.0, 1.0, 0.5];
/// Frames of each scene, spread from the first to the last.
const FRAMES: u32 = 5;
/// Samples of each of a reference's pictures.
const SAMPLES: u32 = 512;
const PICTURES: u64 = 3;
const ROUNDS: u32 = 5;
const SIZE: (u32, u32) = (480, 270);

fn main() {
    let wanted: Vec<String> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    println!(
        "| scene | error asked for | errors found, frame by frame | reference's | time / that of the quickest that is as good in all \
         frames | in the middle one |"
    );
    println!("|---|---|---|---|---|---|");
    let is_wanted = |scene: &&str| wanted.is_empty() || wanted.iter().any(|name| name == *scene);
    let gains: Vec<(&str, String)> =
        SCENES.into_iter().filter(is_wanted).map(|scene| (scene, measure(scene))).collect();
    println!("\n| scene | samples in all pixels / as many as each needs, for the same error |");
    println!("|---|---|");
    for (scene, gains) in gains {
        println!("| {scene} | {gains} |");
    }
}

/// Measures a scene, and returns what it gains by samples where they are needed.
fn measure(scene: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene).with_extension("ron");
    let mut engine = Engine::load(path).expect("shipped scenes are good");
    for film in engine.world_mut().query_mut::<&mut FilmSettings>() {
        (film.width, film.height) = SIZE;
    }
    let timeline = engine.timeline();
    let last = timeline.frame_count() - 1;
    let frames: Vec<Time> = (0..FRAMES).map(|frame| timeline.time_of(last * frame / (FRAMES - 1))).collect();
    let references: Vec<Converged> = frames.iter().map(|frame| reference(&mut engine, *frame)).collect();
    let uncertainty = references.iter().map(|reference| reference.rms).fold(0.0, f64::max);
    let middle = FRAMES as usize / 2;
    for asked in ERRORS {
        let chosen = FrameSamples::for_error(asked, Sampling::LARGEST_COUNT);
        let found: Vec<f64> = frames
            .iter()
            .zip(&references)
            .map(|(frame, reference)| error(&mut engine, *frame, chosen, reference))
            .collect();
        let [all, one] = price(&mut engine, &frames, (chosen, asked), &references);
        let found: Vec<String> = found.iter().map(|error| format!("{error:.2}")).collect();
        println!("| {scene} | {asked} | {} | {uncertainty:.2} | {all:.2} | {one:.2} |", found.join(", "));
    }
    gains(&mut engine, frames[middle], &references[middle])
}

/// Returns by how much fewer samples are taken where they are needed, for several errors.
fn gains(engine: &mut Engine, frame: Time, reference: &Converged) -> String {
    let pixels = f64::from(SIZE.0 * SIZE.1);
    let mut uniform = Vec::new();
    for exponent in 1..10 {
        let samples = 1 << exponent;
        let found = error(engine, frame, FrameSamples::everywhere(samples), reference);
        uniform.push((f64::from(samples), found));
    }
    let told = [4.0, 2.0, 1.0, 0.5, 0.25].map(|asked| {
        let found = error(engine, frame, FrameSamples::for_error(asked, Sampling::LARGEST_COUNT), reference);
        let samples = engine.report().rays.camera as f64 / pixels;
        let gain = samples_for(&uniform, found).map_or_else(
            || "more than 512 in all pixels".to_owned(),
            |all| format!("{:.2} ({all:.1} / {samples:.1})", all / samples),
        );
        format!("{found:.2}: {gain}")
    });
    told.join(", ")
}

/// Returns the samples that an error takes, between those that were measured: on lines between logarithms.
fn samples_for(measured: &[(f64, f64)], error: f64) -> Option<f64> {
    let (few, fewest_error) = measured[0];
    if error >= fewest_error {
        return Some(few);
    }
    measured.windows(2).find(|pair| pair[1].1 <= error).map(|pair| {
        let [(few, large), (many, small)] = [pair[0], pair[1]];
        few * (many / few).powf((large / error).ln() / (large / small).ln())
    })
}

fn reference(engine: &mut Engine, frame: Time) -> Converged {
    let films: Vec<_> = (1..=PICTURES)
        .map(|seed| {
            let knobs = Knobs {
                seed: Some(seed << 32),
                samples: Some(SAMPLES),
                max_error: Some(0.0),
                ..Knobs::default()
            };
            engine.set_knobs(knobs);
            engine.render_at(frame).expect("shipped scenes can be rendered")
        })
        .collect();
    Converged::mean(&films, engine.film_settings().transfer)
}

fn error(engine: &mut Engine, frame: Time, samples: FrameSamples, reference: &Converged) -> f64 {
    engine.set_knobs(samples.knobs());
    let film = engine.render_at(frame).expect("shipped scenes can be rendered");
    FilmError::between(&film, &reference.film, engine.film_settings().transfer).rms
}

/// Returns the time of the middle frame with the chosen samples as a multiple of that with the quickest setting whose error is as small as
/// asked: in all frames, and in that alone.
fn price(
    engine: &mut Engine,
    frames: &[Time],
    (chosen, asked): (FrameSamples, f32),
    references: &[Converged],
) -> [f64; 2] {
    let (frame, reference) = (frames[frames.len() / 2], &references[frames.len() / 2]);
    let uniform = (0..7).map(|exponent| FrameSamples::everywhere(1 << exponent));
    let adaptive =
        [0.25, 0.5, 1.0, 2.0, 4.0].map(|error| FrameSamples::for_error(error, Sampling::LARGEST_COUNT));
    let good: Vec<FrameSamples> = uniform
        .chain(adaptive)
        .filter(|samples| error(engine, frame, *samples, reference) <= f64::from(asked))
        .collect();
    let in_all: Vec<bool> = good
        .iter()
        .map(|samples| {
            let mut all = frames.iter().zip(references);
            all.all(|(frame, reference)| error(engine, *frame, *samples, reference) <= f64::from(asked))
        })
        .collect();
    let mut seconds = vec![Vec::new(); good.len() + 1];
    for _ in 0..ROUNDS {
        for (samples, seconds) in good.iter().chain([&chosen]).zip(&mut seconds) {
            engine.set_knobs(samples.knobs());
            let start = Instant::now();
            engine.render_at(frame).expect("shipped scenes can be rendered");
            seconds.push(start.elapsed().as_secs_f64());
        }
    }
    let medians: Vec<f64> = seconds.iter().map(|seconds| Spread::of(seconds).median).collect();
    let (chosen, others) = medians.split_last().expect("there is the chosen one");
    let quickest = |is_meant: &dyn Fn(usize) -> bool| {
        let meant = others.iter().enumerate().filter(|(place, _)| is_meant(*place));
        meant.map(|(_, seconds)| *seconds).fold(*chosen, f64::min)
    };
    [chosen / quickest(&|place| in_all[place]), chosen / quickest(&|_| true)]
}
