//! XTC: compressed trajectories of GROMACS, with positions in nanometres and times in picoseconds.
//!
//! Columns are `x`, `y` and `z`, with the 32-bit values that GROMACS reads. An edge of zeros in the box is not periodic.

use glam::DVec3;

use super::data_file::{DataFile, zeros};
use super::error::{DataPlace, Faults};
use super::frame_reader::{FileEnd, FrameReader};
use super::snapshot::{Cell, Snapshot, Values};
use super::xtc_coordinates::{CompressedCoordinates, decode};

/// Bytes of a frame before its coordinates: magic number, atoms, step, time, box, and atoms again.
const HEADER: u64 = 56;
/// Bytes before compressed coordinates: precision, bounds, index of the small size, and number of bytes.
const PRELUDE: u64 = 36;
/// Most atoms whose coordinates are not compressed.
const FEW: u32 = 9;

/// The frames of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct XtcFrames {
    frames: Vec<XtcHeader>,
    end: u64,
}

/// The header of a frame.
#[derive(Clone, Copy, Debug)]
struct XtcHeader {
    /// Position of the frame.
    start: u64,
    atoms: u32,
    /// `true` if the number of bytes has 64 bits, as in files of GROMACS 2023 with very many atoms.
    is_wide: bool,
    /// Bytes of the compressed coordinates.
    bytes: u64,
}

/// Returns the big-endian number at a position.
fn word(bytes: &[u8], position: usize) -> u32 {
    bytes.get(position..).and_then(<[u8]>::first_chunk).map_or(0, |bytes| u32::from_be_bytes(*bytes))
}

fn float(bytes: &[u8], position: usize) -> f32 {
    f32::from_bits(word(bytes, position))
}

impl XtcHeader {
    /// Reads the header of the frame at a position. Returns the fault of a frame that is truncated or damaged.
    fn read(file: &DataFile, start: u64, frame: usize) -> std::io::Result<Result<Self, Faults>> {
        let left = file.length() - start;
        let fail = |cause: String| {
            let remedy = "copy the file again; `gmx check` finds the last whole frame";
            Ok(Err(Faults::one(DataPlace::Byte(start), format!("frame {frame}: {cause}"), remedy)))
        };
        let truncated = || fail("it is truncated".to_owned());
        if left < HEADER {
            return truncated();
        }
        let header = file.read(start..start + left.min(HEADER + PRELUDE + 4))?;
        let is_wide = match word(&header, 0) {
            1995 => false,
            2023 => true,
            other => return fail(format!("its magic number is {other}, expected 1995 or 2023")),
        };
        let atoms = word(&header, 4);
        if atoms != word(&header, 52) || i32::try_from(atoms).is_err() {
            return fail(format!("it has {atoms} and {} atoms", word(&header, 52)));
        }
        let bytes = if atoms <= FEW {
            0
        } else if is_wide {
            u64::from(word(&header, 88)) << 32 | u64::from(word(&header, 92))
        } else {
            u64::from(word(&header, 88))
        };
        let frame = Self { start, atoms, is_wide, bytes };
        if atoms > FEW && left < HEADER + PRELUDE + if is_wide { 4 } else { 0 } {
            return truncated();
        }
        // The shortest code of an atom has two bits.
        if atoms > FEW && u64::from(atoms) > bytes.saturating_mul(4) {
            return fail(format!("its {bytes} bytes are too few for {atoms} atoms"));
        }
        match frame.end() {
            Some(end) if end <= file.length() => Ok(Ok(frame)),
            _ => truncated(),
        }
    }

    /// Returns the position after the header.
    fn coordinates(&self) -> u64 {
        let prelude = PRELUDE + if self.is_wide { 4 } else { 0 };
        self.start + HEADER + if self.atoms > FEW { prelude } else { 0 }
    }

    /// Returns the position after the frame, if there is such a number.
    fn end(&self) -> Option<u64> {
        let length = if self.atoms > FEW { self.bytes } else { u64::from(self.atoms) * 12 };
        self.coordinates().checked_add(length)?.checked_next_multiple_of(4)
    }
}

impl FrameReader for XtcFrames {
    fn index(&mut self, file: &DataFile, _end: FileEnd) -> Result<Vec<Faults>, Faults> {
        let mut position = self.end;
        let mut found = Vec::new();
        let mut warnings = Vec::new();
        while position < file.length() {
            match XtcHeader::read(file, position, self.frames.len() + found.len())? {
                Ok(frame) => {
                    position = frame.end().unwrap_or(file.length());
                    found.push(frame);
                }
                Err(faults) if self.frames.is_empty() && found.is_empty() => return Err(faults),
                Err(faults) => {
                    warnings.push(faults.within("frames are read up to here"));
                    break;
                }
            }
        }
        if self.frames.is_empty() && found.is_empty() {
            return Err(Faults::one(
                DataPlace::Whole,
                "the file has no frames",
                "write it with GROMACS or MDAnalysis",
            ));
        }
        self.frames.append(&mut found);
        self.end = position;
        Ok(warnings)
    }

    fn frames(&self) -> usize {
        self.frames.len()
    }

    fn extent(&self) -> (usize, u64) {
        (self.frames.len(), self.end)
    }

    fn read(&self, file: &DataFile, frame: usize) -> Result<Snapshot, Faults> {
        let header = self.frames[frame];
        let bytes = file.read(header.start..header.end().unwrap_or(header.start))?;
        let count = header.atoms as usize;
        let mut axes = [zeros(count)?, zeros(count)?, zeros(count)?];
        let coordinates = usize::try_from(header.coordinates() - header.start).unwrap_or(usize::MAX);
        let data = bytes.get(coordinates..).unwrap_or_default();
        if header.atoms > FEW {
            let compressed = CompressedCoordinates {
                precision: float(&bytes, 56),
                low: [60, 64, 68].map(|position| word(&bytes, position).cast_signed()),
                high: [72, 76, 80].map(|position| word(&bytes, position).cast_signed()),
                small: word(&bytes, 84),
                data,
            };
            decode(&compressed, &mut axes).map_err(|cause| {
                let place = DataPlace::Byte(header.start);
                let cause = format!("frame {frame}: its coordinates are damaged: {cause}");
                Faults::one(place, cause, "copy the file again, or read another frame")
            })?;
        } else {
            for (index, axis) in axes.iter_mut().enumerate() {
                for (atom, coordinate) in axis.iter_mut().enumerate() {
                    *coordinate = f64::from(float(data, 12 * atom + 4 * index));
                }
            }
        }
        let cell = read_box(&bytes, header.start)?;
        let mut snapshot =
            Snapshot { count, cell, time: Some(f64::from(float(&bytes, 12))), ..Snapshot::default() };
        for (name, values) in ["x", "y", "z"].into_iter().zip(axes) {
            snapshot.push(name, Values::Numbers(values));
        }
        Ok(snapshot)
    }
}

/// Returns the cell of a frame, or `None` for a box of zeros.
fn read_box(bytes: &[u8], start: u64) -> Result<Option<Cell>, Faults> {
    let edge = |index: usize| {
        let number = |axis: usize| f64::from(float(bytes, 16 + 12 * index + 4 * axis));
        DVec3::new(number(0), number(1), number(2))
    };
    let edges = [edge(0), edge(1), edge(2)];
    let cell = Cell { origin: DVec3::ZERO, edges, periodic: edges.map(|edge| edge != DVec3::ZERO) };
    if edges == [DVec3::ZERO; 3] {
        Ok(None)
    } else if cell.is_valid() {
        Ok(Some(cell))
    } else {
        let remedy = "write the trajectory with a valid box, as `gmx trjconv -box` does";
        Err(Faults::one(DataPlace::Byte(start + 16), "the box spans no volume", remedy))
    }
}
