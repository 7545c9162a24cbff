//! NPZ: arrays of NumPy by name.
//!
//! Positions are the array `positions`, `pos`, `xyz`, `coordinates`, `coords`, `x` (beside `y` and `z`) or `arr_0`; its shape gives the
//! number of particles and of frames. Arrays with a value for each particle, or for each frame and particle, become columns. `cell`, `pbc`
//! and `time` are those of the frame; `numbers` are atomic numbers, from which the column `element` follows. Other arrays are omitted.
//!
//! Compressed arrays are decompressed once, when the file is opened, and kept as other
//! compressed files are.

use std::sync::Arc;

use glam::DVec3;

use super::column_names::{MOST_COLUMNS, property_names};
use super::data_file::DataFile;
use super::element::{SYMBOLS, normalize_elements};
use super::error::{DataPlace, Faults};
use super::frame_reader::{FileEnd, FrameReader};
use super::numpy::NumpyArray;
use super::snapshot::{Cell, Snapshot, Values};
use super::strided::frame_columns;
use super::zip::{inflate, members};

/// Names of the array of positions, the first that is there counts.
const POSITIONS: [&str; 9] =
    ["positions", "position", "pos", "xyz", "coordinates", "coords", "trajectory", "x", "arr_0"];

/// Names of arrays with the times of frames.
const TIMES: [&str; 3] = ["time", "times", "t"];

/// Names of arrays with cells.
const CELLS: [&str; 3] = ["cell", "lattice", "box"];

/// Number of decompressed bytes of all arrays from which a file is rejected.
const LARGEST_ARRAYS: u64 = 64 << 30;

/// Number of decompressed bytes of all arrays that are kept in memory; those beyond are decompressed into temporary files.
const MEMORY: u64 = 256 << 20;

/// Returns whether an array of this name belongs to frames, not to particles.
fn is_of_frames(name: &str) -> bool {
    name == "pbc" || TIMES.contains(&name) || CELLS.contains(&name)
}

/// The arrays of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct NpzFrames {
    arrays: Vec<NamedArray>,
    frames: usize,
    particles: u64,
    length: u64,
}

#[derive(Clone, Debug)]
struct NamedArray {
    name: String,
    array: NumpyArray,
    /// The decompressed array; `None` if it is stored in the file as it is.
    data: Option<Arc<DataFile>>,
}

/// The relation of an array to frames and particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ArrayExtent {
    /// Values for each particle, the same in all frames.
    Particles,
    /// Values for each particle and frame.
    FramesAndParticles,
}

impl FrameReader for NpzFrames {
    fn index(&mut self, file: &DataFile, _end: FileEnd) -> Result<Vec<Faults>, Faults> {
        let (mut arrays, mut memory) = (Vec::new(), MEMORY);
        let members = members(file)?;
        let deflated = members.iter().filter(|member| member.is_deflated);
        if deflated.fold(0, |sum: u64, member| sum.saturating_add(member.length)) > LARGEST_ARRAYS {
            let cause = format!("its arrays hold more than {} GiB when decompressed", LARGEST_ARRAYS >> 30);
            return Err(Faults::one(DataPlace::Whole, cause, "save fewer arrays, or by `numpy.savez`"));
        }
        for member in members {
            let Some(name) = member.name.strip_suffix(".npy") else { continue };
            let data = match member.is_deflated {
                true => Some(inflate(file, &member, memory)?),
                false => None,
            };
            if member.is_deflated && member.length <= memory {
                memory -= member.length;
            }
            let position = if data.is_some() { 0 } else { member.start };
            let array = NumpyArray::read(data.as_ref().unwrap_or(file), position)
                .map_err(|faults| faults.within(&format!("array `{name}`")))?;
            arrays.push(NamedArray { name: name.to_owned(), array, data: data.map(Arc::new) });
        }
        let positions = POSITIONS.iter().find_map(|name| arrays.iter().find(|array| array.name == *name));
        let Some(positions) = positions.or_else(|| arrays.iter().find(|array| array.array.shape.len() > 1))
        else {
            let names = arrays.iter().map(|array| format!("`{}`", array.name)).collect::<Vec<_>>().join(", ");
            let cause = format!("there is no array `positions`; the arrays are {names}");
            return Err(Faults::one(
                DataPlace::Whole,
                cause,
                "save one, with `numpy.savez(file, positions=...)`",
            ));
        };
        let (frames, particles) = match positions.array.shape[..] {
            // An array `x` has an axis of frames before that of particles.
            [frames, particles] if positions.name == "x" => (frames, particles),
            [particles] | [particles, _] => (1, particles),
            [frames, particles, _] if frames > 0 && particles > 0 => (frames, particles),
            _ => {
                let cause =
                    format!("array `{}` has the shape {}", positions.name, positions.array.shape_text());
                return Err(Faults::one(
                    DataPlace::Whole,
                    cause,
                    "save it as (particles, 3) or (frames, particles, 3)",
                ));
            }
        };
        if frames == 0 || positions.array.length() == Some(0) && (particles > 0 || frames > 1) {
            let cause = format!("array `{}` has no values", positions.name);
            return Err(Faults::one(DataPlace::Whole, cause, "save at least one frame"));
        }
        self.frames = usize::try_from(frames).unwrap_or(usize::MAX);
        (self.particles, self.length, self.arrays) = (particles, file.length(), arrays);
        Ok(self.omitted())
    }

    fn frames(&self) -> usize {
        self.frames
    }

    fn extent(&self) -> (usize, u64) {
        (self.frames, self.length)
    }

    fn read(&self, file: &DataFile, frame: usize) -> Result<Snapshot, Faults> {
        let count = usize::try_from(self.particles).unwrap_or(usize::MAX);
        let mut snapshot = Snapshot { count, ..Snapshot::default() };
        for array in &self.arrays {
            let Some((extent, width)) = self.extent_of(array) else { continue };
            let mut shaped = array.array.clone();
            let at = match extent {
                ArrayExtent::Particles => 0,
                ArrayExtent::FramesAndParticles => frame as u64,
            };
            // The axes of values become one.
            shaped.shape = match extent {
                ArrayExtent::Particles => vec![self.particles, width],
                ArrayExtent::FramesAndParticles => vec![self.frames as u64, self.particles, width],
            };
            let columns = frame_columns(array.data.as_deref().unwrap_or(file), &shaped, at)?;
            let names = names(array, columns.len());
            for (name, values) in names.into_iter().zip(columns) {
                snapshot.push(name, values);
            }
        }
        normalize_elements(&mut snapshot);
        add_elements(&mut snapshot);
        snapshot.cell = self.cell(file, frame)?;
        let time = TIMES.iter().find_map(|name| self.frame_values(file, frame, name).transpose());
        snapshot.time = time.transpose()?.and_then(|values| values.first().copied());
        Ok(snapshot)
    }
}

impl NpzFrames {
    /// Returns the relation of an array to the particles, and its number of values for each; `None` if it has none.
    fn extent_of(&self, array: &NamedArray) -> Option<(ArrayExtent, u64)> {
        if is_of_frames(&array.name) {
            return None;
        }
        let frames = self.frames as u64;
        let (extent, rest) = match &array.array.shape[..] {
            [first, second, rest @ ..] if *first == frames && *second == self.particles && frames > 1 => {
                (ArrayExtent::FramesAndParticles, rest)
            }
            [1, second, rest @ ..] if frames == 1 && *second == self.particles && self.particles > 1 => {
                (ArrayExtent::FramesAndParticles, rest)
            }
            [1, 1, third] if frames == 1 && self.particles == 1 => {
                return Some((ArrayExtent::Particles, *third));
            }
            [first, rest @ ..] if *first == self.particles => (ArrayExtent::Particles, rest),
            _ => return None,
        };
        let width = rest.iter().try_fold(1, |product: u64, length| product.checked_mul(*length))?;
        let columns = width.checked_mul(array.array.fields.len() as u64)?;
        // Axes of Fortran's order do not become one.
        let is_plain = rest.len() < 2 || !array.array.fortran_order;
        (is_plain && (1..=MOST_COLUMNS as u64).contains(&columns)).then_some((extent, width))
    }

    /// Returns warnings of the arrays that are not used.
    fn omitted(&self) -> Vec<Faults> {
        let omitted = self.arrays.iter().filter(|array| {
            !is_of_frames(&array.name) && !array.array.shape.is_empty() && self.extent_of(array).is_none()
        });
        let warning = |array: &NamedArray| {
            let shape = array.array.shape_text();
            let cause = format!(
                "array `{}` of shape {shape} has no values for each particle, and is omitted",
                array.name
            );
            Faults::one(
                DataPlace::Whole,
                cause,
                "save it with the particles along the first axis, or the second after frames",
            )
        };
        omitted.map(warning).collect()
    }

    /// Returns the values of an array that belong to a frame, if there are any.
    fn frame_values(&self, file: &DataFile, frame: usize, name: &str) -> Result<Option<Vec<f64>>, Faults> {
        let Some(named) = self.arrays.iter().find(|array| array.name == name) else { return Ok(None) };
        let (array, frames) = (&named.array, self.frames as u64);
        // A cell is a few numbers; what is longer is none.
        let values =
            array.shape.iter().try_fold(1, |product: u64, length| product.checked_mul(*length)).unwrap_or(0);
        // A cell, or the flags of one, is that of all frames, even where there are as many frames as it has rows.
        let is_of_all = !TIMES.contains(&name) && matches!(array.shape[..], [3 | 9] | [3, 3]);
        let (shape, at) = match array.shape.first() {
            Some(first) if *first == frames && !is_of_all && (frames > 1 || array.shape.len() != 2) => {
                (vec![frames, 1, values / frames.max(1)], frame as u64)
            }
            _ => (vec![1, 1, values], 0),
        };
        if shape[2] == 0
            || shape[2] > 9
            || array.is_structured
            || array.fortran_order && array.shape.len() > 1
        {
            return Ok(None);
        }
        let shaped = NumpyArray { shape, fortran_order: false, ..array.clone() };
        let columns = frame_columns(named.data.as_deref().unwrap_or(file), &shaped, at)?;
        let numbers = columns.into_iter().filter_map(|values| match values {
            Values::Numbers(numbers) => numbers.first().copied(),
            Values::Labels { .. } => None,
        });
        Ok(Some(numbers.collect()))
    }

    fn cell(&self, file: &DataFile, frame: usize) -> Result<Option<Cell>, Faults> {
        let values = CELLS.iter().find_map(|name| self.frame_values(file, frame, name).transpose());
        let edges = match values.transpose()?.as_deref() {
            Some(&[a, b, c]) => [DVec3::X * a, DVec3::Y * b, DVec3::Z * c],
            Some(&[a, b, c, d, e, f, g, h, i]) => {
                [DVec3::new(a, b, c), DVec3::new(d, e, f), DVec3::new(g, h, i)]
            }
            _ => return Ok(None),
        };
        let periodic = match self.frame_values(file, frame, "pbc")?.as_deref() {
            Some(&[x, y, z]) => [x, y, z].map(|value| value != 0.0),
            Some(&[all]) => [all != 0.0; 3],
            _ => [true; 3],
        };
        let cell = Cell { origin: DVec3::ZERO, edges, periodic };
        if edges == [DVec3::ZERO; 3] {
            return Ok(None);
        }
        if cell.is_valid() {
            return Ok(Some(cell));
        }
        let remedy = "save three independent edges, or make flat directions not periodic (`pbc`)";
        Err(Faults::one(DataPlace::Frame(frame), "the array `cell` spans no volume", remedy))
    }
}

/// Returns the names of an array's columns.
fn names(array: &NamedArray, width: usize) -> Vec<String> {
    if array.array.is_structured {
        return array.array.fields.iter().map(|field| field.name.clone()).collect();
    }
    let is_positions = POSITIONS.contains(&array.name.as_str()) && array.name != "x";
    let name = match array.name.as_str() {
        _ if is_positions => "pos",
        "v" => "velocities",
        "types" | "particle_types" => "type",
        "ids" => "id",
        "species" | "elements" => "symbols",
        name => name,
    };
    if is_positions && width > 3 {
        let names = (0..width).map(|index| {
            ["x", "y", "z"].get(index).map_or_else(|| index.to_string(), |name| (*name).to_owned())
        });
        return names.collect();
    }
    property_names(name, width)
}

/// Adds elements from atomic numbers, as ASE saves them.
fn add_elements(snapshot: &mut Snapshot) {
    if snapshot.column("element").is_some() {
        return;
    }
    let Some(Values::Numbers(numbers)) =
        snapshot.column("numbers").or_else(|| snapshot.column("atomic_numbers"))
    else {
        return;
    };
    let mut names = Vec::<String>::new();
    let mut indices = [None; SYMBOLS.len() + 1];
    let labels = numbers.iter().map(|number| {
        let is_known = number.fract() == 0.0 && (1.0..=SYMBOLS.len() as f64).contains(number);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number up to 118"
        )]
        let atomic = if is_known { *number as usize } else { 0 };
        *indices[atomic].get_or_insert_with(|| {
            names.push(atomic.checked_sub(1).map_or(String::new(), |index| SYMBOLS[index].to_owned()));
            u32::try_from(names.len() - 1).unwrap_or(0)
        })
    });
    let labels = labels.collect();
    snapshot.push("element", Values::Labels { labels, names });
}
