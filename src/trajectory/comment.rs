//! The comment line of extended XYZ: `key=value`, with values that may be quoted, bracketed, or several numbers.

use glam::DVec3;

use super::column_names::{MOST_COLUMNS, property_names};
use super::error::{DataPlace, FaultKind, Faults, quote};
use super::snapshot::Cell;
use super::table::{ColumnForm, ColumnKind, not_a_number};
use super::text::{label, parse_logical, parse_number, parse_whole};

/// A comment line.
pub(super) struct Comment<'a> {
    text: &'a [u8],
    pairs: Vec<(&'a [u8], &'a [u8])>,
}

/// The columns that `Properties` names.
pub(super) struct Properties {
    pub columns: Vec<ColumnForm>,
}

impl<'a> Comment<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { text, pairs: pairs(text) }
    }

    /// Returns the value of a key, in which upper and lower case are the same.
    fn value(&self, key: &str) -> Option<&'a [u8]> {
        let is_key = |name: &[u8]| name.eq_ignore_ascii_case(key.as_bytes());
        self.pairs.iter().find(|(name, _)| is_key(name)).map(|(_, value)| *value)
    }

    /// Returns the position of a value in the line, counted from 1.
    fn place(&self, line: u64, value: &[u8]) -> DataPlace {
        let byte = (value.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize) + 1;
        DataPlace::Line { line, byte: byte as u64 }
    }

    /// Returns the columns of `Properties=species:S:1:pos:R:3`.
    pub(super) fn properties(&self, line: u64) -> Result<Option<Properties>, Faults> {
        let Some(value) = self.value("Properties") else { return Ok(None) };
        let place = self.place(line, value);
        let fail = |cause: String| {
            Err(Faults::one(
                place,
                cause,
                "write `name:kind:columns` for each property, as in `Properties=species:S:1:pos:R:3`",
            ))
        };
        let parts: Vec<&[u8]> = value.split(|byte| *byte == b':').map(<[u8]>::trim_ascii).collect();
        if !parts.len().is_multiple_of(3) {
            return fail(format!("Properties has {} parts, which are no groups of three", parts.len()));
        }
        let mut columns = Vec::new();
        for part in parts.chunks_exact(3) {
            let name = label(part[0]);
            let kind = match part[1] {
                b"R" | b"I" | b"L" | b"r" | b"i" | b"l" => ColumnKind::Numbers,
                b"S" | b"s" => ColumnKind::Labels,
                other => {
                    return fail(format!(
                        "the kind of property `{name}` is {}, expected R, I, S or L",
                        quote(other)
                    ));
                }
            };
            let width = parse_whole::<usize>(part[2]).filter(|width| (1..=MOST_COLUMNS).contains(width));
            let Some(width) = width else {
                return fail(format!(
                    "property `{name}` has {} columns, expected a number from 1 to {MOST_COLUMNS}",
                    quote(part[2])
                ));
            };
            columns.extend(property_names(&name, width).into_iter().map(|name| ColumnForm::new(name, kind)));
            if columns.len() > MOST_COLUMNS {
                return fail(format!("Properties has more than {MOST_COLUMNS} columns"));
            }
        }
        Ok(Some(Properties { columns }))
    }

    /// Returns the cell of `Lattice`, `Origin` and `pbc`. Cells of zeros alone stand for none.
    pub(super) fn cell(&self, line: u64) -> Result<Option<Cell>, Faults> {
        let Some(value) = self.value("Lattice").or_else(|| self.value("cell")) else { return Ok(None) };
        let place = self.place(line, value);
        let numbers = numbers(value, "Lattice", place)?;
        let edges = match numbers[..] {
            [a, b, c] => [DVec3::X * a, DVec3::Y * b, DVec3::Z * c],
            [a, b, c, d, e, f, g, h, i] => [DVec3::new(a, b, c), DVec3::new(d, e, f), DVec3::new(g, h, i)],
            _ => {
                let cause = format!("Lattice has {} numbers, expected 9", numbers.len());
                return Err(Faults::one(place, cause, "write three edges of three numbers each"));
            }
        };
        if edges == [DVec3::ZERO; 3] {
            return Ok(None);
        }
        let origin = match self
            .value("Origin")
            .map(|value| numbers_of(value, "Origin", self.place(line, value)))
        {
            None => DVec3::ZERO,
            Some(numbers) => match numbers?[..] {
                [x, y, z] => DVec3::new(x, y, z),
                _ => return Err(Faults::one(place, "Origin has not three numbers", "write three numbers")),
            },
        };
        let cell = Cell { origin, edges, periodic: self.periodic(line)? };
        if cell.is_valid() {
            return Ok(Some(cell));
        }
        let cause = format!("Lattice {} spans no volume", quote(value));
        Err(Faults::one(
            place,
            cause,
            "write three independent edges, or make flat directions not periodic (`pbc=\"T T F\"`)",
        ))
    }

    fn periodic(&self, line: u64) -> Result<[bool; 3], Faults> {
        let Some(value) = self.value("pbc").or_else(|| self.value("periodic")) else { return Ok([true; 3]) };
        let values = numbers_of(value, "pbc", self.place(line, value))?;
        match values[..] {
            [all] => Ok([all != 0.0; 3]),
            [x, y, z] => Ok([x, y, z].map(|value| value != 0.0)),
            _ => {
                let cause = format!("pbc has {} values, expected 3", values.len());
                Err(Faults::one(
                    self.place(line, value),
                    cause,
                    "write T or F for each edge, as in `pbc=\"T T F\"`",
                ))
            }
        }
    }

    /// Returns the number after `time`, as in `Time=1.5` and `i = 3, time = 1.5, E = -17`.
    pub(super) fn time(&self) -> Option<f64> {
        let lower = self.text.to_ascii_lowercase();
        let mut words = memchr::memmem::find_iter(&lower, b"time");
        words.find_map(|start| {
            let is_word =
                start == 0 || !(lower[start - 1].is_ascii_alphanumeric() || lower[start - 1] == b'_');
            let rest = self.text[start + 4..].trim_ascii_start();
            let rest = rest.strip_prefix(b"=").or(rest.strip_prefix(b":"))?.trim_ascii_start();
            let rest = rest.strip_prefix(b"\"").unwrap_or(rest);
            let end = rest.iter().position(|byte| byte.is_ascii_whitespace() || b",;\"".contains(byte));
            is_word.then(|| parse_number(&rest[..end.unwrap_or(rest.len())])).flatten()
        })
    }
}

use numbers as numbers_of;

/// Returns the numbers of a value, whatever separates them.
fn numbers(value: &[u8], key: &str, place: DataPlace) -> Result<Vec<f64>, Faults> {
    let words = value.split(|byte| byte.is_ascii_whitespace() || b",[](){}".contains(byte));
    let mut faults = Faults::default();
    let mut found = Vec::new();
    for word in words.filter(|word| !word.is_empty()) {
        match parse_number(word).or_else(|| parse_logical(word)) {
            Some(number) => found.push(number),
            None => faults.add(FaultKind::NotANumber, place, || not_a_number(key, word)),
        }
    }
    if faults.is_empty() { Ok(found) } else { Err(faults) }
}

/// Returns the pairs of a comment. Words without a value, which ASE reads as true, are omitted.
fn pairs(text: &[u8]) -> Vec<(&[u8], &[u8])> {
    let mut pairs = Vec::new();
    let mut rest = text;
    loop {
        rest = rest.trim_ascii_start();
        if rest.is_empty() {
            return pairs;
        }
        let (key, after) = if let [quote @ (b'"' | b'\''), inner @ ..] = rest {
            split_at(inner, |byte| byte == *quote)
        } else {
            let end = rest.iter().position(|byte| *byte == b'=' || byte.is_ascii_whitespace());
            rest.split_at(end.unwrap_or(rest.len()))
        };
        let Some(value) = after.trim_ascii_start().strip_prefix(b"=") else {
            rest = after;
            continue;
        };
        let (value, after) = value_of(value.trim_ascii_start());
        pairs.push((key, value));
        rest = after;
    }
}

/// Splits a text before and after the first such byte.
fn split_at(text: &[u8], is_end: impl Fn(u8) -> bool) -> (&[u8], &[u8]) {
    let end = text.iter().position(|byte| is_end(*byte)).unwrap_or(text.len());
    (&text[..end], text.get(end + 1..).unwrap_or(&[]))
}

/// Splits a value from what follows it.
fn value_of(text: &[u8]) -> (&[u8], &[u8]) {
    match text {
        [quote @ (b'"' | b'\''), inner @ ..] => split_at(inner, |byte| byte == *quote),
        [b'{', inner @ ..] => split_at(inner, |byte| byte == b'}'),
        [b'[', ..] => {
            let mut depth = 0_usize;
            let end = text.iter().position(|byte| {
                depth = match byte {
                    b'[' => depth + 1,
                    b']' => depth.saturating_sub(1),
                    _ => depth,
                };
                depth == 0
            });
            text.split_at(end.map_or(text.len(), |end| end + 1))
        }
        _ => split_at(text, |byte| byte.is_ascii_whitespace()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_quoted_in_any_way() {
        let text = br#" Lattice="1 0 0 0 2 0 0 0 3" Properties=species:S:1:pos:R:3:f:R:2 'pbc'='T F T' Origin=[1,2, 3] flag note={a b} time = 2.5"#;
        let comment = Comment::new(text);
        let cell = comment.cell(2).unwrap().unwrap();
        assert_eq!(cell.edges, [DVec3::X, DVec3::Y * 2.0, DVec3::Z * 3.0]);
        assert_eq!((cell.origin, cell.periodic), (DVec3::new(1.0, 2.0, 3.0), [true, false, true]));
        assert_eq!(
            (comment.value("note"), comment.value("flag"), comment.time()),
            (Some(&b"a b"[..]), None, Some(2.5))
        );
        let columns = comment.properties(2).unwrap().unwrap().columns;
        let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["element", "x", "y", "z", "f.1", "f.2"]);
        assert_eq!(Comment::new(b" i = 3, time = 1.50, E = -17").time(), Some(1.5));
        assert_eq!(Comment::new(b"Atoms. Timestep: 100").time(), None);
        let nested = Comment::new(b"Lattice=[[1,0,0],[0,1,0],[0,0,1]] pbc=F");
        assert_eq!(nested.cell(2).unwrap().unwrap().periodic, [false; 3]);
        assert_eq!(Comment::new(b"Lattice=\"0 0 0 0 0 0 0 0 0\"").cell(2), Ok(None));
    }

    #[test]
    fn bad_lattices_and_properties_are_rejected_at_their_place() {
        for (text, place, cause) in [
            ("a=1 Lattice=\"1 2\"", 14, "has 2 numbers"),
            ("Lattice=\"1 0 0 1 0 0 0 0 1\"", 10, "spans no volume"),
            ("Lattice=\"1 0 0 0 inf 0 0 0 1\"", 10, "spans no volume"),
            ("Lattice=\"1 0 x 0 1 0 0 0 1\"", 10, "found \"x\""),
            ("Properties=pos:R", 12, "2 parts"),
            ("Properties=pos:Q:3", 12, "expected R, I, S or L"),
            ("Properties=pos:R:99999999999999999999", 12, "columns"),
        ] {
            let comment = Comment::new(text.as_bytes());
            let faults = comment.cell(7).and(comment.properties(7).map(|_| None::<Cell>)).unwrap_err();
            let message = faults.warning(std::path::Path::new("a"));
            assert!(message.starts_with(&format!("a:7:{place}: ")) && message.contains(cause), "{message}");
        }
    }
}
