//! Tests with real editors, and with other programs that write files, each in its own way.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use rayreel::live::Event;

use crate::LONG_ENOUGH;
use crate::session::{Stage, scene};

/// Returns true if a program is installed. Otherwise prints a message, and its test does nothing.
fn there_is(program: &str) -> bool {
    let found = Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    let there_is = found.is_ok_and(|status| status.success());
    if !there_is {
        println!("there is no {program}: it was not tried");
    }
    there_is
}

/// Runs a program in the scene's folder, without the settings of its user.
fn run(program: &str, arguments: &[&str], folder: &Path) {
    let status = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .env("HOME", folder.join("home"))
        .env("TERM", "xterm")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    assert!(status.unwrap().success(), "{program} {arguments:?}");
}

/// Checks that every save is read exactly once. `save` writes the given radius.
fn every_save_is_read_once(what: &str, save: impl Fn(&str, &Path)) {
    let stage = Stage::new(Some(&scene(1.0, "")));
    stage.matches_a_cold_start();
    for (radius, reload) in ["0.9", "1.3", "0.7"].into_iter().zip(2..) {
        save(radius, stage.folder());
        // On a busy machine, an editor may leave a partial file for longer than a save takes.
        let shown = stage.converges_to_a_cold_start();
        assert_eq!(shown.info.reloads, reload, "{what}");
        assert!(std::fs::read_to_string(stage.path("ball.ron")).unwrap().contains(radius), "{what}");
        let more = stage.events_within(LONG_ENOUGH);
        assert!(!more.iter().any(|event| matches!(event, Event::Reloaded(_))), "{what}: {more:?}");
    }
}

/// Runs Vim in ex mode, which saves as Vim does otherwise.
fn vim(setting: &str) {
    if there_is("vim") {
        every_save_is_read_once(&format!("vim with {setting}"), |radius, folder| {
            let substitute = format!("%s/radius: [0-9.]*/radius: {radius}/");
            let arguments =
                ["-u", "NONE", "-N", "-es", "-c", setting, "-c", &substitute, "-c", "wq", "ball.ron"];
            run("vim", &arguments, folder);
        });
    }
}

#[test]
fn vim_without_settings() {
    vim("set nocompatible");
}

#[test]
fn vim_with_backups_that_are_renamed() {
    vim("set backup backupcopy=no");
}

#[test]
fn vim_with_backups_that_are_copies() {
    vim("set backup backupcopy=yes");
}

#[test]
fn vim_without_backups() {
    vim("set nobackup nowritebackup");
}

fn emacs(setting: &str) {
    if there_is("emacs") {
        every_save_is_read_once(&format!("emacs with {setting}"), |radius, folder| {
            let edit = format!(
                "(progn {setting} (find-file \"ball.ron\") (re-search-forward \"radius: [0-9.]+\") \
                 (replace-match \"radius: {radius}\") (save-buffer))"
            );
            run("emacs", &["-Q", "--batch", "--eval", &edit], folder);
        });
    }
}

#[test]
fn emacs_with_backups() {
    emacs("(setq make-backup-files t)");
}

#[test]
fn emacs_that_writes_a_temporary_file_first() {
    emacs("(setq file-precious-flag t make-backup-files nil)");
}

#[test]
fn emacs_with_backups_that_are_copies() {
    emacs("(setq backup-by-copying t)");
}

/// Checks nano at a terminal, key by key: the line is cut and typed again.
#[test]
fn nano() {
    if !there_is("nano") || !there_is("script") {
        return;
    }
    every_save_is_read_once("nano", |radius, folder| {
        let mut child = Command::new("script")
            .args(["--quiet", "--return", "--command", "nano --ignorercfiles ball.ron", "/dev/null"])
            .current_dir(folder)
            .env("TERM", "xterm")
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let mut keys = child.stdin.take().unwrap();
        let line = format!("(name: \"ball\", shape: Sphere(radius: {radius}), material: \"clay\"),");
        for key in ["\u{17}", "radius\r", "\u{1}", "\u{b}", &line, "\r", "\u{13}", "\u{18}"] {
            sleep(Duration::from_millis(200));
            keys.write_all(key.as_bytes()).unwrap();
        }
        assert!(child.wait().unwrap().success());
    });
}

#[test]
fn sed() {
    if there_is("sed") {
        every_save_is_read_once("sed -i", |radius, folder| {
            run("sed", &["-i", &format!("s/radius: [0-9.]*/radius: {radius}/"), "ball.ron"], folder);
        });
    }
}

/// Checks a checkout that changes both the scene and its included file.
#[test]
fn git_that_checks_out_another_branch() {
    if !there_is("git") {
        return;
    }
    let part = |radius: f64| {
        let knob = format!("(name: \"knob\", shape: Sphere(radius: {radius:?}), material: \"m\")");
        format!("Scene(materials: {{ \"m\": (k_a: 1) }}, entities: [{knob}])")
    };
    let text = |radius| scene(radius, "").replacen("Scene(", "Scene(include: [(file: \"part.ron\")],", 1);
    let stage = Stage::new(Some(&scene(1.0, "")));
    let git = |arguments: &[&str]| {
        let own =
            ["-c", "user.name=nobody", "-c", "user.email=nobody@localhost", "-c", "commit.gpgsign=false"];
        run("git", &[&own, arguments].concat(), stage.folder());
    };
    git(&["init", "--initial-branch=one"]);
    for (branch, radius) in [("one", 0.5), ("other", 0.8)] {
        git(&["checkout", "-B", branch]);
        std::fs::write(stage.path("ball.ron"), text(radius)).unwrap();
        std::fs::write(stage.path("part.ron"), part(2.0 * radius)).unwrap();
        git(&["add", "ball.ron", "part.ron"]);
        git(&["commit", "--message", branch]);
    }
    stage.events_within(2 * LONG_ENOUGH);
    let before = stage.session().handle().state().reloads;
    for (branch, reload) in ["one", "other", "one"].into_iter().zip(before + 1..) {
        git(&["checkout", branch]);
        let shown = stage.converges_to_a_cold_start();
        assert_eq!(shown.info.reloads, reload, "{branch}");
        let more = stage.events_within(LONG_ENOUGH);
        assert!(!more.iter().any(|event| matches!(event, Event::Reloaded(_))), "{branch}: {more:?}");
    }
}
