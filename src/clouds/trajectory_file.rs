//! Reading of frames, ahead of their use.

use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread::JoinHandle;
use std::time::SystemTime;

use super::bonds::bonds_of;
use super::error::{CloudError, CloudPart};
use crate::trajectory::{Snapshot, Trajectory, TrajectoryError};

/// A data file, with the frames in use.
#[derive(Debug)]
pub struct TrajectoryFile {
    trajectory: Trajectory,
    stamp: Option<OpenedStamp>,
    /// True if frames stay in memory after use, since other settings may be applied to them.
    is_kept: bool,
    frames: Mutex<HeldFrames>,
    bonds: Mutex<Vec<FrameBonds>>,
}

/// The bonds of a frame in use, as found with a distance.
#[derive(Debug)]
struct FrameBonds {
    frame: Weak<Snapshot>,
    distance: Option<f64>,
    pairs: Arc<Vec<[u32; 2]>>,
}

/// The length of a file, and the time of its last write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct OpenedStamp(u64, Option<SystemTime>);

#[derive(Debug, Default)]
struct HeldFrames {
    held: Vec<(usize, Arc<Snapshot>)>,
    /// The frame that is being read ahead.
    ahead: Option<(usize, JoinHandle<Result<Snapshot, TrajectoryError>>)>,
}

/// The number of frames that are held: those before and after a moment.
const HELD_FRAMES: usize = 2;

impl TrajectoryFile {
    /// Opens a file. With `is_kept`, the last frames stay in memory, so that other settings read no file.
    ///
    /// # Errors
    ///
    /// If it cannot be read, or has no frame.
    pub fn open(path: &Path, is_kept: bool) -> Result<Arc<Self>, TrajectoryError> {
        let stamp = stamp(path);
        let trajectory = Trajectory::open(path, None)?;
        Ok(Arc::new(Self { trajectory, stamp, is_kept, frames: Mutex::default(), bonds: Mutex::default() }))
    }

    /// Opens a file again that has changed. Of one that has only grown, the new part alone is searched for frames.
    ///
    /// # Errors
    ///
    /// If it cannot be read, or has no frame.
    pub fn opened_again(&self, path: &Path) -> Result<Arc<Self>, TrajectoryError> {
        let stamp = stamp(path);
        let trajectory = self.trajectory.opened_again()?;
        let is_kept = self.is_kept;
        Ok(Arc::new(Self { trajectory, stamp, is_kept, frames: Mutex::default(), bonds: Mutex::default() }))
    }

    /// Returns the file.
    #[must_use]
    pub fn trajectory(&self) -> &Trajectory {
        &self.trajectory
    }

    /// Returns whether the file at this path is still the one that was opened.
    #[must_use]
    pub fn is_current(&self, path: &Path) -> bool {
        self.stamp.is_some() && self.stamp == stamp(path)
    }

    /// Returns a frame, which is read unless it is held.
    ///
    /// # Errors
    ///
    /// If it cannot be read.
    pub fn frame(&self, index: usize) -> Result<Arc<Snapshot>, CloudError> {
        let ahead = {
            let mut frames = self.lock();
            if let Some(place) = frames.held.iter().position(|(held, _)| *held == index) {
                // The frame that was used least recently is the first.
                frames.held[place..].rotate_left(1);
                return Ok(Arc::clone(&frames.held[frames.held.len() - 1].1));
            }
            // A frame that was read ahead in vain is not needed soon.
            frames.ahead.take().filter(|(ahead, _)| *ahead == index)
        };
        // Nothing is locked while threads work: one that waits for others may take on work that needs the same file.
        let ahead = ahead.and_then(|(_, reader)| reader.join().ok());
        let read = ahead.unwrap_or_else(|| self.trajectory.read(index));
        let help = "correct the file, or choose other times in `frames`";
        let read = read.map_err(|error| CloudError::new(CloudPart::Source, error.to_string(), help))?;
        let snapshot = Arc::new(read);
        let mut frames = self.lock();
        if frames.held.len() == HELD_FRAMES {
            frames.held.remove(0);
        }
        frames.held.push((index, Arc::clone(&snapshot)));
        Ok(snapshot)
    }

    /// Returns the bonds of a frame. They are found once while it is in use.
    pub(super) fn bonds(
        &self,
        frame: &Arc<Snapshot>,
        distance: Option<f64>,
    ) -> Result<Arc<Vec<[u32; 2]>>, CloudError> {
        let all = || self.bonds.lock().unwrap_or_else(PoisonError::into_inner);
        let is_same =
            |known: &&FrameBonds| known.frame.as_ptr() == Arc::as_ptr(frame) && known.distance == distance;
        if let Some(known) = all().iter().find(is_same) {
            return Ok(Arc::clone(&known.pairs));
        }
        // Nothing is locked while threads work, as above.
        let pairs = Arc::new(bonds_of(frame, distance)?);
        let mut all = all();
        all.retain(|known| known.frame.strong_count() > 0);
        all.push(FrameBonds { frame: Arc::downgrade(frame), distance, pairs: Arc::clone(&pairs) });
        Ok(pairs)
    }

    fn lock(&self) -> MutexGuard<'_, HeldFrames> {
        self.frames.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Releases all frames except these, unless frames are kept.
    pub(super) fn release(&self, kept: &[usize]) {
        if !self.is_kept {
            self.lock().held.retain(|(index, _)| kept.contains(index));
        }
    }

    /// Starts to read a frame that will be needed.
    pub(super) fn read_ahead(self: &Arc<Self>, index: usize) {
        let mut frames = self.lock();
        let is_held = frames.held.iter().any(|(held, _)| *held == index);
        if index >= self.trajectory.frames() || is_held || frames.ahead.is_some() {
            return;
        }
        let file = Arc::clone(self);
        let read = move || {
            // A pool of its own: the threads of the common one may be waiting for this frame.
            match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
                Ok(pool) => pool.install(|| file.trajectory.read(index)),
                Err(_) => file.trajectory.read(index),
            }
        };
        frames.ahead = std::thread::Builder::new().spawn(read).ok().map(|reader| (index, reader));
    }
}

fn stamp(path: &Path) -> Option<OpenedStamp> {
    let metadata = std::fs::metadata(path).ok()?;
    Some(OpenedStamp(metadata.len(), metadata.modified().ok()))
}
