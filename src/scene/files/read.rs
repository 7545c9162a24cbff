//! Reads files as text.

use std::io::ErrorKind;
use std::path::Path;

use crate::scene::Diagnostic;
use crate::scene::input::{InputError, InputFiles, InputKind, LARGEST_FILE};
use crate::scene::suggest_file::nearby;

/// Maximum depth of nested includes, and number of scenes that a scene extends, one through the other.
pub(super) const DEEPEST: usize = 32;

/// The content of a file.
#[derive(Debug)]
pub(super) enum FileContent {
    Text(String),
    /// Text that is not UTF-8, decoded lossily, with the diagnostic of its first invalid byte.
    Invalid(String, Diagnostic),
}

/// The reason why a file could not be read.
#[derive(Debug)]
pub(super) struct ReadFailure {
    pub(super) message: String,
    pub(super) label: &'static str,
    pub(super) help: Option<String>,
}

/// Reads a scene file, or standard input.
pub(super) fn read(path: &Path, files: &mut InputFiles) -> Result<FileContent, ReadFailure> {
    content(path, path, InputKind::Accepted, files)
}

/// Reads a file that is included as `written`. Streams are rejected, because they cannot be read again.
pub(super) fn read_included(
    path: &Path,
    written: &Path,
    files: &mut InputFiles,
) -> Result<FileContent, ReadFailure> {
    content(path, written, InputKind::Refused, files)
}

fn content(
    path: &Path,
    written: &Path,
    offered: InputKind,
    files: &mut InputFiles,
) -> Result<FileContent, ReadFailure> {
    let bytes =
        files.read(path, offered, LARGEST_FILE).map_err(|error| ReadFailure::of(&error, path, written))?;
    Ok(String::from_utf8(bytes).map_or_else(|error| invalid_text(&error), FileContent::Text))
}

impl ReadFailure {
    fn of(error: &InputError, path: &Path, written: &Path) -> Self {
        let file = path.display();
        let name_a_scene = || Some("name a scene file, such as one that ends in .ron".to_owned());
        let error = match error {
            InputError::System(error) => error,
            InputError::NotAFile => {
                let message = format!("`{file}` is not a file");
                return Self { message, label: "a device or a pipe", help: name_a_scene() };
            }
            InputError::TooLarge(most) => {
                let message = format!("`{file}` is too large for a scene file");
                let help = format!("a scene file has at most {most} bytes: let scripts spawn what is many");
                return Self { message, label: "too large", help: Some(help) };
            }
        };
        let (message, label, help) = match error.kind() {
            ErrorKind::NotFound => (
                format!("there is no file `{file}`"),
                "not there",
                nearby(path, written, |name| name.ends_with(".ron")),
            ),
            ErrorKind::IsADirectory => (format!("`{file}` is a directory"), "not a file", name_a_scene()),
            ErrorKind::PermissionDenied => {
                (format!("`{file}` may not be read: permission denied"), "not readable", None)
            }
            _ => (format!("`{file}` cannot be read: {error}"), "not readable", None),
        };
        Self { message, label, help }
    }
}

fn invalid_text(error: &std::string::FromUtf8Error) -> FileContent {
    let valid = error.utf8_error().valid_up_to();
    let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
    let byte = error.as_bytes()[valid];
    let diagnostic = Diagnostic::new(
        "the file is not UTF-8 text",
        format!("the byte 0x{byte:02x} is not part of any character"),
        Some("save the file as UTF-8; is it really a scene?".to_owned()),
        Some(valid..valid + char::REPLACEMENT_CHARACTER.len_utf8()),
    );
    FileContent::Invalid(text, diagnostic)
}
