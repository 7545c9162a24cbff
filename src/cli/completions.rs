//! `rayreel completions`

use clap::CommandFactory;

use super::args::{Arguments, CompletionsArguments};
use super::exit::Failure;
use super::print;

pub(super) fn run(arguments: &CompletionsArguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "rayreel", &mut script);
    print::result(&String::from_utf8_lossy(&script))?;
    Ok(())
}
