//! Words of POSIX shell scripts, which can only be created by quoting.

use std::fmt::{self, Display, Formatter};
use std::ops::Add;

use super::one_line;

/// A word that a shell reads as exactly one argument. Adding words joins them into one word.
pub(super) struct ShellWord(String);

impl ShellWord {
    /// Quotes a text, which must be printable and on one line: scripts must be readable, and a line of the text could end a here-document.
    pub(super) fn quote(text: &str) -> anyhow::Result<Self> {
        let text = one_line(text)?;
        let is_plain = |character: char| character.is_ascii_alphanumeric() || "-_./:=,@+".contains(character);
        let is_bare = !text.is_empty() && text.chars().all(is_plain);
        Ok(Self(if is_bare { text.to_owned() } else { format!("'{}'", text.replace('\'', "'\\''")) }))
    }

    /// Returns a word that expands to the value of a variable, whatever characters the value contains.
    pub(super) fn variable(name: &'static str) -> Self {
        Self(format!("\"${{{name}}}\""))
    }

    /// Joins words into one command.
    pub(super) fn command(words: &[Self]) -> String {
        words.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
    }
}

impl Add for ShellWord {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0.as_str())
    }
}

impl Display for ShellWord {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}
