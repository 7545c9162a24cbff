//! The command-line interface.
//!
//! [`args`] defines the arguments as typed, [`settings`] holds the validated settings of `render`, and every command has its own
//! file. Results go to standard output, everything else to standard error.

mod accuracy;
mod args;
mod check;
mod choice;
mod compare;
mod completions;
mod deadline;
mod draft;
mod exit;
mod explain;
mod farm;
mod heat_map;
#[cfg(target_os = "linux")]
mod huge_pages;
mod instructions;
mod interrupt;
mod lsp;
mod man;
mod manifest;
mod measure_progress;
mod movie;
mod new;
mod new_from;
mod overrides;
mod print;
mod probe;
mod progress;
mod render;
mod report;
mod schema;
mod settings;
mod settings_file;
mod sheet;
mod stream;
mod values;
mod verify;
mod warnings;
mod watch;
mod write_file;

#[cfg(target_os = "linux")]
pub(crate) use huge_pages::HugePages;

use std::process::ExitCode;

use clap::Parser;
use clap::error::{ContextKind, ContextValue};

use rayreel::scene::Printable;

use args::{Arguments, Command, SchemaArguments};
use exit::Failure;
use interrupt::Interruption;

/// Parses the command line and runs the command.
pub(crate) fn run() -> ExitCode {
    let Ok(arguments) =
        Arguments::try_parse().or_else(|_| match Arguments::try_parse_from(printable_arguments()) {
            Err(error) => shortened(error).exit(),
            Ok(_) => Err(()),
        })
    else {
        // Parsing succeeded only with the escaped arguments.
        print::error(
            "an argument has bytes that are not UTF-8, or control characters, where text is needed: write it as text",
        );
        return ExitCode::from(2);
    };
    let result = Interruption::listen()
        .map_err(Failure::from)
        .and_then(|interruption| run_command(arguments.command, &interruption));
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print();
            failure.code()
        }
    }
}

/// Returns the arguments with unprintable characters escaped, for error messages. File names may contain any bytes.
fn printable_arguments() -> impl Iterator<Item = String> {
    std::env::args_os().map(|argument| Printable(&argument.to_string_lossy()).to_string())
}

/// Truncates long arguments that an error quotes.
fn shortened(mut error: clap::Error) -> clap::Error {
    /// Maximum number of characters quoted, more than realistic arguments have.
    const LONGEST: usize = 200;
    for kind in [ContextKind::InvalidArg, ContextKind::InvalidValue, ContextKind::InvalidSubcommand] {
        if let Some(ContextValue::String(argument)) = error.get(kind)
            && let Some((end, _)) = argument.char_indices().nth(LONGEST)
        {
            let cut = format!("{}…", &argument[..end]);
            error.insert(kind, ContextValue::String(cut));
        }
    }
    error
}

fn run_command(command: Command, interruption: &Interruption) -> Result<(), Failure> {
    match command {
        Command::Render(arguments) => render::run(&arguments, interruption),
        Command::Watch(arguments) => watch::run(&arguments, interruption),
        Command::Check(arguments) => check::run(&arguments),
        Command::Explain(arguments) => explain::run(&arguments),
        Command::Accuracy(arguments) => accuracy::run(&arguments, interruption),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Probe(arguments) => probe::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments, interruption),
        Command::Farm(arguments) => farm::run(&arguments),
        Command::New(arguments) => new::run(&arguments),
        Command::Lsp(arguments) => lsp::run(&arguments),
        Command::Schema(SchemaArguments {}) => schema::run(),
        Command::Man(arguments) => man::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
    }
}
