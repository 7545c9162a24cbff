//! The visible state of a session: a value that can be read at any time.

use serde::Serialize;

use super::mailbox::Detail;
use crate::engine::{EngineError, FrameReport};
use crate::scene::{LoadError, ScriptMistake, SourcePosition};
use crate::systems::{Effect, Plan};

/// The current state of a session.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct State {
    /// The scene's file.
    pub scene: String,
    /// A number that differs between sessions.
    pub session: u64,
    /// The number of times the scene was read without a mistake.
    pub reloads: u64,
    /// The frame to be seen: the requested one, or the last.
    pub frame: u32,
    /// The number of frames.
    pub frames: u32,
    /// The frames per second.
    pub rate: f64,
    /// The requested quality of pictures.
    pub detail: Detail,
    /// The film's width and height in pixels.
    pub film: (u32, u32),
    /// The latest picture.
    pub picture: Option<PictureInfo>,
    /// The last picture before the last edit, not a coarse one if there is another.
    pub before: Option<PictureInfo>,
    /// Whether a better picture is being made.
    pub rendering: bool,
    /// The share of it that exists, 0 to 1.
    pub progress: f64,
    /// The mistakes in the files as they are; the scene is then the last good one.
    pub mistakes: Option<Mistakes>,
    /// The mistakes of this frame.
    pub frame_mistakes: Option<Mistakes>,
    /// The effects of the frame of the last picture that was not coarse.
    pub plan: Vec<Planned>,
    /// What its samples are worth, as far as it was measured: the scene's own first, then others, ascending.
    pub curve: Vec<CurvePlace>,
    /// The times of the last reload and of the latest picture.
    pub times: Times,
    /// The number of rays of the latest picture.
    pub rays: u64,
}

/// A picture, without its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PictureInfo {
    /// The number under which it can be requested; later pictures have greater ones.
    pub id: u64,
    /// The frame it shows.
    pub frame: u32,
    /// The number of reloads before it.
    pub reloads: u64,
    /// Its width in pixels.
    pub width: u32,
    /// Its height in pixels.
    pub height: u32,
    /// The width and height, in pixels, of the film that it shows.
    pub film: (u32, u32),
    /// Whether it is the same as rendered to a file, bit for bit.
    pub full: bool,
    /// Whether it is coarse or unfinished, for lack of time.
    pub coarse: bool,
}

/// Mistakes in a scene or a frame.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Mistakes {
    /// Their number.
    pub count: usize,
    /// All of them as a compiler would show them, without colours.
    pub text: String,
    /// The place of the first, as `ball.ron:12:3`.
    pub place: Option<String>,
}

/// An effect of the frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Planned {
    /// Its name.
    pub effect: &'static str,
    /// Whether it is needed.
    pub needed: bool,
    /// The reason why it is needed, or what is missing for it.
    pub why: &'static str,
    /// The share of the frame's time that is saved without it, where it was measured: 0 to 1.
    pub cost: Option<f64>,
}

/// A picture's error and its price.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CurvePlace {
    /// The samples per pixel; `None` for as many as each pixel needs.
    pub samples: Option<u32>,
    /// The time of the frame.
    pub milliseconds: f64,
    /// The error, in steps of 8 bits, as the root of the mean square.
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
            EngineError::Scene(_) | EngineError::UnknownComponent(_) => None,
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
    pub(super) fn milliseconds(duration: std::time::Duration) -> f64 {
        1e3 * duration.as_secs_f64()
    }

    pub(super) fn set_frame(&mut self, report: &FrameReport) {
        self.animate = Self::milliseconds(report.animate);
        self.prepare = Self::milliseconds(report.prepare);
        self.trace = Self::milliseconds(report.trace);
    }

    /// Returns the time of a frame, without reading, building and encoding.
    #[must_use]
    pub fn frame(&self) -> f64 {
        self.animate + self.prepare + self.trace
    }
}
