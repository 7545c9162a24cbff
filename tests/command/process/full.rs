//! Tests of full disks, simulated by a file size limit, and of file names that are not valid UTF-8.

use std::fs;
use std::path::Path;
use std::process::Output;

use crate::{FIRST_LIGHT, RAYREEL, command, files, output_of, rayreel, text};

/// Runs `rayreel` with a file size limit of 0: writing returns an error, or kills the process if `dies`.
fn limited(folder: &Path, dies: bool, arguments: &[&str]) -> Output {
    let script = if dies { "ulimit -c 0;" } else { "trap '' XFSZ;" };
    let script = format!("{script} ulimit -f 0; exec \"$0\" \"$@\"");
    output_of(command("sh", folder).args(["-c", &script, RAYREEL]).args(arguments).spawn().unwrap())
}

const RENDER: [&str; 8] = ["render", FIRST_LIGHT, "--size", "8x8", "--frames", "0-2", "--out", "out"];

const RENDERED: [&str; 4] =
    ["first_light.0000.png", "first_light.0001.png", "first_light.0002.png", "first_light.sequence.json"];

#[test]
fn failed_writes_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (arguments, expected) in [
        (&["new", "mine.ron"][..], "cannot write `mine.ron`"),
        (&RENDER, "cannot write `out/first_light.sequence.json`"),
        (&["explain", FIRST_LIGHT, "--path", "path.svg"], "cannot write `path.svg`"),
    ] {
        let output = limited(folder, false, arguments);
        assert_eq!(output.status.code(), Some(1));
        assert!(text(&output.stderr).contains(expected), "{}", text(&output.stderr));
    }
    assert_eq!((files(folder), files(&folder.join("out"))), (vec!["out".to_owned()], vec![]));
}

#[test]
fn partial_files_of_killed_writers_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (arguments, written, names) in [
        (&["new", "mine.ron"][..], "a", &["mine.ron"][..]),
        (&RENDER, "b/out", &RENDERED),
        (&["explain", FIRST_LIGHT, "--path", "path.svg"], "c", &["path.svg"]),
    ] {
        let (here, written) = (folder.join(&written[..1]), folder.join(written));
        fs::create_dir(&here).unwrap();
        assert_eq!(limited(&here, true, arguments).status.code(), None);
        assert!(files(&written).iter().all(|name| name.ends_with(".partial")), "{:?}", files(&written));
        assert!(!files(&written).is_empty());
        let output = rayreel(&here, arguments);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert_eq!(files(&written), names);
    }
}

/// Checks names that are not valid UTF-8. Other systems require valid names.
#[cfg(target_os = "linux")]
#[test]
fn non_utf8_names_stay_distinct() {
    use std::ffi::{OsStr, OsString};
    use std::os::unix::ffi::OsStrExt;

    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let names: Vec<OsString> = [&b"a\xff"[..], b"a\xfe", b"a\xef\xbf\xbd", b"\xc3"]
        .map(|name| OsStr::from_bytes(name).to_owned())
        .into();
    for name in &names {
        let scene = Path::new(name).with_extension("ron");
        fs::copy(FIRST_LIGHT, folder.join(&scene)).unwrap();
        for more in [&[][..], &["--sheet", "1x1"], &["--draft"]] {
            let fixed = ["render", "--frames", "0", "--size", "8x8", "--out", "out"];
            let mut all: Vec<&OsStr> = fixed.iter().chain(more).map(OsStr::new).collect();
            all.push(scene.as_os_str());
            let output = rayreel(folder, all);
            assert!(output.status.success(), "{}", text(&output.stderr));
        }
        let mut frame = name.clone();
        frame.push(".0000.png");
        assert!(folder.join("out").join(&frame).is_file());
        assert!(folder.join("out/draft").join(&frame).is_file());
    }
    // Only the name that is valid UTF-8 has a sequence file. The last entry is the draft folder.
    assert_eq!(fs::read_dir(folder.join("out")).unwrap().count(), 2 * names.len() + 2);

    // Frames of a scene whose path cannot be stored are not described by the sequence file of the scene before.
    let subfolder = folder.join(OsStr::from_bytes(b"\xff"));
    fs::create_dir(&subfolder).unwrap();
    let scene = subfolder.join("a.ron");
    for place in [folder.join("a.ron"), scene.clone()] {
        fs::copy(FIRST_LIGHT, place).unwrap();
    }
    for (scene, has_manifest) in [(Path::new("a.ron"), true), (&scene, false)] {
        let fixed = ["render", "--frames", "0", "--size", "8x8", "--out", "of_a"].map(OsStr::new);
        let output = rayreel(folder, fixed.into_iter().chain([scene.as_os_str()]));
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert_eq!(folder.join("of_a/a.sequence.json").exists(), has_manifest);
    }
}
