//! The command line.
//!
//! [`args`] is what was typed, [`settings`] is what it means; every command has a file of its own. Results go to standard
//! output, everything else to standard error.

mod args;
mod check;
mod completions;
mod draft;
mod exit;
mod explain;
mod interrupt;
mod new;
mod print;
mod probe;
mod progress;
mod render;
mod report;
mod settings;
mod sheet;
mod watch;

use std::process::ExitCode;

use clap::Parser;

use args::{Arguments, Command};

/// Runs the command that was typed.
pub(crate) fn run() -> ExitCode {
    let arguments = Arguments::parse();
    let result = match arguments.command {
        Command::Render(arguments) => render::run(&arguments),
        Command::Watch(arguments) => watch::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Explain(arguments) => explain::run(&arguments),
        Command::Probe(arguments) => probe::run(&arguments),
        Command::New(arguments) => new::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print();
            failure.code()
        }
    }
}
