//! The language of builds without the feature `script`: every script is an error.

use super::{Data, NoResult, Read, ScriptError, SpawnBudget, Spawned};

/// The compiler of no scripts.
#[derive(Debug)]
pub(crate) struct NoLanguage;

/// A compiled script, of which there is none.
#[derive(Debug)]
pub(crate) enum NoScript {}

/// The inputs of no script.
#[derive(Debug)]
pub(crate) struct NoContext;

impl NoLanguage {
    pub(crate) fn new(_seed: u64) -> Self {
        Self
    }

    pub(crate) fn compile(&self, text: &str) -> Result<NoScript, ScriptError> {
        Err(rejection(text))
    }

    pub(crate) fn run(&self, script: &NoScript, _context: &mut NoContext) -> Result<Data, NoResult> {
        match *script {}
    }
}

impl NoScript {
    pub(crate) fn text(&self) -> &str {
        match *self {}
    }
}

impl NoContext {
    pub(crate) fn new(_fps: f64, _duration: f64) -> Self {
        Self
    }

    pub(crate) fn set_owner(&mut self, _index: u64, _name: &str, _base: Data) {}

    pub(crate) fn set_time(&mut self, _seconds: f64, _frame: f64) {}

    pub(crate) fn operations(&self) -> u64 {
        0
    }

    pub(crate) fn clear_values(&mut self) {}

    pub(crate) fn set_value(&mut self, _read: &Read, _value: Data) {}
}

pub(crate) fn run_spawning(
    text: &str,
    _seed: u64,
    _budget: &mut SpawnBudget,
    _take: impl FnMut(Spawned) -> Result<(), String> + Send + 'static,
) -> Result<(), ScriptError> {
    Err(rejection(text))
}

fn rejection(text: &str) -> ScriptError {
    let help = "build rayreel with its Cargo feature `script`".to_owned();
    ScriptError::new(text, "this build of rayreel has no scripts", "a script", Some(help))
}
