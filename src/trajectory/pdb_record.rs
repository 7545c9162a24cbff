//! Records of PDB files, in columns (wwPDB, "Atomic Coordinate Entry Format Description", version 3.3).

use super::element::{element_of_atom, symbol};
use super::error::{DataPlace, Faults, quote};
use super::snapshot::Cell;
use super::table::not_a_number;
use super::text::{parse_number, parse_whole};

/// Returns the name of a record, in its first six columns.
pub(super) fn record_name(record: &[u8]) -> &[u8] {
    record.get(..record.len().min(6)).unwrap_or_default().trim_ascii_end()
}

/// An ATOM or HETATM record.
pub(super) struct AtomRecord<'a> {
    record: &'a [u8],
    pub serial: Option<u64>,
    /// Serial number, residue number, position, occupancy, temperature factor, and 1 for HETATM.
    pub numbers: [f64; 8],
    element: Element<'a>,
}

/// The element of an atom.
enum Element<'a> {
    Known(&'static str),
    /// A text that is no symbol.
    Other(&'a [u8]),
}

/// A field that is not as the format requires.
pub(super) struct RecordFault {
    /// Position in the line, counted from 1.
    pub byte: u64,
    pub cause: String,
    pub remedy: String,
}

/// Returns the columns of a record, counted from 0, as far as it has them.
fn columns(record: &[u8], start: usize, end: usize) -> &[u8] {
    record.get(start..record.len().min(end)).unwrap_or_default()
}

impl<'a> AtomRecord<'a> {
    pub(super) fn parse(record: &'a [u8]) -> Result<Self, RecordFault> {
        let field = |start, end| columns(record, start, end).trim_ascii();
        let mut position = [0.0; 3];
        for ((coordinate, name), start) in position.iter_mut().zip(["`x`", "`y`", "`z`"]).zip([30, 38, 46]) {
            let text = field(start, start + 8);
            let byte = start as u64 + 1;
            *coordinate = parse_number(text).filter(|_| !text.is_empty()).ok_or_else(|| {
                if record.len() <= start {
                    let cause = format!("the record ends before column {name}");
                    return RecordFault { byte: 0, cause, remedy: "complete it, or remove it".to_owned() };
                }
                let (cause, remedy) = not_a_number(name, text);
                let remedy = if text.contains(&b'*') {
                    remedy
                } else {
                    format!("{remedy}, in columns {byte} to {}", byte + 7)
                };
                RecordFault { byte, cause, remedy }
            })?;
        }
        let number = |start, end, missing: f64| {
            let text = field(start, end);
            if text.is_empty() { missing } else { parse_number(text).unwrap_or(missing) }
        };
        // GROMACS and VMD widen the serial number by a column where it does not fit.
        let serial = serial(columns(record, 6, 11)).or_else(|| serial(columns(record, 6, 12)));
        let residue = residue_number(columns(record, 22, 26));
        let name: [u8; 4] = std::array::from_fn(|index| record.get(12 + index).copied().unwrap_or(b' '));
        let residue_name = String::from_utf8_lossy(field(17, 21));
        let element = match field(76, 78) {
            // Charges and segments of old files stand in these columns, too.
            text if text.is_empty() || text.iter().any(u8::is_ascii_digit) => {
                Element::Known(element_of_atom(&name, &residue_name))
            }
            text => {
                std::str::from_utf8(text).ok().and_then(symbol).map_or(Element::Other(text), Element::Known)
            }
        };
        #[allow(clippy::cast_precision_loss, reason = "serial numbers have at most 40 bits")]
        let id = serial.map_or(f64::NAN, |serial| serial as f64);
        let [x, y, z] = position;
        let hetatm = f64::from(u8::from(record.starts_with(b"HETATM")));
        let numbers = [id, residue, x, y, z, number(54, 60, 1.0), number(60, 66, 0.0), hetatm];
        Ok(Self { record, serial, numbers, element })
    }

    /// Returns name, residue, chain, segment and element.
    pub(super) fn labels(&self) -> [&[u8]; 5] {
        let field = |start, end| columns(self.record, start, end).trim_ascii();
        let element = match self.element {
            Element::Known(symbol) => symbol.as_bytes(),
            Element::Other(text) => text,
        };
        // CHARMM and VMD use a fourth column for long names of residues.
        [field(12, 16), field(17, 21), field(21, 22), field(72, 76), element]
    }

    /// Returns chain, residue and name of an atom with alternate locations; these are the same for all of them.
    pub(super) fn alternate_key(&self) -> Option<Vec<u8>> {
        let location = self.record.get(16).copied().unwrap_or(b' ');
        let part = |start, end| columns(self.record, start, end);
        (location != b' ').then(|| [part(12, 16), part(21, 27), part(72, 76)].concat())
    }
}

/// Returns a serial number, also in hybrid base 36: `A0000` follows 99999, and `a0000` follows `ZZZZZ` (Grosse-Kunstleve, Hybrid-36).
pub(super) fn serial(text: &[u8]) -> Option<u64> {
    hybrid(text.trim_ascii(), 5)
}

/// Returns a number of `width` characters, in decimal or in hybrid base 36.
fn hybrid(text: &[u8], width: u32) -> Option<u64> {
    let first = *text.first()?;
    if !first.is_ascii_alphabetic() {
        return parse_whole(text);
    }
    if text.len() != width as usize {
        return None;
    }
    let is_upper = first.is_ascii_uppercase();
    let digits = text.iter().map(|byte| match byte {
        b'0'..=b'9' => Some(u64::from(byte - b'0')),
        b'A'..=b'Z' if is_upper => Some(u64::from(byte - b'A') + 10),
        b'a'..=b'z' if !is_upper => Some(u64::from(byte - b'a') + 10),
        _ => None,
    });
    let value = digits.into_iter().try_fold(0, |value: u64, digit| Some(value * 36 + digit?))?;
    let before = 36_u64.pow(width - 1);
    let decimals = 10_u64.pow(width);
    Some(value - 10 * before + decimals + if is_upper { 0 } else { 26 * before })
}

/// Returns the number of a residue, or NaN.
fn residue_number(text: &[u8]) -> f64 {
    let text = text.trim_ascii();
    let number = parse_number(text).filter(|_| !text.is_empty());
    #[allow(clippy::cast_precision_loss, reason = "numbers of residues have at most 22 bits")]
    number.or_else(|| hybrid(text, 4).map(|number| number as f64)).unwrap_or(f64::NAN)
}

/// Returns the cell of a CRYST1 record, or `None` for the one that stands for no crystal.
pub(super) fn cell(record: &[u8], line: u64) -> Result<Option<Cell>, Faults> {
    const COLUMNS: [(usize, usize); 6] = [(6, 15), (15, 24), (24, 33), (33, 40), (40, 47), (47, 54)];
    let mut numbers = [0.0; 6];
    for (number, (start, end)) in numbers.iter_mut().zip(COLUMNS) {
        let text = columns(record, start, end).trim_ascii();
        if text.is_empty() {
            // A record without a cell.
            return Ok(None);
        }
        *number = parse_number(text).ok_or_else(|| {
            let (cause, remedy) = not_a_number("`CRYST1`", text);
            Faults::one(DataPlace::Line { line, byte: start as u64 + 1 }, cause, remedy)
        })?;
    }
    let [a, b, c, alpha, beta, gamma] = numbers;
    // Cells of zeros, and the unit cube, stand for molecules without a crystal.
    if [a, b, c] == [0.0; 3] || numbers == [1.0, 1.0, 1.0, 90.0, 90.0, 90.0] {
        return Ok(None);
    }
    let cell = Cell::from_lengths_and_angles([a, b, c], [alpha, beta, gamma]);
    cell.map(Some).ok_or_else(|| {
        let cause = format!("CRYST1 {} is no cell", quote(columns(record, 6, 54)));
        Faults::line(line, cause, "write lengths above 0, and angles that close a cell, or remove the record")
    })
}

/// Returns the time in a TITLE record of GROMACS: `t= 100.00000 step= 50`.
pub(super) fn title_time(record: &[u8]) -> Option<f64> {
    let start = memchr::memmem::find(record, b" t=")?;
    let text = record[start + 3..].trim_ascii_start();
    let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
    parse_number(&text[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hybrid_numbers_continue_decimal_ones() {
        for (text, number) in [
            ("    1", 1),
            ("99999", 99_999),
            ("A0000", 100_000),
            ("A0001", 100_001),
            ("ZZZZZ", 43_770_015),
            ("a0000", 43_770_016),
            ("zzzzz", 87_440_031),
        ] {
            assert_eq!(serial(text.as_bytes()), Some(number), "{text}");
        }
        assert_eq!(residue_number(b"A000"), 10_000.0);
        assert_eq!(residue_number(b" -12"), -12.0);
        for text in ["*****", "A000", "a00A0", "", "A00-0"] {
            assert_eq!(serial(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn elements_follow_from_names() {
        let element = |name: &str, residue: &str| {
            let record = format!("ATOM      1 {name} {residue:>3} A   1       0.000   0.000   0.000");
            AtomRecord::parse(record.as_bytes()).ok().map(|atom| label(atom.labels()[4])).unwrap()
        };
        for (name, residue, symbol) in [
            (" CA ", "ALA", "C"),
            ("CA  ", " CA", "Ca"),
            (" NA ", " NA", "Na"),
            ("HG11", "VAL", "H"),
            ("1HB ", "ALA", "H"),
            (" OXT", "ALA", "O"),
            ("FE  ", "HEM", "Fe"),
            (" NE2", "HIS", "N"),
            ("CL  ", " CL", "Cl"),
            (" SG ", "CYS", "S"),
            ("CA  ", "GLY", "C"),
            ("HW1 ", "SOL", "H"),
            ("ZN  ", " ZN", "Zn"),
            (" X  ", "UNK", ""),
        ] {
            assert_eq!(element(name, residue), symbol, "{name} {residue}");
        }
    }

    fn label(text: &[u8]) -> String {
        String::from_utf8_lossy(text).into_owned()
    }

    #[test]
    fn cells_are_those_of_crystals() {
        let read = |text: &str| cell(text.as_bytes(), 3);
        let cube =
            read("CRYST1   10.000   20.000   30.000  90.00  90.00  90.00 P 1           1").unwrap().unwrap();
        assert_eq!(
            cube.edges.map(|edge| [edge.x, edge.y, edge.z]),
            [[10.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, 30.0]]
        );
        for none in [
            "CRYST1    1.000    1.000    1.000  90.00  90.00  90.00 P 1           1",
            "CRYST1    0.000    0.000    0.000  90.00  90.00  90.00 P 1           1",
            "CRYST1",
        ] {
            assert_eq!(read(none), Ok(None));
        }
        for bad in [
            "CRYST1   10.000   20.000   30.000 190.00  90.00  90.00 P 1           1",
            "CRYST1   10.000   20.0x0   30.000  90.00  90.00  90.00 P 1           1",
            "CRYST1   10.000  -20.000   30.000  90.00  90.00  90.00 P 1           1",
        ] {
            assert!(read(bad).is_err(), "{bad}");
        }
    }
}
