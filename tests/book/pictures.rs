//! Tests of the pictures of the README and the book against their recipes.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use std::{fs, io};

use assert_cmd::cargo::cargo_bin;

use crate::program::exhibit::fitting;
use crate::program::pictures::make;
use crate::program::recipes::{Making, Recipe, recipe, recipes};

const SCENE: &str = r#"Scene(
    timeline: (fps: 10, duration: 2),
    film: (width: 160, height: 90),
    camera: (position: (0, 0, -5), target: (0, 0, 0)),
    ambient: (0.4, 0.4, 0.4),
    materials: { "clay": (k_a: 1, k_d: 0.5, color: (255, 120, 60)) },
    entities: [
        (name: "ball", shape: Sphere(radius: 1), material: "clay"),
        (light: Point(intensity: (1, 1, 1)), transform: (translation: (4, 6, -4))),
    ],
    animate: [(target: "ball", channel: Translation, track: Keys([(0, (0, 0, 0)), (2, (0, 0.5, 0))]))],
)"#;

fn run(words: &[String], folder: &Path) -> io::Result<ExitStatus> {
    let output = Command::new(cargo_bin(&words[0])).args(&words[1..]).current_dir(folder).output()?;
    Ok(output.status)
}

fn size(file: &Path) -> (u32, u32) {
    let reader = image::ImageReader::open(file).unwrap().with_guessed_format().unwrap();
    reader.into_dimensions().unwrap()
}

/// Makes all pictures that do not move again: they have the same pixels, so that they are not written, or the same bytes.
#[test]
fn still_pictures_are_up_to_date() {
    let folder = tempfile::tempdir().unwrap();
    let is_still = |making: &Making| match making {
        Making::Still { .. } => true,
        Making::Movie { .. } => false,
        Making::Command(words) => words[0] == "rayreel",
    };
    let stills: Vec<Recipe> =
        recipes(Path::new("")).unwrap().into_iter().filter(|recipe| is_still(&recipe.making)).collect();
    assert!(stills.len() >= 10, "{stills:?}");
    for recipe in stills {
        let picture = folder.path().join(recipe.picture.file_name().unwrap());
        fs::copy(&recipe.picture, &picture).unwrap();
        make(&Recipe { picture: picture.clone(), ..recipe.clone() }, run).unwrap();
        let is_same = fs::read(&picture).unwrap() == fs::read(&recipe.picture).unwrap();
        assert!(is_same, "{recipe:?}: `cargo run --release --example gallery -- --pictures` makes it again");
    }
}

#[test]
fn recipes_are_read_from_titles() {
    let read = |line: &str| recipe(line, Path::new("src/book/a.md"));
    let made = |file: &str, making| {
        Ok(Some(Recipe {
            chapter: "src/book/a.md".into(),
            picture: Path::new("src/book").join(file),
            making,
        }))
    };
    let scene = || "scenes/ball.ron".into();
    assert_eq!(
        read("[ball]: pictures/ball.png \"scenes/ball.ron, frame 12\""),
        made("pictures/ball.png", Making::Still { scene: scene(), frame: 12 })
    );
    assert_eq!(
        read("[hop]: hop.gif \"scenes/ball.ron, frames 0-95x2\""),
        made("hop.gif", Making::Movie { scene: scene(), frames: "0-95x2".parse().unwrap() })
    );
    let words = ["rayreel", "probe", "scenes/ball.ron", "--svg", "rays.svg"].map(str::to_owned).into();
    assert_eq!(
        read("[rays]: pictures/rays.svg \"rayreel probe scenes/ball.ron --svg rays.svg\""),
        made("pictures/rays.svg", Making::Command(words))
    );
    for line in
        ["[ball]: ball.png", "[page]: page.md \"A page\"", "![ball][ball] \"frame\"", "a [b]: c.png \"d\""]
    {
        assert_eq!(read(line), Ok(None), "{line}");
    }
    for title in ["A ball", "scenes/ball.ron", "scenes/ball.ron, frame x", "scenes/ball.ron, frames 0-9"] {
        let message = read(&format!("[ball]: ball.png \"{title}\"")).unwrap_err();
        assert!(
            message.starts_with(&format!("`{title}` does not tell how `ball.png` is made: write ")),
            "{message}"
        );
    }
}

#[test]
fn pictures_are_made_by_their_recipes_and_keep_their_size() {
    let folder = tempfile::tempdir().unwrap();
    let chapter = folder.path().join("chapter.md");
    fs::write(&chapter, format!("```ron\n// ball.ron\n{SCENE}\n```\n")).unwrap();
    let (scene, frames) = (PathBuf::from("ball.ron"), "0-19x5".parse().unwrap());
    let recipe =
        |name, making| Recipe { chapter: chapter.clone(), picture: folder.path().join(name), making };
    let command = "rayreel render ball.ron --sheet 2x1 --size 32x18".split(' ').map(str::to_owned).collect();
    for (name, making, sizes) in [
        ("new/ball.png", Making::Still { scene: scene.clone(), frame: 3 }, [(480, 270), (32, 18)]),
        ("new/ball.gif", Making::Movie { scene: scene.clone(), frames }, [(480, 270), (32, 18)]),
        ("new/sheet.png", Making::Command(command), [(88, 48); 2]),
    ] {
        let recipe = recipe(name, making);
        make(&recipe, run).unwrap();
        assert_eq!(size(&recipe.picture), sizes[0], "{name}");
        image::RgbImage::new(32, 18).save(&recipe.picture).unwrap();
        make(&recipe, run).unwrap();
        assert_eq!(size(&recipe.picture), sizes[1], "{name}");
        let first = fs::read(&recipe.picture).unwrap();
        make(&recipe, run).unwrap();
        assert!(fs::read(&recipe.picture).unwrap() == first, "{name}");
    }
    let late = recipe("late.png", Making::Still { scene, frame: 20 });
    assert_eq!(make(&late, run).unwrap_err().to_string(), "there is no frame 20: the scene has 20, from 0");
    let nothing = recipe("none.png", Making::Command(["rayreel", "schema"].map(str::to_owned).into()));
    let message = make(&nothing, run).unwrap_err().to_string();
    assert!(message.ends_with(" and made 0 such files"), "{message}");
    assert_eq!(
        [(1920, 1080), (90, 160), (3000, 1)].map(|film| fitting(film, (480, 270))),
        [(480, 270), (152, 270), (480, 1)]
    );
}
