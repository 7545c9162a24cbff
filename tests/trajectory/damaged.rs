//! Damaged files: no panic, no hang, and errors that name the file, the place and the remedy.

use std::io::Write;
use std::time::{Duration, Instant};

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::open;
use crate::random::Random;
use crate::writers::examples;
use rayreel::trajectory::TrajectoryError;

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn zstd(bytes: &[u8]) -> Vec<u8> {
    ruzstd::encoding::compress_to_vec(bytes, ruzstd::encoding::CompressionLevel::Fastest)
}

/// Damages a file in one of the ways that happen, and some that do not.
fn damage(bytes: &mut Vec<u8>, random: &mut Random) {
    const TEXTS: [&[u8]; 12] = [
        b"\n",
        b" ",
        b"nan",
        b"-",
        b"99999999999999999999",
        b"\xff\xff\xff\xff",
        b"\0",
        b"*****",
        b"\"",
        b",",
        b"\r",
        b"1e999",
    ];
    for _ in 0..=random.index(4) {
        let at = random.index(bytes.len() + 1);
        let other = random.index(bytes.len() + 1);
        let (start, end) = (at.min(other), at.max(other));
        match random.index(8) {
            0 => bytes.truncate(at),
            1 if at < bytes.len() => bytes[at] ^= 1 << random.index(8),
            2 if at < bytes.len() => bytes[at] = u8::try_from(random.index(256)).unwrap(),
            3 => drop(bytes.drain(start..end.min(start + 50))),
            4 => {
                let part = bytes[start..end.min(start + 300)].to_vec();
                bytes.splice(at..at, part);
            }
            5 => {
                let text = TEXTS[random.index(TEXTS.len())];
                bytes.splice(at..at, text.iter().copied());
            }
            6 => {
                let text = TEXTS[random.index(TEXTS.len())];
                let end = bytes.len().min(at + text.len());
                bytes.splice(at..end, text.iter().copied());
            }
            // Headers hold the sizes.
            _ if bytes.len() > 100 => {
                let at = random.index(100);
                bytes[at] = u8::try_from(random.index(256)).unwrap();
            }
            _ => {}
        }
    }
}

fn check(error: &TrajectoryError) {
    let message = error.to_string();
    assert!(!error.faults().is_empty(), "no faults");
    for (fault, line) in error.faults().iter().zip(message.lines()) {
        assert!(line.starts_with(&error.path().display().to_string()), "no file: {message}");
        assert!(!fault.cause.is_empty() && !fault.remedy.is_empty(), "no cause or remedy: {message}");
        assert!(line.chars().count() < 1000, "too long: {message}");
    }
    assert!(message.lines().count() <= 5, "not grouped: {message}");
}

#[test]
fn damaged_files_are_read_or_rejected_with_a_place() {
    let cases = std::env::var("RAYREEL_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(2000);
    let folder = tempfile::tempdir().unwrap();
    let examples = examples();
    let mut random = Random(39);
    let (mut rejected, mut read) = (0, 0);
    for case in 0..cases {
        let (name, bytes) = &examples[case % examples.len()];
        let mut bytes = bytes.clone();
        let mut name = (*name).to_owned();
        let compression = random.index(6);
        // Damage comes before or after compression.
        if random.once_in(2) {
            damage(&mut bytes, &mut random);
        }
        if compression == 1 {
            (bytes, name) = (gzip(&bytes), format!("{name}.gz"));
        } else if compression == 2 {
            (bytes, name) = (zstd(&bytes), format!("{name}.zst"));
        }
        damage(&mut bytes, &mut random);
        let start = Instant::now();
        match open(folder.path(), &name, &bytes) {
            Err(error) => {
                check(&error);
                rejected += 1;
            }
            Ok(trajectory) => {
                assert!(trajectory.frames() > 0);
                for frame in [0, trajectory.frames() / 2, trajectory.frames() - 1] {
                    match trajectory.read(frame) {
                        Ok(snapshot) => {
                            assert!(
                                snapshot.columns.iter().all(|column| column.values.len() == snapshot.count)
                            );
                            assert!(
                                snapshot.bonds.iter().flatten().all(|atom| (*atom as usize) < snapshot.count)
                            );
                            assert!(snapshot.cell.is_none_or(|cell| cell.is_valid()));
                            read += 1;
                        }
                        Err(error) => {
                            check(&error);
                            rejected += 1;
                        }
                    }
                }
            }
        }
        // The machine may be busy: a hang takes longer.
        assert!(start.elapsed() < Duration::from_secs(20), "case {case} took {:?}", start.elapsed());
    }
    println!("{cases} damaged files: {rejected} errors, {read} frames read");
    assert!(rejected > cases / 8 && read > cases / 8, "{rejected} errors, {read} frames");
}

#[test]
fn whole_examples_are_read_in_every_compression() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in examples() {
        let plain = open(folder.path(), name, &bytes).unwrap();
        let two = [gzip(&bytes[..100]), gzip(&bytes[100..])].concat();
        let frames = [zstd(&bytes[..100]), zstd(&bytes[100..])].concat();
        for (end, bytes) in [("gz", gzip(&bytes)), ("zst", zstd(&bytes)), ("gz", two), ("zst", frames)] {
            let compressed = open(folder.path(), &format!("{name}.{end}"), &bytes).unwrap();
            assert_eq!(compressed.frames(), plain.frames());
            let last = plain.frames() - 1;
            assert_eq!(compressed.read(last).unwrap(), plain.read(last).unwrap(), "{name}.{end}");
            // What is there of a truncated file is read, with a warning.
            if let Ok(cut) = open(folder.path(), &format!("cut.{name}.{end}"), &bytes[..bytes.len() - 9]) {
                assert!(!cut.warnings().is_empty(), "{name}.{end}");
            }
        }
    }
}

#[test]
fn errors_name_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let message = |name: &str, bytes: &[u8]| {
        let error = open(folder.path(), name, bytes).and_then(|trajectory| trajectory.read(0)).unwrap_err();
        error.to_string().replace(&folder.path().join(name).display().to_string(), name)
    };
    assert_eq!(
        message("a.csv", b"x,y,z\n1,2,3\n1,5,x,3\n"),
        "a.csv:3:5: column `z`: found \"x\", expected a number; write a number, or `nan` if it is missing\n\
         a.csv:3:7: the row goes on with \"3\" after 3 columns; name the column in the header, or remove the field"
    );
    assert_eq!(
        message("b.csv", b"x;y;z\n1,5;2;3\n"),
        "b.csv:2:1: column `x`: found \"1,5\", expected a number; write a decimal point in place of the comma"
    );
    assert!(
        message("a.data", b"1 2 3\n").starts_with("a.data: the format `.data` is unknown; name the format")
    );
    assert!(message("a.csv", b"").starts_with("a.csv: the file has no rows"));
    assert!(message("a.xtc", &[0; 100]).starts_with("a.xtc: byte 0: frame 0: its magic number is 0"));
    assert!(message("a.npy", b"1 2 3\n").starts_with("a.npy: byte 0: this is no array of NumPy"));
    assert!(message("a.npz", b"1 2 3\n").starts_with("a.npz: byte 0: this is no archive of NumPy"));
    assert!(message("a.csv", b"\xff\xfex\0,\0y\0\n\0").contains("UTF-8"));
    let missing = rayreel::trajectory::Trajectory::open(&folder.path().join("none.xyz"), None).unwrap_err();
    assert!(missing.to_string().ends_with("check the name and the folder"), "{missing}");
}

#[test]
fn large_promises_allocate_nothing() {
    let folder = tempfile::tempdir().unwrap();
    // Many columns over few rows, and a first row of many fields.
    let wide = format!("2\n\nH 1 2 3{}\nH 1 2 3\n", " 4".repeat(100_000));
    assert_eq!(open(folder.path(), "a.xyz", wide.as_bytes()).unwrap().read(0).unwrap().columns.len(), 4);
    let zeros = gzip(&vec![b'\n'; 10_000_000]);
    assert!(open(folder.path(), "a.csv.gz", &zeros).is_err());
    let mut atoms = crate::writers::xtc(&[vec![[1, 2, 3]; 20]]);
    for position in [4, 52] {
        atoms[position..position + 4].copy_from_slice(&i32::MAX.to_be_bytes());
    }
    assert!(open(folder.path(), "a.xtc", &atoms).unwrap_err().to_string().contains("too few"));
}
