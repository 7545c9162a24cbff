//! From a path to a text.

use std::fs;
use std::io::{Error, ErrorKind};
use std::path::Path;

use crate::scene::Diagnostic;
use crate::scene::nearby::nearby;

/// What a file holds.
#[derive(Debug)]
pub(super) enum Content {
    Text(String),
    /// Not UTF-8: the text as far as it goes, and where that is not.
    Garbled(String, Diagnostic),
}

/// Why there is no content.
#[derive(Debug)]
pub(super) struct Refusal {
    pub(super) message: String,
    pub(super) label: &'static str,
    pub(super) help: Option<String>,
}

/// Reads whatever can be read, pipes too.
pub(super) fn read(path: &Path) -> Result<Content, Refusal> {
    let bytes = fs::read(path).map_err(|error| Refusal::of(&error, path, path))?;
    Ok(String::from_utf8(bytes).map_or_else(|error| garbled(&error), Content::Text))
}

/// Reads a file that another one includes, where it is called `written`. It must be one that can be read again.
pub(super) fn read_included(path: &Path, written: &Path) -> Result<Content, Refusal> {
    let kind = fs::metadata(path).map_err(|error| Refusal::of(&error, path, written))?;
    if !kind.is_file() && !kind.is_dir() {
        return Err(Refusal {
            message: format!("`{}` is not a file", path.display()),
            label: "a device or a pipe",
            help: Some("include a scene file".to_owned()),
        });
    }
    let bytes = fs::read(path).map_err(|error| Refusal::of(&error, path, written))?;
    Ok(String::from_utf8(bytes).map_or_else(|error| garbled(&error), Content::Text))
}

impl Refusal {
    fn of(error: &Error, path: &Path, written: &Path) -> Self {
        let file = path.display();
        let (message, label, help) = match error.kind() {
            ErrorKind::NotFound => (
                format!("there is no file `{file}`"),
                "not there",
                nearby(path, written, |name| name.ends_with(".ron")),
            ),
            _ if path.is_dir() => (
                format!("`{file}` is a directory"),
                "not a file",
                Some("name a scene file, such as one that ends in .ron".to_owned()),
            ),
            ErrorKind::PermissionDenied => {
                (format!("`{file}` may not be read: permission denied"), "not readable", None)
            }
            _ => (format!("`{file}` cannot be read: {error}"), "not readable", None),
        };
        Self { message, label, help }
    }
}

fn garbled(error: &std::string::FromUtf8Error) -> Content {
    let valid = error.utf8_error().valid_up_to();
    let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
    let byte = error.as_bytes()[valid];
    let diagnostic = Diagnostic {
        message: "the file is not UTF-8 text".to_owned(),
        label: format!("the byte 0x{byte:02x} is not part of any character"),
        help: Some("save the file as UTF-8; is it really a scene?".to_owned()),
        span: Some(valid..valid + char::REPLACEMENT_CHARACTER.len_utf8()),
        source: None,
    };
    Content::Garbled(text, diagnostic)
}
