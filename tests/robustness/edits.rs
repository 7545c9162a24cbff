//! Edits of files: of bytes, of numbers, and of groups in brackets.

use std::collections::BTreeSet;
use std::ops::Range;

use proptest::prelude::*;

use super::files::Files;
use super::values::number;

/// An edit of a text. Places are shares of its length.
#[derive(Clone, Debug)]
pub(crate) enum Edit {
    /// Removes some bytes, and inserts a word, possibly repeated.
    Splice { place: f64, removed: usize, word: String, times: usize },
    /// Overwrites bytes with arbitrary ones.
    Bytes { place: f64, bytes: Vec<u8> },
    /// Removes the rest of the text.
    End { place: f64 },
    /// Replaces the next number.
    Number { place: f64, number: String },
    /// Inserts a copy of a line.
    Line { place: f64, line: f64 },
    /// Replaces another word with the next word, or another group in brackets with the next group.
    Move { place: f64, other: f64, is_group: bool },
    /// Repeats the next word, or the next group in brackets; 0 removes it.
    Repeat { place: f64, times: usize, is_group: bool },
}

/// Words of the format and of scripts, and texts that are special to their parsers.
const SPECIAL: [&str; 55] = [
    "",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ",",
    ":",
    ";",
    "\"",
    "'",
    "/*",
    "*/",
    "//",
    "\\",
    "#",
    "#{",
    "r#\"",
    "\"#",
    "`",
    "${",
    "Some(",
    "None",
    "-",
    "NaN",
    "inf",
    "1e999",
    "1.2.3f64",
    "0x",
    "b\"",
    "ß",
    "\u{1F600}",
    "\u{feff}",
    "\u{a0}",
    "\u{202e}",
    "\u{1b}[31m",
    "\n",
    "\r",
    "\0",
    "true",
    "()",
    "..",
    "1..=2",
    "_",
    "=>",
    "|x|",
    "loop {}",
    "fn f() { f() } f()",
    "\\u{110000}",
    "#![enable(implicit_some)]",
    "-0.0",
    "\r\n",
    "\u{301}",
    "\t",
];

/// Numbers at the limits of the format, and just beyond them.
const LIMITS: [&str; 60] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "0.5",
    "1000",
    "1001",
    "1000000",
    "1000001",
    "100000000",
    "4166666.7",
    "32768",
    "32769",
    "65536",
    "65537",
    "256",
    "257",
    "4096",
    "4097",
    "255",
    "255.1",
    "255.00000000000003",
    "256.0",
    "24.0",
    "1e30",
    "1.1e30",
    "1e60",
    "-1e60",
    "1.1e60",
    "1e61",
    "1e-60",
    "9e-61",
    "1e6",
    "1000000.1",
    "0.001",
    "0.0009",
    "180",
    "179.99999999999997",
    "180.00000000000003",
    "268435456",
    "268435457",
    "4294967295",
    "4294967296",
    "9007199254740993",
    "18446744073709551615",
    "18446744073709551616",
    "340282366920938463463374607431768211456",
    "1.7976931348623157e308",
    "1e309",
    "5e-324",
    "1e-400",
    "NaN",
    "inf",
    "-inf",
    "0x10",
    "0b1",
    "1_000",
    "+1",
    "1e",
];

/// Texts that can be nested or repeated many times.
const LONG: [&str; 14] =
    ["(", "[", "{", "Some(", "(x: ", "\"", "/*", "-", "9", "x", " ", "\n", "#{a: ", "((1, 2, 3), "];

/// Maximum size of a repetition, in bytes.
const LONGEST: usize = 1 << 20;

/// Generates a few edits, either of numbers alone, so that many texts stay valid scenes, or of any kind.
pub(crate) fn edits(scenes: &[Files]) -> impl Strategy<Value = Vec<Edit>> + use<> {
    let any = edit(words_of(scenes));
    prop_oneof![prop::collection::vec(likely_number(), 1..4), prop::collection::vec(any, 1..6)]
}

/// Returns all words of the texts.
fn words_of(scenes: &[Files]) -> Vec<String> {
    let mut words = BTreeSet::new();
    for (_, bytes) in scenes.iter().flat_map(|files| &files.0) {
        let texts =
            tokens(bytes).into_iter().map(|token| String::from_utf8_lossy(&bytes[token]).into_owned());
        words.extend(texts.filter(|text| text.starts_with(|first: char| first.is_alphabetic())));
    }
    words.into_iter().collect()
}

/// Generates numbers that are often valid.
fn likely_number() -> impl Strategy<Value = Edit> {
    let number = prop_oneof![
        3 => number().prop_map(|number| format!("{number:?}")),
        3 => (0.0..1.0f64).prop_map(|number| format!("{number:?}")),
        1 => (0u32..40_000).prop_map(|number| number.to_string()),
    ];
    (0.0..1.0f64, number).prop_map(|(place, number)| Edit::Number { place, number })
}

fn edit(vocabulary: Vec<String>) -> impl Strategy<Value = Edit> {
    let place = || 0.0..1.0f64;
    let removed = prop_oneof![Just(0usize), 0..4usize, 0..60usize];
    let word = prop_oneof![
        prop::sample::select(&SPECIAL[..]).prop_map(str::to_owned),
        prop::sample::select(vocabulary)
    ];
    let times = || prop_oneof![4 => Just(0usize), 4 => 2..4usize, 1 => 4..3000usize];
    let long = (prop::sample::select(&LONG[..]), 100..60_000usize);
    let limit = prop::sample::select(&LIMITS[..]).prop_map(str::to_owned);
    prop_oneof![
        5 => (place(), removed, word).prop_map(|(place, removed, word)| Edit::Splice { place, removed, word, times: 1 }),
        1 => (place(), long).prop_map(|(place, (word, times))| Edit::Splice { place, removed: 0, word: word.to_owned(), times }),
        2 => (place(), prop::collection::vec(any::<u8>(), 1..4)).prop_map(|(place, bytes)| Edit::Bytes { place, bytes }),
        1 => place().prop_map(|place| Edit::End { place }),
        4 => (place(), limit).prop_map(|(place, number)| Edit::Number { place, number }),
        4 => likely_number(),
        2 => (place(), place()).prop_map(|(place, line)| Edit::Line { place, line }),
        4 => (place(), place(), any::<bool>()).prop_map(|(place, other, is_group)| Edit::Move { place, other, is_group }),
        4 => (place(), times(), any::<bool>()).prop_map(|(place, times, is_group)| Edit::Repeat { place, times, is_group }),
    ]
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in the text")]
fn byte_at(text: &[u8], place: f64) -> usize {
    (place * text.len() as f64) as usize
}

/// Returns the tokens of a text: words, numbers and strings as a whole, other bytes one by one, and no whitespace.
pub(crate) fn tokens(text: &[u8]) -> Vec<Range<usize>> {
    let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || b"_.".contains(byte);
    let mut tokens = Vec::new();
    let mut start = 0;
    while start < text.len() {
        let rest = &text[start..];
        let length = match rest[0] {
            b'"' => rest[1..].iter().position(|byte| *byte == b'"').map_or(1, |end| end + 2),
            first if is_word(&first) => rest.iter().position(|byte| !is_word(byte)).unwrap_or(rest.len()),
            _ => 1,
        };
        if !rest[0].is_ascii_whitespace() {
            tokens.push(start..start + length);
        }
        start += length;
    }
    tokens
}

/// Returns the next word, or the next brackets with their content.
fn next(text: &[u8], place: f64, is_group: bool) -> Option<Range<usize>> {
    let (start, tokens) = (byte_at(text, place), tokens(text));
    let first = tokens
        .iter()
        .position(|token| token.start >= start && (!is_group || b"([{".contains(&text[token.start])))?;
    if !is_group {
        return Some(tokens[first].clone());
    }
    let mut depth = 0;
    for token in &tokens[first..] {
        match text[token.start] {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some(tokens[first].start..token.end);
        }
    }
    None
}

impl Edit {
    pub(crate) fn apply(&self, text: &mut Vec<u8>) {
        match self {
            Self::Splice { place, removed, word, times } => {
                let start = byte_at(text, *place);
                let end = (start + removed).min(text.len());
                text.splice(start..end, word.repeat(*times).into_bytes());
            }
            Self::Bytes { place, bytes } => {
                let start = byte_at(text, *place);
                let end = (start + bytes.len()).min(text.len());
                text.splice(start..end, bytes.iter().copied());
            }
            Self::End { place } => text.truncate(byte_at(text, *place)),
            Self::Number { place, number } => {
                let start = byte_at(text, *place);
                let number_from =
                    |token: &Range<usize>| token.start >= start && text[token.start].is_ascii_digit();
                if let Some(token) = tokens(text).into_iter().find(number_from) {
                    let sign = token.start > 0 && text[token.start - 1] == b'-';
                    text.splice(token.start - usize::from(sign)..token.end, number.bytes());
                }
            }
            Self::Line { place, line } => {
                let line_at =
                    |at: usize| text[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
                let (from, start) = (line_at(byte_at(text, *line)), line_at(byte_at(text, *place)));
                let copy: Vec<u8> =
                    text[from..].split_inclusive(|byte| *byte == b'\n').next().unwrap_or_default().to_vec();
                text.splice(start..start, copy);
            }
            Self::Move { place, other, is_group } => {
                if let (Some(from), Some(to)) = (next(text, *place, *is_group), next(text, *other, *is_group))
                {
                    let moved = text[from].to_vec();
                    text.splice(to, moved);
                }
            }
            Self::Repeat { place, times, is_group } => {
                if let Some(range) = next(text, *place, *is_group) {
                    let times = (*times).min(LONGEST / range.len());
                    let repeated = vec![&text[range.clone()]; times].join(&b", "[..]);
                    text.splice(range, repeated);
                }
            }
        }
    }
}

/// Limits the samples and the depth in a text, because large numbers take long.
pub(crate) fn with_little_effort(text: &mut Vec<u8>) {
    let list = tokens(text);
    for index in (2..list.len()).rev() {
        let most = match &text[list[index - 2].clone()] {
            b"samples" => "4",
            b"depth" => "8",
            _ => continue,
        };
        let number =
            std::str::from_utf8(&text[list[index].clone()]).ok().and_then(|text| text.parse::<f64>().ok());
        if number.is_some_and(|number| number > most.parse().unwrap()) {
            text.splice(list[index].clone(), most.bytes());
        }
    }
}
