//! Escaping of external text for terminals.

use std::fmt::{self, Write};

/// Returns whether a character is safe to print to a terminal. Control characters are not, because they can start escape sequences.
/// Directional marks and line separators are not, because they can display other characters out of place. A tab is harmless.
#[must_use]
pub fn is_printable(character: char) -> bool {
    const MARKS: [char; 14] = [
        '\u{61c}', '\u{200e}', '\u{200f}', '\u{2028}', '\u{2029}', '\u{202a}', '\u{202b}', '\u{202c}',
        '\u{202d}', '\u{202e}', '\u{2066}', '\u{2067}', '\u{2068}', '\u{2069}',
    ];
    character.is_ascii_graphic()
        || character == ' '
        || character == '\t'
        || !character.is_control() && !MARKS.contains(&character)
}

/// A display wrapper that prints any text on one line of a terminal. Characters that are not [printable](is_printable) are escaped as in a
/// scene file.
///
/// ```
/// use rayreel::scene::Printable;
///
/// assert_eq!(Printable("red \u{1b}[31m\n").to_string(), r"red \u{1b}[31m\n");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Printable<'a>(pub &'a str);

impl fmt::Display for Printable<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for character in self.0.chars() {
            if is_printable(character) {
                formatter.write_char(character)?;
            } else {
                write!(formatter, "{}", character.escape_default())?;
            }
        }
        Ok(())
    }
}
