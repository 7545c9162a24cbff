//! Files that are none: what would be read for ever, or never opened.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};

use crate::{FIRST_LIGHT, RAYREEL, command, output_of, rayreel, signal, text};

const CAMERA: &str = "camera: (position: (0, 0, -5), target: (0, 0, 0))";

/// A folder with a pipe that nobody writes to.
fn folder_with_a_pipe() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    assert!(Command::new("mkfifo").arg(folder.path().join("pipe")).status().unwrap().success());
    folder
}

/// Each is no file, or has no bytes.
fn endless() -> Vec<&'static str> {
    let mut endless = vec!["pipe", "/dev/zero", "/dev/tty", "/proc/kmsg"];
    endless.retain(|path| *path == "pipe" || Path::new(path).exists());
    endless
}

/// Every way in which a scene names a file.
fn scenes(file: &str) -> Vec<String> {
    vec![
        format!("({CAMERA}, include: [(file: \"{file}\")])"),
        format!("({CAMERA}, spawn: [File(\"{file}\")])"),
        format!(
            "({CAMERA}, animate: [(target: \"scene\", channel: Ambient, track: ScriptFile(\"{file}\"))])"
        ),
    ]
}

#[test]
fn commands_end_whatever_is_named() {
    let folder = folder_with_a_pipe();
    let folder = folder.path();
    for file in endless() {
        let commands: [&[&str]; 6] = [
            &["check", file],
            &["render", file],
            &["explain", file],
            &["probe", file, "--pixel", "0,0"],
            &["explain", file, "--path", "path.svg"],
            &["probe", FIRST_LIGHT, "--rays", file],
        ];
        for arguments in commands {
            let output = rayreel(folder, arguments);
            // A file without bytes has no rays.
            let empty = file == "/proc/kmsg" && arguments.contains(&"--rays");
            assert!(output.status.code() == Some(1) || empty, "{arguments:?}: {}", text(&output.stderr));
        }
        for scene in scenes(file) {
            fs::write(folder.join("scene.ron"), &scene).unwrap();
            let output = rayreel(folder, ["check", "scene.ron"]);
            assert!(
                output.status.code() == Some(1) || file == "/proc/kmsg",
                "{scene}: {}",
                text(&output.stderr)
            );
        }
    }
}

#[test]
fn standard_input_is_read_where_it_is_offered() {
    let folder = tempfile::tempdir().unwrap();
    let scene = format!("({CAMERA})");
    for (arguments, input) in [
        (&["check", "/dev/stdin"][..], scene.as_str()),
        (&["check", "-"], &scene),
        (&["render", "-", "--frames", "0", "--size", "16x9"], &scene),
        (&["probe", "/dev/stdin", "--pixel", "0,0"], &scene),
        (&["probe", FIRST_LIGHT, "--rays", "-"], "0,0,0,0,0,1"),
        (&["probe", FIRST_LIGHT, "--rays", "/dev/stdin"], "0,0,0,0,0,1"),
    ] {
        let mut child =
            command(RAYREEL, folder.path()).args(arguments).stdin(Stdio::piped()).spawn().unwrap();
        child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
        let output = output_of(child);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    }
}

/// They would read it again, or later.
#[test]
fn streams_are_neither_watched_nor_farmed() {
    let folder = tempfile::tempdir().unwrap();
    for stream in ["-", "/dev/stdin", "/dev/fd/0"] {
        for (arguments, told) in [
            (&["watch", stream][..], "cannot be read again"),
            (&["farm", "slurm", stream, "--shards", "2"], "jobs read the scene later"),
        ] {
            let mut child =
                command(RAYREEL, folder.path()).args(arguments).stdin(Stdio::piped()).spawn().unwrap();
            // As long as it is there, there may be more to read.
            let stdin = child.stdin.take();
            let output = output_of(child);
            drop(stdin);
            assert_eq!(output.status.code(), Some(1), "{arguments:?}");
            assert!(text(&output.stderr).contains(told), "{arguments:?}: {}", text(&output.stderr));
        }
    }
}

#[test]
fn the_watcher_reads_no_more_than_the_loader() {
    let folder = folder_with_a_pipe();
    let folder = folder.path();
    for file in ["pipe", "/dev/zero"] {
        for scene in [None].into_iter().chain(scenes(file).into_iter().map(Some)) {
            let watched = scene.as_ref().map_or(file, |_| "scene.ron");
            scene.iter().for_each(|scene| fs::write(folder.join("scene.ron"), scene).unwrap());
            let mut child = command(RAYREEL, folder).args(["watch", watched]).spawn().unwrap();
            let mut told = BufReader::new(child.stderr.take().unwrap());
            // By then it keeps to the files, and has looked at them.
            let mut lines = String::new();
            while !lines.contains("nothing to show yet") {
                assert!(told.read_line(&mut lines).unwrap() > 0, "{lines}");
            }
            assert!(lines.contains("is not a file"), "{lines}");
            signal(&child, "TERM");
            assert_eq!(output_of(child).status.code(), Some(143));
        }
    }
}
