//! Tests of `render --movie`: refusals before rendering, and file names.

use std::fs;
use std::io::Write;
use std::process::{Command, Stdio};

use crate::{FIRST_LIGHT, RAYREEL, command, output_of, pictures, text};

const ARGUMENTS: [&str; 6] = ["render", FIRST_LIGHT, "--size=16x9", "--frames=0-3", "--out=out", "--movie"];

#[test]
fn impossible_movies_are_errors_before_rendering() {
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

#[test]
fn omitted_gif_frames_are_reported_with_quiet() {
    let folder = tempfile::tempdir().unwrap();
    let mut rayreel = command(RAYREEL, folder.path());
    let arguments = ["render", "-", "--out=out", "--movie=a.gif", "--quiet"];
    let mut child = rayreel.args(arguments).stdin(Stdio::piped()).spawn().unwrap();
    let scene = b"Scene(timeline: (fps: 60, duration: 0.5), film: (width: 16, height: 9), camera: (position: (0, 0, -5), target: (0, 0, 0)), background: (bottom: (0, 0, 0), top: (255, 255, 255)))";
    child.stdin.take().unwrap().write_all(scene).unwrap();
    let output = output_of(child);
    let stderr = text(&output.stderr);
    assert!(output.status.success() && stderr.starts_with("warning: a GIF plays at most 50"), "{stderr}");
}
