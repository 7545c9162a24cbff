//! Values at regular distances in a file, to columns, on all threads.

use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

use super::data_file::{DataFile, zeros};
use super::error::Faults;
use super::numpy::{ArrayField, NumpyArray, Scalar, ScalarKind};
use super::snapshot::Values;
use super::table::Dictionary;

/// Bytes that a thread reads at once.
const BLOCK: u64 = 1 << 20;

/// Rows of values in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rows {
    /// Position of the first row.
    pub start: u64,
    /// Distance of rows.
    pub stride: u64,
    /// Number of rows.
    pub count: usize,
}

/// Returns the columns of one frame of an array, in the order of fields within values: a column for each field of each of the last axis's
/// values. Shapes are `[rows]`, `[rows, values]` and `[frames, rows, values]`; the array has been checked against the file.
pub(super) fn frame_columns(file: &DataFile, array: &NumpyArray, frame: u64) -> Result<Vec<Values>, Faults> {
    let (frames, rows, values) = match array.shape[..] {
        [rows] => (1, rows, 1),
        [rows, values] => (1, rows, values),
        [frames, rows, values] => (frames, rows, values),
        _ => return Ok(Vec::new()),
    };
    let count = usize::try_from(rows).map_err(|_| std::io::Error::from(std::io::ErrorKind::OutOfMemory))?;
    let size = array.size;
    if !array.fortran_order {
        let stride = values * size;
        let start = array.start + frame * rows * stride;
        let fields = (0..values).flat_map(|value| {
            array
                .fields
                .iter()
                .map(move |field| ArrayField { offset: value * size + field.offset, ..field.clone() })
        });
        return read_rows(file, Rows { start, stride, count }, &fields.collect::<Vec<_>>());
    }
    let mut columns = Vec::new();
    for value in 0..values {
        let start = array.start + (frame + frames * rows * value) * size;
        columns.extend(read_rows(file, Rows { start, stride: frames * size, count }, &array.fields)?);
    }
    Ok(columns)
}

/// Returns a column for each field of rows that are within the file.
pub(super) fn read_rows(file: &DataFile, rows: Rows, fields: &[ArrayField]) -> Result<Vec<Values>, Faults> {
    let width = fields.iter().map(|field| field.offset + field.scalar.size as u64).max().unwrap_or(0);
    let mut columns = Vec::with_capacity(fields.len());
    for field in fields {
        columns.push(if field.scalar.is_text() {
            Values::Labels { labels: zeros(rows.count)?, names: Vec::new() }
        } else {
            Values::Numbers(zeros(rows.count)?)
        });
    }
    let per_block = usize::try_from((BLOCK / rows.stride.max(1)).max(1)).unwrap_or(1);
    let blocks = rows.count.div_ceil(per_block);
    let block_bytes = |block: usize| {
        let first = (block * per_block) as u64;
        let count = (rows.count - block * per_block).min(per_block);
        let start = rows.start + first * rows.stride;
        file.read(start..start + (count as u64 - 1) * rows.stride + width)
    };

    // The slices of numbers that each block fills.
    let mut slices: Vec<Vec<(&ArrayField, &mut [f64])>> = (0..blocks).map(|_| Vec::new()).collect();
    for (field, column) in fields.iter().zip(&mut columns) {
        if let Values::Numbers(numbers) = column {
            for (block, slice) in slices.iter_mut().zip(numbers.chunks_mut(per_block)) {
                block.push((field, slice));
            }
        }
    }
    let stride = usize::try_from(rows.stride).unwrap_or(usize::MAX);
    slices.into_par_iter().enumerate().try_for_each(|(block, slices)| {
        if slices.is_empty() {
            return Ok(());
        }
        let bytes = block_bytes(block)?;
        for (field, slice) in slices {
            let offset = usize::try_from(field.offset).unwrap_or(usize::MAX);
            field.scalar.read_numbers(bytes.get(offset..).unwrap_or(&[]), stride, slice);
        }
        Ok::<(), std::io::Error>(())
    })?;

    for (field, column) in fields.iter().zip(&mut columns) {
        let Values::Labels { labels, names } = column else { continue };
        let mut dictionary = Dictionary::default();
        for (block, labels) in labels.chunks_mut(per_block).enumerate() {
            let bytes = block_bytes(block)?;
            let offset = usize::try_from(field.offset).unwrap_or(usize::MAX);
            let texts = bytes.get(offset..).unwrap_or(&[]).chunks(stride);
            for (label, text) in labels.iter_mut().zip(texts) {
                *label = dictionary.number(field.scalar.text(text).trim_end_matches('\0').as_bytes());
            }
        }
        *names = dictionary.into_names();
    }
    Ok(columns)
}

impl Scalar {
    /// Reads numbers at a distance of `stride` bytes.
    fn read_numbers(self, bytes: &[u8], stride: usize, numbers: &mut [f64]) {
        /// Reads each number with a conversion from its bytes.
        fn each<const N: usize>(
            bytes: &[u8],
            stride: usize,
            numbers: &mut [f64],
            convert: impl Fn([u8; N]) -> f64,
        ) {
            for (number, bytes) in numbers.iter_mut().zip(bytes.chunks(stride)) {
                if let Some(bytes) = bytes.first_chunk() {
                    *number = convert(*bytes);
                }
            }
        }
        /// Reads each number in one of the two orders of bytes.
        macro_rules! of_type {
            ($number:ty, $convert:expr) => {
                if self.is_big_endian {
                    each(bytes, stride, numbers, |bytes| $convert(<$number>::from_be_bytes(bytes)))
                } else {
                    each(bytes, stride, numbers, |bytes| $convert(<$number>::from_le_bytes(bytes)))
                }
            };
        }
        #[allow(clippy::cast_precision_loss, reason = "numbers above 2^53 are rounded, as documented")]
        match (self.kind, self.size) {
            (ScalarKind::Float, 8) => of_type!(f64, |number| number),
            (ScalarKind::Float, 4) => of_type!(f32, f64::from),
            (ScalarKind::Float, _) => of_type!(u16, half),
            (ScalarKind::Signed, 1) => of_type!(i8, f64::from),
            (ScalarKind::Signed, 2) => of_type!(i16, f64::from),
            (ScalarKind::Signed, 4) => of_type!(i32, f64::from),
            (ScalarKind::Signed, _) => of_type!(i64, |number| number as f64),
            (ScalarKind::Unsigned, 1) => of_type!(u8, f64::from),
            (ScalarKind::Unsigned, 2) => of_type!(u16, f64::from),
            (ScalarKind::Unsigned, 4) => of_type!(u32, f64::from),
            (ScalarKind::Unsigned, _) => of_type!(u64, |number| number as f64),
            (ScalarKind::Bool, _) => of_type!(u8, |number| f64::from(u8::from(number != 0))),
            (ScalarKind::Bytes | ScalarKind::Unicode, _) => {}
        }
    }

    /// Returns the text at the start of these bytes.
    fn text(self, bytes: &[u8]) -> String {
        let bytes = &bytes[..self.size.min(bytes.len())];
        if self.kind == ScalarKind::Bytes {
            return String::from_utf8_lossy(bytes).into_owned();
        }
        let character = |bytes: &[u8; 4]| {
            let code =
                if self.is_big_endian { u32::from_be_bytes(*bytes) } else { u32::from_le_bytes(*bytes) };
            char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER)
        };
        bytes.as_chunks().0.iter().map(character).collect()
    }
}

/// Returns the number of 16 bits: a sign, 5 bits of exponent, and 10 of fraction (IEEE 754, binary16).
fn half(bits: u16) -> f64 {
    let fraction = f64::from(bits & 0x3ff);
    let magnitude = match (bits >> 10) & 0x1f {
        0 => fraction / f64::from(1 << 24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        exponent => (1024.0 + fraction) * f64::from(1_u32 << exponent) / f64::from(1 << 25),
    };
    if bits >> 15 == 1 { -magnitude } else { magnitude }
}
