//! Writes output files other than frames: drawings, pages and tables.

use std::fs;
use std::path::Path;

use anyhow::{Context, ensure};

use rayreel::output::{folder_of, remove_leftovers, write_bytes};

/// Writes a file atomically. An existing path that is not a regular file, such as a pipe or a link, is written in place instead.
pub(super) fn write_file(file: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    if fs::symlink_metadata(file).is_ok_and(|there| !there.is_file()) {
        fs::write(file, bytes).with_context(|| format!("cannot write `{}`", file.display()))
    } else {
        remove_leftovers(folder_of(file));
        Ok(write_bytes(file, bytes)?)
    }
}

/// Returns an error if an output file is the scene file.
pub(super) fn ensure_not_the_scene(file: &Path, scene: &Path) -> anyhow::Result<()> {
    ensure_another(file, scene, "the scene")
}

/// Returns an error if an output file is the input file `read`, which the message calls `name`.
pub(super) fn ensure_another(file: &Path, read: &Path, name: &str) -> anyhow::Result<()> {
    let is_the_same = match (fs::canonicalize(file), fs::canonicalize(read)) {
        (Ok(file), Ok(read)) => file == read,
        _ => false,
    };
    ensure!(!is_the_same, "`{}` is {name} itself: name another file", file.display());
    Ok(())
}
