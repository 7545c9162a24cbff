//! Text dumps of LAMMPS: sections that begin with `ITEM:`, then the next frame.
//!
//! Coordinates are the first complete set of `x y z`, `xu yu zu`, `xs ys zs` and `xsu ysu zsu`; scaled ones are multiplied by the box.
//! Wrapped coordinates stay wrapped: image flags are the columns `ix`, `iy` and `iz`. The time is that of the section TIME, or the
//! timestep.

use glam::DVec3;

use super::data_file::DataFile;
use super::element::normalize_elements;
use super::error::{DataPlace, Faults, quote};
use super::frame_reader::{FileEnd, FrameReader};
use super::frame_span::{FrameSpan, FrameSpans, NextFrame};
use super::snapshot::{Cell, Snapshot, Values};
use super::table::{self, ColumnForm, ColumnKind, TableForm, not_a_number};
use super::text::{LineCursor, Separator, label, parse_number, parse_whole, without_return};

/// The frames of a dump.
#[derive(Clone, Debug, Default)]
pub(super) struct DumpFrames {
    spans: FrameSpans,
}

/// The section that starts a frame.
const FIRST: &[u8] = b"ITEM: TIMESTEP";
/// Sections that may stand before the first of a frame.
const BEFORE: [&[u8]; 2] = [b"ITEM: UNITS", b"ITEM: TIME"];

impl FrameReader for DumpFrames {
    fn index(&mut self, file: &DataFile, end: FileEnd) -> Result<Vec<Faults>, Faults> {
        let empty = || {
            let remedy = "write it with LAMMPS's `dump custom`, or name its format";
            Faults::one(DataPlace::Whole, "the file has no frames (`ITEM: TIMESTEP`)", remedy)
        };
        self.spans.extend(file, end, empty, |cursor, end, _| next_frame(cursor, end))
    }

    fn frames(&self) -> usize {
        self.spans.list.len()
    }

    fn extent(&self) -> (usize, u64) {
        self.spans.extent()
    }

    fn read(&self, file: &DataFile, frame: usize) -> Result<Snapshot, Faults> {
        let span = self.spans.list[frame];
        read_frame(&file.read(span.start..span.end)?, span.line)
    }
}

/// Returns `true` for the section that holds the particles, or the entries of `dump local`.
fn is_table(header: &[u8]) -> bool {
    header.starts_with(b"ITEM: ATOMS") || header.starts_with(b"ITEM: ENTRIES")
}

/// Finds the next frame: its sections up to the particles, of which it skips as many lines as are stated.
fn next_frame(cursor: &mut LineCursor<'_>, end: FileEnd) -> Result<NextFrame, Faults> {
    let mut span: Option<FrameSpan> = None;
    let mut count = None;
    loop {
        let (start, line) = (cursor.position(), cursor.line_number());
        let truncated = |span: FrameSpan| {
            let cause = "the frame is truncated: the file ends before its particles do".to_owned();
            Ok(NextFrame::Truncated(Faults::line(span.line, cause, "complete it, or remove it")))
        };
        let Some(text) = cursor.next_line()? else {
            return span.map_or(Ok(NextFrame::End), truncated);
        };
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        if span.is_none() {
            if text.trim_ascii().is_empty() {
                continue;
            }
            if !text.starts_with(FIRST) && !BEFORE.iter().any(|section| text.starts_with(section)) {
                let cause = format!("found {}, expected `ITEM: TIMESTEP`", quote(text));
                let remedy = "check the number of particles of the frame before, or remove the line";
                let faults = Faults::line(line, cause, remedy);
                return if cursor.is_at_end() { Ok(NextFrame::Truncated(faults)) } else { Err(faults) };
            }
        }
        let span = span.get_or_insert(FrameSpan { start, end: start, line });
        if text.starts_with(b"ITEM: NUMBER OF") {
            let number = cursor.next_line()?.map(<[u8]>::trim_ascii);
            let Some(number) = number else { return truncated(*span) };
            let Some(number) = parse_whole::<u64>(number) else {
                let cause = format!("the number of particles is {}", quote(number));
                let faults = Faults::line(line + 1, cause, "write a whole number");
                return if cursor.is_at_end() { Ok(NextFrame::Truncated(faults)) } else { Err(faults) };
            };
            count = Some(number);
        } else if is_table(text) {
            let Some(count) = count else {
                let remedy = "write `ITEM: NUMBER OF ATOMS` before the particles";
                return Err(Faults::line(line, "the frame has no number of particles", remedy));
            };
            let lines = cursor.skip_lines(count)?;
            span.end = cursor.position();
            let is_cut = count > 0 && cursor.is_at_end() && !cursor.ends_with_line_end()?;
            if lines < count || is_cut && (end == FileEnd::Growing || !is_last_row_whole(cursor, span)?) {
                return truncated(*span);
            }
            return Ok(NextFrame::Found(*span));
        } else if text.starts_with(FIRST) && start > span.start && count.is_some() {
            let cause = "a frame starts before the particles of the last one";
            return Err(Faults::line(line, cause, "write `ITEM: ATOMS` and the particles before it"));
        }
    }
}

/// Returns `true` if the last row has as many fields as the header; the file ends after it, without a line end.
fn is_last_row_whole(cursor: &LineCursor<'_>, span: &FrameSpan) -> Result<bool, Faults> {
    let bytes = cursor.file().read(span.start..span.end)?;
    let fields = |line: &[u8]| Separator::Blanks.fields(line).count();
    let header = bytes.split(|byte| *byte == b'\n').find(|line| is_table(line));
    let last = bytes.rsplit(|byte| *byte == b'\n').next().map_or(0, fields);
    Ok(header.is_none_or(|header| last + 2 >= fields(header)))
}

/// The lines of a frame before its particles.
struct FrameLines<'a> {
    rest: &'a [u8],
    /// Number of the next line, counted from 1.
    line: u64,
}

impl<'a> FrameLines<'a> {
    fn next(&mut self) -> &'a [u8] {
        let end = memchr::memchr(b'\n', self.rest);
        let (line, rest) = end.map_or((self.rest, &[][..]), |end| (&self.rest[..end], &self.rest[end + 1..]));
        self.rest = rest;
        self.line += 1;
        without_return(line)
    }
}

/// Reads a frame from its bytes.
fn read_frame(bytes: &[u8], line: u64) -> Result<Snapshot, Faults> {
    let mut lines = FrameLines { rest: bytes, line };
    let mut snapshot = Snapshot::default();
    let mut timestep = None;
    while !lines.rest.is_empty() {
        let number = lines.line;
        let header = lines.next();
        if let Some(bounds) = header.strip_prefix(b"ITEM: BOX BOUNDS") {
            snapshot.cell = Some(read_box(bounds, &mut lines)?);
        } else if header.starts_with(FIRST) {
            timestep = parse_number(lines.next().trim_ascii());
        } else if header.starts_with(b"ITEM: TIME") {
            snapshot.time = parse_number(lines.next().trim_ascii());
        } else if is_table(header) {
            let columns = table_columns(header, lines.rest);
            let form = TableForm {
                separator: Separator::Blanks,
                columns: &columns,
                rejects_more: false,
                skips_comments: false,
            };
            if columns.is_empty() {
                let remedy = "name them after `ITEM: ATOMS`, as in `ITEM: ATOMS id type x y z`";
                return Err(Faults::line(number, "the columns have no names", remedy));
            }
            let table = table::parse(lines.rest, lines.line, &form)?;
            (snapshot.count, snapshot.columns) = (table.rows, table.columns);
            lines.rest = &[];
        }
    }
    snapshot.time = snapshot.time.or(timestep);
    name_coordinates(&mut snapshot, line)?;
    normalize_elements(&mut snapshot);
    Ok(snapshot)
}

/// Returns the columns of a table from its header and its first row.
fn table_columns(header: &[u8], rows: &[u8]) -> Vec<ColumnForm> {
    let names = Separator::Blanks.fields(header).skip(2).map(|field| label(field.text));
    let row = without_return(&rows[..memchr::memchr(b'\n', rows).unwrap_or(rows.len())]);
    let mut fields = Separator::Blanks.fields(row);
    names
        .map(|name| {
            ColumnForm::new(
                name,
                fields.next().map_or(ColumnKind::Numbers, |field| ColumnKind::of_field(field.text)),
            )
        })
        .collect()
}

/// Reads a box: bounds, with tilts if it is triclinic, or three edges with the origin (`abc origin`).
fn read_box(header: &[u8], lines: &mut FrameLines<'_>) -> Result<Cell, Faults> {
    let first = lines.line;
    let words: Vec<&[u8]> = Separator::Blanks.fields(header).map(|field| field.text).collect();
    let is_general = words.first() == Some(&&b"abc"[..]);
    let is_triclinic = words.first() == Some(&&b"xy"[..]);
    let mut rows = [[0.0; 4]; 3];
    for row in &mut rows {
        let number = lines.line;
        let text = lines.next();
        let mut fields = Separator::Blanks.fields(text);
        let needed = if is_general { 4 } else { 2 + usize::from(is_triclinic) };
        for (index, value) in row.iter_mut().take(needed).enumerate() {
            let Some(field) = fields.next() else {
                let cause = format!("the bounds of the box have {index} of {needed} numbers");
                return Err(Faults::line(number, cause, "complete the line"));
            };
            *value = parse_number(field.text).ok_or_else(|| {
                let (cause, remedy) = not_a_number("`BOX BOUNDS`", field.text);
                Faults::one(DataPlace::Line { line: number, byte: field.start as u64 + 1 }, cause, remedy)
            })?;
        }
    }
    // Each boundary is two letters, one for each side: periodic, fixed, shrink-wrapped, or that with a minimum. Old files have none.
    let is_boundary = |word: &[u8]| word.len() == 2 && word.iter().all(|letter| b"pfsm".contains(letter));
    let boundaries: Vec<bool> =
        words.iter().filter(|word| is_boundary(word)).map(|word| word[0] == b'p').collect();
    let periodic = boundaries.try_into().unwrap_or([true; 3]);
    let cell = if is_general {
        let [a, b, c] = rows.map(|row| DVec3::new(row[0], row[1], row[2]));
        Cell { origin: DVec3::new(rows[0][3], rows[1][3], rows[2][3]), edges: [a, b, c], periodic }
    } else {
        let [[x_low, x_high, xy, _], [y_low, y_high, xz, _], [z_low, z_high, yz, _]] = rows;
        // The file has the bounds of the tilted box (LAMMPS manual, "Triclinic simulation boxes").
        let x_low = x_low - 0.0_f64.min(xy).min(xz).min(xy + xz);
        let x_high = x_high - 0.0_f64.max(xy).max(xz).max(xy + xz);
        let (y_low, y_high) = (y_low - yz.min(0.0), y_high - yz.max(0.0));
        let edges = [
            DVec3::new(x_high - x_low, 0.0, 0.0),
            DVec3::new(xy, y_high - y_low, 0.0),
            DVec3::new(xz, yz, z_high - z_low),
        ];
        Cell { origin: DVec3::new(x_low, y_low, z_low), edges, periodic }
    };
    if cell.is_valid() {
        return Ok(cell);
    }
    let remedy = "write finite bounds that differ in each periodic direction";
    Err(Faults::line(first, "the box spans no volume", remedy))
}

/// Turns the coordinates of a dump into `x`, `y` and `z`.
fn name_coordinates(snapshot: &mut Snapshot, line: u64) -> Result<(), Faults> {
    let has = |snapshot: &Snapshot, suffix: &str| {
        ["x", "y", "z"].iter().all(|axis| snapshot.numbers(&format!("{axis}{suffix}")).is_ok())
    };
    let Some(suffix) = ["", "u", "s", "su"].into_iter().find(|suffix| has(snapshot, suffix)) else {
        return Ok(());
    };
    if suffix.is_empty() {
        return Ok(());
    }
    if suffix.starts_with('s') {
        let Some(cell) = snapshot.cell else {
            let remedy = "write `ITEM: BOX BOUNDS`, or coordinates that are not scaled";
            return Err(Faults::line(line, "the coordinates are scaled, and the frame has no box", remedy));
        };
        scale(snapshot, suffix, &cell);
    }
    for column in &mut snapshot.columns {
        if let Some(axis) = ["x", "y", "z"].into_iter().find(|axis| column.name == format!("{axis}{suffix}"))
        {
            axis.clone_into(&mut column.name);
        }
    }
    Ok(())
}

/// Multiplies scaled coordinates by the box.
fn scale(snapshot: &mut Snapshot, suffix: &str, cell: &Cell) {
    let mut axes = ["x", "y", "z"].map(|axis| {
        let name = format!("{axis}{suffix}");
        let column = snapshot.columns.iter_mut().find(|column| column.name == name);
        match column.map(|column| &mut column.values) {
            Some(Values::Numbers(numbers)) => std::mem::take(numbers),
            _ => Vec::new(),
        }
    });
    let [x, y, z] = &mut axes;
    for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
        [*x, *y, *z] = cell.position(DVec3::new(*x, *y, *z)).to_array();
    }
    for (axis, values) in ["x", "y", "z"].into_iter().zip(axes) {
        let name = format!("{axis}{suffix}");
        if let Some(column) = snapshot.columns.iter_mut().find(|column| column.name == name) {
            column.values = Values::Numbers(values);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Snapshot, Faults> {
        let file = DataFile::memory(text.as_bytes().to_vec());
        let mut frames = DumpFrames::default();
        frames.index(&file, FileEnd::Final)?;
        frames.read(&file, frames.frames() - 1)
    }

    fn dump(bounds: &str, table: &str) -> String {
        let count = table.lines().count() - 1;
        format!(
            "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n{count}\nITEM: BOX BOUNDS {bounds}\nITEM: ATOMS {table}\n"
        )
    }

    #[test]
    fn coordinates_are_cartesian() {
        let bounds = "pp pp ff\n-1 3\n0 2\n0 1";
        let scaled =
            read(&dump(bounds, "id type xs ys zs ix iy iz\n3 1 0.5 0.25 1 0 -1 2\n1 2 0 0 0 0 0 0")).unwrap();
        assert_eq!(scaled.positions().unwrap(), [&[1.0, -1.0][..], &[0.5, 0.0], &[1.0, 0.0]]);
        assert_eq!(scaled.numbers("iy").unwrap(), [-1.0, 0.0]);
        assert_eq!((scaled.time, scaled.cell.unwrap().periodic), (Some(100.0), [true, true, false]));
        let unwrapped = read(&dump(bounds, "element xu yu zu\nNA 5 6 7")).unwrap();
        assert_eq!(unwrapped.positions().unwrap(), [&[5.0][..], &[6.0], &[7.0]]);
        let both = read(&dump(bounds, "xu x yu y zu z\n5 1 6 2 7 3")).unwrap();
        assert_eq!(both.positions().unwrap(), [&[1.0][..], &[2.0], &[3.0]]);
    }

    #[test]
    fn boxes_are_tilted() {
        // The box of the LAMMPS manual: bounds that hold the tilted edges.
        let tilted =
            read(&dump("xy xz yz pp pp pp\n-1 5 1\n0 4 -2\n0 3 0.5", "id xsu ysu zsu\n1 1 1 1")).unwrap();
        let cell = tilted.cell.unwrap();
        assert_eq!(cell.origin, DVec3::new(1.0, 0.0, 0.0));
        assert_eq!(
            cell.edges,
            [DVec3::new(3.0, 0.0, 0.0), DVec3::new(1.0, 3.5, 0.0), DVec3::new(-2.0, 0.5, 3.0)]
        );
        assert_eq!(tilted.positions().unwrap(), [&[3.0][..], &[4.0], &[3.0]]);
        let old = read(&dump("xy xz yz\n-1 5 1\n0 4 -2\n0 3 0.5", "x y z\n1 2 3")).unwrap();
        assert_eq!(old.cell, tilted.cell);
        let general = "abc origin pp pp pp\n1 2 0 7\n0 3 1 8\n1 0 2 9";
        let general = read(&dump(general, "x y z\n1 2 3")).unwrap().cell.unwrap();
        assert_eq!(general.origin, DVec3::new(7.0, 8.0, 9.0));
        assert_eq!(general.edges[1], DVec3::new(0.0, 3.0, 1.0));
    }

    #[test]
    fn faults_have_places() {
        for (text, message) in [
            (dump("pp pp pp\n0 1\n0 x\n0 1", "x y z\n1 2 3"), "a:7:3: column `BOX BOUNDS`: found \"x\""),
            (dump("pp pp pp\n0 1\n0 0\n0 1", "x y z\n1 2 3"), "a:6: the box spans no volume"),
            (dump("pp pp pp\n0 1\n0 1\n0 1", "x y z\n1 2"), "a:10: the row ends before column `z`"),
            (
                "ITEM: TIMESTEP\n1\nITEM: NUMBER OF ATOMS\n9\nITEM: ATOMS x y z\n1 2 3\n".to_owned(),
                "a:1: the frame is truncated",
            ),
            ("ITEM: TIMESTEP\n1\nITEM: ATOMS x y z\n1 2 3\n".to_owned(), "a:3: the frame has no number"),
            (
                "ITEM: TIMESTEP\n1\nITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS xs ys zs\n1 2 3\n".to_owned(),
                "a:1: the coordinates are scaled",
            ),
            ("H 1 2 3\n4\n".to_owned(), "a:1: found \"H 1 2 3\", expected `ITEM: TIMESTEP`"),
            (String::new(), "a: the file has no frames"),
        ] {
            let faults = read(&text).unwrap_err().warning(std::path::Path::new("a"));
            assert!(faults.starts_with(message), "{faults}\n{message}");
        }
    }
}
