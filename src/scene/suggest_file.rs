//! "Did you mean" suggestions for files.

use std::fs;
use std::path::Path;

use super::suggest;

/// Returns the remedy for a missing file: the most similar name in its directory that satisfies `fits`, with the directory written as in
/// `written`.
pub(super) fn nearby(path: &Path, written: &Path, fits: impl Fn(&str) -> bool) -> Option<String> {
    let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Ok(entries) = fs::read_dir(directory) else {
        return Some(format!("there is no directory `{}` either", directory.display()));
    };
    let mut names: Vec<String> = entries
        .flatten()
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| fits(name))
        .collect();
    names.sort_unstable();
    let wanted = path.file_name()?.to_str()?;
    let name = suggest::nearest(wanted, names.iter().map(String::as_str))?;
    Some(format!("did you mean `{}`?", written.with_file_name(name).display()))
}
