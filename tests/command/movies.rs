//! `render --movie`: refusals before rendering, and names of files.

use std::fs;
use std::process::Command;

use crate::{FIRST_LIGHT, RAYREEL, command, output_of, pictures, text};

const ARGUMENTS: [&str; 6] = ["render", FIRST_LIGHT, "--size=16x9", "--frames=0-3", "--out=out", "--movie"];

#[test]
fn impossible_movies_are_refused_before_frames_are_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (movie, reason) in [("none/a.gif", "there is no folder `none`"), ("a.mp4", "made by ffmpeg")] {
        let mut rayreel = command(RAYREEL, folder);
        let output = output_of(rayreel.args(ARGUMENTS).arg(movie).env("PATH", folder).spawn().unwrap());
        assert_eq!(output.status.code(), Some(1), "{movie}");
        assert!(text(&output.stderr).contains(reason), "{movie}: {}", text(&output.stderr));
        assert!(pictures(&folder.join("out")).is_empty(), "{movie}");
    }
}

#[test]
fn names_like_protocols_and_options_are_files() {
    if Command::new("ffmpeg").arg("-version").output().is_err() {
        println!("there is no ffmpeg: nothing was tried");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::create_dir(folder.join("-d")).unwrap();
    for movie in ["a:b.mp4", "pipe:1.mp4", "-d/x.mp4", "50%.mp4"] {
        let movie_argument = format!("--movie={movie}");
        let mut rayreel = command(RAYREEL, folder);
        rayreel.args(&ARGUMENTS[..5]).arg(&movie_argument);
        let output = output_of(rayreel.spawn().unwrap());
        assert!(output.status.success(), "{movie}: {}", text(&output.stderr));
        assert!(fs::metadata(folder.join(movie)).unwrap().len() > 0, "{movie}");
    }
}
