//! Encodes and writes frames while others are rendered.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::frame_file;
use super::{FrameFormat, FramePixels, WriteError};
use crate::trace::FrameFingerprint;

/// A thread that writes one frame while the next is rendered. At most two films wait.
#[derive(Debug)]
pub struct FrameWriter {
    /// The queue; `None` once the writer is told that no more will come.
    jobs: Option<SyncSender<Job>>,
    written: Receiver<WrittenFrame>,
    thread: Option<JoinHandle<()>>,
}

/// A frame that the writer has finished with.
#[derive(Debug)]
pub struct WrittenFrame {
    /// The number given to [`FrameWriter::submit`].
    pub ticket: usize,
    /// The time spent on encoding and writing.
    pub duration: Duration,
    /// Whether the file is there now.
    pub result: Result<(), WriteError>,
}

#[derive(Debug)]
struct Job {
    ticket: usize,
    path: PathBuf,
    pixels: FramePixels,
    format: FrameFormat,
    frame: Option<FrameFingerprint>,
}

impl FrameWriter {
    /// Starts the thread.
    #[must_use]
    pub fn start() -> Self {
        let (jobs, received) = sync_channel(1);
        let (done, written) = channel();
        let thread = std::thread::spawn(move || run(&received, &done));
        Self { jobs: Some(jobs), written, thread: Some(thread) }
    }

    /// Submits a frame, and what identifies the picture, if it is to say so in its file; waits while too many are queued.
    pub fn submit(
        &self,
        ticket: usize,
        path: PathBuf,
        pixels: impl Into<FramePixels>,
        format: FrameFormat,
        frame: Option<FrameFingerprint>,
    ) {
        if let Some(jobs) = &self.jobs {
            // The thread ends only after the sender is dropped.
            let _ = jobs.send(Job { ticket, path, pixels: pixels.into(), format, frame });
        }
    }

    /// Returns the frames finished since the last call.
    pub fn written(&self) -> impl Iterator<Item = WrittenFrame> {
        self.written.try_iter()
    }

    /// Waits for all films to be written, and returns the frames not yet returned.
    #[must_use]
    pub fn finish(mut self) -> Vec<WrittenFrame> {
        self.jobs = None;
        self.written.iter().collect()
    }
}

impl Drop for FrameWriter {
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            // A panic there has been reported there.
            let _ = thread.join();
        }
    }
}

/// Writes films as they come; while more wait, only their bytes are brought to the disk, and their names together with the last
/// one's.
fn run(jobs: &Receiver<Job>, done: &Sender<WrittenFrame>) {
    let mut next = jobs.recv().ok();
    while let Some(Job { ticket, path, pixels, format, frame }) = next {
        let start = Instant::now();
        let put = frame_file::put(&path, &pixels, format, frame);
        next = jobs.try_recv().ok();
        let goes_on = next.as_ref().is_some_and(|job| job.path.parent() == path.parent());
        let result = if goes_on { put } else { put.and(frame_file::settle(&path)) };
        if done.send(WrittenFrame { ticket, duration: start.elapsed(), result }).is_err() {
            return;
        }
        next = next.or_else(|| jobs.recv().ok());
    }
}
