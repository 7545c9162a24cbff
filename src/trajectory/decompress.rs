//! Decompression of gzip and zstd files.

use std::path::Path;

use super::data_file::DataFile;
use super::error::{DataPlace, Faults};

/// Number of decompressed bytes that are kept in memory; longer files are decompressed into a temporary file.
#[cfg_attr(not(feature = "trajectories"), allow(dead_code, reason = "the limit is documented in all builds"))]
pub(super) const MEMORY_LIMIT: usize = 256 << 20;
/// Number of decompressed bytes from which a file is rejected.
#[cfg_attr(not(feature = "trajectories"), allow(dead_code, reason = "the limit is documented in all builds"))]
pub(super) const LIMIT: u64 = 64 << 30;

/// A compression of whole files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compression {
    Gzip,
    Zstd,
}

impl Compression {
    /// Returns the compression of a file that begins with these bytes.
    pub(super) fn of(magic: [u8; 4]) -> Option<Self> {
        match magic {
            [0x1f, 0x8b, ..] => Some(Self::Gzip),
            [0x28, 0xb5, 0x2f, 0xfd] | [0x50..=0x5f, 0x2a, 0x4d, 0x18] => Some(Self::Zstd),
            _ => None,
        }
    }
}

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

#[cfg(not(feature = "trajectories"))]
fn decompress(_file: &DataFile, _compression: Compression) -> Result<(DataFile, Option<Faults>), Faults> {
    Err(without_feature("compressed files"))
}

/// Returns the error of what this build does not read.
#[cfg(not(feature = "trajectories"))]
pub(super) fn without_feature(what: &str) -> Faults {
    let cause = format!("this build of rayreel has no {what}");
    Faults::one(DataPlace::Whole, cause, "build it with its Cargo feature `trajectories`")
}

#[cfg(feature = "trajectories")]
use with_feature::decompress;
#[cfg(feature = "trajectories")]
pub(super) use with_feature::inflate;

#[cfg(feature = "trajectories")]
mod with_feature {
    use std::io::{BufRead, BufReader, Error, ErrorKind, Read, Result as IoResult, Write};

    use ruzstd::decoding::errors::{FrameDecoderError, ReadFrameHeaderError};
    use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder};
    use tempfile::{SpooledData, SpooledTempFile};

    use super::super::data_file::{DataFile, Storage};
    use super::super::error::{DataPlace, Faults};
    use super::{Compression, LIMIT, MEMORY_LIMIT};

    /// Largest window of a zstd frame, which its decoder keeps in memory: that of zstd itself.
    const WINDOW_LIMIT: u64 = 1 << 27;

    /// Decompresses a file into memory or a temporary file. A file that ends within its compressed data is read up to there, with a warning.
    pub(in crate::trajectory) fn decompress(
        file: &DataFile,
        compression: Compression,
    ) -> Result<(DataFile, Option<Faults>), Faults> {
        let mut spool = SpooledTempFile::new(MEMORY_LIMIT);
        let bytes = BufReader::with_capacity(1 << 18, Sequential { file, position: 0 });
        let (copied, end) = match compression {
            Compression::Gzip => copy(flate2::bufread::MultiGzDecoder::new(bytes), &mut spool)?,
            Compression::Zstd => {
                let mut decoder = FrameDecoder::new();
                decoder.set_max_window_size(WINDOW_LIMIT);
                copy(ZstdFrames { bytes, decoder }, &mut spool)?
            }
        };
        let warning = match end {
            None => None,
            Some(error) if copied > 0 => {
                let cause =
                    format!("the compressed data ends early or is corrupt, and is read up to there: {error}");
                Some(Faults::one(DataPlace::Byte(copied), cause, "copy or write the file again"))
            }
            Some(error) => {
                let cause = format!("cannot be decompressed: {error}");
                return Err(Faults::one(DataPlace::Whole, cause, "copy or write the file again"));
            }
        };
        Ok((DataFile::new(storage(spool), copied), warning))
    }

    /// Copies until the end or an error of the source. Returns the number of bytes, and the error.
    fn copy(mut from: impl Read, to: &mut SpooledTempFile) -> Result<(u64, Option<Error>), Faults> {
        let mut block = vec![0; 1 << 18];
        let mut copied = 0;
        loop {
            let count = match from.read(&mut block) {
                Ok(0) => return Ok((copied, None)),
                Ok(count) => count,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Ok((copied, Some(error))),
            };
            copied += count as u64;
            if copied > LIMIT {
                let cause = format!("holds more than {} GiB when decompressed", LIMIT >> 30);
                return Err(Faults::one(DataPlace::Whole, cause, "decompress it, and open the plain file"));
            }
            to.write_all(&block[..count]).map_err(|error| {
                let cause = format!("cannot be decompressed into a temporary file: {error}");
                Faults::one(DataPlace::Whole, cause, "free space there, or set TMPDIR to another folder")
            })?;
        }
    }

    /// Returns the file that is deflated in a part of a file, and that is stated to have so many bytes.
    pub(in crate::trajectory) fn inflate(
        file: &DataFile,
        start: u64,
        end: u64,
        length: u64,
    ) -> Result<DataFile, Faults> {
        let compressed = Sequential { file, position: start }.take(end.saturating_sub(start));
        let mut spool = SpooledTempFile::new(MEMORY_LIMIT);
        let inflated = flate2::read::DeflateDecoder::new(BufReader::new(compressed)).take(length);
        let (copied, end) = copy(inflated, &mut spool)?;
        if end.is_some() || copied < length {
            let cause = "the compressed data ends early or is corrupt";
            return Err(Faults::one(DataPlace::Byte(start), cause, "copy or write the file again"));
        }
        Ok(DataFile::new(storage(spool), copied))
    }

    fn storage(spool: SpooledTempFile) -> Storage {
        match spool.into_inner() {
            SpooledData::InMemory(bytes) => Storage::Memory(bytes.into_inner()),
            SpooledData::OnDisk(file) => Storage::Disk(file),
        }
    }

    /// Reads a file from its beginning to its end.
    struct Sequential<'a> {
        file: &'a DataFile,
        position: u64,
    }

    impl Read for Sequential<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> IoResult<usize> {
            let left = self.file.length().saturating_sub(self.position);
            let count = usize::try_from(left).unwrap_or(usize::MAX).min(buffer.len());
            self.file.read_into(self.position, &mut buffer[..count])?;
            self.position += count as u64;
            Ok(count)
        }
    }

    /// Decompresses consecutive zstd frames, which the crate reads one by one.
    struct ZstdFrames<R> {
        bytes: R,
        decoder: FrameDecoder,
    }

    impl<R: BufRead> ZstdFrames<R> {
        /// Starts the next frame. Returns `false` at the end of the file.
        fn start_frame(&mut self) -> IoResult<bool> {
            while !self.bytes.fill_buf()?.is_empty() {
                match self.decoder.reset(&mut self.bytes) {
                    Ok(()) => return Ok(true),
                    Err(FrameDecoderError::ReadFrameHeaderError(ReadFrameHeaderError::SkipFrame {
                        length,
                        ..
                    })) => {
                        std::io::copy(&mut (&mut self.bytes).take(length.into()), &mut std::io::sink())?;
                    }
                    Err(error) => return Err(Error::other(error)),
                }
            }
            Ok(false)
        }
    }

    impl<R: BufRead> Read for ZstdFrames<R> {
        fn read(&mut self, buffer: &mut [u8]) -> IoResult<usize> {
            loop {
                let count = self.decoder.read(buffer)?;
                if count > 0 {
                    return Ok(count);
                }
                if !self.decoder.is_finished() {
                    let blocks = BlockDecodingStrategy::UptoBytes(buffer.len());
                    self.decoder.decode_blocks(&mut self.bytes, blocks).map_err(Error::other)?;
                } else if self.decoder.can_collect() == 0 {
                    let stated = self.decoder.get_checksum_from_data();
                    if stated.is_some() && stated != self.decoder.get_calculated_checksum() {
                        return Err(Error::new(ErrorKind::InvalidData, "its checksum is wrong"));
                    }
                    if !self.start_frame()? {
                        return Ok(0);
                    }
                }
            }
        }
    }
}

#[cfg(all(test, not(feature = "trajectories")))]
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
