//! Tests of interrupted movies, and of an ffmpeg that hangs or dies.

use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::ignored::interruption;
use crate::{RAYREEL, command, files, output_of, rayreel, signal, text, until};

/// A scene with only a background, so that frames are rendered faster than they are encoded.
const SCENE: &str = r##"Scene(
    timeline: (fps: 24, duration: 1.5),
    film: (width: 1600, height: 900),
    camera: (position: (0, 0, -5), target: (0, 0, 0)),
    background: (bottom: (255, 255, 255), top: "#80b3ff"),
    entities: [],
)"##;

/// Maximum time from a signal to the exit, on a busy machine.
const SOON: Duration = Duration::from_secs(5);

/// Enough frames that animations take seconds to encode and exceed the size of a pipe.
const MANY: &str = "--frames=0-35";
const FEW: &str = "--frames=0-1";

/// Returns a folder with the scene, its frames, a folder for the movie, and a stand-in for ffmpeg that runs a script.
fn folder_with(ffmpeg: &str, frames: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("scene.ron"), SCENE).unwrap();
    for name in ["bin", "movie"] {
        fs::create_dir(path.join(name)).unwrap();
    }
    let program = path.join("bin/ffmpeg");
    let script = format!("#!/bin/sh\n[ \"$1\" = -version ] && exit\n: > started\n{ffmpeg}\n");
    fs::write(&program, script).unwrap();
    fs::set_permissions(&program, Permissions::from_mode(0o755)).unwrap();
    let rendered = rayreel(path, ["render", "scene.ron", "--out=out", frames]);
    assert!(rendered.status.success(), "{}", text(&rendered.stderr));
    folder
}

/// Starts making a movie in its own process group.
fn start(folder: &Path, movie: &str, frames: &str) -> Child {
    let path = std::env::var("PATH").unwrap_or_default();
    let mut command = command(RAYREEL, folder);
    command.args(["render", "scene.ron", "--out=out", frames, "--movie", &format!("movie/{movie}")]);
    command.env("PATH", format!("{}:{path}", folder.join("bin").display()));
    command.process_group(0).spawn().unwrap()
}

/// Sends a signal to all processes of a group. Returns `false` if there are none.
fn signal_group(leader: u32, name: &str) -> bool {
    let mut kill = Command::new("kill");
    kill.args(["-s", name, "--", &format!("-{leader}")]).stderr(Stdio::null());
    kill.status().unwrap().success()
}

/// Interrupts a movie, by signals to the process and to its group, as soon as `is_under_way` returns true.
fn assert_interruptible(folder: &Path, movie: &str, frames: &str, is_under_way: impl Fn() -> bool) {
    for ((name, code), to_group) in
        [(interruption(), false), (interruption(), true), (("TERM", 143), false), (("TERM", 143), true)]
    {
        let what = format!("{movie}, {name}, to the group: {to_group}");
        let child = start(folder, movie, frames);
        let leader = child.id();
        until(&what, &is_under_way);
        let begin = Instant::now();
        if to_group {
            assert!(signal_group(leader, name), "{what}");
        } else {
            signal(&child, name);
        }
        let output = output_of(child);
        let (took, stderr) = (begin.elapsed(), text(&output.stderr));
        assert_eq!(output.status.code(), Some(code), "{what}: {stderr}");
        assert!(took < SOON, "{what}: {took:?}");
        assert!(stderr.contains("interrupted: the movie") && !stderr.contains("error"), "{what}: {stderr}");
        assert!(files(&folder.join("movie")).is_empty(), "{what}");
        until(&format!("{what}: ffmpeg goes on"), || !signal_group(leader, "0"));
        let _ = fs::remove_file(folder.join("started"));
    }
}

#[test]
fn interrupted_animations_end_at_once_without_files() {
    let folder = folder_with("exit 1", MANY);
    let folder = folder.path();
    for movie in ["a.gif", "a.apng"] {
        assert_interruptible(folder, movie, MANY, || !files(&folder.join("movie")).is_empty());
    }
}

#[test]
fn interrupted_ffmpeg_ends_at_once_without_files() {
    for hangs in [
        "exec sleep 600",
        "cat > /dev/null; exec sleep 600",
        "trap '' INT TERM; exec sleep 600",
        "for target; do :; done; echo half > \"${target#file:}\"; exec sleep 600",
    ] {
        let folder = folder_with(hangs, FEW);
        let folder = folder.path();
        assert_interruptible(folder, "a.mp4", FEW, || folder.join("started").exists());
    }
}

#[test]
fn ffmpeg_failure_is_reported_without_files() {
    for (dies, reason) in [
        ("exit 3", "could not make the movie: it ended with exit status: 3"),
        ("kill -9 $$", "could not make the movie: it ended with signal: 9"),
        ("echo no such codec >&2; exit 1", "could not make the movie: no such codec"),
        ("exit 0", "ffmpeg takes no more frames"),
        // Its child has the pipe open, and never reads.
        ("sleep 600 <&0 2> /dev/null & exit 3", "could not make the movie: it ended with exit status: 3"),
    ] {
        let folder = folder_with(dies, FEW);
        let child = start(folder.path(), "a.mkv", FEW);
        let leader = child.id();
        let output = output_of(child);
        signal_group(leader, "KILL");
        assert_eq!(output.status.code(), Some(1), "{dies}");
        assert!(text(&output.stderr).contains(reason), "{dies}: {}", text(&output.stderr));
        assert!(files(&folder.path().join("movie")).is_empty(), "{dies}");
    }
}

#[test]
fn leftovers_of_killed_processes_are_removed_by_the_next_run() {
    let folder = folder_with("exec sleep 600", FEW);
    let folder = folder.path();
    let child = start(folder, "a.mp4", FEW);
    until("ffmpeg", || folder.join("started").exists());
    assert!(signal_group(child.id(), "KILL"));
    output_of(child);
    assert_eq!(files(&folder.join("movie")).len(), 1);
    let output = output_of(start(folder, "b.gif", FEW));
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(files(&folder.join("movie")), ["b.gif"]);
}

/// Checks a reader that neither reads nor closes the pipe.
#[test]
fn interrupted_streams_end_at_once() {
    let folder = folder_with("exit 1", FEW);
    for to_group in [false, true] {
        let (name, code) = interruption();
        let mut command = command(RAYREEL, folder.path());
        command.args(["render", "scene.ron", "--out=-"]).process_group(0);
        let mut child = command.spawn().unwrap();
        let unread = child.stdout.take();
        // Long enough to fill the pipe.
        std::thread::sleep(Duration::from_millis(500));
        let begin = Instant::now();
        if to_group {
            assert!(signal_group(child.id(), name));
        } else {
            signal(&child, name);
        }
        let output = output_of(child);
        drop(unread);
        assert_eq!(output.status.code(), Some(code), "{}", text(&output.stderr));
        assert!(begin.elapsed() < SOON, "{:?}", begin.elapsed());
    }
}
