//! Headers of portable maps: words separated by whitespace.

use std::io::{BufRead, Read};

/// The reader of the words of a header, which is short, and of the comments between them.
#[derive(Default)]
pub(super) struct Words {
    pub(super) comments: Vec<String>,
}

impl Words {
    /// Reads the next word and the single whitespace character after it. Returns the reason if there is no word.
    pub(super) fn next(&mut self, file: &mut impl BufRead) -> Result<String, String> {
        /// Maximum length of a line in bytes.
        const LONGEST: usize = 200;
        let mut word = String::new();
        loop {
            let mut byte = [0];
            file.read_exact(&mut byte).map_err(|_| "its header ends early")?;
            match byte[0] {
                b' ' | b'\t' | b'\n' | b'\r' if word.is_empty() => {}
                b' ' | b'\t' | b'\n' | b'\r' => return Ok(word),
                b'#' if word.is_empty() => {
                    let mut line = Vec::new();
                    file.take(LONGEST as u64)
                        .read_until(b'\n', &mut line)
                        .map_err(|error| error.to_string())?;
                    let line = line.strip_suffix(b"\n").ok_or("its header ends early")?;
                    let line = std::str::from_utf8(line).map_err(|_| "its header is not text")?;
                    self.comments.push(line.strip_prefix(' ').unwrap_or(line).to_owned());
                }
                graphic if graphic.is_ascii_graphic() => word.push(char::from(graphic)),
                _ => return Err("its header is not text".to_owned()),
            }
            if word.len() + self.comments.len() > LONGEST {
                return Err("its header does not end".to_owned());
            }
        }
    }

    /// Reads a width or height.
    pub(super) fn side(&mut self, file: &mut impl BufRead) -> Result<u32, String> {
        self.next(file)?.parse().map_err(|_| "its size is not a number".to_owned())
    }
}
