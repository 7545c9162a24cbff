//! Printing: handles closed pipes, uses colours only where they are supported, and escapes control characters.
//!
//! Names, paths and texts from files may contain any character. All output passes through this module, which escapes the characters
//! that a terminal could interpret as a command. Only [`mistakes`] prints its text unchanged; that text is escaped when it is rendered.

use std::borrow::Cow;
use std::io::{ErrorKind, IsTerminal, Write, stderr, stdout};
use std::ops::ControlFlow;

use anyhow::Context;
use serde_json::Value;

use rayreel::scene::{Printable, is_printable};

/// Writes results to standard output. A closed pipe is not an error; a full disk is.
pub(super) fn result(text: &str) -> anyhow::Result<()> {
    result_part(text).map(|_| ())
}

/// Writes a part of the results like [`result`]. Returns `Break` if the pipe is closed.
pub(super) fn result_part(text: &str) -> anyhow::Result<ControlFlow<()>> {
    write_result(&escaped(text, |character| Printable(character.encode_utf8(&mut [0; 4])).to_string()))
}

/// Writes a line of results like [`result`].
pub(super) fn result_line(text: &str) -> anyhow::Result<()> {
    result(&format!("{}\n", Printable(text)))
}

/// Version of the JSON output, contained in every top-level object. It is raised when a field is removed or changes its meaning; fields may
/// be added at any time.
const JSON_VERSION: u32 = 2;

/// Writes a JSON object or a list of JSON objects.
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

/// Writes JSON text like [`result_part`]. Control characters occur only inside strings, where they can be escaped.
pub(super) fn json_part(text: &str) -> anyhow::Result<ControlFlow<()>> {
    write_result(&escaped(text, |character| format!("\\u{:04x}", u32::from(character))))
}

/// Writes a message of the language server protocol like [`json_part`], after its length.
pub(super) fn protocol_message(message: &Value) -> anyhow::Result<ControlFlow<()>> {
    let message = message.to_string();
    let message = escaped(&message, |character| format!("\\u{:04x}", u32::from(character)));
    write_result(&format!("Content-Length: {}\r\n\r\n{message}", message.len()))
}

fn write_result(text: &str) -> anyhow::Result<ControlFlow<()>> {
    let mut out = stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(ControlFlow::Continue(())),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(ControlFlow::Break(())),
        Err(error) => Err(error).context("cannot write the results"),
    }
}

/// Escapes all unprintable characters of a text except line ends.
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

/// Prints a JSON value on one line of standard error, for programs that read the progress.
pub(super) fn error_json(value: Value) {
    let line = format!("{}\n", versioned(value));
    write_at_once(&escaped(&line, |character| format!("\\u{:04x}", u32::from(character))));
}

/// Prints a line on standard error, for a terminal or a log.
pub(super) fn error_line(text: &str) {
    write_at_once(&format!("{}\n", Printable(text)));
}

/// Writes a text to standard error, which is unbuffered, in a single call.
fn write_at_once(text: &str) {
    let _ = stderr().lock().write_all(text.as_bytes());
}

/// Prints an error.
pub(super) fn error(text: &str) {
    write_at_once(&format!("{} {}\n", error_word(), Printable(text)));
}

/// Prints a warning and the lines about it.
pub(super) fn warning(text: &str, about: &[String]) {
    let mut lines = format!("{} {}\n", warning_word(), Printable(text));
    for line in about {
        lines += &format!("{}\n", Printable(line));
    }
    write_at_once(&lines);
}

/// Prints mistakes in scenes in the style of compiler errors. The argument of `render` is true if colours are allowed. `render` must
/// escape the text it quotes from files: its colours are the only control sequences.
pub(super) fn mistakes(render: impl FnOnce(bool) -> String) {
    write_at_once(&format!("{}\n", render(is_colorful())));
}

/// Returns whether standard error may be coloured. See <https://no-color.org>.
fn is_colorful() -> bool {
    let unwanted = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    stderr().is_terminal() && !unwanted && !is_dumb()
}

/// Returns whether the terminal, if there is one, can only print lines.
pub(super) fn is_dumb() -> bool {
    std::env::var_os("TERM").is_some_and(|terminal| terminal == "dumb")
}

/// Returns `error:`, in bold red if colours are allowed.
fn error_word() -> &'static str {
    if is_colorful() { "\u{1b}[1m\u{1b}[91merror\u{1b}[0m\u{1b}[1m:\u{1b}[0m" } else { "error:" }
}

/// Returns `warning:`, in bold yellow if colours are allowed.
fn warning_word() -> &'static str {
    if is_colorful() { "\u{1b}[1m\u{1b}[93mwarning\u{1b}[0m\u{1b}[1m:\u{1b}[0m" } else { "warning:" }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn json_objects_alone_have_a_version() {
        let objects = json!([{ "a": { "b": 1 } }, 2, "text"]);
        let version = json!({ "a": { "b": 1 }, "json_version": JSON_VERSION });
        assert_eq!(versioned(objects), json!([version, 2, "text"]));
    }
}
