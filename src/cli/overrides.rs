//! Overrides of the scene for one run.

use std::path::Path;

use serde_json::{Value, json};

use rayreel::{Effect, EffectSet, Engine, EngineError, RenderSettings, Scene};

use super::args::OverrideArguments;

/// Loads a scene with overridden values and disabled effects.
pub(super) fn load(scene: &Path, overrides: &OverrideArguments) -> Result<Engine, EngineError> {
    let values = overrides.all();
    let mut engine = if values.is_empty() {
        Engine::load(scene)?
    } else {
        Engine::from_scene(Scene::load_overridden(scene, &values)?.0)
    };
    engine.settings = RenderSettings { without: overrides.without(), ..RenderSettings::default() };
    Ok(engine)
}

/// The overridden values and disabled effects of a run.
#[derive(Clone, Debug)]
pub(super) struct Changed {
    overrides: Vec<String>,
    without: EffectSet,
}

impl Changed {
    pub(super) fn new(overrides: &OverrideArguments) -> Self {
        let values = overrides.all().iter().map(ToString::to_string).collect();
        Self { overrides: values, without: overrides.without() }
    }

    /// Returns a line that lists the changes, or `None` if there are none.
    pub(super) fn describe(&self) -> Option<String> {
        let without = self.without.iter().map(|effect| format!("no {effect}"));
        let changed: Vec<String> = self.overrides.iter().cloned().chain(without).collect();
        (!changed.is_empty()).then(|| format!("instead of the scene's own: {}", changed.join(", ")))
    }

    /// Adds the changes to a report.
    pub(super) fn add_to(&self, report: &mut Value) {
        report["overrides"] = json!(self.overrides);
        report["without"] = self.without.iter().map(Effect::name).collect();
    }
}
