//! Printing that survives a closed pipe, and knows when colours are welcome.

use std::io::{ErrorKind, IsTerminal, Write, stderr, stdout};
use std::ops::ControlFlow;

use anyhow::Context;

/// Writes results. A reader that has gone away is no error of ours; a full disk is.
pub(super) fn result(text: &str) -> anyhow::Result<()> {
    result_part(text.as_bytes()).map(|_| ())
}

/// Some of the results, as [`result`]. Says whether there is still a reader for more.
pub(super) fn result_part(bytes: &[u8]) -> anyhow::Result<ControlFlow<()>> {
    let mut out = stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Ok(()) => Ok(ControlFlow::Continue(())),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(ControlFlow::Break(())),
        Err(error) => Err(error).context("cannot write the results"),
    }
}

/// A line of results, as [`result`].
pub(super) fn result_line(text: &str) -> anyhow::Result<()> {
    result(&format!("{text}\n"))
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
