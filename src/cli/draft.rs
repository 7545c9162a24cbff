//! `rayreel render --draft`: reduced settings that keep a scene recognisable.

use rayreel::{EffectiveSettings, Engine, RenderSettings};

/// The divisor of the film's width and height.
const SHRINKING: u32 = 3;
/// Maximum ray depth, enough to see through a glass. Lower limits save little time and leave transparent objects black.
const DEPTH: u32 = 5;
/// Maximum number of samples of an area light. Fewer make soft shadows unrecognisable.
const LIGHT_SAMPLES: u32 = 4;

/// Lowers the settings that cost time; raises none.
pub(super) fn settings(engine: &Engine) -> RenderSettings {
    let EffectiveSettings { film, quality, .. } = engine.effective_settings();
    RenderSettings {
        depth: Some(quality.depth.min(DEPTH)),
        max_light_samples: Some(LIGHT_SAMPLES),
        ..RenderSettings::draft(film, SHRINKING)
    }
    .or(engine.settings)
}
