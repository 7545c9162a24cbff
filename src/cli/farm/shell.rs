//! Words of POSIX shell scripts, which can only be made by quoting.

use std::fmt::{self, Display, Formatter};
use std::ops::Add;

use super::one_line;

/// A word that a shell reads as exactly one argument. Words that are added together are one word.
pub(super) struct ShellWord(String);

impl ShellWord {
    /// Quotes a text, which must be printable and on one line: scripts are read by people, and here-documents end at lines.
    pub(super) fn quote(text: &str) -> anyhow::Result<Self> {
        let text = one_line(text)?;
        let is_plain = |character: char| character.is_ascii_alphanumeric() || "-_./:=,@+".contains(character);
        let is_bare = !text.is_empty() && text.chars().all(is_plain);
        Ok(Self(if is_bare { text.to_owned() } else { format!("'{}'", text.replace('\'', "'\\''")) }))
    }

    /// Returns the value of a variable, whatever it holds.
    pub(super) fn variable(name: &'static str) -> Self {
        Self(format!("\"${{{name}}}\""))
    }

    /// Returns the words of one command.
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
