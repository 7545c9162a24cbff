//! Publication of a session's state and pictures, which all threads can read, and of its events.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use tokio::sync::watch;

use super::cache::{CachedPicture, FrameCache};
use super::commands::Detail;
use super::export::{ExportControl, ExportState};
use super::state::{Mistakes, PictureInfo, Planned, State, Times};
use super::warnings::PictureWarnings;
use crate::color::Transfer;
use crate::engine::EngineError;
use crate::output;
use crate::scene::LoadError;
use crate::trace::{Film, TileStats};

/// Number of latest pictures that are kept. A page requests a picture as soon as it is announced, and several may follow before the
/// request arrives.
const HISTORY: usize = 8;

/// An event of a session, passed to the callback of [`Session::start`](super::Session::start).
#[derive(Debug)]
pub enum Event {
    /// The scene was read from its files.
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
    /// Warnings about the scene and the picture. Only full pictures are checked for them.
    pub warnings: PictureWarnings,
    /// True if the picture shows values that are tried on the page and not in the files.
    pub tried: bool,
}

/// A published picture.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Description of the picture.
    pub info: PictureInfo,
    /// The picture encoded as a PNG file.
    pub png: Arc<[u8]>,
    /// The statistics of each tile; empty for a coarse picture.
    pub tile_stats: Arc<[TileStats]>,
    /// The measured RMS error of each tile of the full picture, in output values.
    pub measured_errors: Option<Arc<[f32]>>,
}

/// The state and the latest pictures.
#[derive(Debug)]
pub(super) struct Published {
    state: watch::Sender<State>,
    pictures: Mutex<Pictures>,
    cache: Mutex<FrameCache>,
    export: Arc<ExportControl>,
}

#[derive(Debug, Default)]
struct Pictures {
    latest: VecDeque<Picture>,
    before: Option<Picture>,
}

impl Published {
    /// Publishes a state. `cache` is the maximum size of the pictures that are kept, in bytes.
    pub(super) fn new(state: State, cache: usize) -> Self {
        let cache = Mutex::new(FrameCache::new(cache));
        let export = Arc::default();
        Self { state: watch::Sender::new(state), pictures: Mutex::default(), cache, export }
    }

    /// Returns the control of the export.
    pub(super) fn export(&self) -> &Arc<ExportControl> {
        &self.export
    }

    /// Returns the export that is running, or was the last.
    pub(super) fn export_state(&self) -> Option<ExportState> {
        self.state.borrow().export.clone()
    }

    /// Returns the reason why no more frames are written into the folder of the cache.
    pub(super) fn cache_error(&self) -> Option<String> {
        self.state.borrow().cache_error.clone()
    }

    /// Returns whether values are tried on the page, or a view that is not written.
    pub(super) fn shows_tried_values(&self) -> bool {
        let Unwritten { values, view } = self.unwritten();
        values || view
    }

    /// Returns what is shown that is not in the files.
    pub(super) fn unwritten(&self) -> Unwritten {
        let edits = &self.state.borrow().edits;
        Unwritten { values: !edits.tried.is_empty(), view: edits.look.is_some() }
    }

    /// Returns the requested quality.
    pub(super) fn detail(&self) -> Detail {
        self.state.borrow().detail
    }

    /// Returns the finished pictures of frames.
    pub(super) fn cache(&self) -> MutexGuard<'_, FrameCache> {
        self.cache.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the finished picture of a frame as a PNG file, if the [frames kept](State::cached) are of this generation.
    pub(super) fn frame(&self, generation: u64, frame: u32) -> Option<Arc<[u8]>> {
        let mut cache = self.cache();
        let is_current = cache.generation() == generation;
        Some(Arc::clone(&cache.picture(frame).filter(|_| is_current)?.png))
    }

    /// Publishes which frames have pictures; without `notify`, together with the next change.
    pub(super) fn publish_cached_frames(&self, notify: bool) {
        let cached = self.cache().contents();
        let update = |state: &mut State| state.cached = cached;
        if notify { self.update(update) } else { self.update_without_notify(update) }
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

    /// Adds the measured errors of the tiles of a frame to its full picture, if that is displayed. The caller updates [`State::curve`].
    pub(super) fn add_measured_errors(&self, frame: u32, errors: Arc<[f32]>) {
        let State { picture, reloads, .. } = self.state();
        let is_of = |info: &PictureInfo| info.full && info.frame == frame && info.reloads == reloads;
        let Some(PictureInfo { id, .. }) = picture.filter(is_of) else { return };
        let mut pictures = self.pictures.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(picture) = pictures.latest.iter_mut().rfind(|picture| picture.info.id == id) {
            picture.measured_errors = Some(errors);
        }
    }

    /// Adds a picture. The caller updates [`State::picture`].
    fn add(&self, picture: Picture) {
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
        let picture = now().find(|picture| !picture.info.coarse).or_else(|| now().next()).cloned();
        let info = picture.as_ref().map(|picture| picture.info);
        pictures.before = picture;
        info
    }
}

/// Presence of tried values, and of a view, that are shown and not in the files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Unwritten {
    values: bool,
    view: bool,
}

impl Unwritten {
    /// Returns whether the next scene is a further step of the same edit: another value of a drag, what becomes of it, or the next view.
    pub(super) fn continues_in(self, next: Self) -> bool {
        self.values || self.view && self == next
    }
}

/// A function that encodes a film as a file, or returns the reason for its failure.
type Encode = fn(&Film, Transfer) -> Result<Vec<u8>, String>;

/// The encoder and publisher of pictures, which also emits the session's events.
pub(super) struct Publisher {
    published: Arc<Published>,
    emit: Box<dyn FnMut(Event) + Send>,
    encode: Encode,
    last_id: u64,
    /// The latest picture, with its film unless it comes from the cache.
    latest: Option<(PictureInfo, Option<Arc<Film>>)>,
    /// The picture published last and its frame, until it is in the cache.
    latest_finished: Option<(u32, CachedPicture)>,
}

/// A picture to be published.
pub(super) struct RenderedPicture {
    pub(super) film: Film,
    pub(super) transfer: Transfer,
    pub(super) kind: PictureKind,
    /// Times of the phases, except encoding.
    pub(super) times: Times,
    pub(super) rays: u64,
    pub(super) tile_stats: Arc<[TileStats]>,
    /// Effects of its frame, if known.
    pub(super) plan: Option<Vec<Planned>>,
    /// Warnings about the scene and a full picture.
    pub(super) warnings: PictureWarnings,
}

impl RenderedPicture {
    /// Creates an unfinished picture. `trace` is the time since the picture was begun, in milliseconds.
    pub(super) fn unfinished(
        film: Film,
        transfer: Transfer,
        progress: f64,
        trace: f64,
        state: &State,
    ) -> Self {
        let (kind, times) = (PictureKind::Coarse(progress), Times { trace, reused: 0.0, ..state.times });
        Self {
            film,
            transfer,
            kind,
            times,
            rays: state.rays,
            tile_stats: Arc::default(),
            plan: None,
            warnings: PictureWarnings::default(),
        }
    }
}

/// The kind of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PictureKind {
    /// A coarse or unfinished picture, with the fraction of the better picture that is finished, 0 to 1.
    Coarse(f64),
    /// A requested draft.
    Draft {
        /// True if a full picture follows.
        precedes_full: bool,
    },
    /// A picture identical to one rendered to a file.
    Full,
}

impl PictureKind {
    /// Returns the kind of a finished picture of a quality.
    pub(super) fn finished(detail: Detail) -> Self {
        match detail {
            Detail::Full => Self::Full,
            Detail::Draft | Detail::Half => Self::Draft { precedes_full: false },
        }
    }
}

impl Publisher {
    pub(super) fn new(published: Arc<Published>, emit: Box<dyn FnMut(Event) + Send>) -> Self {
        let encode: Encode =
            |film, transfer| output::encode_quickly(film, transfer).map_err(|error| error.to_string());
        Self { published, emit, encode, last_id: 0, latest: None, latest_finished: None }
    }

    pub(super) fn published(&self) -> &Published {
        &self.published
    }

    pub(super) fn emit(&mut self, event: Event) {
        (self.emit)(event);
    }

    /// Returns the latest picture if it shows the current frame of the current scene, with its film unless it comes from the cache.
    pub(super) fn latest(&self) -> Option<(PictureInfo, Option<&Arc<Film>>)> {
        let state = self.published.state();
        let (info, film) = self.latest.as_ref()?;
        (info.frame == state.frame && info.reloads == state.reloads).then_some((*info, film.as_ref()))
    }

    /// Encodes a finished picture, which is not the displayed one, and adds it to the cache. Returns whether it could be encoded.
    pub(super) fn keep(&mut self, state: &State, picture: &RenderedPicture, current: u32) -> bool {
        let Ok(png) = (self.encode)(&picture.film, picture.transfer) else { return false };
        if let Some(finished) = self.finished(picture, png.into()) {
            self.published.cache().add(state.frame, finished, current);
        }
        true
    }

    /// Adds the picture published last to the cache, if it is finished and the fingerprint of its frame is known.
    pub(super) fn keep_latest(&mut self) {
        if let Some((frame, finished)) = self.latest_finished.take() {
            self.published.cache().add(frame, finished, frame);
            self.published.publish_cached_frames(true);
        }
    }

    /// Returns a picture for the cache; `None` if it is not finished, or has another quality than those there.
    fn finished(&self, picture: &RenderedPicture, png: Arc<[u8]>) -> Option<CachedPicture> {
        let is_full = self.published.detail() == Detail::Full;
        if matches!(picture.kind, PictureKind::Coarse(_)) || (picture.kind == PictureKind::Full) != is_full {
            return None;
        }
        Some(CachedPicture {
            png,
            width: picture.film.width(),
            height: picture.film.height(),
            times: picture.times,
            rays: picture.rays,
            tile_stats: Arc::clone(&picture.tile_stats),
            plan: picture.plan.clone().unwrap_or_default(),
            warnings: picture.warnings.clone(),
            used: 0,
        })
    }

    /// Publishes a picture of the frame of `state` from the cache.
    pub(super) fn publish_cached(&mut self, state: &State, picture: CachedPicture) {
        let CachedPicture { png, width, height, times, rays, tile_stats, plan, warnings, .. } = picture;
        let kind = PictureKind::finished(self.published.detail());
        let info = self.info(state, (width, height), kind);
        self.latest = Some((info, None));
        self.published.add(Picture { info, png, tile_stats, measured_errors: None });
        let Times { read, build, .. } = state.times;
        self.published.update(|state| {
            state.show(info, Times { read, build, ..times }, rays, kind, &warnings, Some(plan));
        });
    }

    /// Encodes and publishes a picture of the frame of `state`. If encoding fails, reports a mistake of the frame and returns `false`.
    pub(super) fn publish(&mut self, state: &State, picture: RenderedPicture) -> bool {
        let start = Instant::now();
        let png = match (self.encode)(&picture.film, picture.transfer) {
            Ok(png) => png,
            Err(error) => {
                let mistakes = Mistakes::of_picture(&error);
                self.show_mistakes(mistakes.clone());
                self.emit(Event::NotShown(mistakes));
                return false;
            }
        };
        let png: Arc<[u8]> = png.into();
        self.latest_finished =
            self.finished(&picture, Arc::clone(&png)).map(|finished| (state.frame, finished));
        let RenderedPicture { film, transfer, kind, mut times, rays, tile_stats, plan, warnings } = picture;
        times.encode = Times::milliseconds(start.elapsed());
        let info = self.info(state, (film.width(), film.height()), kind);
        let film = Arc::new(film);
        self.latest = Some((info, Some(Arc::clone(&film))));
        self.published.add(Picture { info, png, tile_stats, measured_errors: None });
        self.published.update(|state| state.show(info, times, rays, kind, &warnings, plan));
        let tried = self.published.shows_tried_values();
        self.emit(Event::Shown(Shown { info, film, transfer, times, rays, warnings, tried }));
        true
    }

    /// Emits the event of a full picture and publishes its warnings, but not the picture.
    pub(super) fn report(&mut self, state: &State, picture: RenderedPicture) {
        let RenderedPicture { film, transfer, kind, times, rays, warnings, .. } = picture;
        let info = self.info(state, (film.width(), film.height()), kind);
        self.published.update(|state| {
            if (state.frame, state.reloads) == (info.frame, info.reloads) {
                state.warnings.clone_from(&warnings);
            }
        });
        let (film, tried) = (Arc::new(film), self.published.shows_tried_values());
        self.emit(Event::Shown(Shown { info, film, transfer, times, rays, warnings, tried }));
    }

    /// Reports that the frame cannot be rendered.
    pub(super) fn fail(&mut self, error: EngineError) {
        self.show_mistakes(Mistakes::of_frame(&error));
        self.emit(Event::Failed(error));
    }

    fn show_mistakes(&self, mistakes: Mistakes) {
        self.published.update(|state| {
            state.frame_mistakes = Some(mistakes);
            state.rendering = false;
        });
    }

    fn info(&mut self, state: &State, (width, height): (u32, u32), kind: PictureKind) -> PictureInfo {
        self.last_id += 1;
        PictureInfo {
            id: self.last_id,
            frame: state.frame,
            reloads: state.reloads,
            width,
            height,
            film: state.film,
            full: kind == PictureKind::Full,
            coarse: matches!(kind, PictureKind::Coarse(_)),
        }
    }
}

impl State {
    /// Shows a picture of the current frame.
    fn show(
        &mut self,
        info: PictureInfo,
        times: Times,
        rays: u64,
        kind: PictureKind,
        warnings: &PictureWarnings,
        plan: Option<Vec<Planned>>,
    ) {
        self.picture = Some(info);
        self.times = times;
        self.rays = rays;
        (self.rendering, self.progress) = match kind {
            PictureKind::Coarse(share) => (true, share),
            PictureKind::Draft { precedes_full } => (precedes_full, 1.0),
            PictureKind::Full => (false, 1.0),
        };
        self.frame_mistakes = None;
        match kind {
            // Until the full picture follows, the warnings about the last one stay.
            PictureKind::Coarse(_) | PictureKind::Draft { precedes_full: true } => {}
            PictureKind::Draft { precedes_full: false } | PictureKind::Full => {
                self.warnings.clone_from(warnings);
            }
        }
        if let Some(plan) = plan {
            self.plan = plan;
            self.curve.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;

    #[test]
    fn encoding_failure_is_reported_and_ends_rendering() {
        let state = State { rendering: true, ..State::default() };
        let published = Arc::new(Published::new(state.clone(), 0));
        let (sender, events) = channel();
        let emit = move |event| sender.send(event).unwrap();
        let mut publisher = Publisher::new(Arc::clone(&published), Box::new(emit));
        let picture = |kind| RenderedPicture {
            film: Film::new(2, 1),
            transfer: Transfer::Classic,
            kind,
            times: Times::default(),
            rays: 0,
            tile_stats: Arc::default(),
            plan: None,
            warnings: PictureWarnings::default(),
        };
        for kind in [
            PictureKind::Coarse(0.0),
            PictureKind::Coarse(0.5),
            PictureKind::Draft { precedes_full: true },
            PictureKind::Full,
        ] {
            published.update(|state| state.rendering = true);
            publisher.encode = |_, _| Err("no room".to_owned());
            assert!(!publisher.publish(&state, picture(kind)));
            let shown = published.state();
            assert!(!shown.rendering && shown.frame_mistakes.unwrap().text.contains("no room"));
            assert!(matches!(events.try_recv(), Ok(Event::NotShown(_))));
            // The next picture can be shown again.
            publisher.encode = |_, _| Ok(Vec::new());
            assert!(publisher.publish(&state, picture(kind)));
            assert_eq!(published.state().frame_mistakes, None);
            assert!(matches!(events.try_recv(), Ok(Event::Shown(_))));
        }
    }
}
