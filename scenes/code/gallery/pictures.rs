//! Pictures of the README and the book, made by their recipes.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use std::{fs, io};

use rayreel::output::{FrameFormat, read_frame, write};
use rayreel::time::{FrameList, FrameRate};
use rayreel::{Engine, Film};

use super::chapter::folder_of;
use super::exhibit::{fitting, write_loop};
use super::recipes::{Making, Recipe, recipes};

/// Size of pictures that do not exist yet. Others keep their size.
const SIZE: (u32, u32) = (480, 270);

/// Makes all pictures of the repository in the working directory.
pub(crate) fn remake() -> Result<(), Box<dyn Error>> {
    let manifest = std::env::current_dir()?.join("Cargo.toml");
    let run = |words: &[String], folder: &Path| {
        // Cargo sets the variable for programs that it runs.
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
        cargo.args(["run", "--release", "--quiet", "--manifest-path"]).arg(&manifest);
        match words[0].as_str() {
            "rayreel" => cargo.args(["--bin", "rayreel", "--"]).args(&words[1..]),
            // `cargo run --release` and the rest.
            _ => cargo.args(&words[3..]),
        };
        cargo.current_dir(folder).status()
    };
    for recipe in recipes(Path::new(""))? {
        let before = fs::read(&recipe.picture).ok();
        make(&recipe, run).map_err(|error| format!("{}: {error}", recipe.picture.display()))?;
        let is_new = before != fs::read(&recipe.picture).ok();
        println!("{}: {}", recipe.picture.display(), if is_new { "made" } else { "as before" });
    }
    Ok(())
}

/// Makes a picture. The file is written only if pixels differ. `run` runs the words of a command line in a folder.
pub(crate) fn make(
    recipe: &Recipe,
    run: impl Fn(&[String], &Path) -> io::Result<ExitStatus>,
) -> Result<(), Box<dyn Error>> {
    let Recipe { chapter, picture, making } = recipe;
    fs::create_dir_all(picture.parent().unwrap_or(Path::new("")))?;
    let folder = folder_of(Path::new(""), &fs::read_to_string(chapter)?)?;
    let file = |scene: &Path| Some(folder.path().join(scene)).filter(|file| file.exists());
    match making {
        Making::Still { scene, frame } => {
            let mut engine = engine(&file(scene).unwrap_or(scene.clone()), picture)?;
            let (film, transfer) = (still(&mut engine, *frame)?, engine.effective_settings().film.transfer);
            let format = FrameFormat::default();
            if read_frame(picture, format).is_ok_and(|known| known == film.encoded(transfer)) {
                return Ok(());
            }
            Ok(write(picture, &film, transfer, format)?)
        }
        Making::Movie { scene, frames } => {
            let mut engine = engine(&file(scene).unwrap_or(scene.clone()), picture)?;
            let frames = frames.within(engine.timeline.frame_count());
            require(&engine, frames.last())?;
            let (rate, step) = (engine.timeline.rate, step(&frames));
            let (numerator, denominator) = rate.parts();
            let rate = FrameRate::new(numerator, denominator.saturating_mul(step))
                .ok_or("its frames are too far apart")?;
            write_loop(&mut engine, &frames, rate, picture, |_, _| ())
        }
        Making::Command(words) => {
            let status = run(words, folder.path())?;
            let made = files_like(picture, folder.path())?;
            let [made] = &made[..] else {
                return Err(
                    format!("the command ended with {status} and made {} such files", made.len()).into()
                );
            };
            Ok(fs::copy(made, picture).map(|_| ())?)
        }
    }
}

/// Returns the files in a folder, and below it, that have the ending of a picture.
fn files_like(picture: &Path, folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            files.extend(files_like(picture, &path)?);
        } else if path.extension() == picture.extension() {
            files.push(path);
        }
    }
    Ok(files)
}

/// Returns the engine of a scene, for pictures of the size of an existing picture.
fn engine(scene: &Path, picture: &Path) -> Result<Engine, Box<dyn Error>> {
    let mut engine = Engine::load(scene)?;
    let film = engine.effective_settings().film;
    let known = image::ImageReader::open(picture).and_then(image::ImageReader::with_guessed_format);
    let known = known.ok().and_then(|known| known.into_dimensions().ok());
    engine.settings.size = Some(known.unwrap_or_else(|| fitting((film.width, film.height), SIZE)));
    Ok(engine)
}

fn still(engine: &mut Engine, frame: u32) -> Result<Film, Box<dyn Error>> {
    require(engine, frame)?;
    Ok(engine.render_frame(frame)?)
}

/// Requires that a frame is part of the timeline.
fn require(engine: &Engine, frame: u32) -> Result<(), String> {
    let count = engine.timeline.frame_count();
    if frame < count {
        Ok(())
    } else {
        Err(format!("there is no frame {frame}: the scene has {count}, from 0"))
    }
}

/// Returns the distance between the first two frames of a list.
fn step(frames: &FrameList) -> u32 {
    let mut frames = frames.frames();
    match (frames.next(), frames.next()) {
        (Some(first), Some(second)) => second - first,
        _ => 1,
    }
}
