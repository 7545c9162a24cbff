//! The files of the scene, and mistakes in them that are not reported yet.

use std::path::PathBuf;
use std::slice;
use std::time::{Duration, Instant, SystemTime};

use super::editor::EditorCommand;
use super::edits::Edits;
use super::state::Times;
use super::watcher::{Stamp, Watcher};
use crate::scene::{LoadError, Override, Reader, Scene, Sources};

/// Time for which files must be unchanged before mistakes in them are reported. Slow writers leave files incomplete for a while: with 30 ms,
/// 275 saves in place in 5 s gave "the file is empty" twice.
const SETTLE_TIME: Duration = Duration::from_millis(100);
/// Time after which mistakes are reported even if the files keep changing. A longer delay would seem as if the edit had been missed.
const SETTLE_TIMEOUT: Duration = Duration::from_secs(1);

/// The files of the scene. Mistakes are reported once the files have settled, since files may be empty or truncated while they are being
/// written.
pub(super) struct SceneFiles {
    pub(super) scene: PathBuf,
    pub(super) reader: Reader,
    pub(super) watcher: Watcher,
    pub(super) failure: Option<LoadFailure>,
    pub(super) edits: Edits,
    /// The files of the last scene without mistakes.
    pub(super) paths: Vec<PathBuf>,
    pub(super) editor: Option<EditorCommand>,
}

/// Mistakes that are not reported yet.
pub(super) struct LoadFailure {
    pub(super) error: LoadError,
    /// Time of the first of several consecutive failures.
    first: Instant,
    pub(super) check_at: Instant,
    /// True if files had mistakes for [`SETTLE_TIMEOUT`] when they were read. A busy thread may check much later, when they are long mended.
    is_over: bool,
    /// The stamps of the files after they were read; `None` if they were written in the meantime.
    stamps: Option<Vec<Option<Stamp>>>,
}

/// The treatment of files with mistakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FailureAction {
    /// The files have changed, or may be readable now.
    ReadAgain,
    /// The mistakes persist.
    Report,
}

impl SceneFiles {
    pub(super) fn new(
        scene: PathBuf,
        overrides: Vec<Override>,
        watcher: Watcher,
        editor: Option<EditorCommand>,
    ) -> Self {
        watcher.follow(slice::from_ref(&scene), SystemTime::now());
        let reader = Reader::overriding(overrides.clone());
        let edits = Edits::new(overrides);
        Self { scene, reader, watcher, failure: None, edits, paths: Vec::new(), editor }
    }

    /// Reads the files. Returns their scene and the time taken in milliseconds, or keeps the mistakes to be reported later.
    pub(super) fn read(&mut self) -> Option<(Scene, Sources, f64)> {
        self.watcher.check();
        let (since, start) = (SystemTime::now(), Instant::now());
        match self.reader.load(&self.scene) {
            Ok((scene, sources)) => {
                let read = Times::milliseconds(start.elapsed());
                self.watcher.follow(&scene.files, since);
                self.paths.clone_from(&scene.files);
                self.failure = None;
                Some((scene, sources, read))
            }
            Err(error) => {
                self.watcher.follow(error.files(), since);
                let first = self.failure.take().map_or(start, |failure| failure.first);
                let left = SETTLE_TIMEOUT.saturating_sub(first.elapsed());
                let (wait, is_over) = (SETTLE_TIME.min(left), left.is_zero());
                let (check_at, stamps) = (Instant::now() + wait, self.watcher.stamps());
                self.failure = Some(LoadFailure { error, first, check_at, is_over, stamps });
                None
            }
        }
    }

    /// Returns the treatment of mistakes that are not reported yet, once it is time.
    pub(super) fn failure_action(&self) -> Option<FailureAction> {
        let failure = self.failure.as_ref().filter(|failure| failure.check_at <= Instant::now())?;
        let is_unchanged = failure.stamps.is_some() && failure.stamps == self.watcher.stamps();
        let is_settled = failure.is_over || is_unchanged && !failure.error.is_transient();
        Some(if is_settled { FailureAction::Report } else { FailureAction::ReadAgain })
    }
}
