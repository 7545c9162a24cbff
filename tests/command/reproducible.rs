//! Tests that the bytes of all files and streams depend only on the scene and the arguments, in every process. Only the settings file also
//! contains the seconds that frames took.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::{FIRST_LIGHT, files, rayreel, text};

/// Renders four frames in a new process. Returns the bytes of every written file and of standard output, without the seconds.
fn rendered(folder: &Path, options: &[&str]) -> BTreeMap<String, Vec<u8>> {
    let arguments = ["render", FIRST_LIGHT, "--size=16x9", "--frames=0-3"];
    let output = rayreel(folder, arguments.iter().chain(options));
    assert!(output.status.success(), "{options:?}: {}", text(&output.stderr));
    let mut bytes = BTreeMap::from([("-".to_owned(), output.stdout)]);
    let out = folder.join("out");
    for path in files(&out).iter().map(|name| out.join(name)) {
        bytes.insert(path.display().to_string(), without_seconds(&path));
    }
    let _ = fs::remove_dir_all(out);
    bytes
}

fn without_seconds(path: &Path) -> Vec<u8> {
    let bytes = fs::read(path).unwrap();
    if !path.to_string_lossy().ends_with(".settings.json") {
        return bytes;
    }
    let lines = text(&bytes);
    lines.lines().filter(|line| !line.contains("seconds\": ")).flat_map(str::bytes).collect()
}

#[test]
fn every_format_has_the_same_bytes_in_every_process() {
    /// Number of runs. Two attributes in random order would always match with a probability of 1 in 8^4.
    const PROCESSES: usize = 4;
    let folder = tempfile::tempdir().unwrap();
    for (options, count) in [
        (&["--out=out", "--format=png"][..], 6),
        (&["--out=out", "--format=png", "--alpha"], 6),
        (&["--out=out", "--format=png16"], 6),
        (&["--out=out", "--format=ppm"], 6),
        (&["--out=out", "--format=pfm"], 6),
        (&["--out=out", "--format=exr"], 6),
        (&["--out=out", "--format=hdr"], 6),
        (&["--out=out", "--format=exr", "--alpha", "--passes=depth,normal,id,albedo,position"], 6),
        (&["--out=out", "--max-error=8"], 7),
        (&["--out=out", "--sheet=2x2"], 2),
        (&["--out=out", "--movie=out/a.gif"], 7),
        (&["--out=out", "--movie=out/a.apng"], 7),
        (&["--out=-", "--format=y4m"], 1),
        (&["--out=-", "--format=raw"], 1),
    ] {
        let first = rendered(folder.path(), options);
        assert_eq!(first.len(), count, "{options:?}: {:?}", first.keys());
        for _ in 1..PROCESSES {
            let again = rendered(folder.path(), options);
            let differing: Vec<_> =
                first.iter().filter(|(name, bytes)| again.get(*name) != Some(*bytes)).collect();
            let names: Vec<_> = differing.iter().map(|(name, _)| name).collect();
            assert!(names.is_empty() && again.len() == first.len(), "{options:?}: {names:?} differ");
        }
    }
}
