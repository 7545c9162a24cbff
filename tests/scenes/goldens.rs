//! Tests of every shipped scene against its golden pictures, to the last bit, with several numbers of threads, at all SIMD levels of the
//! processor, and by the reference path.
//!
//! The scenes in `tests/flush_faces/` are compared with goldens and with the reference path, too: shapes that rest on each other, share
//! faces or coincide, where rays start on several surfaces at once. Wrong results appear there as speckles, light leaks and dark seams.
//!
//! On a mismatch, the actual picture, the expected picture and their difference are written to `target/golden_mismatches/`.
//! `RAYREEL_BLESS=1 cargo test --test scenes goldens` rewrites the goldens; look at them before keeping them. Goldens are frame files with
//! a fingerprint of their source. A change that makes another picture from the same numbers must raise `trace::SEMANTICS`, or else blessing
//! is refused.

use std::fs;
use std::path::{Path, PathBuf};

use image::{Rgb, RgbImage};
use rayon::{ThreadPool, ThreadPoolBuilder};

use rayreel::components::FilmSettings;
use rayreel::output::{FoundFrame, FrameFormat, FrameWriter, encode};
use rayreel::trace::SimdLevel;
use rayreel::{Engine, Film, RenderRequest, RenderSettings};

use crate::{root, scenes_in};

const SIZE: (u32, u32) = (320, 180);

/// Returns the shipped scenes, and those of the lesson, which extend each other.
fn scenes() -> Vec<PathBuf> {
    [scenes_in("scenes"), scenes_in("scenes/lesson")].concat()
}

/// Returns small scenes of two frames each, at the sizes written in them.
fn flush_faces() -> Vec<PathBuf> {
    scenes_in("tests/flush_faces")
}

fn load(path: &Path, (width, height): (u32, u32)) -> Engine {
    let mut engine = Engine::load(path).unwrap();
    for film in engine.world_mut().query_mut::<&mut FilmSettings>() {
        *film = FilmSettings { width, height, ..*film };
    }
    engine
}

/// Returns the first frame, one from the middle, and the last.
fn frames(engine: &Engine) -> [u32; 3] {
    let count = engine.timeline.frame_count();
    [0, count / 2, count - 1]
}

fn picture(engine: &Engine, film: &Film) -> RgbImage {
    let bytes = encode(film, engine.effective_settings().film.transfer, FrameFormat::default()).unwrap();
    image::load_from_memory(&bytes).unwrap().to_rgb8()
}

/// Compares two pictures, describes their differences, and stores the pictures.
fn compare(name: &str, actual: &RgbImage, expected: &RgbImage) -> Option<String> {
    if actual == expected {
        return None;
    }
    let folder = root().join("target/golden_mismatches");
    fs::create_dir_all(&folder).unwrap();
    let save =
        |kind: &str, picture: &RgbImage| picture.save(folder.join(format!("{name}.{kind}.png"))).unwrap();
    save("actual", actual);
    save("expected", expected);
    if actual.dimensions() != expected.dimensions() {
        return Some(format!("{name}: {:?} instead of {:?}", actual.dimensions(), expected.dimensions()));
    }
    let mut difference = RgbImage::new(actual.width(), actual.height());
    let (mut count, mut first) = (0, None);
    for ((i, j, marked), (found, wanted)) in
        difference.enumerate_pixels_mut().zip(actual.pixels().zip(expected.pixels()))
    {
        if found != wanted {
            count += 1;
            first = first.or(Some((i, j, *found, *wanted)));
            // Small differences are as bad as large ones, and must be as visible.
            *marked = Rgb([0, 1, 2].map(|channel| {
                found[channel].abs_diff(wanted[channel]).saturating_mul(8).saturating_add(64)
            }));
        }
    }
    save("difference", &difference);
    let (i, j, found, wanted) = first?;
    Some(format!(
        "{name}: {count} pixels differ, the first at ({i}, {j}): {:?} instead of {:?}; see {}",
        found.0,
        wanted.0,
        folder.display()
    ))
}

/// Renders a scene's frames, and describes differences from its goldens. `RAYREEL_BLESS` replaces the goldens, unless the same numbers now
/// make another picture: existing frames would be taken for valid.
fn mismatches(name: &str, mut engine: Engine, frames: &[u32]) -> Vec<String> {
    let bless = std::env::var_os("RAYREEL_BLESS").is_some();
    let mut wrong = Vec::new();
    for frame in frames {
        let film = engine.render_frame(*frame).unwrap();
        let actual = picture(&engine, &film);
        let name = format!("{name}.{frame:04}");
        let golden = root().join(format!("tests/goldens/{name}.png"));
        let found = FoundFrame::expected_at(&golden, FrameFormat::default(), (film.width(), film.height()));
        let fingerprint = engine.report().fingerprint.unwrap();
        let is_same =
            matches!(found, FoundFrame::Complete { fingerprint: stored, .. } if stored == fingerprint);
        if bless && !is_same {
            let (writer, film) =
                (FrameWriter::start(), film.encoded(engine.effective_settings().film.transfer));
            writer.submit(0, golden.clone(), film, FrameFormat::default(), Some(fingerprint));
            assert!(writer.finish().into_iter().all(|written| written.result.is_ok()));
        } else if is_same && image::open(&golden).unwrap().to_rgb8() != actual {
            wrong.push(format!("{name}: the same numbers make another picture: raise `trace::SEMANTICS`"));
        } else if !is_same {
            wrong.push(format!("{name}: the golden is of other numbers: look at it, and bless it"));
        }
        let expected = image::open(&golden).map(|picture| picture.to_rgb8()).unwrap_or_default();
        wrong.extend(compare(&name, &actual, &expected));
    }
    wrong
}

fn stem(path: &Path) -> &str {
    path.file_stem().unwrap().to_str().unwrap()
}

/// Returns the name of a shipped scene's goldens.
fn golden_name(path: &Path) -> String {
    let is_of_lesson = path.parent().is_some_and(|folder| folder.ends_with("lesson"));
    format!("{}{}", if is_of_lesson { "lesson." } else { "" }, stem(path))
}

#[test]
fn shipped_scenes_match_their_goldens() {
    let mut wrong = Vec::new();
    let scenes = scenes();
    assert!(scenes.len() >= 6);
    for path in scenes {
        let engine = load(&path, SIZE);
        let frames = frames(&engine);
        wrong.extend(mismatches(&golden_name(&path), engine, &frames));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn flush_faces_show_neither_speckles_nor_leaks_nor_seams() {
    let mut wrong = Vec::new();
    let scenes = flush_faces();
    assert!(scenes.len() >= 8);
    for path in scenes {
        let engine = Engine::load(&path).unwrap();
        wrong.extend(mismatches(&format!("flush_faces.{}", stem(&path)), engine, &[0, 1]));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn goldens_do_not_depend_on_threads_or_instruction_sets() {
    let pools = [1, 2, 8].map(|threads| ThreadPoolBuilder::new().num_threads(threads).build().unwrap());
    for path in scenes().into_iter().chain(flush_faces()) {
        let mut engine = load(&path, (150, 85));
        let last = frames(&engine)[2];
        let mut render = |pool: &ThreadPool, level| {
            engine.settings = RenderSettings { simd: Some(level), ..engine.settings };
            let film = pool.install(|| engine.render_frame(last).unwrap());
            (film, engine.report().rays)
        };
        let expected = render(&pools[0], SimdLevel::best());
        for (name, level) in SimdLevel::all() {
            for pool in &pools {
                let threads = pool.current_num_threads();
                assert!(render(pool, level) == expected, "{}, {threads} threads, {name}", path.display());
            }
        }
    }
}

#[test]
fn reference_path_matches_the_goldens() {
    for path in scenes().into_iter().chain(flush_faces()) {
        let mut engine = load(&path, (80, 45));
        for frame in frames(&engine) {
            let time = engine.timeline.time_of(frame);
            let fast = engine.render(time).unwrap().film;
            let reference =
                engine.render(RenderRequest { reference: true, ..RenderRequest::at(time) }).unwrap().film;
            assert!(fast == reference, "{} frame {frame}", path.display());
        }
    }
}

#[test]
fn changed_pixels_are_reported() {
    let golden = image::open(root().join("tests/goldens/first_light.0000.png")).unwrap().to_rgb8();
    let mut changed = golden.clone();
    changed.get_pixel_mut(7, 5).0[1] ^= 1;
    let message = compare("self_test", &changed, &golden).unwrap();
    assert!(message.contains("1 pixels differ, the first at (7, 5)"), "{message}");
    for kind in ["actual", "expected", "difference"] {
        assert!(root().join(format!("target/golden_mismatches/self_test.{kind}.png")).exists());
    }
}
