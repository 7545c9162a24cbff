//! Rows of text to columns, on all threads.
//!
//! ```text
//! bytes -> chunks at line ends -> lines of each chunk are counted -> columns of that length, a slice for each chunk
//!       -> each chunk is parsed into its slices -> labels get common numbers, gaps of blank lines are closed
//! ```

use std::collections::HashMap;

use rayon::iter::{IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};

use super::data_file::zeros;
use super::error::{DataPlace, FaultKind, Faults, quote};
use super::snapshot::{Column, Values};
use super::text::{
    Separator, TextField, is_blank, is_missing, label, parse_logical, parse_number, parse_value, unquote,
    without_return,
};

/// Bytes of a chunk: small enough that its bytes and columns stay in the cache, and that files of some MiB occupy all threads.
const CHUNK: usize = 256 << 10;

/// The form of a table.
#[derive(Clone, Debug)]
pub(super) struct TableForm<'a> {
    pub separator: Separator,
    pub columns: &'a [ColumnForm],
    /// Rejects fields after the last column.
    pub rejects_more: bool,
    /// Skips lines that are blank or begin with `#`.
    pub skips_comments: bool,
}

/// The form of a column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ColumnForm {
    pub name: String,
    pub kind: ColumnKind,
}

/// The kind of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ColumnKind {
    Numbers,
    Labels,
}

impl ColumnForm {
    pub(super) fn new(name: impl Into<String>, kind: ColumnKind) -> Self {
        Self { name: name.into(), kind }
    }
}

/// The rows of a table.
#[derive(Debug)]
pub(super) struct Table {
    pub rows: usize,
    pub columns: Vec<Column>,
}

/// The part of a column that a chunk fills.
enum ColumnSlice<'a> {
    Numbers(&'a mut [f64]),
    Labels { labels: &'a mut [u32], names: Dictionary },
}

/// Rows of whole lines.
struct Chunk<'a> {
    bytes: &'a [u8],
    /// Number of the first line, counted from 1.
    line: u64,
    /// Length of the slices.
    capacity: usize,
    columns: Vec<ColumnSlice<'a>>,
}

/// The result of a chunk.
struct ParsedChunk {
    rows: usize,
    /// Length of the slices.
    capacity: usize,
    /// Names of each column of labels.
    names: Vec<Vec<String>>,
    faults: Faults,
}

/// Numbers for labels, in the order of their first use.
#[derive(Default)]
pub(super) struct Dictionary {
    numbers: HashMap<Vec<u8>, u32>,
    names: Vec<String>,
    last: usize,
}

impl Dictionary {
    /// Returns the number of a label.
    pub(super) fn number(&mut self, text: &[u8]) -> u32 {
        // Rows of one kind often follow one another.
        if self.names.get(self.last).is_some_and(|last| last.as_bytes() == text) {
            return u32::try_from(self.last).unwrap_or(u32::MAX);
        }
        let number = self.numbers.get(text).copied().unwrap_or_else(|| {
            let number = u32::try_from(self.names.len()).unwrap_or(u32::MAX);
            self.numbers.insert(text.to_owned(), number);
            self.names.push(label(text));
            number
        });
        self.last = number as usize;
        number
    }

    /// Returns the names.
    pub(super) fn into_names(self) -> Vec<String> {
        self.names
    }
}

/// Reads the rows of a text whose first line has this number, counted from 1.
pub(super) fn parse(bytes: &[u8], line: u64, form: &TableForm<'_>) -> Result<Table, Faults> {
    let pieces = pieces(bytes);
    let lines: Vec<usize> = pieces.par_iter().map(|piece| count_lines(piece)).collect();
    // A row has at least a byte for each column. Many blank lines after a long header need no memory.
    let capacity =
        |(lines, piece): (&usize, &&[u8])| (*lines).min(piece.len() / form.columns.len().max(1) + 1);
    let capacities: Vec<usize> = lines.iter().zip(&pieces).map(capacity).collect();
    let total = capacities.iter().sum();
    let mut columns = Vec::with_capacity(form.columns.len());
    for column in form.columns {
        let values = match column.kind {
            ColumnKind::Numbers => Values::Numbers(zeros(total)?),
            ColumnKind::Labels => Values::Labels { labels: zeros(total)?, names: Vec::new() },
        };
        columns.push(Column { name: column.name.clone(), values });
    }

    let chunks = split(&pieces, &lines, &capacities, line, &mut columns);
    let parsed: Vec<ParsedChunk> = chunks.into_par_iter().map(|chunk| parse_chunk(chunk, form)).collect();
    let mut faults = Faults::default();
    for chunk in &parsed {
        faults.append(chunk.faults.clone());
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let rows = parsed.iter().map(|chunk| chunk.rows).sum();
    join_labels(&parsed, &mut columns);
    if rows < total {
        close_gaps(&parsed, rows, &mut columns);
    }
    Ok(Table { rows, columns })
}

/// Splits a text at line ends.
fn pieces(mut bytes: &[u8]) -> Vec<&[u8]> {
    let mut pieces = Vec::new();
    while !bytes.is_empty() {
        let end = bytes.get(CHUNK..).and_then(|rest| memchr::memchr(b'\n', rest));
        let (piece, rest) = bytes.split_at(end.map_or(bytes.len(), |end| CHUNK + end + 1));
        pieces.push(piece);
        bytes = rest;
    }
    pieces
}

fn count_lines(bytes: &[u8]) -> usize {
    memchr::memchr_iter(b'\n', bytes).count() + usize::from(bytes.last().is_some_and(|last| *last != b'\n'))
}

/// Gives each chunk its slices of the columns.
fn split<'a>(
    pieces: &[&'a [u8]],
    lines: &[usize],
    capacities: &[usize],
    first: u64,
    columns: &'a mut [Column],
) -> Vec<Chunk<'a>> {
    let mut line = first;
    let mut chunks = Vec::with_capacity(pieces.len());
    for ((piece, lines), capacity) in pieces.iter().zip(lines).zip(capacities) {
        chunks.push(Chunk {
            bytes: piece,
            line,
            capacity: *capacity,
            columns: Vec::with_capacity(columns.len()),
        });
        line += *lines as u64;
    }
    for column in columns {
        match &mut column.values {
            Values::Numbers(numbers) => {
                let mut rest = &mut numbers[..];
                for chunk in &mut chunks {
                    let (slice, after) = rest.split_at_mut(chunk.capacity);
                    chunk.columns.push(ColumnSlice::Numbers(slice));
                    rest = after;
                }
            }
            Values::Labels { labels, .. } => {
                let mut rest = &mut labels[..];
                for chunk in &mut chunks {
                    let (slice, after) = rest.split_at_mut(chunk.capacity);
                    chunk.columns.push(ColumnSlice::Labels { labels: slice, names: Dictionary::default() });
                    rest = after;
                }
            }
        }
    }
    chunks
}

fn parse_chunk(mut chunk: Chunk<'_>, form: &TableForm<'_>) -> ParsedChunk {
    let mut faults = Faults::default();
    let mut rest = chunk.bytes;
    let (mut rows, mut lines) = (0, 0_u64);
    while !rest.is_empty() {
        let end = memchr::memchr(b'\n', rest);
        let line = without_return(&rest[..end.unwrap_or(rest.len())]);
        rest = end.map_or(&[], |end| &rest[end + 1..]);
        let number = chunk.line + lines;
        lines += 1;
        if form.skips_comments && is_comment(line) {
            continue;
        }
        if rows == chunk.capacity {
            // More rows than bytes allow: one of them was short.
            break;
        }
        parse_row(line, number, rows, &mut chunk.columns, form, &mut faults);
        rows += 1;
    }
    let names = chunk.columns.into_iter().filter_map(|column| match column {
        ColumnSlice::Numbers(_) => None,
        ColumnSlice::Labels { names, .. } => Some(names.into_names()),
    });
    ParsedChunk { rows, capacity: chunk.capacity, names: names.collect(), faults }
}

/// Returns `true` for lines without values.
pub(super) fn is_comment(line: &[u8]) -> bool {
    line.iter().find(|byte| !is_blank(**byte)).is_none_or(|byte| *byte == b'#')
}

/// Reads a row into the columns.
#[inline]
fn parse_row(
    line: &[u8],
    number: u64,
    row: usize,
    columns: &mut [ColumnSlice<'_>],
    form: &TableForm<'_>,
    faults: &mut Faults,
) {
    let mut position = Some(0);
    for (index, column) in columns.iter_mut().enumerate() {
        if let (ColumnSlice::Numbers(numbers), Some(start)) = (&mut *column, position)
            && let Some((value, next)) = plain_number(line, start, form.separator)
        {
            numbers[row] = value;
            position = next;
            continue;
        }
        let field = position.and_then(|start| form.separator.field(line, start));
        let Some(field) = field else {
            return short_row(number, index, form, faults);
        };
        position = field.next;
        // Quotes have a meaning only where separators are characters.
        let quoted = form.separator != Separator::Blanks && field.text.first() == Some(&b'"');
        let text = if quoted { unquote(field.text) } else { Some(field.text.into()) };
        let place = DataPlace::Line { line: number, byte: field.start as u64 + 1 };
        let Some(text) = text else {
            return faults.add(FaultKind::OpenQuote, place, || {
                let cause =
                    format!("column {}: the quotes of {} do not close", form.name(index), quote(field.text));
                (cause, "close them on the same line".to_owned())
            });
        };
        match column {
            ColumnSlice::Labels { labels, names } => labels[row] = names.number(&text),
            ColumnSlice::Numbers(numbers) => match parse_value(text.trim_ascii()) {
                Some(value) => numbers[row] = value,
                None => faults.add(FaultKind::NotANumber, place, || not_a_number(&form.name(index), &text)),
            },
        }
    }
    if form.rejects_more
        && let Some(start) = position
        && let Some(field) =
            form.separator.fields(&line[start.min(line.len())..]).find(|field| !field.text.is_empty())
    {
        let place = DataPlace::Line { line: number, byte: (start + field.start) as u64 + 1 };
        faults.add(FaultKind::LongRow, place, || {
            let columns = form.columns.len();
            let cause = format!("the row goes on with {} after {columns} columns", quote(field.text));
            (cause, "name the column in the header, or remove the field".to_owned())
        });
    }
}

/// Returns the number at a position and the position of the next field, if the field has a usual form.
#[inline]
fn plain_number(line: &[u8], start: usize, separator: Separator) -> Option<(f64, Option<usize>)> {
    let rest = line.get(start..)?;
    let blanks = rest
        .iter()
        .take_while(|byte| **byte == b' ' || **byte == b'\t' && separator == Separator::Blanks)
        .count();
    let rest = &rest[blanks..];
    let (value, length) = fast_float2::parse_partial::<f64, _>(rest).ok()?;
    let end = start + blanks + length;
    match (rest.get(length), separator) {
        (None, Separator::Blanks) => Some((value, Some(end))),
        (None, Separator::Character(_)) => Some((value, None)),
        (Some(byte), Separator::Blanks) => is_blank(*byte).then_some((value, Some(end))),
        (Some(byte), Separator::Character(separator)) => {
            (*byte == separator).then_some((value, Some(end + 1)))
        }
    }
}

#[cold]
fn short_row(number: u64, fields: usize, form: &TableForm<'_>, faults: &mut Faults) {
    faults.add(FaultKind::ShortRow, DataPlace::Line { line: number, byte: 0 }, || {
        let cause = format!(
            "the row ends before column {}: it has {fields} of {} fields",
            form.name(fields),
            form.columns.len()
        );
        (cause, "complete the row, or remove it".to_owned())
    });
}

/// Returns cause and remedy of a field that is not a number.
pub(super) fn not_a_number(column: &str, text: &[u8]) -> (String, String) {
    let cause = format!("column {column}: found {}, expected a number", quote(text));
    let digits_and = |byte: u8| {
        text.iter().all(|found| found.is_ascii_digit() || b"+-eE".contains(found) || *found == byte)
    };
    let remedy = if text.contains(&b'*') {
        "the number did not fit its field: write it with more digits"
    } else if text.contains(&b',') && digits_and(b',') {
        "write a decimal point in place of the comma"
    } else {
        "write a number, or `nan` if it is missing"
    };
    (cause, remedy.to_owned())
}

impl TableForm<'_> {
    /// Returns a column's name as text in an error.
    fn name(&self, index: usize) -> String {
        self.columns
            .get(index)
            .map_or_else(|| format!("{}", index + 1), |column| format!("`{}`", column.name))
    }
}

/// Gives the labels of all chunks common numbers.
fn join_labels(parsed: &[ParsedChunk], columns: &mut [Column]) {
    let columns = columns.iter_mut().filter_map(|column| match &mut column.values {
        Values::Numbers(_) => None,
        Values::Labels { labels, names } => Some((labels, names)),
    });
    for (index, (labels, names)) in columns.enumerate() {
        let mut joined = Dictionary::default();
        let mut start = 0;
        for chunk in parsed {
            let numbers: Vec<u32> =
                chunk.names[index].iter().map(|name| joined.number(name.as_bytes())).collect();
            let is_same = numbers.iter().zip(0..).all(|(number, same)| *number == same);
            for label in labels[start..start + chunk.rows].iter_mut().filter(|_| !is_same) {
                *label = numbers[*label as usize];
            }
            start += chunk.capacity;
        }
        *names = joined.into_names();
    }
}

/// Moves the rows of chunks together, between which lines without rows left gaps.
fn close_gaps(parsed: &[ParsedChunk], rows: usize, columns: &mut [Column]) {
    fn close<T: Copy>(values: &mut Vec<T>, parsed: &[ParsedChunk], rows: usize) {
        let (mut from, mut to) = (0, 0);
        for chunk in parsed {
            values.copy_within(from..from + chunk.rows, to);
            from += chunk.capacity;
            to += chunk.rows;
        }
        values.truncate(rows);
    }
    for column in columns {
        match &mut column.values {
            Values::Numbers(numbers) => close(numbers, parsed, rows),
            Values::Labels { labels, .. } => close(labels, parsed, rows),
        }
    }
}

/// Returns the kinds of columns from some rows: labels if most of a column's fields that are not missing are not numbers.
pub(super) fn kinds<'a>(
    columns: usize,
    rows: impl Iterator<Item = impl Iterator<Item = TextField<'a>>>,
) -> Vec<ColumnKind> {
    // The number of fields that are no numbers, less that of numbers.
    let mut excess = vec![0_i32; columns];
    for row in rows {
        for (excess, field) in excess.iter_mut().zip(row) {
            *excess += unquote(field.text).map_or(0, |text| match text.trim_ascii() {
                text if is_numeric(text) => -1,
                text if is_missing(text) => 0,
                _ => 1,
            });
        }
    }
    excess.iter().map(|excess| if *excess > 0 { ColumnKind::Labels } else { ColumnKind::Numbers }).collect()
}

/// Returns `true` for texts that are numbers, or that are meant to be.
fn is_numeric(text: &[u8]) -> bool {
    // `T` and `F` alone are more often names than logical values.
    let is_logical = text.len() > 1 && parse_logical(text).is_some();
    // Numbers with decimal commas are reported, not taken for names.
    let has_digits = text.iter().any(u8::is_ascii_digit)
        && text.iter().all(|byte| byte.is_ascii_digit() || b"+-.,eE".contains(byte));
    parse_number(text).is_some() || is_logical || has_digits
}

impl ColumnKind {
    /// Returns the kind of a column from its first field.
    pub(super) fn of_field(text: &[u8]) -> Self {
        if parse_number(text).is_some() { Self::Numbers } else { Self::Labels }
    }
}
