//! CSV, TSV, and other tables of text: one frame, a row for each particle.
//!
//! The separator is found in the first row: a tab, semicolon or comma, or else blanks. The header is the first row if it has a field that
//! is not a number, or the last comment (`#`) before the first row if it has as many fields (`numpy.savetxt`). Without a header, the
//! first three columns of numbers are `x`, `y` and `z`. Columns without a name are named by their index, counted from 0. Empty fields are
//! NaN.

use super::column_names::{header_names, names_without_header};
use super::data_file::DataFile;
use super::error::{DataPlace, Faults};
use super::frame_reader::{FileEnd, FrameReader};
use super::snapshot::Snapshot;
use super::table::{self, ColumnForm, TableForm, is_comment};
use super::text::{LineCursor, Separator, parse_number, unquote};

/// Number of rows from which the kinds of columns are found, and their bytes, where rows are long.
const SAMPLE: usize = 100;
const SAMPLE_BYTES: usize = 1 << 20;

/// A table of text.
#[derive(Clone, Debug, Default)]
pub(super) struct CsvFile {
    header: Option<TableHeader>,
    /// Position after the last row.
    end: u64,
}

/// The first lines of a table.
#[derive(Clone, Debug)]
struct TableHeader {
    separator: Separator,
    columns: Vec<ColumnForm>,
    /// Position of the first row.
    start: u64,
    /// Number of the first row's line, counted from 1.
    line: u64,
}

impl FrameReader for CsvFile {
    fn index(&mut self, file: &DataFile, end: FileEnd) -> Result<Vec<Faults>, Faults> {
        let header = read_header(file)?;
        self.end = match end {
            FileEnd::Final => file.length(),
            FileEnd::Growing => last_line_end(file)?.max(header.start),
        };
        self.header = Some(header);
        Ok(Vec::new())
    }

    fn frames(&self) -> usize {
        1
    }

    fn extent(&self) -> (usize, u64) {
        (1, self.end)
    }

    fn read(&self, file: &DataFile, _frame: usize) -> Result<Snapshot, Faults> {
        let Some(header) = &self.header else { return Ok(Snapshot::default()) };
        let bytes = file.read(header.start..self.end)?;
        let form = TableForm {
            separator: header.separator,
            columns: &header.columns,
            rejects_more: true,
            skips_comments: true,
        };
        let table = table::parse(&bytes, header.line, &form)?;
        Ok(Snapshot { count: table.rows, columns: table.columns, ..Snapshot::default() })
    }
}

/// Returns the position after the last line that has an end.
fn last_line_end(file: &DataFile) -> Result<u64, Faults> {
    const BLOCK: u64 = 1 << 16;
    let mut end = file.length();
    while end > 0 {
        let start = end.saturating_sub(BLOCK);
        if let Some(last) = memchr::memrchr(b'\n', &file.read(start..end)?) {
            return Ok(start + last as u64 + 1);
        }
        end = start;
    }
    Ok(0)
}

/// Returns the separator of a line: the one that is there most often.
fn separator(line: &[u8]) -> Separator {
    let count = |character: u8| memchr::memchr_iter(character, line).count();
    // The first of equal counts, so that commas in a text that tabs separate do not win.
    let best = [b'\t', b';', b','].into_iter().rev().max_by_key(|character| count(*character));
    best.filter(|best| count(*best) > 0).map_or(Separator::Blanks, Separator::Character)
}

/// Returns the texts of a line's fields.
fn texts(separator: Separator, line: &[u8]) -> Vec<Vec<u8>> {
    let fields = separator.fields(line);
    let mut texts: Vec<Vec<u8>> =
        fields.map(|field| unquote(field.text).unwrap_or(field.text.into()).trim_ascii().to_vec()).collect();
    // A separator after the last field starts no field.
    if texts.len() > 1 && texts.last().is_some_and(Vec::is_empty) {
        texts.pop();
    }
    texts
}

fn read_header(file: &DataFile) -> Result<TableHeader, Faults> {
    let mut cursor = LineCursor::new(file, 0, 0);
    let mut comment = None;
    let first = loop {
        let (position, line) = (cursor.position(), cursor.line_number());
        let Some(bytes) = cursor.next_line()? else {
            let remedy = "write a header and a row for each particle";
            return Err(Faults::one(DataPlace::Whole, "the file has no rows", remedy));
        };
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        if is_comment(bytes) {
            let text = bytes.trim_ascii_start();
            comment = text.strip_prefix(b"#").map(|text| text.trim_ascii_start().to_vec()).or(comment);
            continue;
        }
        if memchr::memchr(0, bytes).is_some() {
            let remedy = "name its format, or export it as text (UTF-16 files: as UTF-8)";
            return Err(Faults::line(line, "this is no text: it has zero bytes", remedy));
        }
        break (bytes.to_vec(), position, line);
    };
    let (bytes, position, line) = first;
    let separator = separator(&bytes);
    let row = texts(separator, &bytes);
    let is_numbered = is_numbered_header(&row);
    let is_header = is_numbered || row.iter().any(|text| !text.is_empty() && parse_number(text).is_none());
    let after = (cursor.position(), cursor.line_number());

    let mut sample = if is_header { Vec::new() } else { vec![bytes] };
    while sample.len() < SAMPLE
        && sample.iter().map(Vec::len).sum::<usize>() < SAMPLE_BYTES
        && let Some(line) = cursor.next_line()?
    {
        if !is_comment(line) {
            sample.push(line.to_vec());
        }
    }
    // A table of texts alone, such as names beside positions without a header, begins with a number somewhere.
    let looks_alike = is_header && has_header_of_values(&row, &sample, separator);
    let (names, (start, line)) = if is_numbered {
        (numbered_names(row.len()), after)
    } else if is_header && !looks_alike {
        (row, after)
    } else {
        let names = comment.map(|comment| texts(self::separator(&comment), &comment));
        let names = names.filter(|names| names.len() == row.len());
        (names.unwrap_or_else(|| vec![Vec::new(); row.len()]), (position + bom(file, position)?, line))
    };
    let kinds = table::kinds(names.len(), sample.iter().map(|line| separator.fields(line)));
    let names = if names.iter().any(|name| !name.is_empty()) {
        header_names(&names)
    } else {
        names_without_header(&kinds)
    };
    let columns = names.into_iter().zip(kinds).map(|(name, kind)| ColumnForm::new(name, kind)).collect();
    Ok(TableHeader { separator, columns, start, line })
}

/// Returns `true` if the first row has numbers where the next one has them too: it is no header, although it has texts.
fn has_header_of_values(row: &[Vec<u8>], sample: &[Vec<u8>], separator: Separator) -> bool {
    let Some(second) = sample.first().map(|line| texts(separator, line)) else { return false };
    let is_number = |text: &Vec<u8>| parse_number(text).is_some();
    row.len() == second.len()
        && row.iter().zip(&second).any(|(first, second)| is_number(first) && is_number(second))
}

/// Returns `true` for the header that pandas writes for an array without names: an empty field, and then 0, 1, 2 and so on.
fn is_numbered_header(row: &[Vec<u8>]) -> bool {
    let numbers =
        row.iter().skip(1).zip(0_usize..).all(|(text, number)| *text == number.to_string().as_bytes());
    row.len() > 2 && row[0].is_empty() && numbers
}

/// Returns the names of columns of an array without names, after that of the row's index.
fn numbered_names(length: usize) -> Vec<Vec<u8>> {
    let coordinates = ["index", "x", "y", "z"].map(|name| name.as_bytes().to_vec()).into_iter();
    coordinates.chain((3..).map(|index: usize| index.to_string().into_bytes())).take(length).collect()
}

/// Returns the length of the byte order mark at a position.
fn bom(file: &DataFile, position: u64) -> Result<u64, Faults> {
    let end = file.length().min(position + 3);
    Ok(if *file.read(position..end)? == *b"\xef\xbb\xbf" { 3 } else { 0 })
}

#[cfg(test)]
mod tests {
    use super::super::snapshot::Values;
    use super::*;

    fn read(text: &str) -> Result<Snapshot, Faults> {
        let file = DataFile::memory(text.as_bytes().to_vec());
        let mut csv = CsvFile::default();
        csv.index(&file, FileEnd::Final)?;
        csv.read(&file, 0)
    }

    fn names(snapshot: &Snapshot) -> Vec<&str> {
        snapshot.columns.iter().map(|column| column.name.as_str()).collect()
    }

    #[test]
    fn tables_of_other_programs_are_read() {
        let pandas =
            read("\u{feff},x,y,z,species,ok\r\n0,1.5,-2,3e2,\"Na\",True\r\n1,,nan,+4,Cl,False\r\n\r\n")
                .unwrap();
        assert_eq!(names(&pandas), ["0", "x", "y", "z", "element", "ok"]);
        assert_eq!(pandas.numbers("y").unwrap()[0], -2.0);
        assert!(pandas.numbers("x").unwrap()[1].is_nan() && pandas.numbers("y").unwrap()[1].is_nan());
        assert_eq!(pandas.numbers("z").unwrap(), [300.0, 4.0]);
        assert_eq!(pandas.numbers("ok").unwrap(), [1.0, 0.0]);
        let labels = Values::Labels { labels: vec![0, 1], names: vec!["Na".to_owned(), "Cl".to_owned()] };
        assert_eq!(pandas.column("element"), Some(&labels));

        let savetxt = read("# x y z r\n1.0e+00 2.0e+00 3.0e+00 4\n5 6 7 8").unwrap();
        assert_eq!(names(&savetxt), ["x", "y", "z", "r"]);
        assert_eq!(savetxt.numbers("r").unwrap(), [4.0, 8.0]);

        let numbered = read(",0,1,2,3\n0,5,6,7,8\n").unwrap();
        assert_eq!(names(&numbered), ["index", "x", "y", "z", "3"]);

        let plain = read("1\t2\t3\t4\t5\n6\t7\t8\t9\t1.0D+01\n").unwrap();
        assert_eq!(names(&plain), ["x", "y", "z", "3", "4"]);
        assert_eq!(plain.numbers("4").unwrap(), [5.0, 10.0]);

        let paraview = read("\"Points:0\",\"Points:1\",\"Points:2\",\"a, \"\"b\"\"\"\n1,2,3,4\n").unwrap();
        assert_eq!(names(&paraview), ["x", "y", "z", "a, \"b\""]);

        let unnamed = read("Cu;1;2;3\nCu;4;5;6\n").unwrap();
        assert_eq!((unnamed.count, names(&unnamed)), (2, vec!["0", "x", "y", "z"]));
    }

    #[test]
    fn faults_have_places_and_are_counted() {
        let mut text = "x,y,z\n1,2,3\n".to_owned();
        text.push_str("4,five,6\n4,\"5,6\n7,8\n1,2,3,4\n");
        for _ in 0..20 {
            text.push_str("1,2\n");
        }
        let faults = read(&text).unwrap_err();
        let message = super::super::TrajectoryError::new(std::path::Path::new("a.csv"), faults).to_string();
        let lines: Vec<&str> = message.lines().collect();
        assert_eq!(
            lines,
            [
                "a.csv:3:3: column `y`: found \"five\", expected a number; write a number, or `nan` if it is missing",
                "a.csv:4:3: column `y`: the quotes of \"\\\"5,6\" do not close; close them on the same line",
                "a.csv:5: the row ends before column `z`: it has 2 of 3 fields; complete the row, or remove it \
                 (and 20 more of this kind)",
                "a.csv:6:7: the row goes on with \"4\" after 3 columns; name the column in the header, or remove the field",
            ]
        );
    }

    #[test]
    fn chunks_and_gaps_leave_no_trace() {
        let mut text = "id,name,x\n".to_owned();
        for row in 0..60_000 {
            text.push_str(&format!("{row},n{},{}\n", row % 7, f64::from(row) / 3.0));
            if row % 1000 == 0 {
                text.push_str("# comment\n\n");
            }
        }
        let snapshot = read(&text).unwrap();
        let expected: Vec<f64> = (0..60_000).map(f64::from).collect();
        assert_eq!(snapshot.numbers("id").unwrap(), expected);
        let thirds: Vec<f64> = expected.iter().map(|row| row / 3.0).collect();
        assert_eq!(snapshot.numbers("x").unwrap(), thirds);
        let Some(Values::Labels { labels, names }) = snapshot.column("name") else { panic!() };
        assert!(
            labels.iter().enumerate().all(|(row, label)| names[*label as usize] == format!("n{}", row % 7))
        );
        assert_eq!(names.len(), 7);
    }

    #[test]
    fn long_headers_over_blank_lines_need_no_memory() {
        let text = format!("x{}\n{}1\n", ",a".repeat(50_000), "\n".repeat(1_000_000));
        assert!(read(&text).is_err());
    }
}
