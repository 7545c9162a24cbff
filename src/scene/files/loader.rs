//! Loads a scene file and its includes.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::mem;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::foreign::foreign_file;
use super::names;
use super::read::{FileContent, ReadFailure, read, read_included};
use super::{Files, SceneFile, Scope};
use crate::scene::Diagnostic;
use crate::scene::document::SceneDocument;
use crate::scene::overrides::{Override, Unplaced};
use crate::scene::parse::{ParsedEntities, parse};
use crate::scene::quote::{linked, short};
use crate::scene::scripts::{self, Compiled};
use crate::scene::validate::{At, Problems, validate};
use crate::script::SpawnBudget;

/// Maximum depth of nested includes.
const DEEPEST: usize = 32;

impl Files {
    /// Reads a scene file and its includes, and applies overrides.
    pub(in crate::scene) fn read(path: &Path, overrides: &[Override]) -> Self {
        Loader { overrides: Unplaced::new(overrides), ..Loader::default() }.read(path)
    }

    /// Reads a scene file like [`read`](Self::read), and reuses documents from earlier loads.
    pub(in crate::scene) fn read_again(path: &Path, overrides: &[Override], before: &mut Texts) -> Self {
        let texts = Some(mem::take(before));
        let mut loader = Loader { texts, overrides: Unplaced::new(overrides), ..Loader::default() };
        let loaded = loader.read(path);
        *before = loader.texts.unwrap_or_default();
        let is_complete =
            |file: &SceneFile| file.document.is_some() && file.includes.iter().all(Option::is_some);
        if loaded.files.iter().all(is_complete) {
            before.retain(|path, _| loader.known.contains_key(path));
        }
        loaded
    }

    /// Reads a scene from a text, and its includes from files.
    pub(in crate::scene) fn from_text(path: &Path, text: String) -> Self {
        Loader::default().load(path, FileContent::Text(text))
    }

    /// Collects the semantic errors of every file.
    pub(in crate::scene) fn validate(&mut self) {
        let mut problems: Vec<Problems> =
            self.files.iter_mut().map(|file| mem::take(&mut file.problems)).collect();
        let names = names::of_files(self);
        for (index, (file, problems)) in self.files.iter().zip(&mut problems).enumerate() {
            if let Some(document) = &file.document {
                validate(document, Scope::new(&names, &self.files, index), problems);
            }
        }
        drop(names);
        for (file, problems) in self.files.iter_mut().zip(problems) {
            file.problems = problems;
        }
    }

    /// Compiles the scripts that drive values in every file.
    pub(in crate::scene) fn compile(&mut self) -> Compiled {
        let own = self.files.first().and_then(|file| file.document.as_ref());
        let mut compiler = scripts::Compiler::new(own);
        for (index, file) in self.files.iter_mut().enumerate() {
            if let Some(document) = &mut file.document {
                let folder = Path::new(&file.name).parent().unwrap_or(Path::new(""));
                compiler.compile(index, document, folder, &mut self.inputs, &mut file.problems);
            }
        }
        compiler.finish()
    }

    pub(in crate::scene) fn are_good(&self) -> bool {
        self.files.iter().all(|file| file.mistake.is_none() && file.problems.is_empty())
    }
}

/// The entities of the texts that could be parsed, by the canonical paths of their files.
pub(in crate::scene) type Texts = HashMap<PathBuf, ParsedEntities>;

#[derive(Debug, Default)]
struct Loader {
    loaded: Files,
    /// The texts from earlier loads; `None` if nothing is cached.
    texts: Option<Texts>,
    /// The indices of the loaded files, by canonical path.
    known: HashMap<PathBuf, usize>,
    tried: HashSet<PathBuf>,
    /// The stack of files being read: the current file is last, after the files that include it.
    include_stack: Vec<usize>,
    /// The remaining budget of spawning scripts.
    budget: SpawnBudget,
    overrides: Unplaced,
}

impl Loader {
    fn read(&mut self, path: &Path) -> Files {
        let content =
            read(path, &mut self.loaded.inputs).unwrap_or_else(|ReadFailure { message, help, .. }| {
                FileContent::Invalid(String::new(), Diagnostic::new(message, "", help, None))
            });
        self.load(path, content)
    }

    fn load(&mut self, path: &Path, content: FileContent) -> Files {
        let key = self.try_path(path);
        self.add(path, key, content, None);
        if let (Some(mistake), Some(own)) = (self.overrides.mistake(), self.loaded.files.first_mut()) {
            own.mistake.get_or_insert(mistake);
        }
        mem::take(&mut self.loaded)
    }

    /// Adds a path to the files of the scene, and returns the key of the file: its canonical path, or `path` if it has none.
    fn try_path(&mut self, path: &Path) -> PathBuf {
        let key = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if self.tried.insert(key.clone()) {
            self.loaded.inputs.paths.push(path.to_owned());
        }
        key
    }

    fn add(
        &mut self,
        path: &Path,
        key: PathBuf,
        mut content: FileContent,
        from: Option<(usize, usize)>,
    ) -> usize {
        let index = self.loaded.files.len();
        let overridden = match &mut content {
            FileContent::Text(text) => {
                // A byte order mark is not part of the scene, and editors do not count it as a column.
                if text.starts_with('\u{feff}') {
                    text.remove(0);
                }
                self.overrides.place(text)
            }
            FileContent::Invalid(..) => Vec::new(),
        };
        let mut file = SceneFile::new(path, content, from, |text| self.parse(&key, text));
        file.overridden = overridden;
        self.known.insert(key, index);
        let folder = path.parent().unwrap_or(Path::new(""));
        let own = self.loaded.files.first().unwrap_or(&file);
        let seed = own.document.as_ref().map_or(0, |document| document.sampling.seed);
        if let Some(document) = &mut file.document {
            let Self { loaded: Files { inputs, .. }, budget, .. } = self;
            scripts::spawn(document, folder, seed, budget, inputs, &mut file.problems);
        }
        let wanted: Vec<String> = file.document.iter().flat_map(SceneDocument::included_files).collect();
        self.loaded.files.push(file);
        self.include_stack.push(index);
        for (place, written) in wanted.iter().enumerate() {
            let found = self.include(&folder.join(written), Path::new(written), (index, place));
            let file = &mut self.loaded.files[index];
            if let Err(failure) = &found {
                failure.add_to(place, &mut file.problems);
            }
            file.includes.push(found.ok());
        }
        self.include_stack.pop();
        self.loaded.parts_first.push(index);
        index
    }

    /// Parses a text. If it differs little from the previous text of the file, only the difference is parsed.
    fn parse(&mut self, key: &Path, text: &Arc<String>) -> Result<SceneDocument, Vec<Diagnostic>> {
        match &mut self.texts {
            Some(texts) => parse(text, texts.entry(key.to_owned()).or_default()),
            None => parse(text, &mut ParsedEntities::default()),
        }
    }

    fn include(&mut self, path: &Path, written: &Path, from: (usize, usize)) -> Result<usize, ReadFailure> {
        let key = self.try_path(path);
        if let Some(index) = self.known.get(&key) {
            return match self.include_stack.iter().position(|file| file == index) {
                Some(start) => Err(self.ring(start)),
                None => Ok(*index),
            };
        }
        if self.include_stack.len() > DEEPEST {
            return Err(ReadFailure {
                message: format!("files include each other more than {DEEPEST} deep"),
                label: "too deep",
                help: Some("include the file from one that is less deep".to_owned()),
            });
        }
        let content = read_included(path, written, &mut self.loaded.inputs)?;
        Ok(self.add(path, key, content, Some(from)))
    }

    /// Returns the error for a cycle of includes, which starts at an index of `include_stack`.
    fn ring(&self, start: usize) -> ReadFailure {
        let members = &self.include_stack[start..];
        let names: Vec<String> = members
            .iter()
            .chain(&members[..1])
            .map(|index| format!("`{}`", short(&self.loaded.files[*index].name)))
            .collect();
        ReadFailure {
            message: linked(&names, " includes "),
            label: "this closes the ring",
            help: Some("remove one of these includes".to_owned()),
        }
    }
}

impl ReadFailure {
    /// Adds the error to the problems of the including file.
    fn add_to(&self, place: usize, problems: &mut Problems) {
        let (scene, help) = (At::scene(), self.help.as_deref());
        let (list, help) = (scene.field("include"), help.unwrap_or("see to the file, or remove the include"));
        problems.add(&list.index(place).field("file"), self.message.as_str(), self.label, help);
    }
}

impl SceneFile {
    fn new(
        path: &Path,
        content: FileContent,
        from: Option<(usize, usize)>,
        parse: impl FnOnce(&Arc<String>) -> Result<SceneDocument, Vec<Diagnostic>>,
    ) -> Self {
        let mut problems = Problems::default();
        let (text, document, mistake) = match content {
            FileContent::Invalid(text, mistake) => {
                (Arc::new(text), None, Some(foreign_file(path).unwrap_or(mistake)))
            }
            FileContent::Text(text) => {
                let text = Arc::new(text);
                match parse(&text) {
                    Err(_) if let Some(mistake) = foreign_file(path) => (text, None, Some(mistake)),
                    Ok(document) => (text, Some(document), None),
                    Err(mistakes) => {
                        let mistake = problems.add_located(mistakes);
                        (text, None, mistake)
                    }
                }
            }
        };
        let name = path.display().to_string();
        let (includes, overridden) = (Vec::new(), Vec::new());
        Self { name, text, overridden, document, includes, from, mistake, problems }
    }
}
