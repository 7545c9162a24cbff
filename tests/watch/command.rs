//! Tests of `rayreel watch`, as used in a terminal.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::AT_MOST;
use crate::ignored::interruption;
use crate::session::scene;

fn watch(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rayreel"));
    command.current_dir(folder).arg("watch").args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Waits until a condition is true. Panics after `AT_MOST`.
fn until(what: &str, is: impl Fn() -> bool) {
    let start = Instant::now();
    while !is() {
        assert!(start.elapsed() < AT_MOST, "{what}");
        sleep(Duration::from_millis(10));
    }
}

/// Returns the pixels that `render` writes for the current scene.
fn rendered(folder: &Path, overrides: &[&str]) -> Option<Vec<u8>> {
    let arguments = ["render", "ball.ron", "--frames", "3", "--format", "ppm", "--out", "out"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_rayreel"));
    let command = command.current_dir(folder).args(arguments).args(overrides).output();
    assert!(command.unwrap().status.success());
    pixels(&folder.join("out/ball.0003.ppm"))
}

/// Returns the pixels of a picture, or `None` if it does not exist yet. The bytes of files differ, because a frame file also records its
/// source.
fn pixels(picture: &Path) -> Option<Vec<u8>> {
    Some(image::open(picture).ok()?.to_rgb8().into_raw())
}

/// Ends the process as Ctrl-C does, and returns its output.
#[cfg(unix)]
fn interrupt(child: Child) -> Output {
    let (signal, code) = interruption();
    Command::new("kill").args(["-s", signal, &child.id().to_string()]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(code), "{}", String::from_utf8_lossy(&output.stderr));
    output
}

#[cfg(unix)]
#[test]
fn watch_prints_events_and_writes_the_current_frame() {
    let overridden = &["--without", "diffuse-light", "--samples", "2"][..];
    for (more, overrides) in [(&[][..], &[][..]), (&["--poll"], &[]), (&[], overridden)] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        fs::write(path.join("ball.ron"), scene(1.0, "")).unwrap();
        let arguments = [&["ball.ron", "--frame", "3", "--out", "now.ppm"], more, overrides].concat();
        let mut child = watch(path, &arguments).spawn().unwrap();
        let mut line = String::new();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        output.read_line(&mut line).unwrap();
        assert!(line.starts_with("ball.ron: http://127.0.0.1:"), "{line}");

        let first = rendered(path, overrides);
        until("the first frame", || pixels(&path.join("now.ppm")) == first);
        fs::write(path.join("new"), scene(1.5, "")).unwrap();
        fs::rename(path.join("new"), path.join("ball.ron")).unwrap();
        let second = rendered(path, overrides);
        assert!(first != second);
        until("the second frame", || pixels(&path.join("now.ppm")) == second);
        fs::write(path.join("ball.ron"), scene(-1.0, "")).unwrap();
        sleep(Duration::from_millis(500));
        assert!(pixels(&path.join("now.ppm")) == second);

        let output = interrupt(child);
        let stderr = String::from_utf8(output.stderr).unwrap();
        for expected in
            ["ball.ron: read in", "ball.ron: frame 3: animate", "ball.ron:8:", "the last good scene stays"]
        {
            assert!(stderr.contains(expected), "{expected}: {stderr}");
        }
    }
}

/// Returns the address from the first line of output.
fn address(child: &mut Child) -> String {
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    line.split_once(": http://").unwrap().1.trim_end_matches("/\n").to_owned()
}

/// Checks files that become readable again, a change that the file system does not report.
#[cfg(target_os = "linux")]
#[test]
fn temporarily_unreadable_files_are_read_again() {
    let is_there = Command::new("prlimit").arg("--version").stdout(Stdio::null()).status();
    if !is_there.is_ok_and(|status| status.success()) {
        println!("there is no prlimit: it was not tried");
        return;
    }
    for more in [&[][..], &["--poll"]] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        fs::write(path.join("ball.ron"), scene(1.0, "")).unwrap();
        let arguments = [&["ball.ron", "--frame", "3", "--out", "now.ppm"], more].concat();
        let mut child = watch(path, &arguments).spawn().unwrap();
        address(&mut child);
        let first = rendered(path, &[]);
        until("the first frame", || pixels(&path.join("now.ppm")) == first);
        let limit = |files: &str| {
            let arguments = ["--pid", &child.id().to_string(), &format!("--nofile={files}:")];
            assert!(Command::new("prlimit").args(arguments).status().unwrap().success());
        };
        limit("3");
        fs::write(path.join("new"), scene(1.5, "")).unwrap();
        fs::rename(path.join("new"), path.join("ball.ron")).unwrap();
        let second = rendered(path, &[]);
        sleep(Duration::from_millis(2500));
        assert!(pixels(&path.join("now.ppm")) == first);
        limit("1000");
        until("the second frame", || pixels(&path.join("now.ppm")) == second);
        let stderr = String::from_utf8(interrupt(child).stderr).unwrap();
        assert_eq!(stderr.matches("Too many open files").count(), 1, "{stderr}");
    }
}

#[cfg(unix)]
#[test]
fn any_free_port_is_taken_for_0_and_other_names_are_allowed() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("ball.ron"), scene(1.0, "")).unwrap();
    let arguments = ["ball.ron", "--port", "0", "--allow-host", "localhost:9000", "--allow-host", "desk"];
    let mut child = watch(folder.path(), &arguments).spawn().unwrap();
    let address = address(&mut child);
    for (host, status) in
        [(address.as_str(), "200"), ("localhost:9000", "200"), ("desk:7", "200"), ("localhost:9001", "403")]
    {
        let mut stream = TcpStream::connect(&address).unwrap();
        write!(stream, "GET /state HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "{host}: {answer}");
        assert_eq!(answer.contains("--allow-host"), status == "403", "{answer}");
    }
    interrupt(child);
}

/// Returns the message for invalid arguments, which must end the command with an error.
fn refused(folder: &TempDir, arguments: &[&str]) -> String {
    let mut child = watch(folder.path(), arguments).spawn().unwrap();
    let mut stderr = String::new();
    child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
    assert!(!child.wait().unwrap().success());
    stderr
}

#[test]
fn invalid_ports_and_outputs_are_errors_at_start() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("ball.ron"), scene(1.0, "")).unwrap();
    let taken = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let stderr = refused(&folder, &["ball.ron", "--port", &port]);
    assert!(
        stderr.contains(&format!("cannot serve at port {port}")) && stderr.contains("--port"),
        "{stderr}"
    );
    let stderr = refused(&folder, &["ball.ron", "--out", "now.jpeg"]);
    assert!(stderr.contains("now.jpeg") && stderr.contains(".png"), "{stderr}");
    let stderr = refused(&folder, &["ball.ron", "--allow-host", "http://desk/"]);
    assert!(stderr.contains("http://desk/") && stderr.contains("localhost:9000"), "{stderr}");
}

#[cfg(unix)]
#[test]
fn editor_is_opened_at_places_of_the_scene_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("ball.ron"), scene(1.0, "")).unwrap();
    let mut child =
        watch(path, &["ball.ron", "--editor", "cp {file} {file}.{line}.{column}"]).spawn().unwrap();
    let address = address(&mut child);
    let open = |place: &str| {
        let body = format!("{place:?}");
        let mut stream = TcpStream::connect(&address).unwrap();
        let head = format!("POST /open HTTP/1.1\r\nHost: {address}\r\nConnection: close");
        write!(stream, "{head}\r\nContent-Length: {}\r\n\r\n{body}", body.len()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    };
    until("the scene is read", || open("ball.ron:12:3").contains(" 204 "));
    until("the editor has run", || path.join("ball.ron.12.3").exists());
    for place in ["/etc/passwd:1", "../ball.ron:1", "", "ball.ron.12.3:1"] {
        let answer = open(place);
        assert!(answer.contains(" 409 ") && answer.contains("is not in a file of the scene"), "{answer}");
    }
    assert!(open("ball.ron:7, frame 3").contains(" 204 "));
    until("the editor has run", || path.join("ball.ron.7.1").exists());
    interrupt(child);
    let refused = watch(path, &["ball.ron", "--editor", "code"]).output().unwrap();
    assert!(String::from_utf8_lossy(&refused.stderr).contains("write a command with {file}"));
}
