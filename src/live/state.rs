//! The visible state of a session, readable at any time.

use std::time::Duration;

use serde::Serialize;

use super::commands::Detail;
use super::edits::EditState;
use super::export::ExportState;
use super::warnings::PictureWarnings;
use crate::engine::{EngineError, FrameReport};
use crate::scene::{LoadError, ScenePart, ScriptMistake, SourcePosition};
use crate::systems::{Effect, Plan};

/// The current state of a session.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct State {
    /// Path of the scene's file, or the name of an engine.
    pub scene: String,
    /// Absolute path of the folder to which relative paths refer.
    pub folder: String,
    /// Number that differs between sessions.
    pub session: u64,
    /// Number of times that the scene was read without mistakes.
    pub reloads: u64,
    /// Index of the displayed frame: the requested frame, or the last one if the timeline is shorter.
    pub frame: u32,
    /// Number of frames.
    pub frames: u32,
    /// Frames per second.
    pub rate: f64,
    /// Requested quality of pictures.
    pub detail: Detail,
    /// Width and height of the film in pixels.
    pub film: (u32, u32),
    /// The latest picture.
    pub picture: Option<PictureInfo>,
    /// The last picture before the last edit; a picture that is not coarse, if there is one.
    pub before: Option<PictureInfo>,
    /// The values that are changed by hand.
    pub edits: EditState,
    /// The part of the scene that a program has edited last, in the files.
    pub edited: Option<EditedPart>,
    /// The frames whose finished pictures are kept.
    pub cached: CachedFrames,
    /// The reason why no more frames are written into the folder of the cache.
    pub cache_error: Option<String>,
    /// The export that is running, or was the last.
    pub export: Option<ExportState>,
    /// True while a better picture is being rendered.
    pub rendering: bool,
    /// Finished fraction of the better picture, 0 to 1; 0 if it is unknown. With an error target, an estimate that may decrease.
    pub progress: f64,
    /// Mistakes in the current files. The scene is then the last good one.
    pub mistakes: Option<Mistakes>,
    /// Mistakes of this frame.
    pub frame_mistakes: Option<Mistakes>,
    /// Warnings about the scene and the last full picture; none if only drafts are rendered.
    pub warnings: PictureWarnings,
    /// Effects of the frame of the last picture that was not coarse.
    pub plan: Vec<Planned>,
    /// Measured error curve of that frame: the scene's own samples first, then other sample counts, ascending.
    pub curve: Vec<CurvePoint>,
    /// Times of the last reload and of the latest picture.
    pub times: Times,
    /// Number of rays of the latest picture.
    pub rays: u64,
}

/// A picture, without its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PictureInfo {
    /// Number by which the picture can be requested. Later pictures have greater numbers.
    pub id: u64,
    /// Index of its frame.
    pub frame: u32,
    /// Number of reloads before the picture.
    pub reloads: u64,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Width and height, in pixels, of the film that the picture represents.
    pub film: (u32, u32),
    /// True if the picture is bit-identical to one rendered to a file.
    pub full: bool,
    /// True if the picture is coarse or unfinished for lack of time.
    pub coarse: bool,
}

/// A part of the scene that was edited.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct EditedPart {
    /// The part.
    pub part: ScenePart,
    /// The reload that brought the edit.
    pub reloads: u64,
}

/// The frames whose finished pictures are kept.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct CachedFrames {
    /// Number by which the pictures can be requested. It changes with the scene and the requested quality.
    pub generation: u64,
    /// Ranges of frames, with both ends, ascending.
    pub ranges: Vec<(u32, u32)>,
}

/// Mistakes in a scene or a frame.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Mistakes {
    /// Number of mistakes.
    pub count: usize,
    /// The mistakes formatted as compiler diagnostics, without colours.
    pub text: String,
    /// Position of the first mistake, as `ball.ron:12:3`.
    pub place: Option<String>,
}

/// An effect of the frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Planned {
    /// Name of the effect.
    pub effect: &'static str,
    /// True if the effect is needed.
    pub needed: bool,
    /// The reason the effect is needed, or the missing prerequisite.
    pub why: &'static str,
    /// Fraction of the frame's time that is saved by disabling the effect, 0 to 1, if measured.
    pub cost: Option<f64>,
}

/// A point of the error curve: the error and the time of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Samples per pixel; `None` for adaptive sampling.
    pub samples: Option<u32>,
    /// Time of the frame in milliseconds.
    pub milliseconds: f64,
    /// RMS error in 8-bit levels.
    pub error: f64,
}

/// Times in milliseconds, phase by phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Times {
    /// Reading: from files to a scene without mistakes.
    pub read: f64,
    /// Building: from a scene to an engine.
    pub build: f64,
    /// Animating: tracks and scripts.
    pub animate: f64,
    /// Preparing: world transforms and the kernel's arrays.
    pub prepare: f64,
    /// Tracing rays.
    pub trace: f64,
    /// Encoding: from a film to a file.
    pub encode: f64,
    /// Fraction of the picture, 0 to 1, that was taken from a former one. No rays were traced for it, but the number of rays counts those of the
    /// former one.
    pub reused: f64,
}

impl Mistakes {
    pub(super) fn of_scene(error: &LoadError) -> Self {
        let place = error.mistakes().next().map(|mistake| located(mistake.file, mistake.position));
        let count = error.mistakes().count() + error.unlisted();
        Self { count, text: error.render(false), place }
    }

    pub(super) fn of_picture(error: &str) -> Self {
        let text = format!("the picture cannot be shown: {error}; another size of the film may help");
        Self { count: 1, text, place: None }
    }

    pub(super) fn of_frame(error: &EngineError) -> Self {
        let place = match error {
            EngineError::Script(mistake) => place_of(mistake),
            EngineError::Scene(_)
            | EngineError::UnknownComponent(_)
            | EngineError::Cloud(_)
            | EngineError::Cancelled => None,
        };
        Self { count: 1, text: error.to_string(), place }
    }
}

fn place_of(mistake: &ScriptMistake) -> Option<String> {
    let source = mistake.diagnostic().source.as_ref()?;
    Some(located(&source.file, mistake.position()))
}

fn located(file: &str, position: Option<SourcePosition>) -> String {
    position.map_or_else(|| file.to_owned(), |position| format!("{file}:{position}"))
}

impl Planned {
    pub(super) fn all(plan: &Plan) -> Vec<Self> {
        let planned = |effect: Effect| {
            let need = plan.need(effect);
            Self { effect: effect.name(), needed: need.is_needed(), why: need.reason(), cost: None }
        };
        Effect::ALL.into_iter().map(planned).collect()
    }
}

impl Times {
    pub(super) fn milliseconds(duration: Duration) -> f64 {
        1e3 * duration.as_secs_f64()
    }

    /// Sets the times of a frame, which was traced in several parts for `traced` in all.
    pub(super) fn set_frame(&mut self, report: &FrameReport, traced: Duration) {
        self.animate = Self::milliseconds(report.animate);
        self.prepare = Self::milliseconds(report.prepare);
        self.trace = Self::milliseconds(traced);
        self.reused = report.reused;
    }

    /// Returns the time of a frame: the sum of animating, preparing and tracing.
    #[must_use]
    pub fn frame(&self) -> f64 {
        self.animate + self.prepare + self.trace
    }
}
