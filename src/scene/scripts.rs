//! Scripts of scene files: reading, compilation, and execution of spawning scripts.

use std::collections::HashMap;
use std::io::ErrorKind;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use super::Sources;
use super::data;
use super::diagnostic::Source;
use super::document::{EntityDocument, SceneDocument, ScriptDocument};
use super::input::{InputError, InputFiles, InputKind};
use super::script_sources::{SceneScripts, ScriptSource};
use super::source_text::SourceText;
use super::spawn::transfer;
use super::suggest_file::nearby;
use super::validate::{At, Problems};
use crate::script::{CompiledScripts, Language, ScriptError, SpawnBudget, limits, run_spawning};

/// Runs the spawning scripts. Their entities are appended to the document and deducted from `budget`.
pub(super) fn spawn(
    document: &mut SceneDocument,
    scene_text: &SourceText,
    seed: u64,
    budget: &mut SpawnBudget,
    inputs: &mut InputFiles,
    problems: &mut Problems,
) {
    let scene = At::scene();
    let list = scene.field("spawn");
    problems.spawned_from(document.entities.len());
    let values: Vec<_> = (0..document.spawn.len()).map(|index| list.index(index).path()).collect();
    let folders = scene_text.folders(&values).into_iter();
    for (index, (script, folder)) in document.spawn.iter().zip(folders).enumerate() {
        let at = list.index(index);
        let Some(code) = Code::read(script, folder, inputs, &at, problems) else { continue };
        let (result, spawned) = run(&code.text, seed, budget);
        for (entity, place) in spawned {
            document.entities.push(Arc::new(entity));
            problems.spawned_at(index, code.source.as_ref(), place);
        }
        if let Err(error) = result {
            problems.add_script(&at, code.source, &error);
        }
    }
}

/// A compiler of the scripts that drive values, file by file.
pub(super) struct Compiler {
    compiled: Compiled,
}

/// The compiled scripts of a scene, with their origins.
pub(super) struct Compiled {
    scripts: CompiledScripts,
    origins: Vec<ScriptOrigin>,
}

/// The origin of a script; `file` is an index in the files of the scene.
struct ScriptOrigin {
    file: usize,
    /// The index of the animation in the list `animate`.
    animation: usize,
    /// The script's own file, if it has one.
    source: Option<Arc<Source>>,
}

impl Compiler {
    /// Creates a compiler with the seed and the transfer function of the scene file's document.
    pub(super) fn new(scene: Option<&SceneDocument>) -> Self {
        let (seed, film) =
            scene.map_or_else(Default::default, |scene| (scene.sampling.seed, scene.film.transfer));
        let scripts = CompiledScripts::new(Language::new(seed), transfer(film));
        Self { compiled: Compiled { scripts, origins: Vec::new() } }
    }

    /// Compiles the scripts of a file, and stores the index of each script in its animation.
    pub(super) fn compile(
        &mut self,
        file: usize,
        document: &mut SceneDocument,
        scene_text: &SourceText,
        inputs: &mut InputFiles,
        problems: &mut Problems,
    ) {
        let Compiled { scripts, origins } = &mut self.compiled;
        let scene = At::scene();
        let list = scene.field("animate");
        let scripted: Vec<_> = document
            .animate
            .iter_mut()
            .enumerate()
            .filter_map(|(index, animation)| Some((index, animation.track.script()?, animation)))
            .collect();
        let values: Vec<_> = scripted.iter().map(|(index, ..)| list.index(*index).path()).collect();
        let folders = scene_text.folders(&values).into_iter();
        for ((index, script, animation), folder) in scripted.into_iter().zip(folders) {
            let animation_at = list.index(index);
            let at = animation_at.field("track");
            let Some(code) = Code::read(&script, folder, inputs, &at, problems) else { continue };
            match scripts.language.compile(&code.text) {
                Ok(script) => {
                    animation.script = Some(scripts.list.len());
                    scripts.list.push(script);
                    origins.push(ScriptOrigin { file, animation: index, source: code.source });
                }
                Err(error) => problems.add_script(&at, code.source, &error),
            }
        }
    }

    pub(super) fn finish(self) -> Compiled {
        self.compiled
    }
}

impl Compiled {
    /// Adds the uses of the scripts and the source texts. Only texts that contain a script are kept.
    pub(super) fn link(mut self, uses: &[(usize, String)], sources: &Sources) -> SceneScripts {
        let mut kept: HashMap<usize, Arc<SourceText>> = HashMap::new();
        let written: Vec<Option<ScriptSource>> = self
            .origins
            .iter()
            .map(|origin| match &origin.source {
                Some(source) => Some(ScriptSource::File(Arc::clone(source))),
                None => {
                    let scene = sources.file(origin.file)?;
                    let scene = kept.entry(origin.file).or_insert_with(|| Arc::new(scene.clone()));
                    Some(ScriptSource::Scene(Arc::clone(scene), origin.animation))
                }
            })
            .collect();
        self.scripts.uses = uses.to_vec();
        let written = uses.iter().filter_map(|(script, _)| written.get(*script)?.clone()).collect();
        SceneScripts::new(self.scripts, written)
    }
}

type SpawnedEntities = Vec<(EntityDocument, usize)>;

/// Runs a spawning script. Returns all entities spawned before its end or its error, each with the byte offset of its call.
fn run(text: &str, seed: u64, budget: &mut SpawnBudget) -> (Result<(), ScriptError>, SpawnedEntities) {
    let list = Arc::new(Mutex::new(SpawnedEntities::new()));
    let into = Arc::clone(&list);
    let result = run_spawning(text, seed, budget, move |spawned| {
        let entity = data::entity(spawned.entity)?;
        into.lock().unwrap_or_else(PoisonError::into_inner).push((entity, spawned.at));
        Ok(())
    });
    let spawned = std::mem::take(&mut *list.lock().unwrap_or_else(PoisonError::into_inner));
    (result, spawned)
}

/// The text of a script, and its file unless it is written in the scene file.
pub(super) struct Code {
    pub(super) text: String,
    pub(super) source: Option<Arc<Source>>,
}

impl Code {
    /// Reads a script. Adds a problem and returns `None` on failure.
    pub(super) fn read(
        script: &ScriptDocument,
        folder: &Path,
        inputs: &mut InputFiles,
        at: &At<'_>,
        problems: &mut Problems,
    ) -> Option<Self> {
        match script {
            ScriptDocument::Script(text) => Some(Self { text: text.clone(), source: None }),
            ScriptDocument::File(name) => {
                let path = folder.join(name);
                if !inputs.paths.contains(&path) {
                    inputs.paths.push(path.clone());
                }
                match read(&path, Path::new(name), inputs) {
                    Ok(text) => {
                        let file = path.display().to_string();
                        Some(Self { source: Some(Arc::new(Source { file, text: text.clone() })), text })
                    }
                    Err((message, help)) => {
                        problems.add(&at.index(0), message, "not readable", help);
                        None
                    }
                }
            }
        }
    }
}

/// Reads a script file; `written` is its path in the scene. An error consists of a message and a remedy.
fn read(path: &Path, written: &Path, inputs: &mut InputFiles) -> Result<String, (String, String)> {
    let file = path.display();
    let remedy = || "write the path of a text file, as seen from the scene file's folder".to_owned();
    let bytes =
        inputs.read(path, InputKind::Refused, limits::SCRIPT as u64).map_err(|error| match error {
            InputError::System(error) if error.kind() == ErrorKind::NotFound => (
                format!("there is no file `{file}`"),
                nearby(path, written, is_no_scene).unwrap_or_else(remedy),
            ),
            InputError::System(error) if error.kind() != ErrorKind::IsADirectory => {
                (format!("`{file}` cannot be read: {error}"), remedy())
            }
            InputError::NotAFile | InputError::System(_) => (format!("`{file}` is not a file"), remedy()),
            InputError::TooLarge(most) => (
                format!("`{file}` is too long for a script"),
                format!("a script has at most {} KiB", most >> 10),
            ),
        })?;
    let text = String::from_utf8(bytes).map_err(|_| {
        (format!("`{file}` is not UTF-8 text"), "save it as UTF-8; is it really a script?".to_owned())
    })?;
    Ok(text.strip_prefix('\u{feff}').map_or(text.clone(), str::to_owned))
}

fn is_no_scene(name: &str) -> bool {
    Path::new(name).extension().is_none_or(|end| end != "ron")
}

#[cfg(all(test, not(feature = "script")))]
mod tests {
    use crate::Scene;

    #[test]
    fn builds_without_scripts_report_each_script_at_its_place() {
        let scene = |more: &str| {
            let text = format!(
                "Scene(\n timeline: (fps: 1, duration: 1),\n camera: (position: (0, 0, -5), target: (0, 0, 0), fov: 40),\n {more}\n)"
            );
            Scene::from_text("ball.ron", text).map(|_| ()).map_err(|error| error.to_string())
        };
        assert_eq!(scene(""), Ok(()));
        for (script, place) in [
            ("spawn: [Script(\"spawn(#{})\")],", "ball.ron:4:18"),
            ("animate: [(target: \"camera\", channel: Fov, track: Script(\"40 + t\"))],", "ball.ron:4:60"),
        ] {
            let error = scene(script).unwrap_err();
            for part in [place, "this build of rayreel has no scripts", "Cargo feature `script`"] {
                assert!(error.contains(part), "{part}: {error}");
            }
        }
    }
}
