//! Tests of the preview levels, from the first coarse picture to the full one.

use std::thread::sleep;
use std::time::{Duration, Instant};

use rayreel::live::{Event, Shown};

use crate::AT_MOST;
use crate::session::{Stage, scene};

/// Time limit from the reading of a scene to its first picture.
const FIRST: Duration = Duration::from_millis(150);
/// Number of attempts, because the machine may be busy.
const TRIES: usize = 12;

/// Returns scenes in which even a single pixel, or a small picture, takes long in full.
fn heavy() -> Vec<(&'static str, String)> {
    let large = |text: String| text.replace("width: 64, height: 36", "width: 3840, height: 2160");
    let sampled = |text: String, samples: u32| {
        text.replacen("Scene(", &format!("Scene(sampling: (samples: {samples}),"), 1)
    };
    let area = |count: usize, samples: u32| {
        let light = format!(
            "(light: Area(shape: Sphere(radius: 1), intensity: (1, 1, 1), samples: {samples}), \
             transform: (translation: (4, 6, -4))),"
        );
        light.repeat(count)
    };
    let glass = |text: String| {
        text.replacen("Scene(", "Scene(quality: (depth: 200, cutoff: 0),", 1)
            .replace("k_a: 1, k_d: 0.5,", "k_a: 1, reflective: (k_r: 0.9), refractive: (k_t: 0.9, ior: 1.5),")
    };
    let shells: String = (1..20)
        .map(|index| {
            format!("(shape: Sphere(radius: {}), material: \"clay\"),", 1.0 + 0.1 * f64::from(index))
        })
        .collect();
    let lights = "(light: Point(intensity: (0.001, 0.001, 0.001)), transform: (translation: (4, 6, -4))),";
    let planes: String = (0..20_000)
        .map(|index| {
            format!(
                "(shape: Plane(normal: (0, 1, 0)), material: \"clay\", transform: (translation: (0, {}, 0))),",
                -2 - index
            )
        })
        .collect();
    vec![
        ("many pixels and samples", large(sampled(scene(1.0, ""), 4096))),
        ("a light of many samples", large(sampled(scene(1.0, &area(1, 4096)), 64))),
        ("many lights of many samples", scene(1.0, &area(50, 4096))),
        ("glass in glass", glass(scene(1.0, &shells))),
        (
            "glass in glass under a light of many samples",
            glass(scene(1.0, &format!("{shells}{}", area(4, 1024)))),
        ),
        ("many lights", large(scene(1.0, &lights.repeat(5000)))),
        ("many planes", large(sampled(scene(1.0, &planes), 64))),
    ]
}

/// Returns the first picture of a session, and the time since the scene was read.
fn first_picture(stage: &Stage) -> (Shown, Duration) {
    loop {
        if let Event::Reloaded(_) = stage.next() {
            break;
        }
    }
    let start = Instant::now();
    loop {
        if let Event::Shown(shown) = stage.next() {
            return (shown, start.elapsed());
        }
    }
}

#[test]
fn first_picture_appears_quickly_for_any_scene() {
    for (what, text) in heavy() {
        let mut best = Duration::MAX;
        for _ in 0..TRIES {
            let stage = Stage::new(Some(&text));
            best = best.min(first_picture(&stage).1);
            // After an edit, more is known of the scene.
            stage.save(&text.replace("255, 120, 60", "255, 120, 61"));
            let after_an_edit = first_picture(&stage).1;
            if best.max(after_an_edit) <= FIRST {
                best = best.max(after_an_edit);
                break;
            }
        }
        assert!(best <= FIRST, "{what}: {best:?}");
    }
}

#[test]
fn seeking_interrupts_rendering_at_once() {
    for (what, text) in heavy() {
        let mut best = Duration::MAX;
        for frame in (1..).take(TRIES - 1) {
            let stage = Stage::new(Some(&text));
            first_picture(&stage);
            sleep(Duration::from_millis(300));
            let start = Instant::now();
            stage.seek(frame);
            stage.wait_for("a seek", |state| state.frame == frame);
            best = best.min(start.elapsed());
            if best <= FIRST {
                break;
            }
        }
        assert!(best <= FIRST, "{what}: {best:?}");
    }
}

/// The film of the slow scene.
const SLOW: (u32, u32) = (2560, 1440);

/// Returns a scene that takes about a second for each 16 samples.
fn slow(samples: u32) -> String {
    let film = format!("width: {}, height: {}", SLOW.0, SLOW.1);
    let sampling = format!("Scene(sampling: (samples: {samples}),");
    scene(1.0, "").replace("width: 64, height: 36", &film).replacen("Scene(", &sampling, 1)
}

#[test]
fn pictures_get_finer_up_to_the_full_one() {
    // So many samples that even a fast machine shows the picture unfinished.
    let stage = Stage::new(Some(&slow(64)));
    let (first, _) = first_picture(&stage);
    let mut seen = vec![first];
    let start = Instant::now();
    let mut progress = vec![0.0];
    while !seen.last().unwrap().info.full {
        assert!(start.elapsed() < AT_MOST);
        for event in stage.events_within(Duration::from_millis(20)) {
            if let Event::Shown(shown) = event {
                seen.push(shown);
            }
        }
        let state = stage.session().handle().state();
        progress.push(state.progress);
        assert!(state.rendering || state.picture.unwrap().full);
    }
    let widths: Vec<u32> = seen.iter().map(|shown| shown.info.width).collect();
    assert!(widths.is_sorted() && widths[0] < SLOW.0 / 2 && seen.len() > 3, "{widths:?}");
    assert!(seen.iter().rev().skip(1).all(|shown| shown.info.coarse && !shown.info.full));
    assert!(
        progress.is_sorted() && progress.iter().any(|share| *share > 0.0 && *share < 1.0),
        "{progress:?}"
    );
    // Each picture is nearer to the last one.
    let last = &seen.last().unwrap().film;
    let error = |shown: &Shown| {
        let (film, total) = (&shown.film, SLOW.0 * SLOW.1);
        let sum: f64 = (0..total)
            .map(|index| {
                let (i, j) = (index % SLOW.0, index / SLOW.0);
                let other = film.pixel(i * film.width() / SLOW.0, j * film.height() / SLOW.1);
                f64::from((last.pixel(i, j) - other).abs().element_sum())
            })
            .sum();
        sum / f64::from(total)
    };
    let errors: Vec<f64> = seen.iter().map(error).collect();
    assert!(errors.is_sorted_by(|before, after| before >= after), "{errors:?}");
    let mut cold = rayreel::Engine::load(stage.path("ball.ron")).unwrap();
    assert!(cold.render_frame(0).unwrap() == **last);
}

#[test]
fn stopped_preview_resumes_with_its_samples() {
    let stage = Stage::new(Some(&slow(16)));
    first_picture(&stage);
    let start = Instant::now();
    let mut progress = vec![0.0];
    loop {
        assert!(start.elapsed() < AT_MOST, "{progress:?}");
        assert!(stage.probe((640, 360)).is_some());
        sleep(Duration::from_millis(10));
        let state = stage.session().handle().state();
        progress.push(state.progress);
        if state.picture.is_some_and(|picture| picture.full) {
            break;
        }
    }
    assert!(progress.is_sorted(), "{progress:?}");
    // The picture equals an undisturbed one.
    stage.matches_a_cold_start();
}

#[test]
fn edits_during_playback_get_a_full_picture() {
    let stage = Stage::with(Some(&slow(16)), true);
    stage.matches_a_cold_start();
    stage.save(&slow(16).replace("255, 120, 60", "60, 120, 255"));
    let start = Instant::now();
    let mut frame = 0;
    let full = 'playing: loop {
        assert!(start.elapsed() < AT_MOST);
        frame = (frame + 1) % 20;
        stage.play(frame);
        for event in stage.events_within(Duration::from_millis(100)) {
            match event {
                Event::Shown(shown) if shown.info.full && shown.info.reloads == 2 => break 'playing shown,
                // Other pictures are coarse, or from before the edit.
                Event::Shown(shown) => assert!(shown.info.coarse || shown.info.reloads == 1),
                _ => {}
            }
        }
    };
    let mut cold = rayreel::Engine::load(stage.path("ball.ron")).unwrap();
    assert!(cold.render_frame(full.info.frame).unwrap() == *full.film);
    // The full picture is for files: a page that plays does not return to it.
    assert!(stage.session().handle().picture(full.info.id).is_none());

    // After the page has left, the current frame is rendered in full.
    stage.play(7);
    let state = stage.wait_for("rest", |state| !state.rendering && state.frame == 7);
    assert!(state.picture.is_some_and(|picture| picture.full && picture.frame == 7), "{state:?}");
}
