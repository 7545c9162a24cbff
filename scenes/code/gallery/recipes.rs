//! Recipes of the pictures in Markdown files: the titles of the link definitions that name pictures.
//!
//! ```text
//! [ball]: pictures/ball.png "scenes/ball.ron, frame 12"
//! [hop]: pictures/hop.gif "scenes/ball.ron, frames 0-95x2"
//! [rays]: pictures/rays.svg "rayreel probe scenes/ball.ron --pixel 1,2 --svg rays.svg"
//! [sheet]: pictures/sheet.png "rayreel render ball.ron --sheet 4x2"
//! [marbles]: pictures/marbles.gif "cargo run --release --example marbles -- marbles.gif"
//! ```

use std::fs;
use std::path::{Path, PathBuf};

use rayreel::time::FrameList;

/// A picture of a chapter, and the way it is made.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Recipe {
    /// Path of the chapter, a Markdown file.
    pub(crate) chapter: PathBuf,
    /// Path of the picture.
    pub(crate) picture: PathBuf,
    /// The way the picture is made.
    pub(crate) making: Making,
}

/// The way a picture is made. A scene is a file of the repository, or stands in the chapter under its name.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Making {
    /// A frame of a scene.
    Still { scene: PathBuf, frame: u32 },
    /// Frames of a scene, as a moving picture.
    Movie { scene: PathBuf, frames: FrameList },
    /// The words of a command line of `rayreel` or `cargo`, which writes one file with the ending of the picture.
    Command(Vec<String>),
}

/// Returns the recipes of the README and the book in a repository.
pub(crate) fn recipes(repository: &Path) -> Result<Vec<Recipe>, String> {
    let book = repository.join("src/book");
    let mut files = vec![repository.join("README.md")];
    if let Ok(entries) = fs::read_dir(&book) {
        files.extend(entries.flatten().map(|entry| entry.path()));
    }
    files.retain(|file| file.extension().is_some_and(|extension| extension == "md"));
    files[1..].sort();
    let mut recipes = Vec::new();
    for file in files {
        let text = fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
        for (number, line) in (1..).zip(text.lines()) {
            let recipe = recipe(line, &file);
            recipes.extend(
                recipe.map_err(|reason| format!("{}:{number}: {reason}", file.display())).transpose(),
            );
        }
    }
    recipes.into_iter().collect()
}

/// Returns the recipe in a line of a chapter. `None` if the line does not define a picture with a title.
pub(crate) fn recipe(line: &str, chapter: &Path) -> Result<Option<Recipe>, String> {
    let definition = line.strip_prefix('[').and_then(|line| line.split_once("]: "));
    let Some((target, title)) = definition.and_then(|(_, rest)| rest.trim_end().split_once(" \"")) else {
        return Ok(None);
    };
    if !["png", "gif", "apng", "svg"].iter().any(|end| target.ends_with(&format!(".{end}"))) {
        return Ok(None);
    }
    let title = title.strip_suffix('"').unwrap_or(title);
    let making = making(title, Path::new(target)).ok_or_else(|| {
        format!(
            "`{title}` does not tell how `{target}` is made: write \"scenes/ball.ron, frame 12\", for a .gif or .apng file \
             \"scenes/ball.ron, frames 0-95x2\", or a command line that begins with `rayreel` or `cargo`"
        )
    })?;
    Ok(Some(Recipe { chapter: chapter.to_owned(), picture: chapter.with_file_name(target), making }))
}

fn making(title: &str, picture: &Path) -> Option<Making> {
    let moves = picture.extension().is_some_and(|extension| extension == "gif" || extension == "apng");
    if title.starts_with("rayreel ") || title.starts_with("cargo ") {
        return Some(Making::Command(title.split_whitespace().map(str::to_owned).collect()));
    }
    let (scene, frames) = title.split_once(", ")?;
    let scene = PathBuf::from(scene);
    match frames.split_once(' ')? {
        ("frame", frame) if !moves => Some(Making::Still { scene, frame: frame.parse().ok()? }),
        ("frames", frames) if moves => Some(Making::Movie { scene, frames: frames.parse().ok()? }),
        _ => None,
    }
}
