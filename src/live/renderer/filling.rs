//! Rendering of the frames that the cache misses, while nothing else is requested.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::{MIN_SLICE, Renderer};
use crate::components::FilmSettings;
use crate::engine::{EngineError, RenderRequest};
use crate::live::cache::{CachedPicture, FrameKey};
use crate::live::cache_folder::CacheFolder;
use crate::live::commands::Detail;
use crate::live::jobs::{RenderInProgress, settings_of};
use crate::live::publish::PictureKind;
use crate::live::state::State;
use crate::live::warnings::PictureWarnings;
use crate::trace::Signals;

/// Minimum interval between reports of new pictures in the cache. Simple scenes fill it with hundreds of pictures a second.
const CACHE_REPORT_INTERVAL: Duration = Duration::from_millis(100);

impl Renderer {
    /// Forgets which frames have finished pictures, after a change of the scene or of the requested quality.
    pub(in crate::live) fn begin_cache(&mut self) {
        self.filling = None;
        let published = self.publisher.published();
        published.cache().begin(self.engine.timeline.frame_count());
        published.publish_cached_frames(false);
    }

    /// Finds the fingerprint of a frame at the requested quality, unless it is known, and stores the picture that the cache may have of it.
    /// The fingerprint stays unknown if the search is cancelled.
    pub(super) fn find_key(&mut self, frame: u32, signals: Signals<'_>) {
        let published = self.publisher.published();
        if published.cache().key(frame) != FrameKey::Unknown {
            return;
        }
        let time = self.engine.timeline.time_of(frame);
        let settings = settings_of(&self.engine, published.detail());
        let planned = self.engine.plan(RenderRequest { settings, signals, ..RenderRequest::at(time) });
        let key = match planned {
            Ok(report) => report.fingerprint.map_or(FrameKey::Failed, FrameKey::Known),
            Err(EngineError::Cancelled) => return,
            Err(_) => FrameKey::Failed,
        };
        self.publisher.published().cache().set_key(frame, key);
        // An equal picture may exist: of another frame, of tried values that are now kept, or from before an edit that is undone.
        self.store(frame);
    }

    /// Returns whether a picture can be added to the cache. An export comes first.
    pub(in crate::live) fn can_fill_cache(&self) -> bool {
        let published = self.publisher.published();
        !published.export().is_running()
            && (self.filling.is_some() || published.cache().next_missing(published.state().frame).is_some())
    }

    /// Finds the fingerprint of a frame that has no picture in the cache, or continues the picture until it is finished, `until`, or a
    /// command. During playback the work is continued for a while in spite of requests of frames.
    pub(in crate::live) fn fill_cache(&mut self, is_playing: bool, until: Option<Instant>) {
        if !self.can_fill_cache() {
            return;
        }
        let published = self.publisher.published();
        let state = published.state();
        let (next, detail) = (published.cache().next_missing(state.frame), state.detail);
        let mut filling = match (self.filling.take(), next) {
            (Some(filling), _) => filling,
            (None, Some(frame)) => RenderInProgress::new(frame, detail),
            (None, None) => return,
        };
        let frame = filling.frame;
        if published.cache().key(frame) == FrameKey::Unknown {
            let commands = Arc::clone(&self.commands);
            self.find_key(frame, Signals { cancelled: commands.urgent(), ..Signals::none() });
            return self.report_cache();
        }
        if filling.job.is_none() && self.load_stored(frame).is_some() {
            return self.report_cache();
        }
        let slice = if is_playing { MIN_SLICE } else { Duration::ZERO };
        // Frames for the cache reuse tiles of the last one for the cache, which is nearer in time than the displayed one.
        std::mem::swap(&mut self.displayed, &mut self.filled);
        let film = self.continue_in_background(&mut filling, slice, until);
        std::mem::swap(&mut self.displayed, &mut self.filled);
        let is_kept = match film {
            Ok(None) => {
                self.filling = Some(filling);
                return;
            }
            Ok(Some(film)) => {
                let kind = PictureKind::finished(detail);
                let current = state.frame;
                let state = State { frame, ..state };
                let picture = self.rendered(&state, kind, film, filling.traced);
                let is_kept = self.publisher.keep(&state, &picture, current);
                self.store(frame);
                is_kept
            }
            Err(_) => false,
        };
        if !is_kept {
            self.publisher.published().cache().set_key(frame, FrameKey::Failed);
        }
        self.report_cache();
    }

    /// Sets the folder of frames that are kept for other sessions.
    pub(in crate::live) fn set_folder(&mut self, folder: Option<CacheFolder>) {
        self.folder = folder;
    }

    /// Returns whether the folder has a file of the current frame, which may be that of another scene.
    pub(in crate::live) fn may_be_stored(&self) -> bool {
        let State { frame, frames, detail, .. } = self.publisher.published().state();
        let has_file = |folder: &CacheFolder| folder.has_file(frame, frames);
        detail == Detail::Full && self.folder.as_ref().is_some_and(has_file)
    }

    /// Adds the picture of a frame from the folder to the cache, and returns it.
    pub(super) fn load_stored(&mut self, frame: u32) -> Option<CachedPicture> {
        let state = self.publisher.published().state();
        let folder = self.folder.as_mut().filter(|_| state.detail == Detail::Full)?;
        let FrameKey::Known(fingerprint) = self.publisher.published().cache().key(frame) else { return None };
        let FilmSettings { width, height, .. } = self.engine.effective_settings().film;
        let png = folder.read(frame, state.frames, (width, height), fingerprint)?;
        let plan = self.planned(frame, false).ok()?;
        let mut times = state.times;
        times.set_frame(self.engine.report(), Duration::ZERO);
        let warnings = PictureWarnings::of(&self.engine, &self.sources, &self.allowed);
        let tile_stats = Arc::default();
        let picture =
            CachedPicture { png, width, height, times, rays: 0, tile_stats, plan, warnings, used: 0 };
        self.publisher.published().cache().add(frame, picture.clone(), state.frame);
        Some(picture)
    }

    /// Writes the full picture of a frame into the folder, if the cache has it. Values that are tried are in no file.
    pub(super) fn store(&mut self, frame: u32) {
        let published = self.publisher.published();
        let Some(folder) = &mut self.folder else { return };
        if published.detail() != Detail::Full || published.shows_tried_values() {
            return;
        }
        let frames = published.state().frames;
        let mut cache = published.cache();
        if let FrameKey::Known(fingerprint) = cache.key(frame)
            && let Some(CachedPicture { png, width, height, .. }) = cache.picture(frame)
        {
            let picture = (Arc::clone(png), (*width, *height));
            drop(cache);
            folder.write(frame, frames, picture, fingerprint);
        }
    }

    /// Publishes which frames have pictures, at once if all have them.
    fn report_cache(&mut self) {
        if self.cache_reported.elapsed() >= CACHE_REPORT_INTERVAL || !self.can_fill_cache() {
            self.cache_reported = Instant::now();
            self.publisher.published().publish_cached_frames(true);
        }
    }
}
