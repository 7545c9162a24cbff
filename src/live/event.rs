//! Events of a session.

use std::sync::Arc;

use super::state::{Mistakes, PictureInfo, Times};
use crate::color::Transfer;
use crate::engine::EngineError;
use crate::scene::LoadError;
use crate::trace::Film;

/// An event of a session, passed to the callback of [`Session::start`](super::Session::start).
#[derive(Debug)]
pub enum Event {
    /// The scene was read.
    Reloaded(Times),
    /// The files contain mistakes. The last good scene stays.
    Broken(LoadError),
    /// The frame cannot be rendered.
    Failed(EngineError),
    /// A picture was rendered but cannot be shown.
    NotShown(Mistakes),
    /// A picture was rendered.
    Shown(Shown),
}

/// A rendered picture.
#[derive(Debug)]
pub struct Shown {
    /// Description of the picture.
    pub info: PictureInfo,
    /// Pixels of the picture.
    pub film: Arc<Film>,
    /// Transfer function that encodes the colours as bytes.
    pub transfer: Transfer,
    /// Times of the phases.
    pub times: Times,
    /// Number of rays traced.
    pub rays: u64,
    /// Faults of the scene, one line each. Only full pictures are checked for them.
    pub warnings: Vec<String>,
}
