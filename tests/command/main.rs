//! Tests of the `rayreel` command: its subcommands, as used by a person or a script, and its behaviour as a process.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

mod accuracy;
mod camera_targets;
mod choice;
mod compare;
mod explain;
mod explain_path;
mod farm;
#[cfg(unix)]
#[path = "../signals/ignored.rs"]
mod ignored;
#[cfg(unix)]
mod lsp;
mod movies;
#[cfg(unix)]
mod neovim;
mod overrides;
mod probe;
mod probe_terms;
#[cfg(unix)]
mod process;
mod reproducible;
mod rotations;
mod sequence;
mod sheet;
#[cfg(unix)]
#[path = "../random/splitmix.rs"]
mod splitmix;
mod usage;
mod warnings;

use std::ffi::OsStr;
use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

const FIRST_LIGHT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/first_light.ron");
const RAYREEL: &str = env!("CARGO_BIN_EXE_rayreel");

/// Time limit for expected events, generous enough for a busy machine.
const AT_MOST: Duration = Duration::from_secs(300);

/// Returns a command that runs in a folder without input and with captured output.
fn command(program: &str, folder: &Path) -> Command {
    let mut command = Command::new(program);
    command.current_dir(folder).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Runs `rayreel` with these arguments until it ends by itself.
fn rayreel<A: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = A>) -> Output {
    output_of(command(RAYREEL, folder).args(arguments).spawn().unwrap())
}

/// Runs `rayreel` with these arguments, which must succeed, and returns its standard output.
fn stdout_of<A: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = A>) -> String {
    let output = rayreel(folder, arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Waits for a process to end, and returns its output. Panics after `AT_MOST`.
fn output_of(mut child: Child) -> Output {
    let [stdout, stderr] = [all_of(child.stdout.take()), all_of(child.stderr.take())];
    let start = Instant::now();
    let status = loop {
        match child.try_wait().unwrap() {
            Some(status) => break status,
            None if start.elapsed() > AT_MOST => {
                child.kill().unwrap();
                panic!("it does not end");
            }
            None => thread::sleep(Duration::from_millis(5)),
        }
    };
    Output { status, stdout: stdout.join().unwrap(), stderr: stderr.join().unwrap() }
}

fn all_of(stream: Option<impl Read + Send + 'static>) -> thread::JoinHandle<Vec<u8>> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        stream.map(|mut stream| stream.read_to_end(&mut bytes).unwrap());
        bytes
    })
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn files(folder: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut names: Vec<String> =
        entries.map(|entry| text(entry.unwrap().file_name().as_encoded_bytes())).collect();
    names.sort();
    names
}

/// Returns the names of the PNG files in a folder.
fn pictures(folder: &Path) -> Vec<String> {
    files(folder).into_iter().filter(|name| name.ends_with(".png")).collect()
}

#[cfg(unix)]
fn signal(child: &Child, name: &str) {
    let status = Command::new("kill").args(["-s", name, &child.id().to_string()]).status().unwrap();
    assert!(status.success());
}

/// Waits until a condition is true. Panics after `AT_MOST`.
#[cfg(unix)]
fn until(what: &str, mut is: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is() {
        assert!(start.elapsed() < AT_MOST, "{what}");
        thread::sleep(Duration::from_millis(2));
    }
}
