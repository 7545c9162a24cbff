//! `rayreel watch` as a person in a terminal meets it.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::AT_MOST;
use crate::session::scene;

fn watch(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rayreel"));
    command.current_dir(folder).arg("watch").args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Waits until it is so.
fn until(what: &str, is: impl Fn() -> bool) {
    let start = Instant::now();
    while !is() {
        assert!(start.elapsed() < AT_MOST, "{what}");
        sleep(Duration::from_millis(10));
    }
}

/// The pixels that `render` writes for the scene as it is.
fn rendered(folder: &Path) -> Option<Vec<u8>> {
    let arguments = ["render", "ball.ron", "--frames", "3", "--format", "ppm", "--out", "out"];
    let command = Command::new(env!("CARGO_BIN_EXE_rayreel")).current_dir(folder).args(arguments).output();
    assert!(command.unwrap().status.success());
    fs::read(folder.join("out/ball.0003.ppm")).ok()
}

#[cfg(unix)]
fn interrupt(child: Child) -> Output {
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    child.wait_with_output().unwrap()
}

#[cfg(unix)]
#[test]
fn the_terminal_tells_and_the_current_frame_is_written() {
    for more in [&[][..], &["--poll"]] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        fs::write(path.join("ball.ron"), scene(1.0, "")).unwrap();
        let arguments = [&["ball.ron", "--frame", "3", "--out", "now.ppm"], more].concat();
        let mut child = watch(path, &arguments).spawn().unwrap();
        let mut line = String::new();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        output.read_line(&mut line).unwrap();
        assert!(line.starts_with("ball.ron: http://127.0.0.1:"), "{line}");

        let first = rendered(path);
        until("the first frame", || fs::read(path.join("now.ppm")).ok() == first);
        fs::write(path.join("new"), scene(1.5, "")).unwrap();
        fs::rename(path.join("new"), path.join("ball.ron")).unwrap();
        let second = rendered(path);
        assert!(first != second);
        until("the second frame", || fs::read(path.join("now.ppm")).ok() == second);
        fs::write(path.join("ball.ron"), scene(-1.0, "")).unwrap();
        sleep(Duration::from_millis(500));
        assert!(fs::read(path.join("now.ppm")).ok() == second);

        let output = interrupt(child);
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(130), "{told}");
        for expected in
            ["ball.ron: read in", "ball.ron: frame 3: animate", "ball.ron:8:", "the last good scene stays"]
        {
            assert!(told.contains(expected), "{expected}: {told}");
        }
    }
}

/// What is said of arguments that cannot be, and that it ends with an error.
fn refused(folder: &TempDir, arguments: &[&str]) -> String {
    let mut child = watch(folder.path(), arguments).spawn().unwrap();
    let mut told = String::new();
    child.stderr.take().unwrap().read_to_string(&mut told).unwrap();
    assert!(!child.wait().unwrap().success());
    told
}

#[test]
fn what_cannot_be_served_or_written_is_told_at_once() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("ball.ron"), scene(1.0, "")).unwrap();
    let taken = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let told = refused(&folder, &["ball.ron", "--port", &port]);
    assert!(told.contains(&format!("cannot serve at port {port}")) && told.contains("--port"), "{told}");
    let told = refused(&folder, &["ball.ron", "--out", "now.jpeg"]);
    assert!(told.contains("now.jpeg") && told.contains(".png"), "{told}");
}
