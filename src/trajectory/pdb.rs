//! PDB files: records of fixed columns, with a MODEL for each frame, or frames that end with END.
//!
//! Each frame has the cell of its own CRYST1 record or else that of the first frame, and the bonds of all CONECT records of the file, if
//! it has as many atoms as the first frame. Of alternate locations of an atom, the one with the highest occupancy is read, the first of
//! equal ones. Atoms without an element get it from their name. Columns are `id` (the serial number, also in hybrid base 36), `name`,
//! `residue`, `residue_id`, `chain`, `x`, `y`, `z`, `occupancy`, `b_factor`, `segment`, `element`, and `hetatm`, which is 1 for HETATM
//! records. The time is that of a TITLE record with `t= 1.0`, as GROMACS writes it.

use std::collections::{HashMap, HashSet};

use super::data_file::DataFile;
use super::error::{DataPlace, FaultKind, Faults};
use super::frame_reader::{FileEnd, FrameReader};
use super::frame_span::FrameSpan;
use super::pdb_record::{AtomRecord, cell, record_name, serial, title_time};
use super::snapshot::{Cell, Snapshot, Values};
use super::table::Dictionary;
use super::text::{LineCursor, without_return};

/// The frames of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct PdbFrames {
    spans: Vec<FrameSpan>,
    /// The cell of the records before the second frame.
    cell: Option<Cell>,
    /// Pairs of atoms in the first frame, and its number of atoms.
    bonds: Vec<[u32; 2]>,
    bonded_atoms: usize,
    length: u64,
}

/// The index of a file while it is made.
#[derive(Default)]
struct Search {
    spans: Vec<FrameSpan>,
    /// Pairs of serial numbers.
    pairs: HashSet<[u64; 2]>,
    cell: Option<Cell>,
    /// Start of the frame that is searched.
    start: Option<FrameSpan>,
    has_atoms: bool,
    /// `true` within a MODEL, which only ENDMDL ends.
    is_model: bool,
    warnings: Vec<Faults>,
}

impl FrameReader for PdbFrames {
    fn index(&mut self, file: &DataFile, end: FileEnd) -> Result<Vec<Faults>, Faults> {
        let mut search = Search::default();
        let mut cursor = LineCursor::new(file, 0, 0);
        loop {
            let (position, line) = (cursor.position(), cursor.line_number());
            let Some(record) = cursor.next_line()? else { break };
            search.record(record, position, line)?;
        }
        search.finish(file, &cursor, end)?;
        if search.spans.is_empty() {
            let remedy = "write ATOM or HETATM records, or name the format of the file";
            return Err(Faults::one(DataPlace::Whole, "the file has no atoms", remedy));
        }
        let mut frames =
            Self { spans: search.spans, cell: search.cell, length: file.length(), ..Self::default() };
        if !search.pairs.is_empty() {
            let (first, serials) = frames.read_frame(file, 0)?;
            (frames.bonds, frames.bonded_atoms) = (bonds(&search.pairs, &serials), first.count);
        }
        *self = frames;
        Ok(search.warnings)
    }

    fn frames(&self) -> usize {
        self.spans.len()
    }

    fn extent(&self) -> (usize, u64) {
        (self.spans.len(), self.length)
    }

    fn read(&self, file: &DataFile, frame: usize) -> Result<Snapshot, Faults> {
        let (mut snapshot, _) = self.read_frame(file, frame)?;
        snapshot.cell = snapshot.cell.or(self.cell);
        if snapshot.count == self.bonded_atoms {
            snapshot.bonds.clone_from(&self.bonds);
        }
        Ok(snapshot)
    }
}

impl Search {
    /// Takes a record into account.
    fn record(&mut self, record: &[u8], position: u64, line: u64) -> Result<(), Faults> {
        let start = *self.start.get_or_insert(FrameSpan { start: position, end: position, line });
        match record_name(record) {
            b"ATOM" | b"HETATM" => self.has_atoms = true,
            b"MODEL" => {
                // A model without ENDMDL ends where the next one begins.
                if self.has_atoms {
                    self.spans.push(FrameSpan { end: position, ..start });
                    self.start = Some(FrameSpan { start: position, end: position, line });
                    self.has_atoms = false;
                }
                self.is_model = true;
            }
            b"ENDMDL" => {
                self.is_model = false;
                self.end_frame(position);
            }
            // VMD writes END after each frame, and so do writers that write models.
            b"END" if !self.is_model => self.end_frame(position),
            b"CRYST1" if self.spans.is_empty() && self.cell.is_none() => self.cell = cell(record, line)?,
            b"CONECT" => self.connect(record),
            _ => {}
        }
        Ok(())
    }

    fn end_frame(&mut self, position: u64) {
        if let Some(start) = self.start.filter(|_| self.has_atoms) {
            self.spans.push(FrameSpan { end: position, ..start });
            self.start = None;
        }
        self.has_atoms = false;
    }

    /// Adds the bonds of a CONECT record: an atom, and up to four others.
    fn connect(&mut self, record: &[u8]) {
        let mut serials =
            (6..31).step_by(5).map(|at| record.get(at..record.len().min(at + 5)).and_then(serial));
        let Some(Some(first)) = serials.next() else { return };
        for other in serials.flatten().filter(|other| *other != first) {
            self.pairs.insert([first.min(other), first.max(other)]);
        }
    }

    /// Adds the atoms after the last frame's end as a frame, if they are one.
    fn finish(&mut self, file: &DataFile, cursor: &LineCursor<'_>, end: FileEnd) -> Result<(), Faults> {
        let Some(start) = self.start.filter(|_| self.has_atoms) else { return Ok(()) };
        // A model needs its end; the atoms of files without models do not.
        let is_cut = self.is_model || !cursor.ends_with_line_end()? && end == FileEnd::Growing;
        if !is_cut || self.spans.is_empty() && end == FileEnd::Final {
            self.spans.push(FrameSpan { end: file.length(), ..start });
        }
        if is_cut {
            let cause = match self.is_model {
                true => "the last frame is truncated: its MODEL has no ENDMDL",
                false => "the last frame is truncated: its last line has no end",
            };
            self.warnings.push(Faults::line(start.line, cause, "complete it, or remove it"));
        }
        Ok(())
    }
}

/// Returns the pairs of atoms of pairs of serial numbers. Serial numbers that several atoms have name none of them.
fn bonds(pairs: &HashSet<[u64; 2]>, serials: &[Option<u64>]) -> Vec<[u32; 2]> {
    let mut atoms = HashMap::<u64, Option<u32>>::new();
    for (index, serial) in (0..).zip(serials) {
        if let Some(serial) = serial {
            atoms.entry(*serial).and_modify(|atom| *atom = None).or_insert(Some(index));
        }
    }
    let atom = |serial: u64| atoms.get(&serial).copied().flatten();
    let found = pairs.iter().filter_map(|[a, b]| Some([atom(*a)?, atom(*b)?]));
    let mut bonds: Vec<[u32; 2]> = found.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    bonds.sort_unstable();
    bonds.dedup();
    bonds
}

/// The columns of a frame while it is read.
#[derive(Default)]
struct AtomColumns {
    numbers: [Vec<f64>; 8],
    labels: [Vec<u32>; 5],
    names: [Dictionary; 5],
    serials: Vec<Option<u64>>,
}

/// Names of the columns of numbers, in the order of [`AtomRecord::numbers`].
const NUMBERS: [&str; 8] = ["id", "residue_id", "x", "y", "z", "occupancy", "b_factor", "hetatm"];
/// Names of the columns of labels, in the order of [`AtomRecord::labels`].
const LABELS: [&str; 5] = ["name", "residue", "chain", "segment", "element"];
/// Index of the occupancy.
const OCCUPANCY: usize = 5;

impl AtomColumns {
    /// Adds an atom, or replaces one.
    fn set(&mut self, index: Option<usize>, atom: &AtomRecord<'_>) {
        let index = index.unwrap_or_else(|| {
            self.numbers.iter_mut().for_each(|column| column.push(0.0));
            self.labels.iter_mut().for_each(|column| column.push(0));
            self.serials.push(None);
            self.serials.len() - 1
        });
        for (column, number) in self.numbers.iter_mut().zip(atom.numbers) {
            column[index] = number;
        }
        for ((column, names), label) in self.labels.iter_mut().zip(&mut self.names).zip(atom.labels()) {
            column[index] = names.number(label);
        }
        self.serials[index] = atom.serial;
    }

    fn into_snapshot(self) -> Snapshot {
        let mut snapshot = Snapshot { count: self.numbers[0].len(), ..Snapshot::default() };
        let mut numbers = NUMBERS.into_iter().zip(self.numbers);
        let mut labels = LABELS.into_iter().zip(self.labels.into_iter().zip(self.names));
        // The order of the file's columns.
        for is_number in [true, false, false, true, false, true, true, true, true, true, false, false, true] {
            if is_number {
                if let Some((name, numbers)) = numbers.next() {
                    snapshot.push(name, Values::Numbers(numbers));
                }
            } else if let Some((name, (labels, names))) = labels.next() {
                snapshot.push(name, Values::Labels { labels, names: names.into_names() });
            }
        }
        snapshot
    }
}

impl PdbFrames {
    /// Reads a frame, and the serial numbers of its atoms.
    fn read_frame(&self, file: &DataFile, frame: usize) -> Result<(Snapshot, Vec<Option<u64>>), Faults> {
        let span = self.spans[frame];
        let bytes = file.read(span.start..span.end)?;
        let mut columns = AtomColumns::default();
        let mut faults = Faults::default();
        // Atoms with alternate locations: index and occupancy by chain, residue and name.
        let mut alternates = HashMap::<Vec<u8>, usize>::new();
        let (mut found_cell, mut time) = (None, None);
        for (line, record) in (span.line..).zip(bytes.split(|byte| *byte == b'\n')) {
            let record = without_return(record);
            match record_name(record) {
                b"ATOM" | b"HETATM" => {}
                b"CRYST1" => {
                    found_cell = cell(record, line)?;
                    continue;
                }
                b"TITLE" => {
                    time = title_time(record).or(time);
                    continue;
                }
                _ => continue,
            }
            let atom = match AtomRecord::parse(record) {
                Ok(atom) => atom,
                Err(fault) => {
                    let place = DataPlace::Line { line, byte: fault.byte };
                    faults.add(FaultKind::NotANumber, place, || (fault.cause, fault.remedy));
                    continue;
                }
            };
            let before = match atom.alternate_key() {
                Some(key) => match alternates.get(&key) {
                    Some(index) if atom.numbers[OCCUPANCY] <= columns.numbers[OCCUPANCY][*index] => continue,
                    Some(index) => Some(*index),
                    None => {
                        alternates.insert(key, columns.serials.len());
                        None
                    }
                },
                None => None,
            };
            columns.set(before, &atom);
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        let serials = std::mem::take(&mut columns.serials);
        let mut snapshot = columns.into_snapshot();
        (snapshot.cell, snapshot.time) = (found_cell, time);
        Ok((snapshot, serials))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(text: &str) -> (DataFile, PdbFrames, Vec<Faults>) {
        let file = DataFile::memory(text.as_bytes().to_vec());
        let mut frames = PdbFrames::default();
        let warnings = frames.index(&file, FileEnd::Final).unwrap();
        (file, frames, warnings)
    }

    const MODELS: &str = "\
CRYST1   10.000   20.000   30.000  90.00  90.00 120.00 P 1           1
MODEL        1
ATOM      1  N   MET A   1      11.104   6.134  -6.504  1.00 50.00           N
ATOM      2  CA AMET A   1      11.639   6.071  -5.147  0.40 20.00           C
ATOM      3  CA BMET A   1      12.639   6.071  -5.147  0.60 20.00           C
HETATMA0000 CA    CA B   2       1.000   2.000   3.000
TER
ENDMDL
MODEL        2
ATOM      1  N   MET A   1      21.104   6.134  -6.504  1.00 50.00           N
ATOM      2  CA AMET A   1      21.639   6.071  -5.147  0.40 20.00           C
ATOM      3  CA BMET A   1      22.639   6.071  -5.147  0.60 20.00           C
HETATMA0000 CA    CA B   2       2.000   2.000   3.000
ENDMDL
CONECT    1    3
CONECT    3    1    2A0000
END
";

    #[test]
    fn models_are_frames_with_bonds_and_cell() {
        let (file, frames, warnings) = open(MODELS);
        assert_eq!((frames.frames(), warnings.len()), (2, 0));
        let second = frames.read(&file, 1).unwrap();
        assert_eq!(second.numbers("x").unwrap(), [21.104, 22.639, 2.0]);
        assert_eq!(second.numbers("id").unwrap(), [1.0, 3.0, 100_000.0]);
        assert_eq!(second.bonds, [[0, 1], [1, 2]]);
        assert_eq!(second.cell.unwrap().edges[0].x, 10.0);
        let Some(Values::Labels { labels, names }) = second.column("element") else { panic!() };
        let elements: Vec<&str> = labels.iter().map(|label| names[*label as usize].as_str()).collect();
        assert_eq!(elements, ["N", "C", "Ca"]);
        assert_eq!(second.numbers("hetatm").unwrap(), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn frames_end_with_end_or_the_file() {
        let atom = "ATOM      1  N   MET A   1      11.104   6.134  -6.504\n";
        for (text, frames, warnings) in [
            (format!("{atom}END\n{atom}END\n"), 2, 0),
            (format!("{atom}{atom}"), 1, 0),
            (format!("MODEL 1\n{atom}ENDMDL\nMODEL 2\n{atom}"), 1, 1),
            (format!("MODEL 1\n{atom}MODEL 2\n{atom}ENDMDL\n"), 2, 0),
            (format!("MODEL 1\n{atom}ENDMDL\nEND\nREMARK\n"), 1, 0),
        ] {
            let (_, found, faults) = open(&text);
            assert_eq!((found.frames(), faults.len()), (frames, warnings), "{text}");
        }
    }

    #[test]
    fn faults_name_line_and_columns() {
        let (file, frames, _) = open("ATOM      1  N   MET A   1      11.104   6.1x4  -6.504\nATOM\nATOM\n");
        let faults = frames.read(&file, 0).unwrap_err().warning(std::path::Path::new("a"));
        let expected = "a:1:39: column `y`: found \"6.1x4\", expected a number; \
                        write a number, or `nan` if it is missing, in columns 39 to 46 (and 2 more of this kind)";
        assert_eq!(faults, expected);
    }
}
