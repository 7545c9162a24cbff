//! Tests of input paths that are not regular files, and would be read forever or block when opened.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};

use crate::{FIRST_LIGHT, RAYREEL, command, output_of, rayreel, signal, stdout_of, text};

const CAMERA: &str = "camera: (position: (0, 0, -5), target: (0, 0, 0))";

/// Returns a folder with a pipe without a writer.
fn folder_with_a_pipe() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    assert!(Command::new("mkfifo").arg(folder.path().join("pipe")).status().unwrap().success());
    folder
}

/// Returns paths that are not regular files, or have no bytes.
fn endless() -> Vec<&'static str> {
    let mut endless = vec!["pipe", "/dev/zero", "/dev/tty", "/proc/kmsg"];
    endless.retain(|path| *path == "pipe" || Path::new(path).exists());
    endless
}

/// Returns a scene for every way to reference a file.
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
fn commands_terminate_for_any_input_file() {
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
            // A file without bytes contains no rays.
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
fn standard_input_is_read_where_supported() {
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

/// Checks that commands that read a scene again, or later, refuse streams.
#[test]
fn streams_cannot_be_watched_or_farmed() {
    let folder = tempfile::tempdir().unwrap();
    for stream in ["-", "/dev/stdin", "/dev/fd/0"] {
        for (arguments, expected) in [
            (&["watch", stream][..], "cannot be read again"),
            (&["farm", "slurm", stream, "--shards", "2"], "jobs read the scene later"),
        ] {
            let mut child =
                command(RAYREEL, folder.path()).args(arguments).stdin(Stdio::piped()).spawn().unwrap();
            // While stdin is open, more input may follow.
            let stdin = child.stdin.take();
            let output = output_of(child);
            drop(stdin);
            assert_eq!(output.status.code(), Some(1), "{arguments:?}");
            assert!(text(&output.stderr).contains(expected), "{arguments:?}: {}", text(&output.stderr));
        }
    }
}

#[test]
fn watcher_and_loader_have_the_same_size_limit() {
    let folder = folder_with_a_pipe();
    let folder = folder.path();
    for file in ["pipe", "/dev/zero"] {
        for scene in [None].into_iter().chain(scenes(file).into_iter().map(Some)) {
            let watched = scene.as_ref().map_or(file, |_| "scene.ron");
            scene.iter().for_each(|scene| fs::write(folder.join("scene.ron"), scene).unwrap());
            let mut child = command(RAYREEL, folder).args(["watch", watched]).spawn().unwrap();
            let mut stderr = BufReader::new(child.stderr.take().unwrap());
            // After this message, the watcher has examined the files and watches them.
            let mut lines = String::new();
            while !lines.contains("nothing to show yet") {
                assert!(stderr.read_line(&mut lines).unwrap() > 0, "{lines}");
            }
            assert!(lines.contains("is not a file"), "{lines}");
            signal(&child, "TERM");
            assert_eq!(output_of(child).status.code(), Some(143));
        }
    }
}

/// A replacement for a file that is read.
#[derive(Clone, Copy, Debug)]
enum Odd {
    Pipe,
    Device,
    Directory,
    /// A file of 1 TiB, more than fits in memory.
    Long,
    /// A header of a picture that is too large for memory.
    Header,
}

impl Odd {
    fn put(self, path: &Path) {
        let bytes = fs::read(path).unwrap();
        fs::remove_file(path).unwrap();
        match self {
            Self::Pipe => assert!(Command::new("mkfifo").arg(path).status().unwrap().success()),
            Self::Device => std::os::unix::fs::symlink("/dev/zero", path).unwrap(),
            Self::Directory => fs::create_dir(path).unwrap(),
            Self::Long => fs::File::create(path).unwrap().set_len(1 << 40).unwrap(),
            Self::Header => fs::write(path, with_huge_header(&bytes)).unwrap(),
        }
    }
}

/// Returns a frame of the same format with a header of 30000x30000 pixels and little data.
fn with_huge_header(bytes: &[u8]) -> Vec<u8> {
    const SIDE: u32 = 30_000;
    match bytes {
        [0x89, ..] => {
            let depth = if bytes[24] == 16 { png::BitDepth::Sixteen } else { png::BitDepth::Eight };
            let mut huge = Vec::new();
            let mut encoder = png::Encoder::new(&mut huge, SIDE, SIDE);
            encoder.set_color(png::ColorType::Rgb);
            encoder.set_depth(depth);
            encoder.write_header().unwrap().write_chunk(png::chunk::IDAT, b"x\x9c\x03\0").unwrap();
            huge
        }
        [b'P', b'6', ..] => format!("P6\n{SIDE} {SIDE} 255\n").into_bytes(),
        [b'#', ..] => format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {SIDE} +X {SIDE}\n").into_bytes(),
        [b'P', b'F', ..] => format!("PF\n{SIDE} {SIDE}\n-1.0\n").into_bytes(),
        _ => {
            let name = b"dataWindow\0box2i\0\x10\0\0\0";
            let place = bytes.windows(name.len()).position(|window| window == name).unwrap() + name.len();
            let corner = [SIDE - 1, SIDE - 1].map(u32::to_le_bytes).concat();
            [&bytes[..place + 8], &corner, &bytes[place + 16..]].concat()
        }
    }
}

/// Runs `rayreel` with less memory than a huge frame needs.
fn bounded(folder: &Path, arguments: &[&str]) -> std::process::Output {
    let limited = "ulimit -v 2000000; exec \"$0\" \"$@\"";
    output_of(command("sh", folder).args(["-c", limited, RAYREEL]).args(arguments).spawn().unwrap())
}

#[test]
fn invalid_frames_and_manifests_are_reported() {
    for format in ["png", "png16", "ppm", "pfm", "exr", "hdr"] {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let scene = format!("(timeline: (fps: 2, duration: 1), film: (width: 16, height: 9), {CAMERA})");
        fs::write(folder.join("a.ron"), scene).unwrap();
        let render = ["render", "a.ron", "--threads=1", "--format", format];
        stdout_of(folder, render);
        let (frame, later) =
            (format!("a.0001.{format}").replace("16", ""), format!("a.0007.{format}").replace("16", ""));
        for odd in [Odd::Pipe, Odd::Device, Odd::Long, Odd::Header, Odd::Directory] {
            let what = format!("{odd:?} as {format}");
            fs::copy(folder.join("out/a").join(&frame), folder.join("out/a").join(&later)).unwrap();
            odd.put(&folder.join("out/a").join(&frame));
            odd.put(&folder.join("out/a").join(&later));
            let verified = bounded(folder, &["verify", "out/a"]);
            assert_eq!(verified.status.code(), Some(1), "{what}: {}", text(&verified.stderr));
            assert!(text(&verified.stdout).contains("1 of 2 frames"), "{what}: {}", text(&verified.stdout));
            let rendered = bounded(folder, &[&render[..], &["--clean"]].concat());
            let code = if let Odd::Directory = odd { 1 } else { 0 };
            assert_eq!(rendered.status.code(), Some(code), "{what}: {}", text(&rendered.stderr));
            if let Odd::Directory = odd {
                assert!(text(&rendered.stderr).contains(&frame), "{what}: {}", text(&rendered.stderr));
            } else {
                fs::remove_file(folder.join("out/a").join(&later)).unwrap();
            }
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("a.ron"), format!("({CAMERA}, film: (width: 16, height: 9))")).unwrap();
    let manifest = folder.join("out/a/a.sequence.json");
    for odd in [Odd::Pipe, Odd::Device, Odd::Long, Odd::Directory] {
        stdout_of(folder, ["render", "a.ron"]);
        odd.put(&manifest);
        let verified = bounded(folder, &["verify", "out/a"]);
        let stderr = text(&verified.stderr);
        assert_eq!(verified.status.code(), Some(1), "{odd:?}: {stderr}");
        assert!(stderr.contains("cannot read `out/a/a.sequence.json`"), "{odd:?}: {stderr}");
        if !matches!(odd, Odd::Directory) {
            fs::remove_file(&manifest).unwrap();
        }
    }
}
