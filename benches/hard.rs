//! Whether error targets are met on scenes that are hard to sample, and at what price.
//!
//! `cargo bench --bench hard` renders a frame of every hard scene for four targets and compares it with a long reference: the true error, the
//! estimate, the samples, and the rays and the processor time relative to the cheapest uniform number of samples that meets the target.
//! Names of scenes after `--` measure those alone. It takes about ten minutes.

#![allow(
    clippy::print_stdout,
    clippy::disallowed_methods,
    clippy::unwrap_used,
    reason = "a bench prints its table, and no bits depend on it"
)]

#[path = "../tests/accuracy/hard_scenes.rs"]
mod hard_scenes;

use std::ops::ControlFlow::Continue;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use hard_scenes::hard_scenes;
use rayreel::accuracy::FilmError;
use rayreel::trace::{Film, Signals};
use rayreel::{Engine, Knobs, Rgb, Scene};

const TARGETS: [f32; 4] = [4.0, 2.0, 1.0, 0.5];
const UNIFORM: [u32; 17] = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 512];
const REFERENCE: u32 = 8192;
const FRAME: u32 = 6;

struct Picture {
    film: Film,
    rays: f64,
    seconds: f64,
    estimate: Option<(f64, f64)>,
}

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|name| !name.starts_with('-')).collect();
    let wants = |name: &str| wanted.is_empty() || wanted.iter().any(|wanted| name == wanted);
    let scenes: Vec<(String, Engine, bool)> = hard_scenes()
        .into_iter()
        .map(|scene| {
            let loaded = Scene::from_text(scene.name, scene.text).unwrap_or_else(|error| panic!("{error}"));
            (scene.name.to_owned(), Engine::from_scene(loaded), scene.alpha)
        })
        .chain(shipped())
        .filter(|(name, ..)| wants(name))
        .collect();
    println!(
        "| scene | target | true error | estimate | samples a pixel | cheapest uniform | rays / its | time / its |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let (mut points, mut met, mut honest, mut close, mut prices) = (0, 0, 0, 0, Vec::new());
    for (name, mut engine, alpha) in scenes {
        let open = Knobs { instants: Some(256), ..Knobs::default() };
        let reference = render(
            &mut engine,
            Knobs { samples: Some(REFERENCE), max_error: Some(0.0), seed: Some(99), ..open },
            alpha,
        );
        let transfer = engine.film_settings().transfer;
        let error = |film: &Film| FilmError::between(film, &reference.film, transfer).rms;
        let uniform: Vec<(u32, f64, f64, f64)> = UNIFORM
            .into_iter()
            .map(|samples| {
                let picture = render(
                    &mut engine,
                    Knobs { samples: Some(samples), max_error: Some(0.0), ..open },
                    alpha,
                );
                (samples, error(&picture.film), picture.rays, picture.seconds)
            })
            .collect();
        for target in TARGETS {
            let picture = render(
                &mut engine,
                Knobs { samples: Some(65_536), max_error: Some(target), ..Knobs::default() },
                alpha,
            );
            let (estimate, deviation) = picture.estimate.unwrap();
            let (found, film) = (error(&picture.film), engine.film_settings());
            let samples = picture.rays / f64::from(film.width * film.height);
            let cheapest = uniform.iter().find(|(_, error, ..)| *error <= f64::from(target));
            let price =
                cheapest.map_or("| more than 512 | | |".to_owned(), |(count, error, rays, seconds)| {
                    prices.push(picture.seconds / seconds);
                    format!(
                        "| {count} ({error:.2}) | {:.2} | {:.2} |",
                        picture.rays / rays,
                        picture.seconds / seconds
                    )
                });
            points += 1;
            let is_met = found <= f64::from(target);
            met += u32::from(is_met);
            honest += u32::from(is_met || found <= estimate + 2.0 * deviation);
            close += u32::from((0.8..=2.0).contains(&(estimate / found)) || found < 0.05);
            println!(
                "| {name} | {target} | {found:.2}{} | {estimate:.2} ± {deviation:.2} | {samples:.1} {price}",
                if is_met { "" } else { " !" }
            );
        }
    }
    prices.sort_by(f64::total_cmp);
    println!(
        "\n{met} of {points} within the target; {honest} so or reported; {close} estimates between 0.8 and 2 times the error; time / that of the \
         cheapest uniform: median {:.2}, most {:.2}",
        prices[prices.len() / 2],
        prices.last().unwrap()
    );
}

fn shipped() -> impl Iterator<Item = (String, Engine, bool)> {
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
        (scene.to_owned(), engine, false)
    })
}

/// Renders a frame with these settings; of alpha, where that is what is hard.
fn render(engine: &mut Engine, knobs: Knobs, alpha: bool) -> Picture {
    engine.set_knobs(knobs);
    let time = engine.timeline().time_of(FRAME);
    let never = AtomicBool::new(false);
    let start = Instant::now();
    let film = if alpha {
        let picture =
            engine.render_alpha_on(time, Signals::unless(&never), &mut |_| Continue(())).unwrap().unwrap();
        let alpha = picture.alpha;
        // Alpha is compared as it is written, as light that is output without a curve.
        let transfer = engine.film_settings().transfer;
        let light = |alpha: &f32| {
            let byte = f64::from(*alpha) * 255.0;
            transfer.decode([byte; 3])
        };
        let pixels: Vec<Rgb> = alpha.pixels().iter().map(light).collect();
        Film::from_pixels(alpha.width(), alpha.height(), pixels.into_iter())
    } else {
        engine.render_at(time).unwrap()
    };
    let seconds = start.elapsed().as_secs_f64();
    let report = engine.report();
    let rays = report.rays.camera as f64;
    Picture { film, rays, seconds, estimate: report.error.map(|error| (error.rms, error.deviation)) }
}
