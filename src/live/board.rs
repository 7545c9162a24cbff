//! A session's state and pictures, put up for all threads to see.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use tokio::sync::watch;

use super::state::{PictureInfo, State};

/// The number of further pictures after which a picture is dropped.
const KEPT: usize = 8;

/// A picture.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The description of the picture.
    pub info: PictureInfo,
    /// The picture as a PNG file.
    pub png: Arc<[u8]>,
}

/// The state and the latest pictures.
#[derive(Debug)]
pub(super) struct Board {
    state: watch::Sender<State>,
    pictures: Mutex<Pictures>,
}

#[derive(Debug, Default)]
struct Pictures {
    latest: VecDeque<Picture>,
    before: Option<Picture>,
}

impl Board {
    pub(super) fn new(state: State) -> Self {
        Self { state: watch::Sender::new(state), pictures: Mutex::default() }
    }

    pub(super) fn state(&self) -> State {
        self.state.borrow().clone()
    }

    /// Returns a receiver of the states that are put up from now on.
    pub(super) fn subscribe(&self) -> watch::Receiver<State> {
        self.state.subscribe()
    }

    pub(super) fn change(&self, change: impl FnOnce(&mut State)) {
        self.state.send_modify(change);
    }

    /// Changes the state without waking subscribers; they see it with the next change.
    pub(super) fn change_silently(&self, change: impl FnOnce(&mut State)) {
        self.state.send_if_modified(|state| {
            change(state);
            false
        });
    }

    /// Returns a picture that is still kept.
    pub(super) fn picture(&self, id: u64) -> Option<Picture> {
        let pictures = self.pictures.lock().unwrap_or_else(PoisonError::into_inner);
        pictures.latest.iter().chain(&pictures.before).find(|picture| picture.info.id == id).cloned()
    }

    /// Puts up a picture; the caller changes [`State::picture`].
    pub(super) fn hang(&self, picture: Picture) {
        let mut pictures = self.pictures.lock().unwrap_or_else(PoisonError::into_inner);
        pictures.latest.push_back(picture);
        if pictures.latest.len() > KEPT {
            pictures.latest.pop_front();
        }
    }

    /// Keeps the latest picture of the scene as it is for later comparison, one that is not coarse if there is one.
    pub(super) fn keep_for_comparison(&self) -> Option<PictureInfo> {
        let mut pictures = self.pictures.lock().unwrap_or_else(PoisonError::into_inner);
        let reloads = pictures.latest.back().map(|latest| latest.info.reloads);
        let now = || pictures.latest.iter().rev().filter(|picture| Some(picture.info.reloads) == reloads);
        let kept = now().find(|picture| !picture.info.coarse).or_else(|| now().next()).cloned();
        let info = kept.as_ref().map(|picture| picture.info);
        pictures.before = kept;
        info
    }
}
