//! Rendering of timelines into movies.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::render::make_folder;
use super::{FrameRequest, SequenceError, SequenceFault, SequenceReport, render_encoded};
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
        let (movie, timeline, never) = (movie.as_ref(), self.timeline(), AtomicBool::new(false));
        movie_format(movie)?;
        make_folder(folder_of(movie))?;
        let count = timeline.frame_count();
        let mut writer = MovieWriter::create(movie, count, timeline.rate)?;
        let mut report = SequenceReport::default();
        for request in FrameRequest::frames(&FrameList::all(count), timeline) {
            let Some(film) = render_encoded(self, &request, &never, &mut |_| {})? else { break };
            report.collect_faults(self, &request);
            writer.add(film, &never)?;
            report.written += 1;
        }
        writer.finish(&never)?;
        SequenceFault::remove_passing(&mut report.faults, report.written);
        Ok(report)
    }
}
