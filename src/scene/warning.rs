//! Warnings about the text of a scene.

use super::clouds::{DATA_LABEL, MIRRORED_LABEL};
use super::error::original;
use super::files::Files;
use super::validate::HIDDEN_LABEL;
use super::{Diagnostic, SourcePosition};

/// A value of a scene that is valid and surely not meant, such as a colour with channels from 0 to 1, or a truncated data file.
///
/// ```
/// use rayreel::Scene;
/// let text = "(camera: (position: (0, 0, -5), view: (0, 0, 1)), background: (0.5, 0.7, 1))";
/// let scene = Scene::from_text("sky.ron", text.to_owned())?;
/// let warning = &scene.warnings[0];
/// assert_eq!(warning.message, "a colour that is almost black: no channel is above 1");
/// assert_eq!(warning.help, "channels are from 0 to 255: write (128, 179, 255), or (188, 218, 255) for linear light as in POV-Ray");
/// assert_eq!(warning.position.to_string(), "1:63");
/// # Ok::<(), rayreel::scene::LoadError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneWarning {
    /// The name, as in `--allow` of the command: one of [`SceneWarning::NAMES`].
    pub name: &'static str,
    /// The file, as named by the caller or by the include.
    pub file: String,
    /// The position in the file.
    pub position: SourcePosition,
    /// The cause.
    pub message: String,
    /// The remedy.
    pub help: String,
}

impl SceneWarning {
    /// The names of the warnings: about colours from 0 to 1, data files, molecules in left-handed space, and backgrounds that fog hides.
    pub const NAMES: [&str; 4] = ["dark-color", "data-file", "left-handed", "hidden-background"];
}

/// Returns the warnings about all files, by file and position.
pub(super) fn warnings_of(files: &mut Files) -> Vec<SceneWarning> {
    let mut warnings = Vec::new();
    for file in &mut files.files {
        let (located, _) = std::mem::take(&mut file.problems).into_warnings().locate(file.source.text());
        warnings.extend(located.into_iter().filter_map(|diagnostic| {
            let (index, Diagnostic { message, label, help, span, source }) =
                original(&file.source, diagnostic);
            let of_file = &file.source.files()[index];
            let (name, text) = source
                .as_deref()
                .map_or((&of_file.name, &*of_file.text), |source| (&source.file, &source.text));
            let start = span.map_or(0, |span| span.start);
            let is_hexadecimal = text.as_bytes().get(start) == Some(&b'"');
            let [of_color, of_data, of_space, of_fog] = SceneWarning::NAMES;
            let kind = match label.as_str() {
                DATA_LABEL => of_data,
                MIRRORED_LABEL => of_space,
                HIDDEN_LABEL => of_fog,
                _ if is_hexadecimal => return None,
                _ => of_color,
            };
            Some(SceneWarning {
                name: kind,
                file: name.clone(),
                position: SourcePosition::of(text, start),
                message: format!("{message}: {label}"),
                help: help.unwrap_or_default(),
            })
        }));
    }
    warnings
}
