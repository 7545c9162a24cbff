//! The scripts of a scene with their source texts, for reporting runtime errors.

use std::fmt;
use std::sync::Arc;

use super::source_text::{SourceText, TextFile};
use super::spans::{PathStep, inside_text, locate};
use super::validate::help_for;
use super::{Diagnostic, Source, SourcePosition};
use crate::components::ScriptId;
use crate::script::{CompiledScripts, ScriptError};

/// The scripts that drive values of a scene.
#[derive(Debug)]
pub(crate) struct SceneScripts {
    scripts: CompiledScripts,
    sources: ScriptSources,
}

/// The sources of all scripts of a scene.
#[derive(Clone, Debug, Default)]
pub(crate) struct ScriptSources {
    list: Vec<ScriptSource>,
}

/// The location of a script.
#[derive(Clone, Debug)]
pub(super) enum ScriptSource {
    /// A script file.
    File(Arc<Source>),
    /// A scene, and the index of an animation in its list `animate`.
    Scene(Arc<SourceText>, usize),
}

/// A runtime error of a script during the evaluation of a frame. `Display` renders it in compiler style, without colours.
#[derive(Clone)]
pub struct ScriptMistake {
    diagnostic: Diagnostic,
}

debug_as_message!(ScriptMistake);

impl SceneScripts {
    pub(super) fn new(scripts: CompiledScripts, sources: Vec<ScriptSource>) -> Self {
        Self { scripts, sources: ScriptSources { list: sources } }
    }

    /// Returns the scripts and their sources.
    pub(crate) fn into_parts(self) -> (CompiledScripts, ScriptSources) {
        (self.scripts, self.sources)
    }
}

impl ScriptSources {
    /// Returns the located error of a script. `about` names the driven channel and the time.
    pub(crate) fn mistake(&self, script: ScriptId, about: &str, error: &ScriptError) -> ScriptMistake {
        let (message, label) = (format!("{about}: {}", error.message), error.label.clone());
        let (span, source) = match self.list.get(script.0) {
            Some(ScriptSource::Scene(scene, animation)) => {
                let path = [
                    PathStep::Field("animate"),
                    PathStep::Index(*animation),
                    PathStep::Field("track"),
                    PathStep::Index(0),
                ];
                let span = locate(scene.text(), &[path.to_vec()])[0].clone();
                let (file, span) = scene.original(&inside_text(scene.text(), span, &error.span));
                let TextFile { name, text, .. } = &scene.files()[file];
                let source = Source { file: name.clone(), text: text.as_str().to_owned() };
                (Some(span), Some(Arc::new(source)))
            }
            Some(ScriptSource::File(source)) => (Some(error.span.clone()), Some(Arc::clone(source))),
            None => (None, None),
        };
        ScriptMistake { diagnostic: Diagnostic::new(message, label, help_for(error), span).within(source) }
    }
}

impl ScriptMistake {
    /// Returns the cause, position and remedy.
    #[must_use]
    pub fn diagnostic(&self) -> &Diagnostic {
        &self.diagnostic
    }

    /// Returns the position of the error in its file; `None` if there is no text.
    #[must_use]
    pub fn position(&self) -> Option<SourcePosition> {
        let (source, span) = (self.diagnostic.source.as_ref()?, self.diagnostic.span.as_ref()?);
        Some(SourcePosition::of(&source.text, span.start))
    }

    /// Renders the error in compiler style, optionally with terminal colours.
    #[must_use]
    pub fn render(&self, color: bool) -> String {
        self.diagnostic.render("scripts", "", color)
    }
}

impl fmt::Display for ScriptMistake {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.render(false))
    }
}

impl std::error::Error for ScriptMistake {}
