//! Printing that survives a closed pipe, knows when colours are welcome, and sends no terminal what it would obey.
//!
//! Names, paths and texts from files may hold anything. Everything that is printed goes through here, and what a terminal could
//! take for a command is written as an escape; only [`mistakes`] are printed as they are, and escape what they quote themselves.

use std::borrow::Cow;
use std::io::{ErrorKind, IsTerminal, Write, stderr, stdout};
use std::ops::ControlFlow;

use anyhow::Context;
use serde_json::Value;

use rayreel::scene::{Printable, is_printable};

/// Writes results, line by line. A reader that has gone away is no error of ours; a full disk is.
pub(super) fn result(text: &str) -> anyhow::Result<()> {
    result_part(text).map(|_| ())
}

/// Writes some of the results like [`result`]. Returns whether there is still a reader for more.
pub(super) fn result_part(text: &str) -> anyhow::Result<ControlFlow<()>> {
    write_result(&escaped(text, |character| Printable(character.encode_utf8(&mut [0; 4])).to_string()))
}

/// Writes a line of results like [`result`].
pub(super) fn result_line(text: &str) -> anyhow::Result<()> {
    result(&format!("{}\n", Printable(text)))
}

/// The version of what is said in JSON, in every object that stands alone. It is raised when a field goes or means something else; others
/// may come at any time.
const JSON_VERSION: u32 = 2;

/// Writes a JSON value: an object, or a list of them.
pub(super) fn json(value: Value) -> anyhow::Result<()> {
    json_part(&format!("{:#}\n", versioned(value))).map(|_| ())
}

fn versioned(mut value: Value) -> Value {
    match &mut value {
        Value::Object(object) => {
            object.insert("json_version".to_owned(), JSON_VERSION.into());
        }
        Value::Array(objects) => {
            for object in objects {
                *object = versioned(object.take());
            }
        }
        _ => {}
    }
    value
}

/// Writes some JSON values like [`result_part`]. Characters that a terminal would obey are in their texts only, where they may be
/// escaped.
pub(super) fn json_part(text: &str) -> anyhow::Result<ControlFlow<()>> {
    write_result(&escaped(text, |character| format!("\\u{:04x}", u32::from(character))))
}

fn write_result(text: &str) -> anyhow::Result<ControlFlow<()>> {
    let mut out = stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(ControlFlow::Continue(())),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(ControlFlow::Break(())),
        Err(error) => Err(error).context("cannot write the results"),
    }
}

/// Escapes all unprintable characters of a text but its line ends.
fn escaped(text: &str, escape: impl Fn(char) -> String) -> Cow<'_, str> {
    let stays = |character: char| character == '\n' || is_printable(character);
    if text.chars().all(stays) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        if stays(character) {
            escaped.push(character);
        } else {
            escaped += &escape(character);
        }
    }
    Cow::Owned(escaped)
}

/// Prints a JSON value in a line for the program that follows this one.
pub(super) fn error_json(value: Value) {
    let line = format!("{}\n", versioned(value));
    write_at_once(&escaped(&line, |character| format!("\\u{:04x}", u32::from(character))));
}

/// Prints a line for the person at the terminal, or the log.
pub(super) fn error_line(text: &str) {
    write_at_once(&format!("{}\n", Printable(text)));
}

/// Writes a text to standard error, which is not buffered, in one piece.
fn write_at_once(text: &str) {
    let _ = stderr().lock().write_all(text.as_bytes());
}

/// Prints an error.
pub(super) fn error(text: &str) {
    write_at_once(&format!("{} {}\n", error_word(), Printable(text)));
}

/// Prints a warning, and lines about it.
pub(super) fn warning(text: &str, about: &[String]) {
    let mut told = format!("{} {}\n", warning_word(), Printable(text));
    for line in about {
        told += &format!("{}\n", Printable(line));
    }
    write_at_once(&told);
}

/// Prints mistakes in scenes, shown as a compiler would by `render`, which is told whether colours are welcome and escapes what
/// it shows of files: its colours are the only commands.
pub(super) fn mistakes(render: impl FnOnce(bool) -> String) {
    write_at_once(&format!("{}\n", render(is_colorful())));
}

/// Returns whether standard error may be coloured. See <https://no-color.org>.
fn is_colorful() -> bool {
    let unwanted = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    stderr().is_terminal() && !unwanted && !is_dumb()
}

/// Returns whether the terminal, if there is one, can do no more than print lines.
pub(super) fn is_dumb() -> bool {
    std::env::var_os("TERM").is_some_and(|terminal| terminal == "dumb")
}

/// Returns `error:`, as bold and red as may be.
fn error_word() -> &'static str {
    if is_colorful() { "\u{1b}[1m\u{1b}[91merror\u{1b}[0m\u{1b}[1m:\u{1b}[0m" } else { "error:" }
}

/// Returns `warning:`, as bold and yellow as may be.
fn warning_word() -> &'static str {
    if is_colorful() { "\u{1b}[1m\u{1b}[93mwarning\u{1b}[0m\u{1b}[1m:\u{1b}[0m" } else { "warning:" }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn objects_have_a_version_and_nothing_else_has() {
        let objects = json!([{ "a": { "b": 1 } }, 2, "text"]);
        let version = json!({ "a": { "b": 1 }, "json_version": JSON_VERSION });
        assert_eq!(versioned(objects), json!([version, 2, "text"]));
    }
}
