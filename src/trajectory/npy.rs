//! NPY: one array of NumPy.
//!
//! Shapes are (particles,), (particles, values) and (frames, particles, values). The first three values are `x`, `y` and `z`, others are
//! named by their index; structured arrays have a column for each field. Integers of 8 to 64 bits, floating-point numbers of 16 to 64 bits,
//! logical values and texts are read, in either order of bytes and of axes.

use super::column_names::MOST_COLUMNS;
use super::data_file::DataFile;
use super::error::{DataPlace, Faults};
use super::frame_reader::{FileEnd, FrameReader};
use super::numpy::NumpyArray;
use super::snapshot::{Snapshot, Values};
use super::strided::frame_columns;

/// The frames of an array.
#[derive(Clone, Debug, Default)]
pub(super) struct NpyFrames {
    array: Option<NumpyArray>,
}

impl FrameReader for NpyFrames {
    fn index(&mut self, file: &DataFile, _end: FileEnd) -> Result<Vec<Faults>, Faults> {
        let array = NumpyArray::read(file, 0)?;
        check_shape(&array)?;
        let mut warnings = Vec::new();
        if let [rows @ 1..=4, values] = array.shape[..]
            && values > 16
        {
            let cause =
                format!("shape {} is read as {rows} particles with {values} values each", array.shape_text());
            warnings.push(Faults::one(DataPlace::Whole, cause, "if it is transposed, save `array.T`"));
        }
        self.array = Some(array);
        Ok(warnings)
    }

    fn frames(&self) -> usize {
        match self.array.as_ref().map(|array| &array.shape[..]) {
            Some([frames, _, _]) => usize::try_from(*frames).unwrap_or(usize::MAX),
            _ => 1,
        }
    }

    fn extent(&self) -> (usize, u64) {
        (self.frames(), self.array.as_ref().and_then(NumpyArray::length).unwrap_or(0))
    }

    fn read(&self, file: &DataFile, frame: usize) -> Result<Snapshot, Faults> {
        let Some(array) = &self.array else { return Ok(Snapshot::default()) };
        let columns = frame_columns(file, array, frame as u64)?;
        let mut snapshot = Snapshot { count: columns.first().map_or(0, Values::len), ..Snapshot::default() };
        for (values, name) in columns.into_iter().zip(names(array)) {
            snapshot.push(name, values);
        }
        Ok(snapshot)
    }
}

/// Returns the names of an array's columns.
fn names(array: &NumpyArray) -> impl Iterator<Item = String> {
    (0_usize..).map(|index| {
        if array.is_structured {
            // Structured arrays may have a second axis of one value.
            return array.fields.get(index).map_or_else(|| index.to_string(), |field| field.name.clone());
        }
        ["x", "y", "z"].get(index).map_or_else(|| index.to_string(), |name| (*name).to_owned())
    })
}

/// Rejects arrays that are no frames of particles.
fn check_shape(array: &NumpyArray) -> Result<(), Faults> {
    let shape = array.shape_text();
    let fail = |cause: String, remedy: &str| Err(Faults::one(DataPlace::Whole, cause, remedy));
    let values = match array.shape[..] {
        [_] => 1,
        [0, _, _] => return fail(format!("shape {shape} has no frames"), "save at least one"),
        [_, 0, _] => return fail(format!("shape {shape} has no particles"), "save at least one"),
        [_, values] | [_, _, values] => values,
        _ => {
            let remedy =
                "save an array of (particles, values) or (frames, particles, values), with `array.reshape`";
            return fail(format!("shape {shape} has {} axes, expected 1 to 3", array.shape.len()), remedy);
        }
    };
    let columns = values.saturating_mul(array.fields.len() as u64);
    if !(1..=MOST_COLUMNS as u64).contains(&columns) {
        let cause =
            format!("shape {shape} has {columns} values for each particle, expected 1 to {MOST_COLUMNS}");
        return fail(cause, "if the array is transposed, save `array.T`");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns an array as NumPy saves it.
    fn npy(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
        let fortran = if fortran { "True" } else { "False" };
        let header = format!("{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend(u16::try_from(header.len()).unwrap().to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn read(bytes: Vec<u8>, frame: usize) -> Result<Snapshot, Faults> {
        let file = DataFile::memory(bytes);
        let mut frames = NpyFrames::default();
        frames.index(&file, FileEnd::Final)?;
        frames.read(&file, frame)
    }

    #[test]
    fn types_and_orders_are_read() {
        let doubles: Vec<u8> = (0..12).flat_map(|value| f64::from(value).to_le_bytes()).collect();
        let snapshot = read(npy("'<f8'", false, "(3, 4)", &doubles), 0).unwrap();
        assert_eq!(snapshot.numbers("x").unwrap(), [0.0, 4.0, 8.0]);
        assert_eq!(snapshot.numbers("3").unwrap(), [3.0, 7.0, 11.0]);
        let snapshot = read(npy("'<f8'", true, "(3, 4)", &doubles), 0).unwrap();
        assert_eq!(snapshot.numbers("y").unwrap(), [3.0, 4.0, 5.0]);
        let snapshot = read(npy("'<f8'", true, "(2, 2, 3)", &doubles), 1).unwrap();
        assert_eq!(snapshot.positions().unwrap(), [&[1.0, 3.0][..], &[5.0, 7.0], &[9.0, 11.0]]);
        let snapshot = read(npy("'<f8'", false, "(2, 2, 3)", &doubles), 1).unwrap();
        assert_eq!(snapshot.positions().unwrap(), [&[6.0, 9.0][..], &[7.0, 10.0], &[8.0, 11.0]]);
        let big: Vec<u8> = [-3_i16, 500, 7].iter().flat_map(|value| value.to_be_bytes()).collect();
        let snapshot = read(npy("'>i2'", false, "(1, 3)", &big), 0).unwrap();
        assert_eq!(snapshot.positions().unwrap(), [&[-3.0][..], &[500.0], &[7.0]]);
    }

    #[test]
    fn structured_arrays_have_columns_by_field() {
        let mut item = vec![1_u8, 0, 0, 0];
        item.extend(b"Na");
        [1.0_f32, 2.0, 3.0].iter().for_each(|value| item.extend(value.to_le_bytes()));
        item.extend([b'A', 0, 0, 0, 0, 0, 0, 0]);
        let descr = "[('id', '<i4'), ('element', '|S2'), ('pos', '<f4', (3,)), ('chain', '<U2')]";
        let snapshot = read(npy(descr, false, "(1,)", &item), 0).unwrap();
        let names: Vec<&str> = snapshot.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["id", "element", "x", "y", "z", "chain"]);
        assert_eq!(snapshot.positions().unwrap(), [&[1.0][..], &[2.0], &[3.0]]);
        assert_eq!(
            snapshot.column("chain"),
            Some(&Values::Labels { labels: vec![0], names: vec!["A".to_owned()] })
        );
    }

    #[test]
    fn halves_are_exact() {
        let bits: [u16; 9] = [0, 0x8000, 1, 0x3ff, 0x400, 0x3c00, 0xc000, 0x7bff, 0x7c00];
        let data: Vec<u8> = bits.iter().flat_map(|value| value.to_le_bytes()).collect();
        let snapshot = read(npy("'<f2'", false, "(9,)", &data), 0).unwrap();
        let unit = 1.0 / 16_777_216.0;
        let expected = [0.0, -0.0, unit, 1023.0 * unit, 1024.0 * unit, 1.0, -2.0, 65504.0, f64::INFINITY];
        assert_eq!(snapshot.numbers("x").unwrap(), expected);
    }

    #[test]
    fn headers_that_promise_more_than_the_file_are_rejected() {
        for (descr, shape, cause) in [
            ("'<f8'", "(1000000000000, 3)", "truncated"),
            ("'<f8'", "(18446744073709551615, 3)", "larger than any file"),
            ("'<f8'", "(1000000000000000000, 0)", "0 values"),
            ("'<f8'", "(1000000000000000000, 0, 3)", "no particles"),
            ("'<f8'", "(1, 1, 1, 1)", "4 axes"),
            ("'<c16'", "(0, 3)", "no numbers"),
            ("'|O'", "(0, 3)", "no numbers"),
            ("'<f16'", "(0, 3)", "64 bits"),
            ("[('a', '<f8', (1000000,))]", "(0,)", "more than"),
            ("((((((((((1))))))))))", "(0,)", "damaged"),
        ] {
            let message =
                read(npy(descr, false, shape, &[0; 64]), 0).unwrap_err().warning(std::path::Path::new("a"));
            assert!(message.contains(cause), "{descr} {shape}: {message}");
        }
    }
}
