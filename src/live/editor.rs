//! The command that opens a file in an editor.

use std::process::{Command, Stdio};
use std::str::FromStr;
use std::thread;

/// A command that opens a file at a line, such as `code -g {file}:{line}:{column}`: words between spaces, without a shell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EditorCommand(Vec<String>);

/// The error for a command without `{file}`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "write a command with {{file}} and, if it takes them, {{line}} and {{column}}, as in `code -g {{file}}:{{line}}:{{column}}`"
)]
pub struct NoEditorCommand;

impl FromStr for EditorCommand {
    type Err = NoEditorCommand;

    fn from_str(text: &str) -> Result<Self, NoEditorCommand> {
        let words: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
        // The program itself is not a placeholder.
        let names_a_file = words.iter().skip(1).any(|word| word.contains("{file}"));
        if names_a_file { Ok(Self(words)) } else { Err(NoEditorCommand) }
    }
}

impl EditorCommand {
    /// Returns the words of the command for a place.
    fn words(&self, place: &Place<'_>) -> Vec<String> {
        let replaced = |word: &String| {
            word.replace("{line}", &place.line.to_string())
                .replace("{column}", &place.column.to_string())
                .replace("{file}", place.file)
        };
        self.0.iter().map(replaced).collect()
    }

    /// Starts the editor, which is not awaited. Returns the reason why it could not be started.
    pub(super) fn open(&self, place: &Place<'_>) -> Result<(), String> {
        let words = self.words(place);
        let Some((program, arguments)) = words.split_first() else { return Ok(()) };
        let mut command = Command::new(program);
        command.args(arguments).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = command.spawn().map_err(|error| format!("`{program}` cannot be started: {error}"))?;
        // A finished process that is not waited for would remain until the end of this one.
        thread::spawn(move || child.wait());
        Ok(())
    }
}

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place<'a> {
    pub(super) file: &'a str,
    /// The line, from 1.
    pub(super) line: usize,
    /// The column, from 1.
    pub(super) column: usize,
}

impl<'a> Place<'a> {
    /// Parses a place as messages have it, such as `ball.ron:12` or `ball.ron:12:3`.
    pub(super) fn parse(text: &'a str) -> Self {
        let number = |text: &'a str| {
            let (rest, number) = text.rsplit_once(':')?;
            Some((rest, number.parse::<usize>().ok()?))
        };
        match number(text).map(|(rest, last)| (rest, last, number(rest))) {
            Some((_, column, Some((file, line)))) => Self { file, line, column },
            Some((file, line, None)) => Self { file, line, column: 1 },
            None => Self { file: text, line: 1, column: 1 },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_filled_in_word_by_word() {
        let command: EditorCommand = " code  -g {file}:{line}:{column} ".parse().unwrap();
        let words = command.words(&Place::parse("a b/{line}; rm.ron:12:3"));
        assert_eq!(words, ["code", "-g", "a b/{line}; rm.ron:12:3"]);
        for text in ["", "code", "{file}", "code {line}"] {
            assert_eq!(text.parse::<EditorCommand>(), Err(NoEditorCommand), "{text}");
        }
        let message = NoEditorCommand.to_string();
        assert!(message.contains("`code -g {file}:{line}:{column}`"), "{message}");
    }

    #[test]
    fn places_are_parsed() {
        for (text, file, line, column) in [
            ("ball.ron", "ball.ron", 1, 1),
            ("ball.ron:12", "ball.ron", 12, 1),
            ("C:\\a:b.ron:12:3", "C:\\a:b.ron", 12, 3),
            ("C:\\ball.ron", "C:\\ball.ron", 1, 1),
        ] {
            assert_eq!(Place::parse(text), Place { file, line, column }, "{text}");
        }
    }
}
