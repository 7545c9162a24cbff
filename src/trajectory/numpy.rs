//! Headers of NumPy's arrays: types, shape and order.

use super::column_names::{MOST_COLUMNS, property_names};
use super::data_file::DataFile;
use super::error::{DataPlace, Faults, quote};

/// Longest header that is read. NumPy itself refuses longer ones than 10 000 bytes by default.
const LONGEST_HEADER: u64 = 1 << 20;
/// Deepest nesting of a header's values.
const DEEPEST: usize = 8;

/// An array in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct NumpyArray {
    /// Values of an item: one, or the fields of a structured array.
    pub fields: Vec<ArrayField>,
    /// `true` if the fields have names.
    pub is_structured: bool,
    /// Bytes of an item.
    pub size: u64,
    pub shape: Vec<u64>,
    /// `true` if the first index runs fastest.
    pub fortran_order: bool,
    /// Position of the first item in the file.
    pub start: u64,
}

/// A value of an item.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ArrayField {
    /// Name of the column, empty for arrays that are not structured.
    pub name: String,
    /// Position in the item.
    pub offset: u64,
    pub scalar: Scalar,
}

/// A type of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Scalar {
    pub kind: ScalarKind,
    /// Bytes.
    pub size: usize,
    pub is_big_endian: bool,
}

/// A kind of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ScalarKind {
    Bool,
    Signed,
    Unsigned,
    Float,
    /// Bytes of a text, with zeros after its end.
    Bytes,
    /// Characters of four bytes each, with zeros after the end.
    Unicode,
}

/// A value of Python in a header.
#[derive(Clone, Debug, PartialEq)]
enum PythonValue {
    Text(String),
    Whole(u64),
    Bool(bool),
    None,
    /// A tuple or list.
    Sequence(Vec<PythonValue>),
    Dict(Vec<(PythonValue, PythonValue)>),
}

impl NumpyArray {
    /// Reads the header of the array that starts at a position of a file, and checks that the file has all items.
    pub(super) fn read(file: &DataFile, position: u64) -> Result<Self, Faults> {
        let fail =
            |cause: &str| Faults::one(DataPlace::Byte(position), cause, "write it again with `numpy.save`");
        let left = file.length().saturating_sub(position);
        let mut prefix = [0; 12];
        let length = usize::try_from(left).unwrap_or(12).min(12);
        file.read_into(position, &mut prefix[..length])?;
        if !prefix.starts_with(b"\x93NUMPY") {
            return Err(fail("this is no array of NumPy: its first bytes are others"));
        }
        let [low, high, third, fourth] = [prefix[8], prefix[9], prefix[10], prefix[11]];
        let (before, length) = match prefix[6] {
            1 => (10, u64::from(u16::from_le_bytes([low, high]))),
            2 | 3 => (12, u64::from(u32::from_le_bytes([low, high, third, fourth]))),
            version => return Err(fail(&format!("version {version} of the format is unknown"))),
        };
        if length > LONGEST_HEADER {
            let message = format!("its header has {length} bytes, and at most {LONGEST_HEADER} are read");
            return Err(fail(&message));
        }
        if before + length > left {
            return Err(fail(&format!("its header of {length} bytes ends after the file")));
        }
        let header = file.read(position + before..position + before + length)?;
        let header = String::from_utf8_lossy(&header);
        let value = PythonParser { rest: &header }.value(0).ok_or_else(|| fail("its header is damaged"))?;
        let array = Self::from_header(&value, position + before + length)
            .map_err(|(cause, remedy)| Faults::one(DataPlace::Byte(position), cause, remedy))?;
        array.check_length(file, position)?;
        Ok(array)
    }

    fn from_header(header: &PythonValue, start: u64) -> Result<Self, (String, String)> {
        let fail = |cause: &str| (cause.to_owned(), "write it again with `numpy.save`".to_owned());
        let descr = header.get("descr").ok_or_else(|| fail("its header has no types (`descr`)"))?;
        let Some(PythonValue::Bool(fortran_order)) = header.get("fortran_order") else {
            return Err(fail("its header has no order (`fortran_order`)"));
        };
        let Some(PythonValue::Sequence(shape)) = header.get("shape") else {
            return Err(fail("its header has no `shape`"));
        };
        let shape: Option<Vec<u64>> = shape.iter().map(PythonValue::whole).collect();
        let shape = shape.ok_or_else(|| fail("its shape is not of whole numbers"))?;
        let mut fields = Vec::new();
        let size = match descr {
            PythonValue::Sequence(items) => structured_fields(items, &mut fields)?,
            descr => {
                let scalar = Scalar::new(descr)?;
                fields.push(ArrayField { name: String::new(), offset: 0, scalar });
                scalar.size as u64
            }
        };
        let is_structured = matches!(descr, PythonValue::Sequence(_));
        Ok(Self { fields, is_structured, size, shape, fortran_order: *fortran_order, start })
    }

    /// Returns the number of bytes of all items, if there is such a number.
    pub(super) fn length(&self) -> Option<u64> {
        self.shape.iter().try_fold(self.size, |product, length| product.checked_mul(*length))
    }

    fn check_length(&self, file: &DataFile, position: u64) -> Result<(), Faults> {
        let left = file.length().saturating_sub(self.start);
        let shape = self.shape_text();
        match self.length() {
            Some(length) if length <= left => Ok(()),
            Some(length) => {
                let cause = format!(
                    "the array is truncated: shape {shape} needs {length} bytes, the file has {left}"
                );
                Err(Faults::one(DataPlace::Byte(position), cause, "copy or write the file again"))
            }
            None => {
                let cause = format!("shape {shape} is larger than any file");
                Err(Faults::one(DataPlace::Byte(position), cause, "write the file again"))
            }
        }
    }

    /// Returns the shape as Python writes it.
    pub(super) fn shape_text(&self) -> String {
        let lengths = self.shape.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
        if self.shape.len() == 1 { format!("({lengths},)") } else { format!("({lengths})") }
    }
}

/// Adds the fields of a structured type. Returns the bytes of an item.
fn structured_fields(items: &[PythonValue], fields: &mut Vec<ArrayField>) -> Result<u64, (String, String)> {
    let bad =
        || ("the types of its fields are damaged".to_owned(), "write it again with `numpy.save`".to_owned());
    let mut offset = 0_u64;
    for item in items {
        let PythonValue::Sequence(parts) = item else { return Err(bad()) };
        let (name, descr, shape) = match &parts[..] {
            [name, descr] => (name, descr, &[][..]),
            [name, descr, PythonValue::Sequence(shape)] => (name, descr, &shape[..]),
            _ => return Err(bad()),
        };
        let name = match name {
            PythonValue::Text(name) => name,
            // A title and a name.
            PythonValue::Sequence(names) => match &names[..] {
                [_, PythonValue::Text(name)] => name,
                _ => return Err(bad()),
            },
            _ => return Err(bad()),
        };
        let width = shape.iter().try_fold(1, |product: u64, length| product.checked_mul(length.whole()?));
        let width = width.and_then(|width| usize::try_from(width).ok());
        let Some(width) = width.filter(|width| *width <= MOST_COLUMNS) else {
            let cause = format!("field `{name}` has more than {MOST_COLUMNS} values");
            return Err((cause, "save it as an array of its own".to_owned()));
        };
        // Unnamed bytes between fields, which align them.
        if let Some(size) = padding(descr) {
            offset = offset.checked_add(size).ok_or_else(bad)?;
            continue;
        }
        let scalar = Scalar::new(descr)?;
        for column in property_names(name, width) {
            fields.push(ArrayField { name: column, offset, scalar });
            offset = offset.checked_add(scalar.size as u64).ok_or_else(bad)?;
        }
        if fields.len() > MOST_COLUMNS {
            return Err(bad());
        }
    }
    if fields.is_empty() { Err(bad()) } else { Ok(offset) }
}

/// Returns the bytes of unnamed padding, as in `|V4`.
fn padding(descr: &PythonValue) -> Option<u64> {
    match descr {
        PythonValue::Text(text) => text.trim_start_matches('|').strip_prefix('V')?.parse().ok(),
        _ => None,
    }
}

impl Scalar {
    fn new(descr: &PythonValue) -> Result<Self, (String, String)> {
        let PythonValue::Text(text) = descr else {
            return Err((
                "its type is nested".to_owned(),
                "save each field as an array of its own".to_owned(),
            ));
        };
        let (order, rest) = match text.chars().next() {
            Some(order @ ('<' | '>' | '|' | '=')) => (order, &text[1..]),
            _ => ('<', &text[..]),
        };
        let fail = |remedy: &str| {
            Err((format!("values of the type {} are no numbers", quote(text.as_bytes())), remedy.to_owned()))
        };
        let letter = rest.chars().next().filter(char::is_ascii).unwrap_or(' ');
        let Some(size) = rest.get(1..).and_then(|digits| digits.parse::<usize>().ok()) else {
            return fail("save them as numbers, with `array.astype(float)`");
        };
        let (kind, size) = match (letter, size) {
            ('b', 1) => (ScalarKind::Bool, size),
            ('i', 1 | 2 | 4 | 8) => (ScalarKind::Signed, size),
            ('u', 1 | 2 | 4 | 8) => (ScalarKind::Unsigned, size),
            ('f', 2 | 4 | 8) => (ScalarKind::Float, size),
            ('S' | 'a', 1..=65_536) => (ScalarKind::Bytes, size),
            ('U', 1..=16_384) => (ScalarKind::Unicode, size * 4),
            ('f', _) => return fail("save them in 64 bits, with `array.astype(float)`"),
            ('c', _) => return fail("save the real parts, with `array.real`"),
            ('O', _) => {
                return fail(
                    "save them as numbers, with `array.astype(float)`; objects are not read, since they may run code",
                );
            }
            _ => return fail("save them as numbers, with `array.astype(float)`"),
        };
        Ok(Self { kind, size, is_big_endian: order == '>' })
    }

    pub(super) fn is_text(self) -> bool {
        matches!(self.kind, ScalarKind::Bytes | ScalarKind::Unicode)
    }
}

impl PythonValue {
    fn get(&self, key: &str) -> Option<&Self> {
        let Self::Dict(pairs) = self else { return None };
        pairs.iter().find(|(name, _)| *name == Self::Text(key.to_owned())).map(|(_, value)| value)
    }

    fn whole(&self) -> Option<u64> {
        if let Self::Whole(number) = self { Some(*number) } else { None }
    }
}

/// Reads Python's literals.
struct PythonParser<'a> {
    rest: &'a str,
}

impl PythonParser<'_> {
    fn next(&mut self, expected: char) -> bool {
        self.rest = self.rest.trim_start();
        self.rest.strip_prefix(expected).inspect(|rest| self.rest = rest).is_some()
    }

    fn value(&mut self, depth: usize) -> Option<PythonValue> {
        if depth > DEEPEST {
            return None;
        }
        if self.next('{') {
            let mut pairs = Vec::new();
            while !self.next('}') {
                let key = self.value(depth + 1)?;
                if !self.next(':') {
                    return None;
                }
                pairs.push((key, self.value(depth + 1)?));
                if !self.next(',') {
                    return self.next('}').then_some(PythonValue::Dict(pairs));
                }
            }
            return Some(PythonValue::Dict(pairs));
        }
        for (open, close) in [('(', ')'), ('[', ']')] {
            if self.next(open) {
                return self.sequence(close, depth);
            }
        }
        for quote in ['\'', '"'] {
            if self.next(quote) {
                let (text, rest) = self.rest.split_once(quote)?;
                self.rest = rest;
                return Some(PythonValue::Text(text.to_owned()));
            }
        }
        let end = self.rest.find(|letter: char| !letter.is_ascii_alphanumeric()).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        // Python 2 wrote long numbers as `3L`.
        let digits = word.strip_suffix('L').unwrap_or(word);
        let value = match word {
            "True" => PythonValue::Bool(true),
            "False" => PythonValue::Bool(false),
            "None" => PythonValue::None,
            // A text of Python 2: `u'x'`.
            "u" | "b" if rest.starts_with(['\'', '"']) => {
                self.rest = rest;
                return self.value(depth + 1);
            }
            _ => PythonValue::Whole(digits.parse().ok()?),
        };
        self.rest = rest;
        Some(value)
    }

    fn sequence(&mut self, close: char, depth: usize) -> Option<PythonValue> {
        let mut values = Vec::new();
        while !self.next(close) {
            values.push(self.value(depth + 1)?);
            if !self.next(',') {
                return self.next(close).then_some(PythonValue::Sequence(values));
            }
        }
        Some(PythonValue::Sequence(values))
    }
}
