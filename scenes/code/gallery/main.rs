//! The gallery of the scenes: `cargo run --release --example gallery` renders all scenes of the repository into `out/gallery/index.html`:
//! stills, loops, times, plans and sources. It takes some ten minutes; `--scene NAME` makes the pages of some scenes, and `--help` lists
//! the other options. With `--pictures`, it makes the pictures of the README and the book instead.

#![allow(clippy::print_stdout, reason = "a program prints what it makes")]

pub(crate) mod chapter;
pub(crate) mod exhibit;
mod page;
pub(crate) mod pictures;
pub(crate) mod recipes;
pub(crate) mod source;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Parser;

use exhibit::Exhibit;

/// Renders the scenes of the repository into pages with stills, loops, times, plans and sources
#[derive(Clone, Debug, Parser)]
pub(crate) struct Options {
    /// Folder of the pages
    #[arg(default_value = "out/gallery")]
    pub(crate) folder: PathBuf,
    /// Scene to show, as `first_light`, or its file; may be repeated [default: all scenes]
    #[arg(long = "scene", value_name = "NAME")]
    pub(crate) scenes: Vec<PathBuf>,
    /// Size into which the pictures fit
    #[arg(long, default_value = "640x360", value_parser = size)]
    pub(crate) size: (u32, u32),
    /// Samples per pixel, instead of those of the scenes
    #[arg(long)]
    pub(crate) samples: Option<u32>,
    /// Time in which to render the loop of a scene: if it is too short for all frames, some are left out
    #[arg(long, default_value_t = 30.0)]
    pub(crate) seconds: f64,
    /// Makes the pictures of the README and the book, by their recipes
    #[arg(long)]
    pub(crate) pictures: bool,
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let sides =
        text.split_once('x').and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
    sides
        .filter(|(width, height)| *width > 0 && *height > 0)
        .ok_or("write width and height, as 640x360".to_owned())
}

/// Makes the gallery. Returns the path of its first page.
pub(crate) fn make(options: &Options) -> Result<PathBuf, Box<dyn Error>> {
    fs::create_dir_all(&options.folder)?;
    let mut exhibits = Vec::new();
    for file in scenes(options)? {
        let exhibit = Exhibit::make(&file, options)?;
        println!("{}", exhibit.title);
        exhibits.push(exhibit);
    }
    for (index, exhibit) in exhibits.iter().enumerate() {
        fs::write(options.folder.join(format!("{}.html", exhibit.id)), page::scene(&exhibits, index))?;
    }
    let index = options.folder.join("index.html");
    fs::write(&index, page::index(&exhibits))?;
    Ok(index)
}

/// Returns the files of the scenes to show.
fn scenes(options: &Options) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let shipped = |name: &PathBuf| {
        Some(Path::new("scenes").join(name).with_extension("ron")).filter(|file| file.exists())
    };
    if !options.scenes.is_empty() {
        return Ok(options.scenes.iter().map(|name| shipped(name).unwrap_or(name.clone())).collect());
    }
    let mut scenes = Vec::new();
    for folder in ["scenes", "scenes/lesson"] {
        let mut files = Vec::new();
        for entry in fs::read_dir(folder)? {
            files.push(entry?.path());
        }
        files.retain(|file| file.extension().is_some_and(|extension| extension == "ron"));
        files.sort();
        scenes.extend(files);
    }
    Ok(scenes)
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse();
    if options.pictures {
        return pictures::remake();
    }
    println!("{}", make(&options)?.display());
    Ok(())
}
