//! Tests of pictures of which tiles are reused: their bits and ray counts are those of a fresh engine, whatever was edited, rendered,
//! interrupted or sought before.
//!
//! `RAYREEL_CASES` sets the number of sequences of random edits.

use std::fs;
use std::ops::ControlFlow::Break;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayreel::color::Transfer;
use rayreel::scene::{Override, Reader};
use rayreel::sequence::{FormerFrame, FrameRequest, render_encoded};
use rayreel::trace::{RayCounts, RenderJob, ReusablePicture, Signals, TileStats};
use rayreel::{Engine, EngineError, Film, RenderRequest, RenderSettings, Scene};

use crate::reload::model::Model;
use crate::reload::random::Random;

/// Number of edits of a random scene.
const EDITS: usize = 12;
/// Twelve tiles, some of them cut off by the film's border.
const SIZE: (u32, u32) = (60, 41);

type Slot = Option<Arc<ReusablePicture>>;

/// A picture to be rendered.
#[derive(Clone, Copy, Debug)]
struct Shot {
    frame: u32,
    size: (u32, u32),
    alpha: bool,
}

/// The pixels of a picture, their alpha, and its rays, all and by tile.
type Pixels = (Film, Option<Film<f32>>, RayCounts, Arc<[TileStats]>);

fn settings(engine: &Engine, size: (u32, u32)) -> RenderSettings {
    RenderSettings { size: Some(size), ..RenderSettings::default() }.or(engine.settings)
}

/// Renders a frame, interrupted now and then, with the tiles of the last picture in a slot.
fn reused(
    engine: &mut Engine,
    Shot { frame, size, alpha }: Shot,
    slot: &mut Slot,
    pauses: bool,
) -> Result<(Pixels, f64), EngineError> {
    let (time, settings) = (engine.timeline.time_of(frame), settings(engine, size));
    let (mut job, polls) = (None::<RenderJob>, AtomicUsize::new(1));
    loop {
        let pause = || pauses && polls.fetch_add(1, Ordering::Relaxed).is_multiple_of(5);
        let request = RenderRequest {
            settings: Some(settings),
            signals: Signals { pause: &pause, ..Signals::none() },
            on_pause: Some(&mut |_| Break(())),
            resume: Some(&mut job),
            reuse: Some(slot),
            fingerprint: false,
            tile_stats: true,
            alpha,
            ..RenderRequest::at(time)
        };
        match engine.render(request) {
            Err(EngineError::Cancelled) => {}
            other => {
                let (report, tiles) = (engine.report(), Arc::clone(&engine.report().tile_stats));
                return other.map(|image| ((image.film, image.alpha, report.rays, tiles), report.reused));
            }
        }
    }
}

/// Renders a frame in full.
fn fresh(engine: &mut Engine, Shot { frame, size, alpha }: Shot) -> Result<Pixels, EngineError> {
    let (time, settings) = (engine.timeline.time_of(frame), settings(engine, size));
    let image = engine.render(RenderRequest {
        settings: Some(settings),
        alpha,
        tile_stats: true,
        ..RenderRequest::at(time)
    })?;
    let report = engine.report();
    Ok((image.film, image.alpha, report.rays, Arc::clone(&report.tile_stats)))
}

/// Begins a picture and discards it, so that nothing of it may stay.
fn interrupted(engine: &mut Engine, frame: u32, slot: &mut Slot) {
    let (time, settings) = (engine.timeline.time_of(frame), settings(engine, SIZE));
    let (cancelled, polls) = (AtomicBool::new(false), AtomicUsize::new(0));
    let pause = || {
        cancelled.store(polls.fetch_add(1, Ordering::Relaxed) > 3, Ordering::Relaxed);
        false
    };
    let signals = Signals { cancelled: &cancelled, pause: &pause };
    let request =
        RenderRequest { settings: Some(settings), signals, reuse: Some(slot), ..RenderRequest::at(time) };
    let _ = engine.render(request);
}

fn load(model: &Model, folder: &Path, reader: &mut Reader) -> Option<Scene> {
    let (text, files) = model.files();
    for (name, text) in files.iter().map(|(name, text)| (*name, text)).chain([("scene.ron", &text)]) {
        fs::write(folder.join(name), text).unwrap();
    }
    Some(reader.load(&folder.join("scene.ron")).ok()?.0)
}

#[test]
fn random_edits_equal_a_cold_start() {
    let cases = std::env::var("RAYREEL_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(40);
    let (mut shares, mut pictures) = (0.0, 0_u32);
    for seed in 0..cases {
        let (random, folder, mut reader) = (&mut Random(seed), tempfile::tempdir().unwrap(), Reader::new());
        let (mut model, scene) = loop {
            let model = Model::new(random);
            if let Some(scene) = load(&model, folder.path(), &mut reader) {
                break (model, scene);
            }
        };
        let (mut engine, mut slot) = (Engine::from_scene(scene), None);
        let alpha = random.once_in(4);
        for step in 0..EDITS {
            let mut edited = model.clone();
            edited.edit(random);
            let Some(scene) = load(&edited, folder.path(), &mut reader) else { continue };
            model = edited;
            engine.reload(scene);
            let frame = u32::try_from(random.index(4)).unwrap();
            if random.once_in(3) {
                interrupted(&mut engine, frame, &mut slot);
            }
            if random.once_in(4) {
                // A picture of another size, by which the slot is used or replaced.
                let _ = reused(&mut engine, Shot { frame, size: (33, 20), alpha: false }, &mut slot, false);
            }
            let (pauses, shot) = (random.once_in(3), Shot { frame, size: SIZE, alpha });
            let mut cold = Engine::load(folder.path().join("scene.ron")).unwrap();
            let about = || format!("seed {seed}, edit {step}, frame {frame}: {}", model.files().0);
            match (reused(&mut engine, shot, &mut slot, pauses), fresh(&mut cold, shot)) {
                (Ok((pixels, share)), Ok(expected)) => {
                    assert!(pixels == expected, "{}", about());
                    (shares, pictures) = (shares + share, pictures + 1);
                }
                (one, other) => assert_eq!(one.is_ok(), other.is_ok(), "{}", about()),
            }
        }
    }
    let mean = shares / f64::from(pictures);
    println!("{pictures} pictures, {mean:.3} of each reused");
    assert!(mean > 0.1, "{mean}");
}

/// Returns the shipped scenes.
fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut scenes: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    scenes.retain(|path| path.extension().is_some_and(|ending| ending == "ron"));
    scenes.sort();
    scenes
}

#[test]
fn frames_of_shipped_scenes_equal_a_cold_start_in_any_order() {
    const SMALL: (u32, u32) = (96, 54);
    let mut shares = Vec::new();
    for path in scenes() {
        let (mut engine, mut cold) = (Engine::load(&path).unwrap(), Engine::load(&path).unwrap());
        let (mut slot, last) = (None, engine.timeline.frame_count() - 1);
        for frame in [12, 3, 13, 4].map(|frame| frame.min(last)) {
            let shot = Shot { frame, size: SMALL, alpha: false };
            let (pixels, share) = reused(&mut engine, shot, &mut slot, false).unwrap();
            assert!(pixels == fresh(&mut cold, shot).unwrap(), "{} {frame}", path.display());
            shares.push(share);
        }
    }
    assert!(shares.iter().filter(|share| **share > 0.2).count() > 4, "{shares:?}");
}

#[test]
fn frames_of_a_sequence_equal_frames_alone() {
    // Large enough to take the time from which on tiles are reused.
    const LARGE: (u32, u32) = (480, 270);
    for name in ["robot_arm", "newtons_cradle"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("ron");
        let load = || {
            let mut engine = Engine::load(&path).unwrap();
            engine.settings.size = Some(LARGE);
            engine
        };
        let (mut engine, mut former, mut shares) = (load(), FormerFrame::default(), Vec::new());
        for index in 20..24 {
            let request = FrameRequest::frame(index, engine.timeline);
            let encoded = |engine: &mut Engine, former: &mut FormerFrame<Transfer>| {
                render_encoded(engine, &request, former, &AtomicBool::new(false), &mut |_| {})
                    .unwrap()
                    .unwrap()
            };
            let film = encoded(&mut engine, &mut former);
            shares.push(engine.report().reused);
            assert!(film == encoded(&mut load(), &mut FormerFrame::default()), "{name} {index}");
        }
        assert!(shares[3] > 0.2, "{name} {shares:?}");
    }
}

#[test]
fn edits_of_shipped_scenes_equal_a_cold_start() {
    const SMALL: (u32, u32) = (160, 90);
    for (name, edits) in [
        ("chess_morning", &["materials.ivory.color=(200, 30, 30)", "camera.fov=40"][..]),
        ("glass_marbles", &["sampling.samples=2", "film.transfer=Classic"]),
        ("fairground", &["ambient=(2, 1, 1)"]),
        ("lantern", &["quality.depth=2"]),
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("ron");
        let mut reader = Reader::new();
        let mut engine = Engine::from_scene(reader.load(&path).unwrap().0);
        let (mut slot, shot) = (None, Shot { frame: 20, size: SMALL, alpha: false });
        reused(&mut engine, shot, &mut slot, false).unwrap();
        for edit in edits.iter().copied().chain([""]) {
            let overrides: Vec<Override> =
                (!edit.is_empty()).then(|| edit.parse().unwrap()).into_iter().collect();
            reader.set_overrides(overrides.clone());
            engine.reload(reader.load(&path).unwrap().0);
            let (pixels, share) = reused(&mut engine, shot, &mut slot, false).unwrap();
            let mut cold = Engine::from_scene(Scene::load_overridden(&path, &overrides).unwrap().0);
            assert!(pixels == fresh(&mut cold, shot).unwrap(), "{name} {edit}");
            println!("{name} {edit}: {share:.3}");
        }
    }
}
