//! From a file to a scene.

use std::fmt;
use std::io::ErrorKind;
use std::path::Path;

use hecs::World;

use super::parse::parse;
use super::spawn::spawn;
use super::validate::validate;
use super::{Diagnostic, Place};
use crate::time::Timeline;

/// A small commented scene to start from.
pub const TEMPLATE: &str = include_str!("template.ron");

/// A scene that has been read: its entities, and when it plays.
pub struct Scene {
    /// The entities, in document order by [`Order`](crate::components::Order).
    pub world: World,
    /// Frame rate and duration.
    pub timeline: Timeline,
}

impl Scene {
    /// Reads a scene file.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, or with everything that is wrong in it.
    pub fn load(path: &Path) -> Result<Self, LoadError> {
        Self::from_text(&path.display().to_string(), Self::read(path)?)
    }

    /// The text of a scene file.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, or is not text.
    pub fn read(path: &Path) -> Result<String, LoadError> {
        let file = path.display().to_string();
        let bytes = match std::fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) => return Err(LoadError::unreadable(file, path, &error)),
        };
        String::from_utf8(bytes).map_err(|error| LoadError::not_utf8(file, &error))
    }

    /// Reads a scene from text; `file` names it in messages.
    ///
    /// # Errors
    ///
    /// With everything that is wrong in the text.
    pub fn from_text(file: &str, mut text: String) -> Result<Self, LoadError> {
        // A byte order mark is no part of the scene, and editors do not count it as a column.
        if text.starts_with('\u{feff}') {
            text.remove(0);
        }
        let document = match parse(&text) {
            Ok(document) => document,
            Err(diagnostic) => return Err(LoadError::new(file, text, vec![diagnostic], 0)),
        };
        let problems = validate(&document);
        if !problems.is_empty() {
            let (diagnostics, unlisted) = problems.locate(&text);
            return Err(LoadError::new(file, text, diagnostics, unlisted));
        }
        drop(text);
        Ok(spawn(&document))
    }
}

/// Why a scene could not be loaded. Displays as a compiler would, without colours.
#[derive(Clone, Debug)]
pub struct LoadError {
    file: String,
    text: String,
    diagnostics: Vec<Diagnostic>,
    unlisted: usize,
}

impl LoadError {
    fn new(file: &str, text: String, diagnostics: Vec<Diagnostic>, unlisted: usize) -> Self {
        Self { file: file.to_owned(), text, diagnostics, unlisted }
    }

    fn unreadable(file: String, path: &Path, error: &std::io::Error) -> Self {
        let (message, help) = match error.kind() {
            ErrorKind::NotFound => (format!("there is no file `{file}`"), nearby(path)),
            _ if path.is_dir() => (
                format!("`{file}` is a directory"),
                Some("name a scene file, such as one that ends in .ron".to_owned()),
            ),
            ErrorKind::PermissionDenied => (format!("`{file}` may not be read: permission denied"), None),
            _ => (format!("`{file}` cannot be read: {error}"), None),
        };
        let diagnostic = Diagnostic { message, label: String::new(), help, span: None };
        Self { file, text: String::new(), diagnostics: vec![diagnostic], unlisted: 0 }
    }

    fn not_utf8(file: String, error: &std::string::FromUtf8Error) -> Self {
        let valid = error.utf8_error().valid_up_to();
        let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
        let byte = error.as_bytes()[valid];
        let diagnostic = Diagnostic {
            message: "the file is not UTF-8 text".to_owned(),
            label: format!("the byte 0x{byte:02x} is not part of any character"),
            help: Some("save the file as UTF-8; is it really a scene?".to_owned()),
            span: Some(valid..valid + char::REPLACEMENT_CHARACTER.len_utf8()),
        };
        Self { file, text, diagnostics: vec![diagnostic], unlisted: 0 }
    }

    /// The file, as it was named.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    /// All mistakes, in the order of the file; of very many only the first.
    #[must_use]
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// How many more mistakes there are than are listed.
    #[must_use]
    pub fn unlisted(&self) -> usize {
        self.unlisted
    }

    /// Where a mistake is.
    #[must_use]
    pub fn place(&self, diagnostic: &Diagnostic) -> Option<Place> {
        diagnostic.span.as_ref().map(|span| Place::of(&self.text, span.start))
    }

    /// All mistakes as a compiler would show them, with colours for a terminal or without.
    #[must_use]
    pub fn render(&self, color: bool) -> String {
        let rendered =
            self.diagnostics.iter().map(|diagnostic| diagnostic.render(&self.file, &self.text, color));
        let mut parts: Vec<String> = rendered.collect();
        if self.unlisted > 0 {
            parts.push(format!("and {} more mistakes", self.unlisted));
        }
        parts.join("\n\n")
    }
}

impl fmt::Display for LoadError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.render(false))
    }
}

impl std::error::Error for LoadError {}

/// For a file that is not there: the nearest name beside it.
fn nearby(path: &Path) -> Option<String> {
    let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Ok(entries) = std::fs::read_dir(directory) else {
        return Some(format!("there is no directory `{}` either", directory.display()));
    };
    let mut names: Vec<String> = entries
        .flatten()
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| name.ends_with(".ron"))
        .collect();
    names.sort_unstable();
    let wanted = path.file_name()?.to_str()?;
    let name = super::suggest::nearest(wanted, names.iter().map(String::as_str))?;
    Some(format!("did you mean `{}`?", path.with_file_name(name).display()))
}
