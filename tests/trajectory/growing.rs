//! Files that another program still writes.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;

use crate::open;
use crate::writers::{dump, examples, xyz};
use rayreel::trajectory::Trajectory;

fn append(path: &Path, bytes: &[u8]) {
    OpenOptions::new().append(true).open(path).unwrap().write_all(bytes).unwrap();
}

#[test]
fn frames_appear_once_they_are_whole() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in
        examples().into_iter().filter(|(name, _)| ["a.xyz", "a.dump", "a.pdb", "a.xtc"].contains(name))
    {
        let whole = open(folder.path(), &format!("whole.{name}"), &bytes).unwrap();
        let start = bytes.len() / 2;
        let mut trajectory = open(folder.path(), name, &bytes[..start]).unwrap();
        let mut frames = trajectory.frames();
        assert!(frames < whole.frames(), "{name}");
        for end in start..bytes.len() {
            append(trajectory.path().to_owned().as_path(), &bytes[end..=end]);
            if (end - start) % 13 != 0 && end + 1 != bytes.len() {
                continue;
            }
            trajectory.refresh().unwrap();
            assert!(
                trajectory.frames() >= frames,
                "{name}: {} of {frames} frames at {end}",
                trajectory.frames()
            );
            frames = trajectory.frames();
            let last = frames - 1;
            // Bonds come at the end of the file.
            let (found, expected) = (trajectory.read(last).unwrap(), whole.read(last).unwrap());
            assert_eq!(found.columns, expected.columns, "{name} at {end}");
        }
        assert_eq!(frames, whole.frames(), "{name}");
        assert_eq!(trajectory.warnings().len(), 0, "{name}");
        assert!(!trajectory.refresh().unwrap());
    }
}

#[test]
fn last_lines_without_end_are_whole_once_the_file_stays() {
    let folder = tempfile::tempdir().unwrap();
    let frame = "1\n\nH 1 2 3";
    let mut trajectory = open(folder.path(), "a.xyz", format!("{frame}\n").as_bytes()).unwrap();
    let path = trajectory.path().to_owned();
    append(&path, frame.as_bytes());
    assert!(!trajectory.refresh().unwrap());
    assert_eq!((trajectory.frames(), trajectory.warnings().len()), (1, 1));
    assert!(trajectory.refresh().unwrap());
    assert_eq!((trajectory.frames(), trajectory.warnings().len()), (2, 0));
}

#[test]
fn replaced_and_shorter_files_are_read_anew() {
    let folder = tempfile::tempdir().unwrap();
    let frames = |offset: f64, count: usize| {
        let frame =
            crate::writers::Frame { positions: vec![[offset; 3]; 4], labels: vec!["H".to_owned(); 4] };
        vec![frame; count]
    };
    let first = |trajectory: &Trajectory| trajectory.read(0).unwrap().numbers("x").unwrap()[0];
    let mut trajectory = open(folder.path(), "a.dump", &dump(&frames(1.0, 3), "\n")).unwrap();
    let path = trajectory.path().to_owned();
    std::fs::write(&path, dump(&frames(22.0, 2), "\n")).unwrap();
    assert!(trajectory.refresh().unwrap());
    assert_eq!((trajectory.frames(), first(&trajectory)), (2, 22.0));
    // A longer one with the same start, whose frames are elsewhere.
    let mut text = dump(&frames(22.0, 100), "\n");
    let mut trajectory_of_many = open(folder.path(), "b.dump", &text).unwrap();
    let place = text.len() / 2 + text[text.len() / 2..].windows(3).position(|bytes| bytes == b" 22").unwrap();
    text.splice(place + 1..place + 3, *b"22.00");
    text.extend(dump(&frames(7.0, 1), "\n"));
    std::fs::write(trajectory_of_many.path(), &text).unwrap();
    assert!(trajectory_of_many.refresh().unwrap());
    assert_eq!(trajectory_of_many.frames(), 101);
    trajectory_of_many.read(99).unwrap();
    // Another file of this name.
    let other = folder.path().join("b");
    std::fs::write(&other, dump(&frames(333.0, 5), "\n")).unwrap();
    std::fs::rename(&other, &path).unwrap();
    assert!(trajectory.refresh().unwrap());
    assert_eq!((trajectory.frames(), first(&trajectory)), (5, 333.0));
    // A file that cannot be read leaves all as it was.
    std::fs::write(&path, b"nonsense\n").unwrap();
    trajectory.refresh().unwrap_err();
    assert_eq!(trajectory.frames(), 5);
    std::fs::write(&path, xyz(&frames(1.0, 1), "\n")).unwrap();
    trajectory.refresh().unwrap_err();
}
