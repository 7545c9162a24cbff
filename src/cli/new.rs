//! `rayreel new`

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};

use anyhow::{Context, anyhow};

use rayreel::scene::TEMPLATE;

use super::args::NewArguments;
use super::exit::Failure;
use super::print;

pub(super) fn run(arguments: &NewArguments) -> Result<(), Failure> {
    let path = arguments.file.display();
    let opened = OpenOptions::new().write(true).create_new(true).open(&arguments.file);
    let mut file = match opened {
        Ok(file) => file,
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            return Err(anyhow!("`{path}` exists already, and is left as it is: choose another name").into());
        }
        Err(error) => return Err(anyhow!(error).context(format!("cannot write `{path}`")).into()),
    };
    file.write_all(TEMPLATE.as_bytes()).with_context(|| format!("cannot write `{path}`"))?;
    print::result_line(&format!("wrote {path}; render it with: rayreel render {path}"))?;
    Ok(())
}
