//! Tests of two processes in one folder, killed at random moments. Where the system allows it, each runs in its own PID namespace, as
//! process 1.
//!
//! `RAYREEL_KILLS=200` sets the number of kills; the default is 8.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Instant;

use crate::splitmix::Random;
use crate::{AT_MOST, FIRST_LIGHT, RAYREEL, all_of, command, output_of, rayreel, text};

const ARGUMENTS: [&str; 5] = ["render", FIRST_LIGHT, "--size", "64x36", "--out"];

type Frames = BTreeMap<String, Vec<u8>>;

/// Returns the visible files of a folder, and the names of hidden files, which may disappear at any time.
fn seen(folder: &Path) -> (Frames, Vec<String>) {
    let (mut frames, mut hidden) = (Frames::new(), Vec::new());
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        if name.starts_with('.') {
            hidden.push(name);
        } else {
            frames.insert(name, fs::read(entry.path()).unwrap());
        }
    }
    (frames, hidden)
}

/// Returns a command prefix that starts a program as process 1 of a PID namespace and kills it when killed itself. Empty if namespaces are
/// not allowed.
fn namespace() -> Vec<&'static str> {
    let own = ["unshare", "--pid", "--fork", "--kill-child", "--"];
    let as_user = ["unshare", "--user", "--map-root-user", "--pid", "--fork", "--kill-child", "--"];
    let works = |prefix: &[&str]| {
        let mut tried = Command::new(prefix[0]);
        tried.args(&prefix[1..]).arg("true").stdout(Stdio::null()).stderr(Stdio::null());
        tried.status().is_ok_and(|status| status.success())
    };
    [&own[..], &as_user].into_iter().find(|prefix| works(prefix)).map(<[_]>::to_vec).unwrap_or_default()
}

fn start(prefix: &[&str], folder: &Path, more: &[&'static str]) -> Child {
    let arguments = prefix.iter().chain(&[RAYREEL]).chain(&ARGUMENTS).chain(&["out"]).chain(more);
    let mut arguments = arguments.copied();
    let program = arguments.next().unwrap();
    command(program, folder).args(arguments).spawn().unwrap()
}

/// Kills a process, and waits until its output pipes are closed, and thus all its children are gone.
fn kill(mut child: Child) {
    let outputs = [all_of(child.stdout.take()), all_of(child.stderr.take())];
    child.kill().unwrap();
    child.wait().unwrap();
    for output in outputs {
        output.join().unwrap();
    }
}

#[test]
fn killed_processes_leave_no_corrupt_frames() {
    let kills = std::env::var("RAYREEL_KILLS").ok().and_then(|kills| kills.parse().ok()).unwrap_or(8);
    let folder = tempfile::tempdir().unwrap();
    let (folder, out) = (folder.path(), folder.path().join("out"));
    let begin = Instant::now();
    assert!(rayreel(folder, ARGUMENTS.iter().chain(&["whole"])).status.success());
    let whole_run = begin.elapsed();
    let (whole, _) = seen(&folder.join("whole"));
    // One more file records their source.
    assert_eq!(whole.len(), 96 + 1);
    let prefix = namespace();
    if prefix.is_empty() {
        println!("PID namespaces are not allowed: both processes are in this one");
    }
    let mut random = Random(1);
    let (mut left, mut checked) = (0, 0);
    let mut check = || {
        let (frames, hidden) = seen(&out);
        for (name, bytes) in &frames {
            assert!(whole.get(name) == Some(bytes), "{name} is torn: {} bytes", bytes.len());
        }
        checked += frames.len();
        hidden.len()
    };
    for _ in 0..kills / 2 {
        // Finished frames are rendered again, so that a kill can always corrupt one.
        let running = [(); 2].map(|()| start(&prefix, folder, &["--overwrite"]));
        for child in running {
            // A random moment between the start and a time after the end.
            let share = (random.bits() >> 40) as f64 / (1 << 24) as f64;
            sleep(whole_run.min(AT_MOST).mul_f64(share));
            kill(child);
            check();
        }
        left += usize::from(check() > 0);
    }
    println!("{kills} kills: {checked} frames looked at, leftovers after {left} of {} pairs", kills / 2);
    let output = output_of(start(&prefix, folder, &[]));
    assert!(output.status.success(), "{}", text(&output.stderr));
    let output = rayreel(folder, ["verify", "out"]);
    assert!(output.status.success(), "{}", text(&output.stdout));
    let (frames, hidden) = seen(&out);
    assert!(frames == whole && hidden.is_empty(), "{hidden:?}");
}
