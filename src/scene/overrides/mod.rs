//! Overrides of values in a scene's files: `camera.fov=40` changes a value without an edit of the file.
//!
//! A value is inserted into the text before parsing, so that it passes the same checks and produces the same error messages as the file.
//! `set_value` finds its position in a file; `unplaced` finds the file. `write_back` puts values into the files themselves. `written` and
//! `tracks` list the values and the keys that are there, `defaults` the fields that are not.

mod defaults;
mod set_value;
mod tracks;
mod unplaced;
mod write_back;
mod written;

use std::fmt;
use std::str::FromStr;

use super::spans::is_one_value;
pub use tracks::{KeyChange, WrittenKey, WrittenTrack, WrittenTracks};
pub(super) use unplaced::Unplaced;
pub use write_back::{TextChange, WriteBackError, written_value};
#[cfg(feature = "live")]
pub(crate) use written::joined;
pub use written::{ScenePart, WrittenKind, WrittenValue};

/// An override of a value in the scene's files, identified by its path.
///
/// It is written `path=value`, with the value as in a file. The path consists of steps separated by dots, each a name of a field, material,
/// camera or entity, or an index from 0. A name that contains dots is quoted. A missing field is added.
///
/// ```
/// use rayreel::Scene;
/// use rayreel::scene::Override;
///
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("scene.ron");
/// std::fs::write(&path, "(camera: (position: (0, 0, -5), target: (0, 0, 0)), entities: [(name: \"lamp 1.5\")])")?;
/// let overrides = ["sampling.samples=16", "entities.\"lamp 1.5\".light=Point(intensity: (1, 1, 1))", "camera.position.1=2"];
/// let overrides: Vec<Override> = overrides.into_iter().map(|one| one.parse()).collect::<Result<_, _>>()?;
/// let (scene, _) = Scene::load_overridden(&path, &overrides)?;
/// assert_eq!(scene.world.query::<&rayreel::components::Light>().iter().count(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Override {
    /// The steps from the scene to the value, at least one.
    path: Vec<String>,
    /// The text of the value.
    value: String,
}

/// An error in parsing an [`Override`].
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
pub enum OverrideError {
    /// The path or the value is missing.
    #[error("write a path into the scene, = and a value, as in camera.fov=40")]
    Incomplete,
    /// The path has an empty step, or an unterminated quoted step.
    #[error(
        "write the steps of a path between dots, as in entities.ball.shape.radius; names with dots are quoted"
    )]
    Path,
    /// The text after the `=` is not a single RON value.
    #[error("`{0}` is not one value: write it as in the file, as in 40, (1, 2, 3) or \"clay\"")]
    Value(String),
}

debug_as_message!(OverrideError);

impl Override {
    /// Returns the steps of the path.
    #[must_use]
    pub fn path(&self) -> &[String] {
        &self.path
    }

    /// Returns the text of the value.
    #[must_use]
    pub fn value(&self) -> &str {
        &self.value
    }

    /// Returns whether the path leads to a named element, which may be in an included file.
    fn is_named(&self) -> bool {
        self.path.len() > 1 && NAMED.iter().any(|(list, _)| *list == self.path[0])
    }
}

/// The fields of a scene that hold named elements, each with the noun for one element.
const NAMED: [(&str, &str); 4] =
    [("materials", "material"), ("cameras", "camera"), ("entities", "entity"), ("clouds", "cloud")];

impl FromStr for Override {
    type Err = OverrideError;

    fn from_str(text: &str) -> Result<Self, OverrideError> {
        let (mut path, mut rest) = (Vec::new(), text);
        loop {
            let (step, after) = step(rest)?;
            path.push(step);
            rest = after;
            match rest.strip_prefix('.') {
                Some(next) => rest = next,
                None => break,
            }
        }
        let value = rest.strip_prefix('=').map(str::trim).filter(|value| !value.is_empty());
        let value = value.ok_or(OverrideError::Incomplete)?.to_owned();
        if !is_one_value(&value) {
            return Err(OverrideError::Value(super::quote::short(&value)));
        }
        Ok(Self { path, value })
    }
}

/// Splits a path into its first step and the rest.
fn step(text: &str) -> Result<(String, &str), OverrideError> {
    let text = text.trim_start();
    let (step, rest) = match text.strip_prefix('"') {
        Some(quoted) => quoted.split_once('"').ok_or(OverrideError::Path)?,
        None => {
            let end = text.find(['.', '=']).ok_or(OverrideError::Incomplete)?;
            (text[..end].trim_end(), &text[end..])
        }
    };
    if step.is_empty() { Err(OverrideError::Path) } else { Ok((step.to_owned(), rest.trim_start())) }
}

impl fmt::Display for Override {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, step) in self.path.iter().enumerate() {
            let dot = if index == 0 { "" } else { "." };
            let quote = if step.contains(['.', '=', '"']) { "\"" } else { "" };
            write!(formatter, "{dot}{quote}{step}{quote}")?;
        }
        write!(formatter, "={}", self.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overrides_are_parsed_and_formatted() {
        for text in [
            "a=1",
            "camera.lens.aperture=0.2",
            "entities.\"lamp 1.5\".name=\"=\"",
            "entities.3.shape=Box(size: (1, 1, 1))",
        ] {
            assert_eq!(text.parse::<Override>().unwrap().to_string(), text);
        }
        let spaced: Override = " a . \"b.c\" = [1, // last\n 2] ".parse().unwrap();
        assert_eq!(
            (spaced.path(), spaced.value()),
            (&["a".to_owned(), "b.c".to_owned()][..], "[1, // last\n 2]")
        );
    }

    #[test]
    fn invalid_overrides_are_errors() {
        let refused = |text: &str| text.parse::<Override>().unwrap_err();
        for text in ["", "a", "a.b", "a=", "a.b= "] {
            assert_eq!(refused(text), OverrideError::Incomplete, "{text}");
        }
        for text in ["=1", ".a=1", "a.=1", "a..b=1", "\"a=1"] {
            assert_eq!(refused(text), OverrideError::Path, "{text}");
        }
        for value in [
            "1, b: 2",
            "1)",
            "(1",
            "\"a",
            "/* 1",
            "1 /* 2",
            ")",
            ",",
            "1 2",
            "// 1",
            "1 // 2",
            "1 /* 2 */",
            "r#\"a\"",
        ] {
            assert_eq!(refused(&format!("a={value}")), OverrideError::Value(value.to_owned()), "{value}");
        }
    }
}
