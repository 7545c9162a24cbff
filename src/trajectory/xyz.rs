//! XYZ and extended XYZ: a count, a comment, and a row for each particle; then the next frame.
//!
//! Plain rows are an element or a type number, then x, y and z; columns after them are named by their index, counted from 0, and dropped
//! if not all rows have them. In extended XYZ, the comment holds the columns (`Properties`), the cell (`Lattice`, `Origin`, `pbc`) and the
//! time.

use super::comment::{Comment, Properties};
use super::data_file::DataFile;
use super::element::normalize_elements;
use super::error::{DataPlace, Faults, quote};
use super::frame_reader::{FileEnd, FrameReader};
use super::frame_span::{FrameSpan, FrameSpans, NextFrame};
use super::snapshot::Snapshot;
use super::table::{self, ColumnForm, ColumnKind, Table, TableForm};
use super::text::{LineCursor, Separator, parse_whole, without_return};

/// The frames of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct XyzFrames {
    spans: FrameSpans,
}

impl FrameReader for XyzFrames {
    fn index(&mut self, file: &DataFile, end: FileEnd) -> Result<Vec<Faults>, Faults> {
        let empty = || {
            let remedy = "write the number of particles into line 1";
            Faults::one(DataPlace::Whole, "the file has no frames", remedy)
        };
        self.spans.extend(file, end, empty, next_frame)
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

/// Finds the next frame.
fn next_frame(
    cursor: &mut LineCursor<'_>,
    end: FileEnd,
    before: Option<&FrameSpan>,
) -> Result<NextFrame, Faults> {
    let (start, line, count) = loop {
        let (start, line) = (cursor.position(), cursor.line_number());
        let Some(text) = cursor.next_line()? else { return Ok(NextFrame::End) };
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text).trim_ascii();
        // Blank lines may follow the last frame, or stand between frames.
        if text.is_empty() {
            continue;
        }
        let number = text.split(u8::is_ascii_whitespace).next().and_then(parse_whole::<u64>);
        let Some(count) = number else {
            let cause = format!("found {}, expected the number of particles", quote(text));
            let remedy = match before {
                Some(before) => format!(
                    "check the number of particles in line {}: the frame there ends before this line",
                    before.line
                ),
                None => {
                    "write the number of particles into line 1, a comment into line 2, and then the particles"
                        .to_owned()
                }
            };
            if cursor.is_at_end() && before.is_some() {
                return Ok(NextFrame::Truncated(Faults::line(line, cause, remedy)));
            }
            return Err(Faults::line(line, cause, remedy));
        };
        break (start, line, count);
    };
    let lines = cursor.skip_lines(count.saturating_add(1))?;
    let span = FrameSpan { start, end: cursor.position(), line };
    let truncated = |found: u64| {
        let cause = format!("the frame is truncated: it has {found} of {count} particles");
        let remedy = "complete it, or correct the number of particles";
        Ok(NextFrame::Truncated(Faults::line(line, cause, remedy)))
    };
    if lines <= count {
        return truncated(lines.saturating_sub(1));
    }
    if cursor.is_at_end() && !cursor.ends_with_line_end()? && !is_last_row_whole(cursor, &span, count, end)? {
        return truncated(count.saturating_sub(1));
    }
    Ok(NextFrame::Found(span))
}

/// Returns `true` if the last row of a frame has as many fields as the frame needs; the file ends after it, without a line end.
fn is_last_row_whole(
    cursor: &LineCursor<'_>,
    span: &FrameSpan,
    count: u64,
    end: FileEnd,
) -> Result<bool, Faults> {
    if end == FileEnd::Growing {
        return Ok(false);
    }
    let bytes = cursor.file().read(span.start..span.end)?;
    let comment = bytes.split(|byte| *byte == b'\n').nth(1).unwrap_or_default();
    let properties = Comment::new(comment).properties(span.line + 1).ok().flatten();
    let needed = properties.map_or(4, |properties| properties.columns.len());
    let last = bytes.rsplit(|byte| *byte == b'\n').next().unwrap_or_default();
    Ok(count == 0 || Separator::Blanks.fields(last).count() >= needed)
}

/// Reads a frame from its bytes.
fn read_frame(bytes: &[u8], line: u64) -> Result<Snapshot, Faults> {
    let (_, rest) = split_line(bytes);
    let (comment, rows) = split_line(rest);
    let comment_line = line + 1;
    let comment = Comment::new(comment);
    let (mut columns, named) = match comment.properties(comment_line)? {
        Some(Properties { columns }) => (columns, true),
        None => (plain_columns(split_line(rows).0), false),
    };
    if !named && !rows.is_empty() && columns.len() < 4 {
        columns = plain_columns(b"");
    }
    let parse = |columns: &[ColumnForm]| -> Result<Table, Faults> {
        let form =
            TableForm { separator: Separator::Blanks, columns, rejects_more: false, skips_comments: false };
        table::parse(rows, line + 2, &form)
    };
    let table = match parse(&columns) {
        // Other rows may be shorter, or hold other things after the position.
        Err(_) if !named && columns.len() > 4 => parse(&columns[..4])?,
        result => result?,
    };
    let mut snapshot = Snapshot { count: table.rows, columns: table.columns, ..Snapshot::default() };
    normalize_elements(&mut snapshot);
    snapshot.cell = comment.cell(comment_line)?;
    snapshot.time = comment.time();
    Ok(snapshot)
}

/// Splits a text after its first line.
fn split_line(bytes: &[u8]) -> (&[u8], &[u8]) {
    let end = memchr::memchr(b'\n', bytes);
    let (line, rest) = end.map_or((bytes, &[][..]), |end| (&bytes[..end], &bytes[end + 1..]));
    (without_return(line), rest)
}

/// Returns the columns of plain XYZ from the first row.
fn plain_columns(row: &[u8]) -> Vec<ColumnForm> {
    let mut fields = Separator::Blanks.fields(row).map(|field| ColumnKind::of_field(field.text));
    let mut columns = vec![match fields.next() {
        Some(ColumnKind::Numbers) => ColumnForm::new("type", ColumnKind::Numbers),
        _ => ColumnForm::new("element", ColumnKind::Labels),
    }];
    columns.extend(["x", "y", "z"].map(|name| ColumnForm::new(name, ColumnKind::Numbers)));
    columns.extend(
        fields.skip(3).zip(4..).map(|(kind, index): (_, usize)| ColumnForm::new(index.to_string(), kind)),
    );
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::Values;

    fn open(text: &str, end: FileEnd) -> Result<(DataFile, XyzFrames, Vec<Faults>), Faults> {
        let file = DataFile::memory(text.as_bytes().to_vec());
        let mut frames = XyzFrames::default();
        let warnings = frames.index(&file, end)?;
        Ok((file, frames, warnings))
    }

    fn read(text: &str) -> Result<Snapshot, Faults> {
        let (file, frames, _) = open(text, FileEnd::Final)?;
        frames.read(&file, 0)
    }

    fn message(faults: &Faults) -> String {
        faults.warning(std::path::Path::new("a.xyz"))
    }

    #[test]
    fn plain_rows_have_elements_or_types() {
        let elements =
            read("\u{feff} 3 \r\nF and CL, time = 2\r\nF 1 2 3\r\nCL\t4 5 6.5D-1\r\n NA 7 8 -nan").unwrap();
        let names = ["F", "Cl", "Na"].map(str::to_owned).to_vec();
        assert_eq!(elements.column("element"), Some(&Values::Labels { labels: vec![0, 1, 2], names }));
        assert_eq!(elements.numbers("z").unwrap()[..2], [3.0, 0.65]);
        assert!(elements.numbers("z").unwrap()[2].is_nan());
        assert_eq!(elements.time, Some(2.0));
        let types = read("2\n\n1 1 2 3 9 a\n2 4 5 6 8 b\n\n\n").unwrap();
        assert_eq!(types.numbers("type").unwrap(), [1.0, 2.0]);
        assert_eq!(types.numbers("4").unwrap(), [9.0, 8.0]);
        // Not all rows have the fifth column.
        assert_eq!(read("2\n\nH 1 2 3 9\nH 4 5 6\n").unwrap().columns.len(), 4);
        assert_eq!(read("0\nnothing\n").unwrap().count, 0);
    }

    #[test]
    fn extended_rows_have_the_named_columns() {
        let text = "2\nLattice=\"2 0 0 0 2 0 0 0 2\" Properties=id:I:1:species:S:1:pos:R:3:forces:R:3:fixed:L:1 Time=0.5\n\
                    7 O 0 0 0 1 2 3 T\n8 H 1 1 1 4 5 6 F\n";
        let snapshot = read(text).unwrap();
        let names: Vec<&str> = snapshot.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["id", "element", "x", "y", "z", "forces.x", "forces.y", "forces.z", "fixed"]);
        assert_eq!(snapshot.numbers("fixed").unwrap(), [1.0, 0.0]);
        assert_eq!((snapshot.cell.is_some(), snapshot.time), (true, Some(0.5)));
    }

    #[test]
    fn frames_are_found_up_to_the_last_whole_one() {
        let frame = "1\n\nH 1 2 3\n";
        for (rest, warnings) in [
            ("", 0),
            ("\n\n", 0),
            ("2\n\nH 1 2 3\n", 1),
            ("1\n\nH 1", 1),
            ("1\n", 1),
            ("1", 1),
            ("1\n\nH 1 2 3", 0),
        ] {
            let (_, frames, found) = open(&format!("{frame}{frame}{rest}"), FileEnd::Final).unwrap();
            let expected = 2 + usize::from(rest.ends_with("3") && warnings == 0);
            assert_eq!((frames.frames(), found.len()), (expected, warnings), "{rest:?}");
        }
        let (_, frames, warnings) = open(&format!("{frame}1\n\nH 1 2 3"), FileEnd::Growing).unwrap();
        assert_eq!((frames.frames(), warnings.len()), (1, 1));
        let faults = open("5\n\nH 1 2 3\n", FileEnd::Final).err().unwrap();
        assert_eq!(
            message(&faults),
            "a.xyz:1: the frame is truncated: it has 1 of 5 particles; complete it, or correct the number of particles"
        );
        let faults = open("1\n\nH 1 2 3\nH 4 5 6\n1\n\nH 1 2 3\n", FileEnd::Final).err().unwrap();
        assert!(message(&faults).starts_with("a.xyz:4: found \"H 4 5 6\", expected the number of particles"));
        let faults = open("18446744073709551615\n\nH 1 2 3\n", FileEnd::Final).err().unwrap();
        assert!(message(&faults).contains("truncated"));
    }

    #[test]
    fn faults_name_line_and_column() {
        let faults = read("3\n\nH 1 2 3\nH 4 five 6\nH 7 8\n").unwrap_err();
        let faults =
            crate::trajectory::TrajectoryError::new(std::path::Path::new("a.xyz"), faults).to_string();
        assert_eq!(
            faults,
            "a.xyz:4:5: column `y`: found \"five\", expected a number; write a number, or `nan` if it is missing\n\
             a.xyz:5: the row ends before column `z`: it has 3 of 4 fields; complete the row, or remove it"
        );
    }
}
