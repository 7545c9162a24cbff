//! The `rayreel` command: parses arguments, calls the library and prints the results.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
