//! What happens while a scene is watched.

use std::sync::Arc;

use super::state::{Mistakes, PictureInfo, Times};
use crate::color::Transfer;
use crate::engine::EngineError;
use crate::scene::LoadError;
use crate::trace::Film;

/// What happens in a session, for whoever wants to tell it.
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
    /// Which.
    pub info: PictureInfo,
    /// Its pixels.
    pub film: Arc<Film>,
    /// How they become bytes.
    pub transfer: Transfer,
    /// What it took.
    pub times: Times,
    /// How many were traced.
    pub rays: u64,
    /// What is not drawn as it says, a line each; looked for in full pictures alone.
    pub warnings: Vec<String>,
}
