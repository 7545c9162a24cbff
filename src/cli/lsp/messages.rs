//! Messages of the protocol: a header with the length, an empty line, and JSON.

use std::io::{BufRead, Read};

use anyhow::{Context, ensure};
use serde_json::Value;

/// The longest message: more than a scene file may have.
const LONGEST: u64 = 1 << 31;
/// The longest line of a header.
const LONGEST_LINE: u64 = 1 << 12;

/// Reads a message; `Err` within `Some` for one that is not JSON. Lines that are no header of a message are skipped. Returns `None` at the
/// end of the input.
pub(super) fn read(input: &mut impl BufRead) -> anyhow::Result<Option<serde_json::Result<Value>>> {
    const CANNOT: &str = "cannot read messages";
    let mut length = None;
    loop {
        let mut line = Vec::new();
        if input.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line).context(CANNOT)? == 0 {
            return Ok(None);
        }
        let line = String::from_utf8_lossy(&line).to_ascii_lowercase();
        match (line.trim(), length) {
            ("", Some(_)) => break,
            (header, _) => {
                let written = header.strip_prefix("content-length:").map(str::trim);
                length = written.and_then(|written| written.parse::<u64>().ok()).or(length);
            }
        }
    }
    let length = length.unwrap_or_default();
    ensure!(length <= LONGEST, "a message of {length} bytes is too long: at most {LONGEST} are read");
    let mut content = Vec::new();
    input.by_ref().take(length).read_to_end(&mut content).context(CANNOT)?;
    Ok((content.len() as u64 == length).then(|| serde_json::from_slice(&content)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_read_after_nonsense() {
        let mut input =
            "nonsense\r\n\r\nContent-Length: x\r\n\r\ncontent-length: 2\r\nContent-Type: y\r\n\r\n{}\
            Content-Length: 3\r\n\r\n{a}Content-Length: 9\r\n\r\n1"
                .as_bytes();
        assert_eq!(read(&mut input).unwrap().unwrap().unwrap(), serde_json::json!({}));
        assert!(read(&mut input).unwrap().unwrap().is_err());
        assert!(read(&mut input).unwrap().is_none());
        assert!(read(&mut "Content-Length: 9999999999\r\n\r\n".as_bytes()).is_err());
    }
}
