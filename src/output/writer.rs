//! Encoding and writing of frames in parallel with rendering.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::frame_file;
use super::{FrameFormat, FramePixels, WriteError};
use crate::trace::FrameFingerprint;

/// A thread that writes one frame while the next is rendered. At most two films are queued.
#[derive(Debug)]
pub struct FrameWriter {
    /// The queue; `None` once no more frames will be submitted.
    jobs: Option<SyncSender<Job>>,
    written: Receiver<WrittenFrame>,
    thread: Option<JoinHandle<()>>,
}

/// The result of writing a frame.
#[derive(Debug)]
pub struct WrittenFrame {
    /// Number given to [`FrameWriter::submit`].
    pub ticket: usize,
    /// Time spent on encoding and writing.
    pub duration: Duration,
    /// Success, or the error that prevented the write.
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

    /// Submits a frame, and waits while too many are queued. If `frame` is given, the file contains its provenance.
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

    /// Waits until all films are written, and returns the frames not returned before.
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
            // A panic of the thread has already been reported.
            let _ = thread.join();
        }
    }
}

/// Writes queued films. While more films for the same folder are queued, only the bytes of a film are synced to the disk. Its name is
/// synced together with the name of the last one.
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
