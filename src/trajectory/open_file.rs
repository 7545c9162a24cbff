//! Opening of plain and compressed files.

use std::path::Path;

use super::compression::Compression;
use super::data_file::DataFile;
use super::decompress::decompress;
use super::error::{DataPlace, Faults};

/// Opens a file, and decompresses it if its first bytes are those of gzip or zstd. Truncated compressed files are read up to their end,
/// with a warning.
pub(super) fn open(path: &Path) -> Result<(DataFile, Option<Faults>), Faults> {
    if std::fs::metadata(path)?.is_dir() {
        return Err(Faults::one(DataPlace::Whole, "is a folder", "name a file in it"));
    }
    let file = DataFile::open(path)?;
    let mut magic = [0; 4];
    let length = file.length().min(4);
    magic.iter_mut().zip(file.read(0..length)?.iter()).for_each(|(to, from)| *to = *from);
    match Compression::of(magic) {
        None => Ok((file, None)),
        Some(compression) => decompress(&file, compression),
    }
}
