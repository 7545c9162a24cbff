//! Decompression of gzip and zstd files, and of deflated members of ZIP files.

use std::io::{BufRead, BufReader, Error, ErrorKind, Read, Result as IoResult, Write};
use std::ops::Range;

use ruzstd::decoding::errors::{FrameDecoderError, ReadFrameHeaderError};
use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder};
use tempfile::{SpooledData, SpooledTempFile};

use super::compression::Compression;
use super::data_file::{DataFile, Storage};
use super::error::{DataPlace, Faults};

/// Number of decompressed bytes that are kept in memory; longer files are decompressed into a temporary file.
const MEMORY_LIMIT: usize = 256 << 20;
/// Number of decompressed bytes from which a file is rejected.
const LIMIT: u64 = 64 << 30;

/// Largest window of a zstd frame, which its decoder keeps in memory: that of zstd itself.
const WINDOW_LIMIT: u64 = 1 << 27;

/// Decompresses a file into memory or a temporary file. A file that ends within its compressed data is read up to there, with a warning.
pub(super) fn decompress(
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

/// Returns the file that is deflated in a part of a file, and that is stated to have so many bytes: in memory, if there are at most `memory`.
pub(super) fn inflate(
    file: &DataFile,
    Range { start, end }: Range<u64>,
    length: u64,
    memory: u64,
) -> Result<DataFile, Faults> {
    let compressed = Sequential { file, position: start }.take(end.saturating_sub(start));
    let mut spool = SpooledTempFile::new(usize::try_from(memory).unwrap_or(usize::MAX));
    let bytes = BufReader::with_capacity(1 << 18, compressed);
    let inflated = flate2::bufread::DeflateDecoder::new(bytes).take(length);
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
