//! What there is to be seen of a session: a value that can be read at any time.

use serde::Serialize;

use super::mailbox::Detail;
use crate::engine::{EngineError, FrameReport};
use crate::scene::{LoadError, Place, ScriptMistake};
use crate::systems::{Effect, Plan};

/// A session as it is now.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct State {
    /// The scene's file.
    pub scene: String,
    /// Another number for every session.
    pub session: u64,
    /// How often the scene was read without a mistake.
    pub reloads: u64,
    /// What is to be seen: the frame that was asked for, or the last.
    pub frame: u32,
    /// How many there are.
    pub frames: u32,
    /// In a second.
    pub rate: f64,
    /// How good pictures are asked to be.
    pub detail: Detail,
    /// Of the film, in pixels: width and height.
    pub film: (u32, u32),
    /// The latest picture.
    pub picture: Option<PictureInfo>,
    /// The last picture before the last edit, not a coarse one if there is another.
    pub before: Option<PictureInfo>,
    /// Is a better picture under way?
    pub rendering: bool,
    /// How much of it there is, 0 to 1.
    pub progress: f64,
    /// What is wrong with the files as they are; the scene is then the last good one.
    pub mistakes: Option<Mistakes>,
    /// What is wrong with this frame.
    pub frame_mistakes: Option<Mistakes>,
    /// What the frame of the last picture calls for that was not coarse.
    pub plan: Vec<Planned>,
    /// What the last reload and the latest picture took.
    pub times: Times,
    /// Rays of the latest picture.
    pub rays: u64,
}

/// A picture, without its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PictureInfo {
    /// Under which it can be had; later pictures have greater ones.
    pub id: u64,
    /// What it shows.
    pub frame: u32,
    /// After how many reloads.
    pub reloads: u64,
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// The film that it is of, in pixels: width and height.
    pub film: (u32, u32),
    /// As it is rendered to a file, bit for bit?
    pub full: bool,
    /// Coarse or unfinished, for lack of time?
    pub coarse: bool,
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Mistakes {
    /// How many.
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
    /// Is it called for?
    pub needed: bool,
    /// By what, or what is missing.
    pub why: &'static str,
    /// The share of the frame's time that is saved without it, where it was measured: 0 to 1.
    pub cost: Option<f64>,
}

/// Milliseconds, phase by phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Times {
    /// From files to a scene without mistakes.
    pub read: f64,
    /// From a scene to an engine.
    pub build: f64,
    /// Tracks and scripts.
    pub animate: f64,
    /// World transforms and the kernel's arrays.
    pub prepare: f64,
    /// Rays.
    pub trace: f64,
    /// From a film to a file.
    pub encode: f64,
}

impl Mistakes {
    pub(super) fn of_scene(error: &LoadError) -> Self {
        let place = error.mistakes().next().map(|mistake| located(mistake.file, mistake.place));
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
    Some(located(&source.file, mistake.place()))
}

fn located(file: &str, place: Option<Place>) -> String {
    place.map_or_else(|| file.to_owned(), |place| format!("{file}:{place}"))
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

    /// Of a frame, without reading and writing.
    #[must_use]
    pub fn frame(&self) -> f64 {
        self.animate + self.prepare + self.trace
    }
}
