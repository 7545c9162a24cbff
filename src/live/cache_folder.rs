//! Finished frames in a folder, with the names and the fingerprints that `render` gives them.
//!
//! Files are read on the session's thread, which would otherwise trace their frames, and written on another thread. A file counts only if
//! it is complete and its fingerprint is that of the frame. Frames of other scenes and settings are replaced, as `render` replaces them;
//! files that are no frames, or damaged, stay.

use std::collections::HashMap;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

use crate::output::{self, FoundFrame, FrameFormat, PictureFile, Sequence, remove_leftovers};
use crate::trace::FrameFingerprint;

/// Maximum number of pictures that wait to be written. A film of simple pictures is finished faster than a slow disk takes it; the session
/// then waits for it.
const MAX_QUEUED: usize = 32;

/// The folder, and the thread that writes into it.
#[derive(Debug)]
pub(super) struct CacheFolder {
    folder: PathBuf,
    /// Name of the scene, which begins the names of the files.
    name: OsString,
    /// The frames whose files are known to have these fingerprints, or are on their way.
    stored: HashMap<u32, FrameFingerprint>,
    /// The queue of the thread; `None` if the folder cannot be made.
    jobs: Option<SyncSender<StoreJob>>,
    thread: Option<JoinHandle<()>>,
}

/// A picture to be written.
#[derive(Debug)]
struct StoreJob {
    path: PathBuf,
    png: Arc<[u8]>,
    size: (u32, u32),
    fingerprint: FrameFingerprint,
}

impl CacheFolder {
    /// Opens the folder of a scene's frames, which is made if it does not exist. The first error of the folder or of a file is passed to
    /// `fail`, after which no more files are written.
    pub(super) fn open(folder: PathBuf, scene: &Path, fail: impl FnOnce(String) + Send + 'static) -> Self {
        let name = scene.file_stem().unwrap_or("frame".as_ref()).to_owned();
        let (jobs, thread) = match fs::create_dir_all(&folder) {
            Ok(()) => {
                remove_leftovers(&folder);
                let (jobs, received) = sync_channel(MAX_QUEUED);
                (Some(jobs), Some(thread::spawn(move || store_all(&received, fail))))
            }
            Err(error) => {
                fail(format!("cannot make the folder `{}`: {error}", folder.display()));
                (None, None)
            }
        };
        Self { folder, name, stored: HashMap::new(), jobs, thread }
    }

    /// Returns the path of a frame of a timeline with `frames` frames.
    fn path(&self, frame: u32, frames: u32) -> PathBuf {
        let (folder, last) = (self.folder.clone(), frames.saturating_sub(1));
        Sequence::new(folder, self.name.clone(), last, FrameFormat::default()).frame(frame)
    }

    /// Returns whether a frame has a file, of any fingerprint.
    pub(super) fn has_file(&self, frame: u32, frames: u32) -> bool {
        self.path(frame, frames).is_file()
    }

    /// Returns the file of a frame, if it has this fingerprint.
    pub(super) fn read(
        &mut self,
        frame: u32,
        frames: u32,
        size: (u32, u32),
        fingerprint: FrameFingerprint,
    ) -> Option<Arc<[u8]>> {
        let path = self.path(frame, frames);
        let png = output::read_complete(&path, FrameFormat::default(), size, fingerprint)?;
        self.stored.insert(frame, fingerprint);
        Some(png.into())
    }

    /// Writes the picture of a frame, unless its file has this fingerprint.
    pub(super) fn write(
        &mut self,
        frame: u32,
        frames: u32,
        (png, size): (Arc<[u8]>, (u32, u32)),
        fingerprint: FrameFingerprint,
    ) {
        if self.stored.insert(frame, fingerprint) == Some(fingerprint) {
            return;
        }
        let job = StoreJob { path: self.path(frame, frames), png, size, fingerprint };
        if let Some(jobs) = &self.jobs {
            // The thread has ended after an error.
            let _ = jobs.send(job);
        }
    }
}

impl Drop for CacheFolder {
    /// Waits until all pictures are written.
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has already been reported.
            let _ = thread.join();
        }
    }
}

/// Writes pictures until there are no more, or a file cannot be written.
fn store_all(jobs: &Receiver<StoreJob>, fail: impl FnOnce(String)) {
    for StoreJob { path, png, size, fingerprint } in jobs {
        if !is_replaceable(&path, size, fingerprint) {
            continue;
        }
        let Some(film) = output::decode_png(&png) else { continue };
        if let Err(error) = output::write_frame(&path, film, FrameFormat::default(), fingerprint) {
            let cause =
                std::error::Error::source(&error).map_or_else(String::new, |cause| format!(": {cause}"));
            return fail(format!("{error}{cause}"));
        }
    }
}

/// Returns whether a file is missing, or a frame with another fingerprint.
fn is_replaceable(path: &Path, size: (u32, u32), fingerprint: FrameFingerprint) -> bool {
    let at = |size| FoundFrame::expected_at(path, FrameFormat::default(), size);
    let found = match at(size) {
        FoundFrame::OtherSize { size: (width, height) }
            if u64::from(width) * u64::from(height) <= PictureFile::LARGEST_AREA =>
        {
            at((width, height))
        }
        found => found,
    };
    match found {
        FoundFrame::Missing => true,
        FoundFrame::Complete { fingerprint: found, .. } => found != fingerprint,
        FoundFrame::Corrupt(_) | FoundFrame::Unknown { .. } | FoundFrame::OtherSize { .. } => false,
    }
}
