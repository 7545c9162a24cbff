//! The `rayreel` command: parses arguments, calls the library and prints the results.

mod cli;

#[cfg(target_os = "linux")]
#[global_allocator]
static ALLOCATOR: cli::HugePages = cli::HugePages;

fn main() -> std::process::ExitCode {
    cli::run()
}
