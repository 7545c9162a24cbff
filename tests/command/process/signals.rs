//! Tests of signals, handled and ignored.

use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::ignored::is_ignored_here;
use crate::{FIRST_LIGHT, RAYREEL, command, files, output_of, pictures, signal, text, until};

const FRAMES: usize = 24;

/// Starts a rendering in a process that ignores some signals from the start, and waits for the first frame.
fn start_rendering(folder: &Path, ignored: &str) -> Child {
    let script = if ignored.is_empty() { String::new() } else { format!("trap '' {ignored}; ") };
    let child = command("sh", folder)
        .args(["-c", &(script + "exec \"$0\" \"$@\""), RAYREEL, "render", FIRST_LIGHT, "--out", "out"])
        .args(["--size", "240x135", "--frames", "0-23"])
        .spawn()
        .unwrap();
    let out = folder.join("out");
    until("the first frame", || files(&out).iter().any(|name| name.ends_with(".png")));
    child
}

#[test]
fn signals_set_the_exit_code_unless_ignored() {
    let signals = [("HUP", 1), ("INT", 2), ("TERM", 15)];
    for (sent, number) in signals {
        for ignored in [&[][..], &["HUP"], &["INT"], &["TERM"], &["HUP", "INT", "TERM"]] {
            let survives = ignored.contains(&sent);
            if !survives && is_ignored_here(number) {
                println!("{sent} is ignored already: it was not tried");
                continue;
            }
            let folder = tempfile::tempdir().unwrap();
            let child = start_rendering(folder.path(), &ignored.join(" "));
            signal(&child, sent);
            let Output { status, stderr, .. } = output_of(child);
            let what = format!("{sent} where {ignored:?} are ignored: {}", text(&stderr));
            let written = files(&folder.path().join("out"));
            assert!(written.iter().all(|name| name.starts_with("first_light.")), "{what}: {written:?}");
            let written = pictures(&folder.path().join("out"));
            if survives {
                assert_eq!((status.code(), written.len()), (Some(0), FRAMES), "{what}");
            } else {
                let code = 128 + i32::try_from(number).unwrap();
                assert_eq!(status.code(), Some(code), "{what}");
                assert!(written.len() < FRAMES, "{what}");
            }
        }
    }
}

#[test]
fn nohup_ignores_the_hangup_signal() {
    let folder = tempfile::tempdir().unwrap();
    let mut nohup = command("nohup", folder.path());
    nohup.args([RAYREEL, "render", FIRST_LIGHT, "--size", "240x135", "--frames", "0-23", "--out", "out"]);
    let child = nohup.spawn().unwrap();
    let out = folder.path().join("out");
    until("the first frame", || files(&out).iter().any(|name| name.ends_with(".png")));
    signal(&child, "HUP");
    let output = output_of(child);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(pictures(&out).len(), FRAMES);
}

/// Checks signals during the reading of a scene from a stream that never ends.
#[test]
fn interrupted_reading_ends_at_once() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [&["render"][..], &["check"], &["explain"], &["probe", "--pixel", "0,0"]] {
        let mut reads = command(RAYREEL, folder.path());
        reads.args(arguments).arg("/dev/stdin").stdin(Stdio::piped());
        let mut child = reads.spawn().unwrap();
        // While stdin is open, more input may follow.
        let stdin = child.stdin.take();
        sleep(Duration::from_millis(300));
        signal(&child, "TERM");
        let output = output_of(child);
        drop(stdin);
        // On a busy machine, the signal may arrive before the handler is installed.
        let ended = output.status.code() == Some(143) || output.status.signal() == Some(15);
        assert!(ended, "{arguments:?}: {:?} {}", output.status, text(&output.stderr));
    }
}
