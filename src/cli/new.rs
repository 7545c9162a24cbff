//! `rayreel new`

use std::io::ErrorKind;

use anyhow::anyhow;

use rayreel::output::{WriteError, folder_of, remove_leftovers, write_new};
use rayreel::scene::TEMPLATE;

use super::args::NewArguments;
use super::exit::Failure;
use super::new_from::scene_of;
use super::print;

pub(super) fn run(arguments: &NewArguments) -> Result<(), Failure> {
    let path = arguments.file.display();
    let text = match &arguments.from {
        Some(data) => scene_of(data, &arguments.file)?,
        None => TEMPLATE.to_owned(),
    };
    remove_leftovers(folder_of(&arguments.file));
    match write_new(&arguments.file, text.as_bytes()) {
        Ok(()) => {}
        Err(WriteError::File { source, .. }) if source.kind() == ErrorKind::AlreadyExists => {
            return Err(anyhow!("`{path}` exists already, and is left as it is: choose another name").into());
        }
        Err(error) => return Err(anyhow!(error).into()),
    }
    print::result_line(&format!("wrote {path}; render it with: rayreel render {path}"))?;
    Ok(())
}
