//! Whether pictures are as good as they are asked to be, and at what price.
//!
//! `cargo bench --bench targets` renders frames of six scenes for four errors, as `render --max-error` does, compares them with long
//! references, and times them beside every number of samples from 1 to 64 and every error that the sweep of `rayreel accuracy` has. It
//! takes a quarter of an hour; the name of a scene after `--` measures that alone.

#![allow(clippy::print_stdout, reason = "a bench prints its table")]

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use rayreel::accuracy::{Converged, FewSamples, FilmError, FrameSamples, Pilot, Spread};
use rayreel::components::Sampling;
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

fn main() {
    let wanted: Vec<String> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    println!(
        "| scene | error asked for | settings | errors found, frame by frame | reference's | time / that of the quickest that is as good |"
    );
    println!("|---|---|---|---|---|---|");
    for scene in
        SCENES.into_iter().filter(|scene| wanted.is_empty() || wanted.iter().any(|name| name == scene))
    {
        measure(scene);
    }
}

fn measure(scene: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene).with_extension("ron");
    let mut engine = Engine::load(path).expect("shipped scenes are good");
    let timeline = engine.timeline();
    let last = timeline.frame_count() - 1;
    let frames: Vec<Time> = (0..FRAMES).map(|frame| timeline.time_of(last * frame / (FRAMES - 1))).collect();
    let references: Vec<Converged> = frames.iter().map(|frame| reference(&mut engine, *frame)).collect();
    let all = timeline.frame_count() as usize;
    let pilot =
        Pilot::new(all, |frame| timeline.time_of(u32::try_from(frame).expect("frames are counted so")));
    let uncertainty = references.iter().map(|reference| reference.rms).fold(0.0, f64::max);
    let middle = FRAMES as usize / 2;
    for asked in ERRORS {
        let few = FewSamples::estimate(&mut engine, &pilot, asked.into(), &AtomicBool::new(false))
            .expect("shipped scenes can be rendered")
            .expect("nobody cancels");
        let chosen =
            few.samples_for(asked, Sampling::LARGEST_COUNT).expect("so many samples are always enough");
        let found: Vec<f64> = frames
            .iter()
            .zip(&references)
            .map(|(frame, reference)| error(&mut engine, *frame, chosen, reference))
            .collect();
        let ratio = price(&mut engine, frames[middle], (chosen, asked), &references[middle]);
        let settings = match chosen.max_error {
            0.0 => format!("{} samples", chosen.samples),
            error => format!("max error {error}"),
        };
        let found: Vec<String> = found.iter().map(|error| format!("{error:.2}")).collect();
        println!("| {scene} | {asked} | {settings} | {} | {uncertainty:.2} | {ratio:.2} |", found.join(", "));
    }
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

/// Returns the time of a frame with the chosen samples as a multiple of that with the quickest setting whose error is as small as
/// asked.
fn price(
    engine: &mut Engine,
    frame: Time,
    (chosen, asked): (FrameSamples, f32),
    reference: &Converged,
) -> f64 {
    let uniform = (0..7).map(|exponent| FrameSamples { samples: 1 << exponent, max_error: 0.0 });
    let adaptive =
        [0.25, 0.5, 1.0, 2.0, 4.0].map(|error| FrameSamples::for_error(error, Sampling::LARGEST_COUNT));
    let good: Vec<FrameSamples> = uniform
        .chain(adaptive)
        .filter(|samples| error(engine, frame, *samples, reference) <= f64::from(asked))
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
    chosen / others.iter().copied().fold(*chosen, f64::min)
}
