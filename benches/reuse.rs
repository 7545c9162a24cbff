//! Time from an edit to the exact picture, with tiles of the former picture and without: values of materials and places of entities are
//! changed, one at a time, in all shipped scenes.
//!
//! `cargo bench --bench reuse` prints a table; `-- chess` measures scenes with `chess` in their name. The pictures are of the middle frame at
//! the scene's own size. Times are medians of interleaved runs, from the world to the film. `recorded` is the time of a whole picture that
//! is recorded for reuse, relative to one that is not.
//!
//! `-- frames` measures consecutive frames as `render` traces them, again with tiles of the frame before and without.

#![allow(clippy::print_stdout, reason = "the table is the result")]

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use rayreel::color::Transfer;
use rayreel::scene::{Override, WrittenKind, WrittenValue};
use rayreel::sequence::{FormerFrame, FrameRequest, render_encoded};
use rayreel::trace::ReusablePicture;
use rayreel::{Engine, RenderRequest, Scene};

#[expect(dead_code, reason = "other benches look at more of it")]
mod shipped;

/// Number of runs of each picture.
const RUNS: usize = 3;
/// Maximum number of edits of each kind in a scene, spread over its materials and entities.
const EDITS: usize = 3;
/// Maximum number of frames of a scene.
const FRAMES: usize = 36;

fn main() {
    let mut arguments: Vec<String> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let of_frames = arguments.first().is_some_and(|first| first == "frames");
    if of_frames {
        arguments.remove(0);
    }
    let filter = arguments.pop().unwrap_or_default();
    if of_frames {
        return frames(&filter);
    }
    println!(
        "{:<17} {:<44} {:>9} {:>9} {:>7} {:>7}",
        "scene", "edit", "full ms", "reuse ms", "faster", "reused"
    );
    let mut gains = Vec::new();
    for name in scenes().iter().filter(|name| name.contains(&filter)) {
        let path = shipped::path(name);
        let files = [path.clone()];
        let text = std::fs::read_to_string(&path).expect("it is there");
        let mut edits = spread(paints(&files, &text));
        edits.extend(spread(moves(&files)));
        let load = |edit: Option<&Override>| {
            let edits: Vec<Override> = edit.into_iter().cloned().collect();
            Scene::load_overridden(&path, &edits).ok().map(|(scene, _)| scene)
        };
        for edit in &edits {
            let (mut full, mut reused, mut share) = (Vec::new(), Vec::new(), 0.0);
            for _ in 0..RUNS {
                let (Some(before), Some(after)) = (load(None), load(Some(edit))) else { break };
                let mut engine = Engine::from_scene(before);
                let mut slot = None;
                render(&mut engine, Some(&mut slot));
                engine.reload(after);
                reused.push(render(&mut engine, Some(&mut slot)));
                share = engine.report().reused;
                let (Some(before), Some(after)) = (load(None), load(Some(edit))) else { break };
                let mut engine = Engine::from_scene(before);
                render(&mut engine, None);
                engine.reload(after);
                full.push(render(&mut engine, None));
            }
            if full.is_empty() {
                continue;
            }
            let (full, reused) = (median(&mut full), median(&mut reused));
            gains.push(full / reused);
            let edit: String = edit.to_string().chars().take(44).collect();
            println!("{name:<17} {edit:<44} {full:9.1} {reused:9.1} {:7.2} {share:7.2}", full / reused);
        }
        let mut engine = Engine::load(&path).expect("it is valid");
        let [mut plain, mut recorded] = [const { Vec::new() }; 2];
        for _ in 0..RUNS {
            plain.push(render(&mut engine, None));
            recorded.push(render(&mut engine, Some(&mut None)));
        }
        println!("{name:<17} recorded {:.3}", median(&mut recorded) / median(&mut plain));
    }
    gains.sort_by(f64::total_cmp);
    if let (Some(least), Some(most)) = (gains.first(), gains.last()) {
        let middle = gains[gains.len() / 2];
        println!("{} edits: {least:.2} to {most:.2} times as fast, {middle:.2} in the median", gains.len());
    }
}

/// Measures consecutive frames of scenes.
fn frames(filter: &str) {
    println!("{:<17} {:>9} {:>9} {:>7} {:>7}", "scene", "full ms", "reuse ms", "faster", "reused");
    for name in scenes().iter().filter(|name| name.contains(filter)) {
        let path = shipped::path(name);
        let [mut engine, mut other] = [(); 2].map(|()| Engine::load(&path).expect("it is valid"));
        let (timeline, mut former) = (engine.timeline, FormerFrame::default());
        let first = timeline.frame_count() / 2;
        let (mut full, mut reused, mut share) = (0.0, 0.0, 0.0);
        let mut count = 0;
        for frame in (first..timeline.frame_count()).take(FRAMES) {
            let request = FrameRequest::frame(frame, timeline);
            reused += encoded(&mut engine, &request, &mut former);
            share += engine.report().reused;
            // Nothing is recorded in the first frame of a sequence.
            full += encoded(&mut other, &request, &mut FormerFrame::default());
            count += 1;
        }
        let count = f64::from(count);
        println!(
            "{name:<17} {:9.1} {:9.1} {:7.3} {:7.2}",
            full / count,
            reused / count,
            full / reused,
            share / count
        );
    }
}

/// Renders a frame as bytes. Returns the time in milliseconds.
fn encoded(engine: &mut Engine, request: &FrameRequest, former: &mut FormerFrame<Transfer>) -> f64 {
    let start = Instant::now();
    let film = render_encoded(engine, request, former, &AtomicBool::new(false), &mut |_| {});
    film.expect("it is valid");
    1e3 * start.elapsed().as_secs_f64()
}

/// Returns the names of all shipped scenes.
fn scenes() -> Vec<String> {
    let folder =
        std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")).expect("it is there");
    let paths = folder.filter_map(|entry| Some(entry.ok()?.path()));
    let scenes = paths.filter(|path| path.extension().is_some_and(|ending| ending == "ron"));
    let mut names: Vec<String> =
        scenes.filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned())).collect();
    names.sort();
    names
}

/// Renders the middle frame. Returns the time in milliseconds.
fn render(engine: &mut Engine, reuse: Option<&mut Option<Arc<ReusablePicture>>>) -> f64 {
    let timeline = engine.timeline;
    let time = timeline.time_of(timeline.frame_count() / 2);
    let start = Instant::now();
    engine
        .render(RenderRequest { reuse, fingerprint: false, ..RenderRequest::at(time) })
        .expect("it is valid");
    1e3 * start.elapsed().as_secs_f64()
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn spread(edits: Vec<Override>) -> Vec<Override> {
    let step = edits.len().div_ceil(EDITS).max(1);
    edits.into_iter().step_by(step).collect()
}

/// Returns other colours of the scene's materials.
fn paints(files: &[PathBuf], text: &str) -> Vec<Override> {
    let names = text.lines().filter_map(|line| line.trim().strip_prefix('"')?.split_once('"'));
    let names = names.filter(|(_, rest)| rest.trim_start().starts_with(':')).map(|(name, _)| name);
    let colors = names.filter_map(|name| {
        let values = WrittenValue::all(&["materials".to_owned(), name.to_owned()], files);
        let color = values.into_iter().find(|value| value.kind == WrittenKind::Color)?;
        format!("{}=(120, 110, 160)", color.path).parse().ok()
    });
    colors.collect()
}

/// Returns other places of the scene's entities.
fn moves(files: &[PathBuf]) -> Vec<Override> {
    let places = (0..500).filter_map(|index| {
        let values = WrittenValue::all(&["entities".to_owned(), index.to_string()], files);
        let is_light = values.iter().any(|value| value.path.contains(".light"));
        let place = values.iter().find(|value| value.path.ends_with("transform.translation") && !is_light)?;
        let mut numbers =
            place.text.trim_matches(['(', ')']).split(',').map(|number| number.trim().parse::<f64>().ok());
        let (x, y, z) = (numbers.next()??, numbers.next()??, numbers.next()??);
        format!("{}=({}, {}, {})", place.path, x + 0.1, y + 0.05, z - 0.1).parse().ok()
    });
    places.collect()
}
