//! The `rayreel` command: arguments to settings to calls of the library, and all printing.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
