//! What the headers of portable maps have in common: lines of text.

use std::io::{BufRead, Read};

/// Reads the next line of a header, without its end. Returns why there is none, in words.
pub(super) fn read_line(file: &mut impl BufRead) -> Result<String, String> {
    /// The longest line there is.
    const LONGEST: u64 = 200;
    let mut line = Vec::new();
    file.take(LONGEST).read_until(b'\n', &mut line).map_err(|error| error.to_string())?;
    let line = line.strip_suffix(b"\n").ok_or("its header ends early")?;
    String::from_utf8(line.to_vec()).map_err(|_| "its header is not text".to_owned())
}

/// Reads a number of columns or rows.
pub(super) fn side(text: &str) -> Result<u32, String> {
    text.parse().map_err(|_| "its size is not a number".to_owned())
}
