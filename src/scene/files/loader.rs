//! Loads a scene file and its includes.

use std::collections::HashMap;
use std::mem;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::bases::{BaseReader, ChainLink, without_mark};
use super::foreign::foreign_file;
use super::names;
use super::read::{DEEPEST, FileContent, ReadFailure, read, read_included};
use super::{Files, Origin, SceneFile, Scope};
use crate::scene::Diagnostic;
use crate::scene::clouds::{CloudFiles, CloudScene};
use crate::scene::document::SceneDocument;
use crate::scene::extend::EXTENDS;
use crate::scene::overrides::{Override, Unplaced};
use crate::scene::parse::{ParsedEntities, parse};
use crate::scene::quote::{linked, short};
use crate::scene::scripts::{self, Compiled};
use crate::scene::source_text::SourceText;
use crate::scene::validate::{At, Problems, validate};
use crate::script::SpawnBudget;

impl Files {
    /// Reads a scene file and its includes, and applies overrides.
    pub(in crate::scene) fn read(path: &Path, overrides: &[Override]) -> Self {
        Loader { overrides: Unplaced::new(overrides), ..Loader::default() }.read(path)
    }

    /// Reads a scene file like [`read`](Self::read), and reuses documents from earlier loads.
    pub(in crate::scene) fn read_again(path: &Path, overrides: &[Override], before: &mut Texts) -> Self {
        let texts = Some(mem::take(before));
        let clouds = CloudFiles::kept();
        let mut loader = Loader { texts, clouds, overrides: Unplaced::new(overrides), ..Loader::default() };
        let loaded = loader.read(path);
        *before = loader.texts.unwrap_or_default();
        let is_complete =
            |file: &SceneFile| file.document.is_some() && file.includes.iter().all(Option::is_some);
        if loaded.files.iter().all(is_complete) {
            before.clouds = loader.clouds;
            before.parsed.retain(|path, _| loader.known.contains_key(path));
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
                compiler.compile(index, document, &file.source, &mut self.inputs, &mut file.problems);
            }
        }
        compiler.finish()
    }

    pub(in crate::scene) fn are_good(&self) -> bool {
        self.files.iter().all(|file| file.mistake.is_none() && file.problems.is_empty())
    }
}

/// The entities of the texts that could be parsed, by the canonical paths of their files, and the data files of clouds.
#[derive(Debug, Default)]
pub(in crate::scene) struct Texts {
    parsed: HashMap<PathBuf, ParsedEntities>,
    clouds: CloudFiles,
}

#[derive(Debug, Default)]
struct Loader {
    loaded: Files,
    /// The texts from earlier loads; `None` if nothing is cached.
    texts: Option<Texts>,
    /// The indices of the loaded files, by canonical path.
    known: HashMap<PathBuf, usize>,
    /// The stack of files being read: the current file is last, after the files that include it.
    include_stack: Vec<usize>,
    /// The remaining budget of spawning scripts.
    budget: SpawnBudget,
    overrides: Unplaced,
    /// The data files of clouds.
    clouds: CloudFiles,
    /// The number of bytes of all extended scenes.
    extended_bytes: u64,
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
        let key = self.loaded.inputs.add(path);
        self.add(path, key, content, None);
        if let (Some(mistake), Some(own)) = (self.overrides.mistake(), self.loaded.files.first_mut()) {
            own.mistake.get_or_insert(mistake);
        }
        mem::take(&mut self.loaded)
    }

    fn add(&mut self, path: &Path, key: PathBuf, content: FileContent, from: Option<Origin>) -> usize {
        let index = self.loaded.files.len();
        let mut file = match content {
            FileContent::Text(text) => {
                let source = SourceText::new(path, without_mark(text));
                let mut bases =
                    BaseReader { inputs: &mut self.loaded.inputs, bytes: &mut self.extended_bytes };
                match bases.compose(path, &key, source) {
                    Ok(source) => self.parsed(path, &key, source),
                    Err(chain) => {
                        self.known.insert(key, index);
                        self.add_faulty(chain, from);
                        return index;
                    }
                }
            }
            FileContent::Invalid(text, mistake) => {
                let mistake = foreign_file(path).unwrap_or(mistake);
                SceneFile { mistake: Some(mistake), ..SceneFile::new(SourceText::new(path, text)) }
            }
        };
        file.from = from;
        self.known.insert(key, index);
        let own = self.loaded.files.first().unwrap_or(&file);
        let seed = own.document.as_ref().map_or(0, |document| document.sampling.seed);
        let of_scene = own
            .document
            .as_ref()
            .map(|document| CloudScene { transfer: document.film.transfer, space: document.space });
        if let Some(document) = &mut file.document {
            let Self { loaded: Files { inputs, .. }, budget, .. } = self;
            scripts::spawn(document, &file.source, seed, budget, inputs, &mut file.problems);
            let none = CloudFiles::default();
            let before = self.texts.as_ref().map_or(&none, |texts| &texts.clouds);
            let of_scene = of_scene.unwrap_or_default();
            self.clouds.open(document, &file.source, of_scene, before, inputs, &mut file.problems);
        }
        let wanted = file.included_files();
        self.loaded.files.push(file);
        self.include_stack.push(index);
        for (place, (folder, written)) in wanted.iter().enumerate() {
            let from = Origin { file: index, list: "include", index: place };
            let found = self.include(&folder.join(written), Path::new(written), from);
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

    /// Adds the files of a chain that cannot be composed, each after the one that extends it.
    fn add_faulty(&mut self, chain: Vec<ChainLink>, mut from: Option<Origin>) {
        for ChainLink { source, mistake, problems, .. } in chain {
            let index = self.loaded.files.len();
            self.loaded.files.push(SceneFile { from, mistake, problems, ..SceneFile::new(source) });
            self.loaded.parts_first.push(index);
            from = Some(Origin { file: index, list: EXTENDS, index: 0 });
        }
    }

    /// Applies overrides to a text, and parses it.
    fn parsed(&mut self, path: &Path, key: &Path, mut source: SourceText) -> SceneFile {
        let overridden = self.overrides.place(&mut source);
        let mut file = SceneFile { overridden, ..SceneFile::new(source) };
        match self.parse(key, file.source.text()) {
            Err(_) if let Some(mistake) = foreign_file(path) => file.mistake = Some(mistake),
            Ok(document) => file.document = Some(document),
            Err(mistakes) => file.mistake = file.problems.add_located(mistakes),
        }
        file
    }

    /// Parses a text. If it differs little from the previous text of the file, only the difference is parsed.
    fn parse(&mut self, key: &Path, text: &Arc<String>) -> Result<SceneDocument, Vec<Diagnostic>> {
        match &mut self.texts {
            Some(texts) => parse(text, texts.parsed.entry(key.to_owned()).or_default()),
            None => parse(text, &mut ParsedEntities::default()),
        }
    }

    fn include(&mut self, path: &Path, written: &Path, from: Origin) -> Result<usize, ReadFailure> {
        let key = self.loaded.inputs.add(path);
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
            .map(|index| format!("`{}`", short(self.loaded.files[*index].source.name())))
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
    fn new(source: SourceText) -> Self {
        let (includes, problems) = (Vec::new(), Problems::default());
        let (overridden, document, from, mistake) = (Vec::new(), None, None, None);
        Self { source, overridden, document, includes, from, mistake, problems }
    }

    /// Returns the paths of the includes as written, each with the folder that it is relative to.
    fn included_files(&self) -> Vec<(PathBuf, String)> {
        let written: Vec<String> = self.document.iter().flat_map(SceneDocument::included_files).collect();
        let scene = At::scene();
        let list = scene.field("include");
        let values: Vec<_> = (0..written.len()).map(|index| list.index(index).path()).collect();
        self.source.folders(&values).into_iter().map(Path::to_owned).zip(written).collect()
    }
}
