//! Accuracy and cost of error targets on scenes that are hard to sample.
//!
//! `cargo bench --bench hard` renders one frame of every hard scene, and of shipped ones, for four targets and compares it with a reference
//! of many samples. It prints the true error, the estimate, the sample count, and the rays and the processor time relative to the cheapest
//! uniform sample count that meets the target, on one thread. `cargo bench --bench hard -- run` renders one frame of each scene with twelve seeds and
//! prints only errors. Scene names after `--` select scenes. The bench takes about half an hour.

#![allow(
    clippy::print_stdout,
    clippy::disallowed_methods,
    clippy::unwrap_used,
    reason = "a bench prints its table, and no bits depend on it"
)]

#[path = "../tests/accuracy/hard_scenes.rs"]
mod hard_scenes;
#[path = "../tests/processor_time/spent.rs"]
mod spent;

use hard_scenes::hard_scenes;
use rayreel::accuracy::FilmError;
use rayreel::color::Transfer;
use rayreel::trace::{EstimatedError, Film};
use rayreel::{Engine, RenderRequest, RenderSettings, Rgb, Scene};
use spent::Spent;

const TARGETS: [f32; 4] = [4.0, 2.0, 1.0, 0.5];
const UNIFORM: [u32; 17] = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 512];
/// Sample counts of references for hard and for shipped scenes. They are repeated with other seeds until the mean's own error is at most
/// `REFERENCE_ERROR`, a tenth of the smallest target, or for as many as `REPEATS` times.
const REFERENCE: [u32; 2] = [65_536, 8192];
const REFERENCE_ERROR: f64 = 0.05;
const REPEATS: u64 = 128;
/// Index of the frame whose cost is measured. It is rendered repeatedly for more than `LONG` seconds.
const FRAME: u32 = 6;
const LONG: f64 = 0.2;
/// The number of seeds of a run.
const RUN: u64 = 12;

struct Subject {
    name: String,
    engine: Engine,
    alpha: bool,
    reference: u32,
}

struct Picture {
    film: Film,
    rays: f64,
    seconds: f64,
    estimate: Option<EstimatedError>,
}

/// The mean of films of many samples, and its own error.
struct Reference {
    film: Film,
    error: f64,
    transfer: Transfer,
}

impl Reference {
    /// Renders a reference as two halves: their means differ by twice the error of the whole mean.
    fn render(subject: &mut Subject, frame: u32) -> Self {
        let transfer = subject.engine.effective_settings().film.transfer;
        let mut part = |seed| {
            let settings = RenderSettings {
                samples: Some(subject.reference / 2),
                max_error: Some(0.0),
                seed: Some(seed),
                instants: Some(256),
                ..RenderSettings::default()
            };
            render(subject, frame, settings).film
        };
        let mut halves = [1000, 1001].map(&mut part);
        let mut repeats = 1;
        let error = loop {
            let error = FilmError::between(&halves[0], &halves[1], transfer).rms / 2.0;
            if error <= REFERENCE_ERROR || repeats == REPEATS {
                break error;
            }
            repeats += 1;
            for (half, seed) in halves.iter_mut().zip(1000 * repeats..) {
                *half = mix(half, &part(seed), 1.0 / repeats as f32);
            }
        };
        let film = mix(&halves[0], &halves[1], 0.5);
        Self { film, error, transfer }
    }

    /// Returns the error of a film, without that of the reference.
    fn error_of(&self, film: &Film) -> f64 {
        let found = FilmError::between(film, &self.film, self.transfer).rms;
        (found.powi(2) - self.error.powi(2)).max(0.0).sqrt()
    }
}

/// Returns a film between two: the first for a weight of 0, the second for 1.
fn mix(first: &Film, second: &Film, weight: f32) -> Film {
    let pixels = first
        .pixels()
        .iter()
        .zip(second.pixels())
        .map(|(first, second)| *first + (*second - *first) * weight);
    Film::from_pixels(first.width(), first.height(), pixels)
}

/// Counts of measurements: all, within the target, within the target or reported, and with a close estimate.
#[derive(Default)]
struct TargetTally {
    points: u32,
    within: u32,
    honest: u32,
    close: u32,
}

impl TargetTally {
    fn add(
        &mut self,
        found: f64,
        target: f32,
        EstimatedError { value, deviation, hidden }: EstimatedError,
    ) -> bool {
        let is_within = found <= f64::from(target);
        self.points += 1;
        self.within += u32::from(is_within);
        self.honest += u32::from(is_within || found <= (value + 2.0 * deviation).hypot(hidden));
        self.close += u32::from((0.8..=2.0).contains(&(value / found)) || found < 0.05);
        is_within
    }

    fn print(&self) {
        let Self { points, within, honest, close } = self;
        println!(
            "\n{within} of {points} within the target; {honest} within it or reported; {close} estimates between 0.8 and 2 times the error"
        );
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let (run, wanted): (Vec<String>, Vec<String>) = words.into_iter().partition(|word| word == "run");
    let wants = |name: &str| wanted.is_empty() || wanted.iter().any(|wanted| name == wanted);
    let hard = hard_scenes().into_iter().map(|scene| {
        let loaded = Scene::from_text(scene.name, scene.text).unwrap_or_else(|error| panic!("{error}"));
        let (name, engine) = (scene.name.to_owned(), Engine::from_scene(loaded));
        Subject { name, engine, alpha: scene.alpha, reference: REFERENCE[0] }
    });
    let subjects = hard.chain(shipped()).filter(|subject| wants(&subject.name));
    if run.is_empty() { measure_costs(subjects) } else { runs(subjects) }
}

/// Measures the error and the cost of one frame of each subject, on one thread, and prints a table.
fn measure_costs(subjects: impl Iterator<Item = Subject>) {
    println!(
        "| scene | target | true error | estimate | samples a pixel | cheapest uniform | rays / its | time / its |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let (mut tally, mut costs) = (TargetTally::default(), Vec::new());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for mut subject in subjects {
        let (name, reference) = (subject.name.clone(), Reference::render(&mut subject, FRAME));
        // Processor time is counted in ticks of some milliseconds: as many pictures as it takes for many of them.
        let mut timed = |settings: RenderSettings| {
            pool.install(|| {
                let (start, mut count) = (Spent::now(), 0.0);
                loop {
                    let picture = render(&mut subject, FRAME, settings);
                    count += 1.0;
                    let seconds = Spent::now().since(start).as_secs_f64();
                    if seconds > LONG {
                        return Picture { seconds: seconds / count, ..picture };
                    }
                }
            })
        };
        let uniform: Vec<(u32, f64, Picture)> = UNIFORM
            .into_iter()
            .map(|samples| {
                let instants = Some(samples.min(256));
                let settings = RenderSettings {
                    samples: Some(samples),
                    max_error: Some(0.0),
                    instants,
                    ..RenderSettings::default()
                };
                let picture = timed(settings);
                (samples, reference.error_of(&picture.film), picture)
            })
            .collect();
        for target in TARGETS {
            let picture = timed(RenderSettings {
                samples: Some(65_536),
                max_error: Some(target),
                ..RenderSettings::default()
            });
            let estimate = picture.estimate.unwrap();
            let found = reference.error_of(&picture.film);
            let samples = picture.rays / f64::from(picture.film.width() * picture.film.height());
            let cheapest = uniform.iter().find(|(_, error, _)| *error <= f64::from(target));
            let price = cheapest.map_or("| more than 512 | | |".to_owned(), |(count, error, cheapest)| {
                let price = picture.seconds / cheapest.seconds;
                costs.push(price);
                format!("| {count} ({error:.2}) | {:.2} | {price:.2} |", picture.rays / cheapest.rays)
            });
            let mark = if tally.add(found, target, estimate) { "" } else { " !" };
            println!(
                "| {} | {target} | {found:.2}{mark} | {:.2} ± {:.2} + {:.2} | {samples:.1} {price}",
                name, estimate.value, estimate.deviation, estimate.hidden
            );
        }
    }
    tally.print();
    costs.sort_by(f64::total_cmp);
    if let (Some(median), Some(most)) = (costs.get(costs.len() / 2), costs.last()) {
        let dear = costs.iter().filter(|price| **price > 1.3).count();
        println!(
            "time / that of the cheapest uniform: median {median:.2}, most {most:.2}, above 1.3 in {dear} of {} points",
            costs.len()
        );
    }
}

/// Measures the errors of one frame of each subject with several seeds, and prints a table.
fn runs(subjects: impl Iterator<Item = Subject>) {
    println!("| scene | target | true errors, seed by seed | estimates |");
    println!("|---|---|---|---|");
    let mut tally = TargetTally::default();
    for mut subject in subjects {
        let reference = Reference::render(&mut subject, FRAME);
        for target in TARGETS {
            let (mut errors, mut estimates) = (Vec::new(), Vec::new());
            for seed in 0..RUN {
                let settings = RenderSettings {
                    samples: Some(65_536),
                    max_error: Some(target),
                    seed: Some(seed),
                    ..RenderSettings::default()
                };
                let picture = render(&mut subject, FRAME, settings);
                let found = reference.error_of(&picture.film);
                let mark = if tally.add(found, target, picture.estimate.unwrap()) { "" } else { "!" };
                errors.push(format!("{found:.2}{mark}"));
                estimates.push(format!("{:.2}", picture.estimate.unwrap().value));
            }
            println!("| {} | {target} | {} | {} |", subject.name, errors.join(" "), estimates.join(" "));
        }
    }
    tally.print();
}

fn shipped() -> impl Iterator<Item = Subject> {
    const SCENES: [&str; 10] = [
        "first_light",
        "chess_morning",
        "hall_of_mirrors",
        "stage_lights",
        "box_field",
        "robot_arm",
        "newtons_cradle",
        "solar_system",
        "fairground",
        "glass_marbles",
    ];
    SCENES.into_iter().map(|scene| {
        let path = format!("{}/scenes/{scene}.ron", env!("CARGO_MANIFEST_DIR"));
        let mut engine = Engine::load(path).unwrap();
        for film in engine.world_mut().query_mut::<&mut rayreel::components::FilmSettings>() {
            (film.width, film.height) = (240, 135);
        }
        Subject { name: scene.to_owned(), engine, alpha: false, reference: REFERENCE[1] }
    })
}

/// Renders a frame with these settings; of alpha, where that is what is hard.
fn render(Subject { engine, alpha, .. }: &mut Subject, frame: u32, settings: RenderSettings) -> Picture {
    engine.settings = settings;
    let time = engine.timeline.time_of(frame);
    let film = if *alpha {
        let image = engine.render(RenderRequest { alpha: true, ..RenderRequest::at(time) });
        let alpha = image.unwrap().alpha.unwrap();
        // Alpha is written without a transfer curve. Decoding it here cancels the curve of the comparison.
        let transfer = engine.effective_settings().film.transfer;
        let light = |alpha: &f32| {
            let byte = f64::from(*alpha) * 255.0;
            transfer.decode([byte; 3])
        };
        let pixels: Vec<Rgb> = alpha.pixels().iter().map(light).collect();
        Film::from_pixels(alpha.width(), alpha.height(), pixels.into_iter())
    } else {
        engine.render(time).unwrap().film
    };
    let report = engine.report();
    let rays = report.rays.camera as f64;
    Picture { film, rays, seconds: 0.0, estimate: report.error }
}
