//! The manifest of a folder of frames: the scene and the settings they were rendered with. `verify` reads it.

use std::ffi::OsString;
use std::fs;
use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, bail};
use clap::{Parser, ValueEnum};
use serde::{Deserialize, Serialize};

use rayreel::output::{folder_of, write_bytes};
use rayreel::scene::input::{self, InputKind};

use super::args::{Arguments, Command, RenderArguments};
use super::settings::OutputSettings;

/// Suffix of the file name of a manifest, after the name of the frames.
const ENDING: &str = ".sequence.json";

/// Contents of the manifest file.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Manifest {
    /// The version of rayreel that wrote the file.
    rayreel: String,
    /// Path of the scene, relative to the folder where possible.
    scene: String,
    /// The arguments of `render` that affect pictures.
    arguments: Vec<String>,
}

/// Writes the manifest of a folder, unless an equal one exists.
pub(super) fn write(arguments: &RenderArguments, settings: &OutputSettings) -> anyhow::Result<()> {
    let file = settings.sequence.manifest();
    let folder = settings.sequence.directory();
    let chosen = arguments.max_error.is_some() || arguments.deadline.is_some();
    let samples = match &arguments.settings {
        Some(file) => Some(from_folder(folder, file)?),
        None => chosen.then(|| settings.file_of_settings().file_name().map(PathBuf::from)).flatten(),
    };
    let (Some(scene), Some(pictures)) = (
        from_folder(folder, &arguments.scene)?.to_str().map(str::to_owned),
        picture_arguments(arguments, samples),
    ) else {
        // Paths that are not UTF-8 cannot be stored. `verify` then reports a missing manifest, rather than read that of earlier frames.
        return match fs::remove_file(&file) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                Err(error).with_context(|| format!("cannot remove `{}`", file.display()))
            }
            _ => Ok(()),
        };
    };
    let manifest = Manifest { rayreel: env!("CARGO_PKG_VERSION").to_owned(), scene, arguments: pictures };
    if read(&file).ok().as_ref() != Some(&manifest) {
        write_bytes(&file, format!("{}\n", serde_json::to_string_pretty(&manifest)?).as_bytes())?;
    }
    Ok(())
}

/// Returns the arguments that the frames of a folder were rendered with, from its only manifest or from the manifest of `scene`.
pub(super) fn render_arguments(folder: &Path, scene: Option<&Path>) -> anyhow::Result<RenderArguments> {
    let file = find(folder, scene)?;
    let Manifest { scene: recorded, arguments, .. } = read(&file)?;
    let scene = scene.map_or_else(|| from_here(folder.join(recorded)), Path::to_owned);
    let words = ["rayreel", "render"].map(OsString::from).into_iter();
    let words = words.chain(arguments.into_iter().map(OsString::from));
    let words = words.chain(["--out".into(), folder.into(), "--".into(), scene.into()]);
    let broken = || format!("`{}` has arguments that `render` does not take", file.display());
    let Command::Render(mut arguments) = Arguments::try_parse_from(words).with_context(broken)?.command
    else {
        bail!(broken());
    };
    // The stored path is relative to the folder.
    arguments.settings = arguments.settings.map(|file| folder.join(file));
    if arguments.draft {
        // Drafts are written to a subfolder of `--out`.
        arguments.out = Some(folder_of(folder).to_owned());
    }
    Ok(arguments)
}

/// Finds the only manifest of a folder, or the manifest of the given scene.
fn find(folder: &Path, scene: Option<&Path>) -> anyhow::Result<PathBuf> {
    let entries =
        fs::read_dir(folder).with_context(|| format!("cannot read the folder `{}`", folder.display()))?;
    let mut files = Vec::new();
    for entry in entries {
        let name = entry?.file_name();
        let Some(stem) = name.to_str().and_then(|name| name.strip_suffix(ENDING)) else { continue };
        if scene.is_none_or(|scene| scene.file_stem().is_some_and(|own| own == stem)) {
            files.push(folder.join(name));
        }
    }
    match &files[..] {
        [file] => Ok(file.clone()),
        [] => bail!(
            "`{}` does not say what its frames were rendered from: it has no file *{ENDING}, which `render` writes{}, except for a scene from standard input: render a scene file",
            folder.display(),
            if scene.is_some() { " for this scene" } else { "" }
        ),
        _ => bail!("`{}` has frames of several scenes: name one with --scene", folder.display()),
    }
}

fn read(file: &Path) -> anyhow::Result<Manifest> {
    /// Maximum size in bytes, far more than any command line has.
    const MOST: u64 = 1 << 24;
    let bytes = input::read(file, InputKind::Refused, MOST)
        .with_context(|| format!("cannot read `{}`", file.display()))?;
    serde_json::from_slice(&bytes)
        .with_context(|| format!("`{}` is not a manifest written by `render`", file.display()))
}

/// Returns the arguments that affect pictures, in command-line form. `samples` is the settings file, if samples were selected. Returns
/// `None` if its path is not UTF-8.
fn picture_arguments(arguments: &RenderArguments, samples: Option<PathBuf>) -> Option<Vec<String>> {
    let mut words = Vec::new();
    let mut add = |option: &str, value: String| words.extend([format!("--{option}={value}")]);
    if let Some((width, height)) = arguments.size {
        add("size", format!("{width}x{height}"));
    }
    if let Some(names) = &arguments.name {
        add("name", names.to_string());
        // A name without a place for numbers names a single frame.
        if let Some(frames) = arguments.frames.as_ref().filter(|_| !names.have_numbers()) {
            add("frames", frames.to_string());
        }
    }
    let name = |value: clap::builder::PossibleValue| value.get_name().to_owned();
    add("precision", name(arguments.precision.to_possible_value()?));
    if let Some(format) = arguments.format {
        add("format", name(format.to_possible_value()?));
    }
    if let Some(passes) = arguments.passes {
        add("passes", passes.to_string());
    }
    if let Some(cutoff) = arguments.cutoff {
        add("cutoff", cutoff.to_string());
    }
    if let Some(samples) = samples {
        add("settings", samples.to_str()?.to_owned());
    }
    let chosen = arguments.max_error.is_some();
    for value in arguments.overrides.all() {
        // With an error target, the samples are the maximum per pixel, which the settings file holds for each frame.
        if !(chosen && value.path() == ["sampling", "samples"]) {
            add("set", value.to_string());
        }
    }
    for effect in arguments.overrides.without().iter() {
        add("without", effect.name().to_owned());
    }
    let flags = [(arguments.alpha, "--alpha"), (arguments.draft, "--draft")];
    words.extend(flags.into_iter().filter(|(is_given, _)| *is_given).map(|(_, flag)| flag.to_owned()));
    Some(words)
}

/// Returns the path relative to the working directory, or the path unchanged if the file is elsewhere.
fn from_here(file: PathBuf) -> PathBuf {
    let short = || {
        let here = std::env::current_dir().ok()?.canonicalize().ok()?;
        Some(file.canonicalize().ok()?.strip_prefix(here).ok()?.to_owned())
    };
    short().unwrap_or(file)
}

/// Returns the relative path from a folder to a file, or the absolute path if the two have no common root.
fn from_folder(folder: &Path, file: &Path) -> anyhow::Result<PathBuf> {
    let full = |path: &Path| path.canonicalize().with_context(|| format!("cannot find `{}`", path.display()));
    let (folder, file) = (full(folder)?, full(file)?);
    let common = folder.components().zip(file.components()).take_while(|(one, other)| one == other).count();
    let has_root = folder.components().take(common).any(|part| part == Component::RootDir);
    if !has_root {
        return Ok(file);
    }
    let up = folder.components().skip(common).map(|_| Component::ParentDir);
    Ok(up.chain(file.components().skip(common)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(words: &[&str]) -> RenderArguments {
        match Arguments::try_parse_from(["rayreel", "render", "a.ron"].iter().chain(words)).unwrap().command {
            Command::Render(arguments) => arguments,
            _ => unreachable!(),
        }
    }

    #[test]
    fn manifest_round_trips_picture_settings() {
        let arguments = parsed(&[
            "--size=64x48",
            "--name=shot_%05d",
            "--precision=textbook-f32",
            "--format=exr",
            "--passes=id,depth",
            "--cutoff=0.25",
            "--samples=4",
            "--set=camera.fov=-5e1",
            "--set=materials.clay.color=(255, 0, 0)",
            "--without=shadows",
            "--without=depth of field",
            "--alpha",
            "--draft",
            "--threads=1",
            "--frames=3-5",
            "--json",
        ]);
        let words = picture_arguments(&arguments, None).unwrap();
        let again = parsed(&words.iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(picture_arguments(&again, None).unwrap(), words);
        assert_eq!((again.size, again.cutoff, again.draft), (Some((64, 48)), Some(0.25), true));
        assert_eq!(again.name, arguments.name);
        assert_eq!((again.format, again.passes, again.alpha), (arguments.format, arguments.passes, true));
        assert_eq!(again.overrides.all(), arguments.overrides.all());
        assert_eq!(again.overrides.without(), arguments.overrides.without());
        assert_eq!((again.threads, again.json, again.frames), (None, false, None));
    }

    #[test]
    fn relative_paths_lead_from_the_folder_to_the_file() {
        let root = tempfile::tempdir().unwrap();
        let (folder, file) = (root.path().join("out/a"), root.path().join("scenes/a.ron"));
        fs::create_dir_all(&folder).unwrap();
        fs::create_dir(file.parent().unwrap()).unwrap();
        fs::write(&file, "").unwrap();
        assert_eq!(from_folder(&folder, &file).unwrap(), Path::new("../../scenes/a.ron"));
    }
}
