//! Rendering of timelines into movies.

use std::ops::ControlFlow::{self, Continue};
use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::render::make_folder;
use super::{
    FormerFrame, FrameRequest, SequenceError, SequenceFault, SequenceProgress, SequenceReport, render_encoded,
};
use crate::engine::Engine;
use crate::output::{MovieWriter, folder_of, movie_format};
use crate::time::FrameList;

impl Engine {
    /// Renders all frames of the timeline into a movie, without frame files. The extension selects the format: `.gif` or `.apng`, or `.mp4`,
    /// `.mov`, `.mkv` or `.webm`, for which the program ffmpeg must be installed. The folder is created if it does not exist. An existing
    /// file is replaced once the movie is complete.
    ///
    /// A GIF has 256 colours and at most 50 frames per second; further frames are omitted. The sides of movies by ffmpeg are even; the last
    /// column or row of an odd side is repeated.
    ///
    /// [`render_to`](Engine::render_to) keeps the frames, so that an interrupted sequence can be continued, and
    /// [`write_movie`](crate::output::write_movie) makes a movie of them.
    ///
    /// ```no_run
    /// use rayreel::Engine;
    ///
    /// Engine::load("scenes/first_light.ron")?.render_movie("out/first_light.mp4")?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`]; if the extension is not that of a movie; if ffmpeg is needed and cannot be started, or fails; if frames
    /// differ in size; and if the file system reports an error. No incomplete file is left.
    pub fn render_movie(&mut self, movie: impl AsRef<Path>) -> Result<SequenceReport, SequenceError> {
        let all = FrameList::all(self.timeline.frame_count());
        render_movie_until(self, &all, movie.as_ref(), &AtomicBool::new(false), |_| Continue(()))
    }
}

/// Renders frames into a movie like [`Engine::render_movie`], until `cancelled` becomes true or `on_progress`, after a frame,
/// breaks. Then no file is left, and the report counts no frame.
///
/// # Errors
///
/// As [`Engine::render_movie`].
pub fn render_movie_until(
    engine: &mut Engine,
    frames: &FrameList,
    movie: &Path,
    cancelled: &AtomicBool,
    mut on_progress: impl FnMut(SequenceProgress) -> ControlFlow<()>,
) -> Result<SequenceReport, SequenceError> {
    movie_format(movie)?;
    make_folder(folder_of(movie))?;
    let timeline = engine.timeline;
    let frames = frames.within(timeline.frame_count());
    let total = frames.count();
    let mut writer = MovieWriter::create(movie, u32::try_from(total).unwrap_or(u32::MAX), timeline.rate)?;
    let (mut report, mut former) = (SequenceReport::default(), FormerFrame::default());
    for request in FrameRequest::frames(&frames, timeline) {
        let film = render_encoded(engine, &request, &mut former, cancelled, &mut |_| {})?;
        let Some(film) = film else { return Ok(SequenceReport::default()) };
        report.collect_faults(engine, &request);
        if !writer.add(film, cancelled)? {
            return Ok(SequenceReport::default());
        }
        report.written += 1;
        let frame = request.frame.unwrap_or_default();
        if on_progress(SequenceProgress { frame, kept: false, done: report.written, total }).is_break() {
            return Ok(SequenceReport::default());
        }
    }
    if !writer.finish(cancelled)? {
        return Ok(SequenceReport::default());
    }
    SequenceFault::remove_passing(&mut report.faults, report.written);
    Ok(report)
}
