//! Compressed files in builds without the feature `trajectories`: they are not read.

use std::ops::Range;

use super::compression::Compression;
use super::data_file::DataFile;
use super::error::{DataPlace, Faults};

fn rejection(what: &str) -> Faults {
    let cause = format!("this build of rayreel has no {what}");
    Faults::one(DataPlace::Whole, cause, "build it with its Cargo feature `trajectories`")
}

pub(super) fn decompress(
    _file: &DataFile,
    _compression: Compression,
) -> Result<(DataFile, Option<Faults>), Faults> {
    Err(rejection("compressed files"))
}

pub(super) fn inflate(
    _file: &DataFile,
    _compressed: Range<u64>,
    _length: u64,
    _memory: u64,
) -> Result<DataFile, Faults> {
    Err(rejection("compressed arrays"))
}

#[cfg(test)]
mod tests {
    use crate::trajectory::Trajectory;

    #[test]
    fn builds_without_trajectories_name_the_feature() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv.gz");
        std::fs::write(&path, b"\x1f\x8b\x08\x00").unwrap();
        let error = Trajectory::open(&path, None).unwrap_err().to_string();
        assert!(error.contains("Cargo feature `trajectories`"), "{error}");
    }
}
