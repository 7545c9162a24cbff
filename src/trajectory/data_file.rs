//! The bytes of a data file, decompressed, read at any position.
//!
//! Plain files are read from the disk. Compressed ones are decompressed once, when they are opened: into memory, and from
//! 256 MiB on into a temporary file without a name.

use std::borrow::Cow;
use std::fs::File;
use std::io::{Error, ErrorKind, Result};
use std::ops::Range;
use std::path::Path;

use rayon::iter::{IndexedParallelIterator, ParallelIterator};
use rayon::slice::ParallelSliceMut;

/// Bytes that a thread reads at once: large enough to hide the calls, small enough for the cache.
const BLOCK: usize = 1 << 20;

/// The decompressed bytes of a file.
#[derive(Debug)]
pub(super) struct DataFile {
    storage: Storage,
    length: u64,
}

#[derive(Debug)]
pub(super) enum Storage {
    #[cfg_attr(not(feature = "trajectories"), allow(dead_code, reason = "for decompressed files"))]
    Memory(Vec<u8>),
    Disk(File),
}

impl DataFile {
    /// Opens a file as it is.
    pub(super) fn open(path: &Path) -> Result<Self> {
        let file = File::open(path)?;
        let length = file.metadata()?.len();
        Ok(Self { storage: Storage::Disk(file), length })
    }

    #[cfg_attr(not(feature = "trajectories"), allow(dead_code, reason = "for decompressed files"))]
    pub(super) fn new(storage: Storage, length: u64) -> Self {
        Self { storage, length }
    }

    /// Returns a file of these bytes.
    #[cfg(test)]
    pub(super) fn memory(bytes: Vec<u8>) -> Self {
        let length = bytes.len() as u64;
        Self { storage: Storage::Memory(bytes), length }
    }

    /// Returns the number of bytes.
    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// Fills `bytes` from this position on.
    pub(super) fn read_into(&self, position: u64, bytes: &mut [u8]) -> Result<()> {
        match &self.storage {
            Storage::Disk(file) => read_at(file, position, bytes),
            Storage::Memory(memory) => {
                let start = usize::try_from(position).unwrap_or(usize::MAX);
                let found = memory.get(start..).and_then(|rest| rest.get(..bytes.len()));
                bytes.copy_from_slice(found.ok_or(ErrorKind::UnexpectedEof)?);
                Ok(())
            }
        }
    }

    /// Returns the bytes of a range of the file, read by all threads if they are many.
    pub(super) fn read(&self, range: Range<u64>) -> Result<Cow<'_, [u8]>> {
        if range.end > self.length || range.start > range.end {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        let length = usize::try_from(range.end - range.start).map_err(|_| ErrorKind::OutOfMemory)?;
        match &self.storage {
            Storage::Memory(memory) => {
                let start = usize::try_from(range.start).map_err(|_| ErrorKind::OutOfMemory)?;
                Ok(Cow::Borrowed(&memory[start..start + length]))
            }
            Storage::Disk(file) => {
                let mut bytes = zeros(length)?;
                // Few bytes are not worth a hand-over to the threads.
                if length <= BLOCK {
                    read_at(file, range.start, &mut bytes)?;
                } else {
                    bytes.par_chunks_mut(BLOCK).enumerate().try_for_each(|(index, block)| {
                        read_at(file, range.start + (index * BLOCK) as u64, block)
                    })?;
                }
                Ok(Cow::Owned(bytes))
            }
        }
    }
}

/// Returns so many zeros, or an error if there is no memory for them.
pub(super) fn zeros<T: Default + Clone>(length: usize) -> Result<Vec<T>> {
    // `vec!` takes zeroed pages from the system, which are not touched before they are filled, yet ends the process if there are none.
    let available = Vec::<T>::new().try_reserve_exact(length);
    available.map_err(|_| Error::new(ErrorKind::OutOfMemory, format!("no memory for {length} values")))?;
    Ok(vec![T::default(); length])
}

#[cfg(unix)]
fn read_at(file: &File, position: u64, bytes: &mut [u8]) -> Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, bytes, position)
}

#[cfg(windows)]
fn read_at(file: &File, mut position: u64, mut bytes: &mut [u8]) -> Result<()> {
    while !bytes.is_empty() {
        match std::os::windows::fs::FileExt::seek_read(file, bytes, position) {
            Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
            Ok(count) => {
                bytes = &mut bytes[count..];
                position += count as u64;
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}
