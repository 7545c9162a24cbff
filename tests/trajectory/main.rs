//! Tests of the readers of data files: files of other programs against independent readers, files of a simple writer read back, files
//! that grow, and damaged files.
//!
//! `RAYREEL_CASES` sets the number of damaged files, by default 2000.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

mod damaged;
mod growing;
mod programs;
#[path = "../random/splitmix.rs"]
mod random;
mod round_trips;
mod writers;

use std::path::Path;

use rayreel::trajectory::{Snapshot, Trajectory, TrajectoryError, Values};

/// Writes a file into a folder, and opens it.
fn open(folder: &Path, name: &str, bytes: &[u8]) -> Result<Trajectory, TrajectoryError> {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    Trajectory::open(&path, None)
}

/// Returns a column as texts: labels, or numbers in the shortest form that has the same bits.
fn texts(snapshot: &Snapshot, name: &str) -> Vec<String> {
    match snapshot.column(name).unwrap_or_else(|| panic!("no column {name}")) {
        Values::Numbers(numbers) => numbers.iter().map(|number| format!("{number:?}")).collect(),
        Values::Labels { labels, names } => {
            labels.iter().map(|label| names[*label as usize].clone()).collect()
        }
    }
}
