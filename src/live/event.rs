//! What happens while a scene is watched.

use std::sync::Arc;

use super::state::{Mistakes, PictureInfo, Times};
use crate::color::Transfer;
use crate::engine::EngineError;
use crate::scene::LoadError;
use crate::trace::Film;

/// An event of a session, for whoever wants to report it.
#[derive(Debug)]
pub enum Event {
    /// The scene was read.
    Reloaded(Times),
    /// The files are wrong; the last good scene stays.
    Broken(LoadError),
    /// The frame cannot be made.
    Failed(EngineError),
    /// A picture was made, but cannot be shown.
    NotShown(Mistakes),
    /// A picture was made.
    Shown(Shown),
}

/// A picture that was made.
#[derive(Debug)]
pub struct Shown {
    /// The description of the picture.
    pub info: PictureInfo,
    /// Its pixels.
    pub film: Arc<Film>,
    /// The conversion of its colours to bytes.
    pub transfer: Transfer,
    /// The times it took.
    pub times: Times,
    /// The number of rays traced.
    pub rays: u64,
    /// The faults of the scene, one line each; looked for in full pictures alone.
    pub warnings: Vec<String>,
}
