//! Tests of full, read-only and forbidden file systems, in user namespaces where the system allows them, and of folders that disappear.

use std::fs;
use std::path::Path;
use std::process::Output;

use crate::{FIRST_LIGHT, RAYREEL, command, files, output_of, pictures, text, until};

/// Runs a script in its own user namespace, and returns its output. With `mounts` it may mount file systems; without, it has no rights to
/// the files of other users. `$0` is `rayreel` and `$1` a scene. Returns `None` if the system does not allow namespaces.
fn in_own_space(folder: &Path, mounts: bool, script: &str) -> Option<Output> {
    let kind = if mounts { &["--user", "--map-root-user", "--mount"][..] } else { &["--user"] };
    let run = |script: &str| {
        let mut unshare = command("unshare", folder);
        unshare.args(kind).args(["sh", "-c", script, RAYREEL, FIRST_LIGHT]).spawn().map(output_of)
    };
    let trial = if mounts { "mount -t tmpfs tmpfs ." } else { "true" };
    if !run(trial).is_ok_and(|output| output.status.success()) {
        println!("there are no name spaces of one's own: it was not tried");
        return None;
    }
    Some(run(script).unwrap())
}

/// Checks frames of some 30 kB each on a disk with room for a few.
#[test]
fn full_disk_keeps_complete_frames_and_the_next_run_continues() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::create_dir(folder.join("out")).unwrap();
    let script = r#"
        mount -t tmpfs -o size=300k tmpfs out || exit 9
        "$0" render "$1" --out out --size 320x180 --frames 0-23 && exit 8
        ls -A out > listing
        mount -o remount,size=64m out || exit 7
        "$0" render "$1" --out out --size 320x180 --frames 0-23 --json > report.json || exit 6
        "$0" verify out --frames 0-23
    "#;
    let Some(output) = in_own_space(folder, true, script) else { return };
    let stderr = text(&output.stderr);
    assert!(output.status.success(), "{stderr}");
    assert!(
        stderr.contains("No space left on device") && stderr.contains("cannot write `out/first"),
        "{stderr}"
    );
    let listing = fs::read_to_string(folder.join("listing")).unwrap();
    let written = listing.lines().filter(|name| name.ends_with(".png")).count();
    assert!((1..24).contains(&written), "{listing}");
    assert!(!listing.contains(".partial"), "{listing}");
    let report: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.join("report.json")).unwrap()).unwrap();
    assert_eq!(report["kept"].as_array().unwrap().len(), written);
}

#[test]
fn unwritable_folder_stays_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::create_dir(folder.join("out")).unwrap();
    fs::write(folder.join("out/first_light.0000.png"), "mine").unwrap();
    let render = r#""$0" render "$1" --out out --size 32x18 --frames 0-1"#;
    let read_only = format!("mount --bind out out && mount -o remount,bind,ro out || exit 9; {render}");
    let forbidden = format!("chmod 555 out; {render}");
    for (mounts, script, reason) in
        [(true, read_only, "Read-only file system"), (false, forbidden, "Permission denied")]
    {
        let Some(output) = in_own_space(folder, mounts, &script) else { continue };
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        assert!(stderr.contains(reason) && stderr.contains("cannot write `out/"), "{stderr}");
        assert_eq!(files(&folder.join("out")), ["first_light.0000.png"]);
        assert_eq!(fs::read(folder.join("out/first_light.0000.png")).unwrap(), b"mine");
    }
}

#[test]
fn removed_folder_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let mut rendering = command(RAYREEL, folder.path());
    let rendering = rendering.args(["render", FIRST_LIGHT, "--out", "out", "--size", "240x135"]).spawn();
    until("the first frame", || !pictures(&out).is_empty());
    fs::rename(&out, folder.path().join("gone")).unwrap();
    let output = output_of(rendering.unwrap());
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("cannot write `out/first_light."), "{stderr}");
    let left = files(&folder.path().join("gone"));
    assert!(left.iter().all(|name| name.starts_with("first_light.")), "{left:?}");
}
