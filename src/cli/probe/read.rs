//! Reads rays from text: lines of six numbers, separated by commas.

use std::io::{BufRead, BufReader, Read, stdin};
use std::path::Path;

use anyhow::{Context, anyhow};

use rayreel::Ray;
use rayreel::scene::input::{self, InputError, InputKind};

/// The names of the six numbers. A first line that consists of this header is skipped.
const HEADER: &str = "ox,oy,oz,dx,dy,dz";

/// Maximum length of a line in bytes, which bounds memory: far more than six numbers with all their digits need.
const LONGEST_LINE: u64 = 1 << 16;

/// Reader of rays, line by line.
pub(super) struct RayReader {
    source: Box<dyn BufRead>,
    /// Name of the source in messages.
    name: String,
    line: Vec<u8>,
    /// The number of lines read so far.
    count: u64,
    /// True until the first line that is not blank has been read; that line may be a header.
    at_start: bool,
}

/// A mistake in a line, with its column, counted from 1, if it is in a single field.
#[derive(Debug, PartialEq)]
struct LineMistake {
    column: Option<usize>,
    message: String,
}

impl RayReader {
    /// Opens a file, or standard input if the path is `-`.
    pub(super) fn open(path: &Path) -> anyhow::Result<Self> {
        if path.as_os_str() == "-" {
            return Ok(Self::new("standard input".to_owned(), stdin().lock()));
        }
        let name = path.display().to_string();
        let file = input::open(path, InputKind::Accepted, u64::MAX).map_err(|error| match error {
            InputError::NotAFile => {
                anyhow!("`{name}` is not a file: name a file of rays, or - for standard input")
            }
            error => anyhow!(error).context(format!("cannot read `{name}`")),
        })?;
        Ok(Self::new(name, BufReader::with_capacity(1 << 16, file)))
    }

    fn new(name: String, source: impl BufRead + 'static) -> Self {
        Self { source: Box::new(source), name, line: Vec::new(), count: 0, at_start: true }
    }

    /// Appends the next rays, until there are `count` or the input ends. After an error, `rays` holds the rays before the mistake.
    pub(super) fn read(&mut self, rays: &mut Vec<Ray>, count: usize) -> anyhow::Result<()> {
        while rays.len() < count && self.read_line()? {
            let line = String::from_utf8_lossy(&self.line);
            let is_first = std::mem::take(&mut self.at_start);
            if is_first && line.trim() == HEADER {
                continue;
            }
            match parse(&line) {
                Ok(ray) => rays.push(ray),
                Err(LineMistake { column, message }) => {
                    let column = column.map_or_else(String::new, |column| format!(":{column}"));
                    return Err(anyhow!("{}:{}{column}: {message}", self.name, self.count));
                }
            }
        }
        Ok(())
    }

    /// Reads the next line that is not blank. Returns `false` at the end of the input.
    fn read_line(&mut self) -> anyhow::Result<bool> {
        loop {
            self.line.clear();
            let mut limited = (&mut self.source).take(LONGEST_LINE);
            let length = limited
                .read_until(b'\n', &mut self.line)
                .with_context(|| format!("cannot read `{}`", self.name))?;
            self.count += 1;
            if length == 0 {
                return Ok(false);
            }
            if length as u64 == LONGEST_LINE && !self.line.ends_with(b"\n") {
                return Err(anyhow!(
                    "{}:{}: the line is longer than {LONGEST_LINE} bytes: write every ray, {HEADER}, on a line of its own",
                    self.name,
                    self.count
                ));
            }
            // Removes a byte order mark before the first number.
            if self.count == 1 && self.line.starts_with("\u{feff}".as_bytes()) {
                self.line.drain(.."\u{feff}".len());
            }
            if !self.line.trim_ascii().is_empty() {
                return Ok(true);
            }
        }
    }
}

/// Parses the value of `--ray`.
pub(in crate::cli) fn parse_ray(text: &str) -> Result<Ray, String> {
    parse(text).map_err(|mistake| mistake.message)
}

fn parse(line: &str) -> Result<Ray, LineMistake> {
    let mut numbers = [0.0_f64; 6];
    let mut columns = [0; 6];
    let count = line.split(',').count();
    if count != numbers.len() {
        let values = if count == 1 { "1 value".to_owned() } else { format!("{count} values") };
        let message = format!("{values} instead of 6: write a ray as {HEADER}, its origin and its direction");
        return Err(LineMistake { column: None, message });
    }
    let mut start = 0;
    for ((number, column), field) in numbers.iter_mut().zip(&mut columns).zip(line.split(',')) {
        let text = field.trim();
        let before = start + (field.len() - field.trim_start().len());
        *column = line[..before].chars().count() + 1;
        start += field.len() + 1;
        let mistake = |message: String| LineMistake { column: Some(*column), message };
        *number = text
            .parse()
            .map_err(|_| mistake(format!("`{text}` is not a number: write one such as 1, -0.25 or 1e-3")))?;
        if !number.is_finite() {
            return Err(mistake(format!(
                "`{text}` is not finite: write a number from -1.7976931348623157e308 to 1.7976931348623157e308"
            )));
        }
    }
    let [ox, oy, oz, dx, dy, dz] = numbers;
    if [dx, dy, dz] == [0.0; 3] {
        let message = "the direction is zero: let at least one of dx, dy and dz be another number".to_owned();
        return Err(LineMistake { column: Some(columns[3]), message });
    }
    Ok(Ray { origin: [ox, oy, oz].into(), direction: [dx, dy, dz].into() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (usize, Result<(), String>) {
        let mut reader = RayReader::new("rays.csv".to_owned(), std::io::Cursor::new(text.to_owned()));
        let mut rays = Vec::new();
        let read = reader.read(&mut rays, 100).map_err(|error| error.to_string());
        (rays.len(), read)
    }

    #[test]
    fn blank_lines_headers_byte_order_marks_and_line_endings_are_ignored() {
        for text in [
            "0,0,0,0,0,1\n1,2,3,4,5,6\n",
            "\u{feff}ox,oy,oz,dx,dy,dz\r\n0,0,0,0,0,1\r\n\r\n1,2,3,4,5,6",
            "\n \n  ox,oy,oz,dx,dy,dz\n\n 0, 0,0 ,0,0,1e0\n\t\n+1,2.,.3,4,5,6\n\n",
        ] {
            assert_eq!(read(text), (2, Ok(())), "{text}");
        }
        assert_eq!(read(""), (0, Ok(())));
        assert_eq!(read("ox,oy,oz,dx,dy,dz"), (0, Ok(())));
    }

    #[test]
    fn mistakes_have_line_column_and_remedy() {
        for (text, message) in [
            (
                "0,0,0,0,0,1\r\n\r\n1,2,3,4,5\r\n",
                "rays.csv:3: 5 values instead of 6: write a ray as ox,oy,oz,dx,dy,dz, its origin and its direction",
            ),
            ("\n0,0, ä ,0,0,1", "rays.csv:2:6: `ä` is not a number: write one such as 1, -0.25 or 1e-3"),
            ("0,,0,0,0,1", "rays.csv:1:3: `` is not a number: write one such as 1, -0.25 or 1e-3"),
            (
                "1,2,3,4,5,1e999",
                "rays.csv:1:11: `1e999` is not finite: write a number from -1.7976931348623157e308 to 1.7976931348623157e308",
            ),
            (
                "1,2,3,0,-0,0e9",
                "rays.csv:1:7: the direction is zero: let at least one of dx, dy and dz be another number",
            ),
            (
                "1,2,3,4,5,6\nox,oy,oz,dx,dy,dz",
                "rays.csv:2:1: `ox` is not a number: write one such as 1, -0.25 or 1e-3",
            ),
        ] {
            assert_eq!(read(text).1, Err(message.to_owned()));
        }
        let (_, result) = read(&"1".repeat(1 << 17));
        assert_eq!(
            result.unwrap_err(),
            "rays.csv:1: the line is longer than 65536 bytes: write every ray, ox,oy,oz,dx,dy,dz, on a line of its own"
        );
    }
}
