//! `rayreel man`: manual pages, generated from the same definitions as `--help`.

use anyhow::{Context, anyhow};
use clap::CommandFactory;
use clap_mangen::Man;

use super::args::{Arguments, ManArguments};
use super::exit::Failure;
use super::print;

pub(super) fn run(arguments: &ManArguments) -> Result<(), Failure> {
    let mut all = Arguments::command();
    // Sets the full names of subcommands.
    all.build();
    let command = match &arguments.command {
        None => all,
        Some(name) => {
            all.find_subcommand(name).cloned().ok_or_else(|| anyhow!("there is no command `{name}`"))?
        }
    };
    let mut page = Vec::new();
    Man::new(command).render(&mut page).context("cannot write the page")?;
    Ok(print::result(&String::from_utf8_lossy(&page))?)
}
