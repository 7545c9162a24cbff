//! Tests of drafts, and of pictures that are rendered in pieces.

use std::ops::ControlFlow::{Break, Continue};
use std::sync::atomic::{AtomicBool, AtomicI32, AtomicU32, Ordering};

use rayreel::components::FilmSettings;
use rayreel::trace::Signals;
use rayreel::{Effect, Engine, EngineError, Film, RenderRequest, RenderSettings, Rgb, Scene, Time};

use crate::session::scene;

fn engine(text: String) -> Engine {
    Engine::from_scene(Scene::from_text("ball.ron", text).unwrap())
}

fn sized(divisor: u32) -> RenderSettings {
    RenderSettings::draft(FilmSettings { width: 64, height: 36, ..FilmSettings::default() }, divisor)
}

fn render(engine: &mut Engine, time: Time, settings: RenderSettings, cancelled: &AtomicBool) -> Option<Film> {
    let signals = Signals::unless(cancelled);
    let request = RenderRequest { settings: Some(settings), signals, ..RenderRequest::at(time) };
    match engine.render(request) {
        Err(EngineError::Cancelled) => None,
        image => Some(image.unwrap().film),
    }
}

#[test]
fn draft_has_one_sample_and_keeps_the_frame() {
    let sampled = scene(1.0, "").replacen("Scene(", "Scene(sampling: (samples: 4),", 1);
    let never = AtomicBool::new(false);
    let (mut plain, mut sampled) = (engine(scene(1.0, "")), engine(sampled));
    let time = plain.timeline.time_of(3);
    let (one, four) = (plain.render(time).unwrap().film, sampled.render(time).unwrap().film);
    assert!(one != four);
    assert!(render(&mut sampled, time, sized(1), &never).unwrap() == one);
    let coarse = render(&mut sampled, time, sized(5), &never).unwrap();
    assert_eq!((coarse.width(), coarse.height()), (12, 7));
    assert_eq!(sampled.report().rays.camera, 84);
    assert!(sampled.render(time).unwrap().film == four);
    let cancelled = AtomicBool::new(true);
    assert_eq!(render(&mut sampled, time, sized(1), &cancelled), None);
}

/// Returns a scene with an area light, glass, a lens and an open shutter.
fn rich(samples: u32, instants: u32) -> String {
    let more = r#"(name: "glass", shape: Sphere(radius: 0.6), material: "glass", transform: (translation: (0.6, 0.4, -2))),
        (light: Area(shape: Sphere(radius: 1), intensity: (1, 0.9, 0.8), samples: 8), transform: (translation: (-3, 5, -3))),"#;
    scene(1.0, more)
        .replacen(
            "Scene(",
            &format!("Scene(quality: (depth: 7), sampling: (samples: {samples}, instants: {instants}),"),
            1,
        )
        .replace("materials: {", "materials: { \"glass\": (refractive: (k_t: 0.9, ior: 1.5)),")
        .replace("target: (0, 0, 0)", "target: (0, 0, 0), lens: (aperture: 0.2, focus: 5), shutter: 0.5")
}

#[test]
fn cheaper_drafts_trace_fewer_rays_and_keep_the_scene() {
    let mut engine = engine(rich(4, 2));
    let (time, never) = (engine.timeline.time_of(3), AtomicBool::new(false));
    let full = engine.render(time).unwrap().film;
    let plain = RenderSettings { max_light_samples: Some(1), depth: Some(2), ..sized(1) };
    let bare = RenderSettings { without: [Effect::Shadows].into(), depth: Some(1), ..plain };
    let mut last = u64::MAX;
    for (draft, divisor) in [(sized(1), 1), (plain, 1), (bare, 1), (bare, 4), (bare, 64)] {
        let draft = RenderSettings { size: sized(divisor).size, ..draft };
        render(&mut engine, time, draft, &never).unwrap();
        let rays = engine.report().rays;
        assert!(rays.total() < last, "{draft:?}");
        assert!(draft.without.is_empty() || (rays.shadow, rays.refraction) == (0, 0), "{draft:?}");
        last = rays.total();
        // A normal render afterwards shows the full scene.
        assert_eq!(engine.render(time).unwrap().film, full);
    }
    assert_eq!(last, 1);
}

/// Checks a picture that is interrupted at many places, at once or after the current samples, and continued.
#[test]
fn resumed_picture_equals_an_uninterrupted_one() {
    for (samples, instants) in [(1, 1), (3, 1), (4, 4), (5, 2)] {
        let mut engine = engine(rich(samples, instants));
        let time = engine.timeline.time_of(3);
        let once = engine.render(time).unwrap().film;
        let report = engine.report().clone();
        for rest in 1..6 {
            let (mut begun, mut pieces, mut shares) = (None, 0, vec![0.0]);
            let film = loop {
                let (polls, cancelled) = (AtomicU32::new(0), AtomicBool::new(false));
                let pause = || {
                    let now = polls.fetch_add(1, Ordering::Relaxed) >= rest;
                    // Every other interruption discards the current samples.
                    cancelled.store(now && pieces % 2 == 0, Ordering::Relaxed);
                    now
                };
                let signals = Signals { cancelled: &cancelled, pause: &pause };
                let mut visit = |_: &_| Break(());
                let image = engine.render(RenderRequest {
                    signals,
                    on_pause: Some(&mut visit),
                    resume: Some(&mut begun),
                    ..RenderRequest::at(time)
                });
                pieces += 1;
                match image {
                    Err(EngineError::Cancelled) => {}
                    image => break image.unwrap().film,
                }
                shares.extend(begun.as_ref().and_then(|begun| begun.progress().share));
            };
            assert!(film == once && pieces > 2, "{samples} {instants} {rest}: {pieces}");
            assert_eq!(engine.report().rays, report.rays, "{samples} {instants} {rest}");
            assert_eq!(engine.report().ends, report.ends);
            assert!(
                shares.is_sorted() && shares.iter().all(|share| (0.0..1.0).contains(share)),
                "{shares:?}"
            );
        }
    }
}

#[test]
fn unfinished_picture_is_resolved_over_another() {
    let mut engine = engine(rich(2, 1));
    let time = engine.timeline.time_of(0);
    let full = engine.render(time).unwrap().film;
    let beneath = Film::from_pixels(2, 1, [Rgb::new(1.0, 0.0, 0.0), Rgb::new(0.0, 0.0, 1.0)].into_iter());
    let (never, mut seen) = (AtomicBool::new(false), Vec::new());
    // Five tile samples at a time, of twice as many as there are tiles. Whichever threads take them, the first portion leaves most tiles
    // empty.
    let portion = 5_u16;
    let left = AtomicI32::new(portion.into());
    let pause = || left.fetch_sub(1, Ordering::Relaxed) <= 0;
    let signals = Signals { cancelled: &never, pause: &pause };
    let mut visit = |exposure: &rayreel::trace::RenderJob| {
        seen.push(exposure.resolve_over(&beneath));
        left.store(portion.into(), Ordering::Relaxed);
        Continue(())
    };
    let request = RenderRequest { signals, on_pause: Some(&mut visit), ..RenderRequest::at(time) };
    assert!(engine.render(request).unwrap().film == full);
    let finished = |film: &Film| {
        (0..36)
            .flat_map(|j| (0..64).map(move |i| (i, j)))
            .filter(|(i, j)| film.pixel(*i, *j) == full.pixel(*i, *j))
            .count()
    };
    let counts: Vec<usize> = seen.iter().map(finished).collect();
    assert!(counts.len() > 2 && counts[0] < 64 * 36 && counts.last() > counts.first(), "{counts:?}");
    // Where nothing has been rendered yet, the other picture is visible, scaled to this size.
    let others = (0..36)
        .flat_map(|j| (0..64).map(move |i| (i, j)))
        .filter(|(i, j)| seen[0].pixel(*i, *j) == beneath.pixel(i / 32, 0))
        .count();
    assert!(others >= 64 * 36 - usize::from(portion) * 16 * 16, "{others}");
}
