//! Reading of the scenes that a scene extends.

use std::path::{Path, PathBuf};

use super::foreign::foreign_file;
use super::read::{DEEPEST, FileContent, ReadFailure, read_included};
use crate::scene::Diagnostic;
use crate::scene::extend::{EXTENDS, MissingName, WITHOUT, extend};
use crate::scene::input::{InputFiles, LARGEST_FILE};
use crate::scene::parse::check_notation;
use crate::scene::quote::{linked, short};
use crate::scene::source_text::SourceText;
use crate::scene::spans::{bracket, first_field, literal_text, root};
use crate::scene::suggest::remedy;
use crate::scene::validate::{At, Problems, add_misplaced_extends};

/// A reader of extended scenes.
pub(super) struct BaseReader<'a> {
    pub(super) inputs: &'a mut InputFiles,
    /// The number of bytes of all extended scenes.
    pub(super) bytes: &'a mut u64,
}

/// A file of a chain in which each scene extends the next one.
#[derive(Debug)]
pub(super) struct ChainLink {
    path: PathBuf,
    key: PathBuf,
    pub(super) source: SourceText,
    pub(super) mistake: Option<Diagnostic>,
    pub(super) problems: Problems,
}

impl BaseReader<'_> {
    /// Reads the scenes that a scene extends, and composes their texts. If there are errors, returns the files of the chain instead, the
    /// scene's own first.
    pub(super) fn compose(
        &mut self,
        path: &Path,
        key: &Path,
        source: SourceText,
    ) -> Result<SourceText, Vec<ChainLink>> {
        if extended_file(&source).is_none() {
            return Ok(source);
        }
        let mut chain = self.chain(ChainLink::new(path, key.to_owned(), source));
        compose(&mut chain).ok_or(chain)
    }

    /// Reads a chain from its first file to the last one, or to the first that cannot be read.
    fn chain(&mut self, first: ChainLink) -> Vec<ChainLink> {
        let mut chain = vec![first];
        while let Some(link) = chain.last()
            && let Some(written) = extended_file(&link.source)
        {
            let folder = link.path.parent().unwrap_or(Path::new(""));
            match self.base(&folder.join(&written), Path::new(&written), &chain) {
                Ok(base) => chain.push(base),
                Err(ReadFailure { message, label, help }) => {
                    let help = help.as_deref().unwrap_or("see to the file, or remove this field");
                    if let Some(link) = chain.last_mut() {
                        link.problems.add(&At::scene().field(EXTENDS), message, label, help);
                    }
                    break;
                }
            }
        }
        chain
    }

    /// Reads the file that the last one of a chain extends.
    fn base(&mut self, path: &Path, written: &Path, chain: &[ChainLink]) -> Result<ChainLink, ReadFailure> {
        let key = self.inputs.add(path);
        if let Some(start) = chain.iter().position(|link| link.key == key) {
            let ring = chain[start..].iter().chain(&chain[start..=start]);
            let names: Vec<String> = ring.map(|link| format!("`{}`", short(link.source.name()))).collect();
            return Err(ReadFailure {
                message: linked(&names, " extends "),
                label: "this closes the ring",
                help: Some(format!("remove one of these fields `{EXTENDS}`")),
            });
        }
        if chain.len() > DEEPEST {
            return Err(ReadFailure {
                message: format!("scenes extend each other more than {DEEPEST} deep"),
                label: "too deep",
                help: Some("extend a scene that is less deep".to_owned()),
            });
        }
        let content = read_included(path, written, self.inputs)?;
        let (FileContent::Text(text) | FileContent::Invalid(text, _)) = &content;
        *self.bytes = self.bytes.saturating_add(text.len() as u64);
        if *self.bytes > LARGEST_FILE {
            return Err(ReadFailure {
                message: format!("the extended scenes have more than {LARGEST_FILE} bytes in total"),
                label: "too large",
                help: Some("extend smaller scenes, or fewer".to_owned()),
            });
        }
        Ok(match content {
            FileContent::Text(text) => ChainLink::new(path, key, SourceText::new(path, without_mark(text))),
            FileContent::Invalid(text, mistake) => {
                let (source, problems) = (SourceText::new(path, text), Problems::default());
                ChainLink { path: path.to_owned(), key, source, mistake: Some(mistake), problems }
            }
        })
    }
}

impl ChainLink {
    /// Checks the notation of a file.
    fn new(path: &Path, key: PathBuf, source: SourceText) -> Self {
        let mut link =
            Self { path: path.to_owned(), key, source, mistake: None, problems: Problems::default() };
        let text = link.source.text();
        match check_notation(text) {
            Err(_) if let Some(mistake) = foreign_file(path) => link.mistake = Some(mistake),
            Err(mistakes) => link.mistake = link.problems.add_located(mistakes),
            Ok(()) => {
                let written = bracket(text, root(text)).and_then(|scene| scene.field(text, EXTENDS));
                let written = written.filter(|path| &text[path.clone()] != "None");
                let is_first = first_field(text, EXTENDS).is_some();
                let scene = At::scene();
                if written.is_some() && !is_first {
                    add_misplaced_extends(&scene, &mut link.problems);
                } else if written.is_some() && extended_file(&link.source).is_none() {
                    let (at, message) =
                        (scene.field(EXTENDS), format!("`{EXTENDS}` takes the path of a scene"));
                    link.problems.add(
                        &at,
                        message,
                        "not a text",
                        "write it in double quotes, as \"base.ron\"",
                    );
                }
            }
        }
        link
    }

    fn is_faulty(&self) -> bool {
        self.mistake.is_some() || !self.problems.is_empty()
    }

    fn add_unknown(&mut self, unknown: Vec<MissingName>) {
        let scene = At::scene();
        let list = scene.field(WITHOUT);
        for MissingName { index, name, known } in unknown {
            let known: Vec<&str> = known.iter().map(String::as_str).collect();
            let message =
                format!("the extended scene has no entity, include or camera called \"{}\"", short(&name));
            self.problems.add(&list.index(index), message, "unknown", remedy(&name, &known, "names"));
        }
    }
}

/// Composes the texts of a chain. `None` if there are errors.
fn compose(chain: &mut [ChainLink]) -> Option<SourceText> {
    if chain.iter().any(ChainLink::is_faulty) {
        return None;
    }
    let (last, changes) = chain.split_last_mut()?;
    let mut composed = last.source.clone();
    for link in changes.iter_mut().rev() {
        match extend(&composed, &link.source) {
            Ok(extended) => composed = extended,
            Err(unknown) => {
                link.add_unknown(unknown);
                return None;
            }
        }
    }
    Some(composed)
}

/// Returns the path in the field `extends`, if this is a scene's first field.
fn extended_file(source: &SourceText) -> Option<String> {
    literal_text(&source.text()[first_field(source.text(), EXTENDS)?])
}

/// Removes a byte order mark, which is not part of the scene, and which editors do not count as a column.
pub(super) fn without_mark(mut text: String) -> String {
    if text.starts_with('\u{feff}') {
        text.remove(0);
    }
    text
}
