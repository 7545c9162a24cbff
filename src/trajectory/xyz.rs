//! XYZ and extended XYZ: a count, a comment, and a row for each particle; then the next frame.
//!
//! Plain rows are an element or a type number, then x, y and z; columns after them are named by their index, counted from 0, and dropped
//! if not all rows have them. In extended XYZ, the comment holds the columns (`Properties`), the cell (`Lattice`, `Origin`, `pbc`) and the
//! time.

use super::comment::{Comment, Properties};
use super::data_file::DataFile;
use super::element::normalize_elements;
use super::error::{DataPlace, Faults, quote};
use super::frame_span::{FrameSpan, FrameSpans, NextFrame};
use super::reader::{FileEnd, FrameReader};
use super::snapshot::{Snapshot, Values};
use super::table::{self, ColumnForm, ColumnKind, Table, TableForm};
use super::text::{LineCursor, Separator, parse_number, parse_whole, without_return};

/// The frames of a file.
#[derive(Debug, Default)]
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

/// Returns `true` if the last row of a frame has as many fields as the first one; the file ends after it, without a line end.
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
    let fields = |line: &[u8]| Separator::Blanks.fields(line).count();
    let first = bytes.split(|byte| *byte == b'\n').nth(2).map_or(0, fields);
    let last = bytes.rsplit(|byte| *byte == b'\n').next().map_or(0, fields);
    Ok(count <= 1 || last >= first)
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
    for column in &mut snapshot.columns {
        if let ("element", Values::Labels { names, .. }) = (column.name.as_str(), &mut column.values) {
            normalize_elements(names);
        }
    }
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
    let kind =
        |text: &[u8]| if parse_number(text).is_some() { ColumnKind::Numbers } else { ColumnKind::Labels };
    let mut fields = Separator::Blanks.fields(row).map(|field| kind(field.text));
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
