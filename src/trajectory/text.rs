//! Text of data files: numbers, fields, and a cursor over lines.

use std::borrow::Cow;
use std::io::Result;

use super::data_file::DataFile;

/// Longest line that is read. Longer ones are those of files that are not text.
const LONGEST_LINE: usize = 16 << 20;
/// Bytes that a cursor reads at once.
const BLOCK: usize = 1 << 20;

/// Returns the number that a field holds, correctly rounded.
///
/// In addition to decimal numbers, these are read: Fortran's exponents (`1.0D+00`, `1.0-100`), and NaN and infinity as C, Fortran, Python
/// and Windows write them.
pub(super) fn parse_number(field: &[u8]) -> Option<f64> {
    fast_float2::parse::<f64, _>(field).ok().or_else(|| parse_unusual(field))
}

/// Returns the number of a field in a column of numbers, in which logical values are 0 and 1, and words for missing numbers are NaN.
///
/// Elsewhere, such words have other meanings: `F` is fluorine, and `NA` is sodium in files that have upper case alone.
pub(super) fn parse_value(field: &[u8]) -> Option<f64> {
    parse_number(field).or_else(|| parse_logical(field)).or_else(|| is_missing(field).then_some(f64::NAN))
}

/// Returns 0 or 1 for a logical value.
pub(super) fn parse_logical(field: &[u8]) -> Option<f64> {
    match field {
        b"T" | b"True" | b"TRUE" | b"true" | b".TRUE." | b".true." => Some(1.0),
        b"F" | b"False" | b"FALSE" | b"false" | b".FALSE." | b".false." => Some(0.0),
        _ => None,
    }
}

/// Returns `true` for empty fields, and for words that stand for missing numbers.
pub(super) fn is_missing(field: &[u8]) -> bool {
    matches!(field, b"" | b"NA" | b"N/A" | b"#N/A" | b"<NA>" | b"null" | b"NULL" | b"None")
}

#[cold]
fn parse_unusual(field: &[u8]) -> Option<f64> {
    let word = field.strip_prefix(b"-").or(field.strip_prefix(b"+")).unwrap_or(field);
    let is = |words: &[&str]| words.iter().any(|known| word.eq_ignore_ascii_case(known.as_bytes()));
    if is(&["nan", "nan(ind)", "nan(snan)", "1.#ind", "1.#qnan", "1.#snan"]) {
        return Some(f64::NAN);
    }
    if is(&["1.#inf"]) {
        return Some(if field.first() == Some(&b'-') { f64::NEG_INFINITY } else { f64::INFINITY });
    }
    // An exponent of three digits may leave no place for its letter.
    let at = field.iter().skip(1).position(|byte| b"dDqQ+-".contains(byte))? + 1;
    let rest = if b"+-".contains(&field[at]) { &field[at..] } else { &field[at + 1..] };
    let digits = rest.strip_prefix(b"-").or(rest.strip_prefix(b"+")).unwrap_or(rest);
    let plain = field[..at].iter().all(|byte| byte.is_ascii_digit() || b"+-.".contains(byte));
    if !plain || digits.is_empty() || !digits.iter().all(u8::is_ascii_digit) || field.len() > 400 {
        return None;
    }
    fast_float2::parse([&field[..at], b"e", rest].concat()).ok()
}

/// Returns the whole number that a field holds.
pub(super) fn parse_whole<T: std::str::FromStr>(field: &[u8]) -> Option<T> {
    std::str::from_utf8(field).ok()?.trim().parse().ok()
}

/// Separator of fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Separator {
    /// Any number of spaces and tabs.
    Blanks,
    /// A character. Spaces and tabs around fields are ignored, and double quotes protect separators in a field.
    Character(u8),
}

/// A field of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TextField<'a> {
    /// Text, without blanks around it; with the quotes of a quoted field.
    pub text: &'a [u8],
    /// Position of the text in the line.
    pub start: usize,
    /// Position of the next field, or `None` after the last.
    pub next: Option<usize>,
}

pub(super) fn is_blank(byte: u8) -> bool {
    byte == b' ' || byte == b'\t'
}

impl Separator {
    /// Returns the field that starts at a position of a line. For blanks, there is none if only blanks are left.
    pub(super) fn field(self, line: &[u8], position: usize) -> Option<TextField<'_>> {
        let blanks = |byte: u8| is_blank(byte) && self != Self::Character(byte);
        let start = position + line.get(position..)?.iter().take_while(|byte| blanks(**byte)).count();
        let rest = &line[start..];
        match self {
            Self::Blanks => {
                let length = rest.iter().position(|byte| is_blank(*byte)).unwrap_or(rest.len());
                (length > 0).then(|| TextField { text: &rest[..length], start, next: Some(start + length) })
            }
            Self::Character(separator) => {
                let protected = if rest.first() == Some(&b'"') { closing_quote(rest) } else { 0 };
                let end = memchr::memchr(separator, &rest[protected..]).map(|end| end + protected);
                let text = &rest[..end.unwrap_or(rest.len())];
                let length = text.iter().rposition(|byte| !is_blank(*byte)).map_or(0, |last| last + 1);
                Some(TextField { text: &text[..length], start, next: end.map(|end| start + end + 1) })
            }
        }
    }

    /// Returns all fields of a line.
    pub(super) fn fields(self, line: &[u8]) -> impl Iterator<Item = TextField<'_>> {
        let mut position = Some(0);
        std::iter::from_fn(move || {
            let field = self.field(line, position?)?;
            position = field.next;
            Some(field)
        })
    }
}

/// Returns the length of a text in quotes, with both, at the start of a text; its whole length if the quote is not closed.
fn closing_quote(text: &[u8]) -> usize {
    let mut position = 1;
    while let Some(quote) = text.get(position..).and_then(|rest| memchr::memchr(b'"', rest)) {
        position += quote + 1;
        // A doubled quote stands for one in the text.
        if text.get(position) != Some(&b'"') {
            return position;
        }
        position += 1;
    }
    text.len()
}

/// Returns the text of a field without its quotes, or `None` if a quote is not closed.
pub(super) fn unquote(field: &[u8]) -> Option<Cow<'_, [u8]>> {
    let Some(inner) = field.strip_prefix(b"\"") else { return Some(Cow::Borrowed(field)) };
    let inner = inner.strip_suffix(b"\"")?;
    if memchr::memchr(b'"', inner).is_none() {
        return Some(Cow::Borrowed(inner));
    }
    let mut plain = Vec::with_capacity(inner.len());
    let mut bytes = inner.iter();
    while let Some(byte) = bytes.next() {
        plain.push(*byte);
        if *byte == b'"' && bytes.next() != Some(&b'"') {
            return None;
        }
    }
    Some(Cow::Owned(plain))
}

/// Returns a line without the carriage return at its end.
pub(super) fn without_return(line: &[u8]) -> &[u8] {
    line.strip_suffix(b"\r").unwrap_or(line)
}

/// Returns text as the label that it stands for.
pub(super) fn label(text: &[u8]) -> String {
    String::from_utf8_lossy(text).into_owned()
}

/// Reads the lines of a file in order, a block at a time.
pub(super) struct LineCursor<'a> {
    file: &'a DataFile,
    block: Vec<u8>,
    /// Position of the next line in the block.
    start: usize,
    /// Position of the block's end in the file.
    end: u64,
    /// Number of lines before the next one.
    line: u64,
}

impl<'a> LineCursor<'a> {
    /// Starts at a position of a file, which has so many lines before it.
    pub(super) fn new(file: &'a DataFile, position: u64, line: u64) -> Self {
        Self { file, block: Vec::new(), start: 0, end: position, line }
    }

    /// Returns the position of the next line in the file.
    pub(super) fn position(&self) -> u64 {
        self.end - (self.block.len() - self.start) as u64
    }

    /// Returns the number of the next line, counted from 1.
    pub(super) fn line_number(&self) -> u64 {
        self.line + 1
    }

    pub(super) fn is_at_end(&self) -> bool {
        self.start == self.block.len() && self.end >= self.file.length()
    }

    pub(super) fn file(&self) -> &'a DataFile {
        self.file
    }

    /// Returns `true` if the last byte that was passed ends a line.
    pub(super) fn ends_with_line_end(&self) -> Result<bool> {
        let position = self.position();
        Ok(position == 0 || *self.file.read(position - 1..position)? == *b"\n")
    }

    /// Appends the next block. Returns `false` at the end of the file.
    fn refill(&mut self) -> Result<bool> {
        let left = self.file.length().saturating_sub(self.end);
        if left == 0 {
            return Ok(false);
        }
        self.block.drain(..self.start);
        self.start = 0;
        let kept = self.block.len();
        let count = usize::try_from(left).unwrap_or(usize::MAX).min(BLOCK);
        self.block.resize(kept + count, 0);
        self.file.read_into(self.end, &mut self.block[kept..])?;
        self.end += count as u64;
        Ok(true)
    }

    /// Returns the next line without its end, or `None` at the end of the file.
    pub(super) fn next_line(&mut self) -> Result<Option<&[u8]>> {
        let mut searched = 0;
        let length = loop {
            let rest = &self.block[self.start..];
            if let Some(length) = memchr::memchr(b'\n', &rest[searched..]) {
                break searched + length;
            }
            searched = rest.len();
            if searched > LONGEST_LINE {
                let message = format!("line {} has more than {LONGEST_LINE} bytes", self.line + 1);
                return Err(std::io::Error::new(std::io::ErrorKind::InvalidData, message));
            }
            if !self.refill()? {
                break searched;
            }
        };
        if self.start == self.block.len() {
            return Ok(None);
        }
        let line = self.start..self.start + length;
        self.start = (line.end + 1).min(self.block.len());
        self.line += 1;
        Ok(Some(without_return(&self.block[line])))
    }

    /// Skips lines. Returns the number of those that were there, which is smaller at the end of the file.
    pub(super) fn skip_lines(&mut self, count: u64) -> Result<u64> {
        let mut skipped = 0;
        // The bytes of lines that are skipped are not kept, however long they are.
        let mut is_inside = false;
        while skipped < count {
            let wanted = count - skipped;
            // Counting is several times as fast as finding each line. It goes no further than so many short lines reach, so that a block
            // of short frames is not counted again for each of them.
            let left = self.block.len() - self.start;
            let window =
                usize::try_from(wanted).unwrap_or(usize::MAX).saturating_mul(64).max(1 << 12).min(left);
            let rest = &self.block[self.start..self.start + window];
            let found = memchr::memchr_iter(b'\n', rest).count() as u64;
            if found < wanted {
                is_inside = rest.last().map_or(is_inside, |last| *last != b'\n');
                self.start += window;
                self.line += found;
                skipped += found;
                if self.start == self.block.len() && !self.refill()? {
                    self.line += u64::from(is_inside);
                    return Ok(skipped + u64::from(is_inside));
                }
            } else {
                let last = usize::try_from(wanted - 1).unwrap_or(usize::MAX);
                let end = memchr::memchr_iter(b'\n', rest).nth(last).map_or(rest.len(), |end| end + 1);
                self.start += end;
                self.line += wanted;
                skipped = count;
            }
        }
        Ok(skipped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_all_programs_are_read() {
        for (text, number) in [
            ("1", 1.0),
            ("+.5", 0.5),
            ("-1.", -1.0),
            ("1.0D+00", 1.0),
            ("1.5d-3", 1.5e-3),
            ("0.25-100", 0.25e-100),
            ("-0.25+100", -0.25e100),
            ("1Q2", 100.0),
            ("Infinity", f64::INFINITY),
            ("-inf", f64::NEG_INFINITY),
            ("-1.#INF", f64::NEG_INFINITY),
            // Halfway between two numbers, decided by the last digit.
            ("9007199254740993", 9_007_199_254_740_992.0),
            ("9007199254740993.00000000000000000000000000000000000000000000000001", 9_007_199_254_740_994.0),
            ("2.4703282292062327208e-324", 0.0),
            ("2.4703282292062328e-324", 5e-324),
        ] {
            assert_eq!(parse_number(text.as_bytes()), Some(number), "{text}");
        }
        for text in ["nan", "-NaN", "-nan(ind)", "1.#QNAN"] {
            assert!(parse_number(text.as_bytes()).is_some_and(f64::is_nan), "{text}");
        }
        for text in [
            "", "-", "D", "1D", "1D+", "1-", "--1", "1.5.2", "1 2", "0x10", "1_000", "****", "1e", "D+00",
            "-+1", "1,5",
        ] {
            assert_eq!(parse_number(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn names_are_no_numbers() {
        // Fluorine, sodium, indium, tritium, and chains.
        for text in ["F", "NA", "In", "T", "None", "N/A", "I", "E", "D"] {
            assert_eq!(parse_number(text.as_bytes()), None, "{text}");
        }
        assert_eq!((parse_value(b"F"), parse_value(b"True")), (Some(0.0), Some(1.0)));
        assert!(parse_value(b"NA").is_some_and(f64::is_nan));
    }

    #[test]
    fn fields_are_split_and_unquoted() {
        let texts = |separator: Separator, line: &'static str| -> Vec<String> {
            let fields =
                separator.fields(line.as_bytes()).map(|field| unquote(field.text).map(|text| label(&text)));
            fields.map(|text| text.unwrap_or("open".to_owned())).collect()
        };
        assert_eq!(texts(Separator::Blanks, "  a\tb  \"c d\" "), ["a", "b", "open", "d\""]);
        assert_eq!(texts(Separator::Character(b','), " a , \"b, \"\"c\"\"\" ,,"), ["a", "b, \"c\"", "", ""]);
        assert_eq!(texts(Separator::Character(b'\t'), "a\t b\t\tc"), ["a", "b", "", "c"]);
        assert_eq!(texts(Separator::Character(b','), "\"a,b"), ["open"]);
        assert_eq!(texts(Separator::Character(b','), ""), [""]);
    }

    #[test]
    fn cursors_count_lines_across_blocks() {
        let mut text = String::new();
        for line in 0..300_000 {
            text.push_str(&format!("line {line}\r\n"));
        }
        text.push_str("last");
        let starts: Vec<usize> = memchr::memchr_iter(b'\n', text.as_bytes()).collect();
        let file = DataFile::memory(text.into_bytes());
        let mut cursor = LineCursor::new(&file, 0, 0);
        for skip in [0, 1, 70_000, 3, 99_995, 100_000] {
            let before = cursor.line_number();
            assert_eq!(cursor.skip_lines(skip).unwrap(), skip);
            assert_eq!(cursor.line_number(), before + skip);
            let line = cursor.line_number();
            let position = if line == 1 { 0 } else { starts[usize::try_from(line).unwrap() - 2] as u64 + 1 };
            assert_eq!(cursor.position(), position);
            let found = cursor.next_line().unwrap().map(label);
            assert_eq!(found, Some(format!("line {}", line - 1)));
        }
        assert_eq!(cursor.skip_lines(100_000).unwrap(), 29_996);
        assert!(cursor.is_at_end() && !cursor.ends_with_line_end().unwrap());
        assert_eq!(cursor.next_line().unwrap(), None);
    }

    #[test]
    fn endless_lines_are_rejected() {
        let file = DataFile::memory(vec![b' '; LONGEST_LINE + BLOCK + 2]);
        assert!(LineCursor::new(&file, 0, 0).next_line().is_err());
        assert_eq!(LineCursor::new(&file, 0, 0).skip_lines(5).unwrap(), 1);
    }
}
