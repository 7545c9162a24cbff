//! The published state and pictures of a session, readable from all threads.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use tokio::sync::watch;

use super::state::{PictureInfo, State};

/// Number of latest pictures that are kept.
const HISTORY: usize = 8;

/// A published picture.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Description of the picture.
    pub info: PictureInfo,
    /// The picture encoded as a PNG file.
    pub png: Arc<[u8]>,
}

/// The state and the latest pictures.
#[derive(Debug)]
pub(super) struct Published {
    state: watch::Sender<State>,
    pictures: Mutex<Pictures>,
}

#[derive(Debug, Default)]
struct Pictures {
    latest: VecDeque<Picture>,
    before: Option<Picture>,
}

impl Published {
    pub(super) fn new(state: State) -> Self {
        Self { state: watch::Sender::new(state), pictures: Mutex::default() }
    }

    pub(super) fn state(&self) -> State {
        self.state.borrow().clone()
    }

    /// Returns a receiver of subsequent states.
    pub(super) fn subscribe(&self) -> watch::Receiver<State> {
        self.state.subscribe()
    }

    pub(super) fn update(&self, update: impl FnOnce(&mut State)) {
        self.state.send_modify(update);
    }

    /// Changes the state without notifying subscribers. They receive the change together with the next one.
    pub(super) fn update_without_notify(&self, update: impl FnOnce(&mut State)) {
        self.state.send_if_modified(|state| {
            update(state);
            false
        });
    }

    /// Returns a picture if it is still kept.
    pub(super) fn picture(&self, id: u64) -> Option<Picture> {
        let pictures = self.pictures.lock().unwrap_or_else(PoisonError::into_inner);
        pictures.latest.iter().chain(&pictures.before).find(|picture| picture.info.id == id).cloned()
    }

    /// Publishes a picture. The caller updates [`State::picture`].
    pub(super) fn publish(&self, picture: Picture) {
        let mut pictures = self.pictures.lock().unwrap_or_else(PoisonError::into_inner);
        pictures.latest.push_back(picture);
        if pictures.latest.len() > HISTORY {
            pictures.latest.pop_front();
        }
    }

    /// Keeps the latest picture of the current scene for later comparison. Pictures that are not coarse take precedence.
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
