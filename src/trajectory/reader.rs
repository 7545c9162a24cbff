//! Opening, reading and refreshing of data files.

use std::borrow::Cow;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::data_file::DataFile;
use super::error::{DataPlace, Faults, TrajectoryError};
use super::format::Format;
use super::frame_reader::{FileEnd, FrameReader};
use super::open_file;
use super::snapshot::Snapshot;
use super::{csv_file, lammps, npy, npz, pdb, xtc, xyz};

/// A file of particles: an index of its frames, which are read on demand.
///
/// Opening an XYZ, LAMMPS or PDB file passes over it once to find its frames; of a CSV file, it reads the first rows. Frames are then read in
/// any order, and from several threads; memory is that of one frame, and of an index of the frames. Compressed files, and compressed arrays
/// of NPZ files, are decompressed once, when they are opened, into up to 256 MiB of memory, and beyond that into temporary files, which have no
/// names and go with the process.
#[derive(Clone)]
pub struct Trajectory {
    path: PathBuf,
    format: Format,
    file: Arc<DataFile>,
    frames: Box<dyn FrameReader>,
    warnings: Vec<String>,
    /// Size and time of the file when it was last read.
    stamp: FileStamp,
    /// The meaning of the file's end when it was last read.
    end: FileEnd,
    /// The first and the last bytes, which tell a file that has grown from another.
    ends: [Vec<u8>; 2],
}

/// Size and time of a file.
type FileStamp = (u64, Option<std::time::SystemTime>);

/// Number of bytes at each end by which a grown file is recognized.
const RECOGNIZED: u64 = 1 << 10;

impl fmt::Debug for Trajectory {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, format, warnings, .. } = self;
        let mut debug = formatter.debug_struct("Trajectory");
        debug.field("path", path).field("format", format).field("frames", &self.frames());
        debug.field("warnings", warnings).finish_non_exhaustive()
    }
}

impl Trajectory {
    /// Opens a file and finds its frames. Without a format, the name decides: see [`Format::extensions`].
    ///
    /// # Errors
    ///
    /// Returns an error if the file cannot be read, if its format is unknown, or if it has no whole frame.
    pub fn open(path: &Path, format: Option<Format>) -> Result<Self, TrajectoryError> {
        let fail = |faults| TrajectoryError::new(path, faults);
        // The stamp comes first: what is written from now on counts as new.
        let stamp = stamp(path).map_err(|error| fail(Faults::io(&error)))?;
        let format = format.or_else(|| Format::of_name(path)).ok_or_else(|| fail(unknown_format(path)))?;
        let (file, warning) = open_file::open(path).map_err(fail)?;
        let mut frames = reader(format);
        let mut faults = warning.into_iter().collect::<Vec<_>>();
        faults.extend(frames.index(&file, FileEnd::Final).map_err(fail)?);
        let warnings = faults.iter().map(|fault| fault.warning(path)).collect();
        let ends = ends(&file, file.length()).map_err(|error| fail(Faults::io(&error)))?;
        let (path, file, end) = (path.to_owned(), Arc::new(file), FileEnd::Final);
        Ok(Self { path, format, file, frames, warnings, stamp, end, ends })
    }

    /// Returns the path of the file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the format.
    #[must_use]
    pub fn format(&self) -> Format {
        self.format
    }

    /// Returns the number of frames, which is at least 1.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames.frames()
    }

    /// Reads a frame, counted from 0.
    ///
    /// # Errors
    ///
    /// Returns an error if there is no such frame, or if it is not as the format requires.
    pub fn read(&self, frame: usize) -> Result<Snapshot, TrajectoryError> {
        let fail = |faults| TrajectoryError::new(&self.path, faults);
        if frame >= self.frames() {
            let cause = format!("there is no such frame: the file has {}, counted from 0", self.frames());
            return Err(fail(Faults::one(DataPlace::Frame(frame), cause, "read another frame")));
        }
        self.frames.read(&self.file, frame).map_err(fail)
    }

    /// Finds frames that were appended to the file since it was last read. Returns `true` if frames have been added or have changed.
    ///
    /// An incomplete last frame is omitted; one whose last line has no end counts as incomplete until the file stays the same between two
    /// calls. A file that was replaced is read anew.
    ///
    /// # Errors
    ///
    /// Returns an error if the file cannot be read, or has no whole frame any more; the trajectory is then as before.
    pub fn refresh(&mut self) -> Result<bool, TrajectoryError> {
        let fail = |faults| TrajectoryError::new(&self.path, faults);
        let stamp = stamp(&self.path).map_err(|error| fail(Faults::io(&error)))?;
        let is_settled = stamp == self.stamp;
        if is_settled && self.end == FileEnd::Final {
            return Ok(false);
        }
        self.index_again(stamp, if is_settled { FileEnd::Final } else { FileEnd::Growing })
    }

    /// Returns the file as it is now, as [`open`](Self::open) does. Of one that has only grown, the new part alone is searched for frames.
    ///
    /// # Errors
    ///
    /// Returns an error if the file cannot be read, or has no whole frame any more.
    pub fn opened_again(&self) -> Result<Self, TrajectoryError> {
        let stamp =
            stamp(&self.path).map_err(|error| TrajectoryError::new(&self.path, Faults::io(&error)))?;
        let mut again = self.clone();
        again.index_again(stamp, FileEnd::Final)?;
        Ok(again)
    }

    /// Finds the frames of a file that has changed. `growing` is the meaning of its end if it has only grown. Returns whether frames have
    /// been added or have changed.
    fn index_again(&mut self, stamp: FileStamp, growing: FileEnd) -> Result<bool, TrajectoryError> {
        let fail = |faults| TrajectoryError::new(&self.path, faults);
        let (file, warning) = open_file::open(&self.path).map_err(fail)?;
        let ends_before = |length| ends(&file, length).map_err(|error| fail(Faults::io(&error)));
        let (before, now) = (self.file.length(), file.length());
        let grown = now >= before && ends_before(before)? == self.ends;
        let new_ends = ends_before(now)?;
        let end = if grown { growing } else { FileEnd::Final };
        let extent = self.frames.extent();
        let mut faults = warning.into_iter().collect::<Vec<_>>();
        let mut frames = reader(self.format);
        // Frames of a file that only grew need no second search.
        let known = if grown { &mut self.frames } else { &mut frames };
        faults.extend(known.index(&file, end).map_err(fail)?);
        if !grown {
            self.frames = frames;
        }
        self.warnings = faults.iter().map(|fault| fault.warning(&self.path)).collect();
        (self.file, self.stamp, self.ends, self.end) = (Arc::new(file), stamp, new_ends, end);
        Ok(!grown || self.frames.extent() != extent)
    }

    /// Returns the warnings of opening, such as a truncated last frame.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}

fn reader(format: Format) -> Box<dyn FrameReader> {
    match format {
        Format::Csv => Box::<csv_file::CsvFile>::default(),
        Format::Xyz => Box::<xyz::XyzFrames>::default(),
        Format::Lammps => Box::<lammps::DumpFrames>::default(),
        Format::Pdb => Box::<pdb::PdbFrames>::default(),
        Format::Npy => Box::<npy::NpyFrames>::default(),
        Format::Npz => Box::<npz::NpzFrames>::default(),
        Format::Xtc => Box::<xtc::XtcFrames>::default(),
    }
}

fn stamp(path: &Path) -> std::io::Result<FileStamp> {
    let metadata = std::fs::metadata(path)?;
    Ok((metadata.len(), metadata.modified().ok()))
}

/// Returns the bytes at both ends of the first `length` bytes of a file.
fn ends(file: &DataFile, length: u64) -> std::io::Result<[Vec<u8>; 2]> {
    let read = |range| file.read(range).map(Cow::into_owned);
    Ok([read(0..length.min(RECOGNIZED))?, read(length.saturating_sub(RECOGNIZED)..length)?])
}

fn unknown_format(path: &Path) -> Faults {
    let extensions =
        Format::ALL.iter().flat_map(|format| format.extensions()).map(|name| format!("`.{name}`"));
    let extensions = extensions.collect::<Vec<_>>().join(", ");
    let cause = match path.extension() {
        Some(extension) => format!("the format `.{}` is unknown", extension.to_string_lossy()),
        None => "the name has no extension that tells the format".to_owned(),
    };
    let compressed = ["bz2", "xz", "lz4", "zip", "7z", "z"];
    if path.extension().is_some_and(|end| compressed.iter().any(|known| end.eq_ignore_ascii_case(known))) {
        let remedy = "decompress the file, or compress it with gzip or zstd";
        return Faults::one(DataPlace::Whole, cause, remedy);
    }
    let remedy = format!(
        "name the format, or rename the file to one of {extensions}, each with or without `.gz` or `.zst`"
    );
    Faults::one(DataPlace::Whole, cause, remedy)
}
