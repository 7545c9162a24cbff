//! Printing that survives a closed pipe, and knows when colours are welcome.

use std::io::{IsTerminal, Write, stderr, stdout};

/// A line of results. A reader that has gone away is no error of ours.
pub(super) fn result_line(text: &str) {
    let _ = writeln!(stdout().lock(), "{text}");
}

/// A line for the person at the terminal, or the log.
pub(super) fn error_line(text: &str) {
    let _ = writeln!(stderr().lock(), "{text}");
}

/// May standard error be coloured? See <https://no-color.org>.
pub(super) fn is_colorful() -> bool {
    let unwanted = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let dumb = std::env::var_os("TERM").is_some_and(|terminal| terminal == "dumb");
    stderr().is_terminal() && !unwanted && !dumb
}

/// `error:`, as bold and red as may be.
pub(super) fn error_word() -> &'static str {
    if is_colorful() { "\u{1b}[1m\u{1b}[91merror\u{1b}[0m\u{1b}[1m:\u{1b}[0m" } else { "error:" }
}
