//! `rayreel completions`

use std::io::Write;

use clap::CommandFactory;

use super::args::{Arguments, CompletionsArguments};
use super::exit::Failure;

pub(super) fn run(arguments: &CompletionsArguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "rayreel", &mut script);
    // A reader that has gone away is no error of ours.
    let _ = std::io::stdout().write_all(&script);
    Ok(())
}
