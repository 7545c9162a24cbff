//! Movies: encodes frames into one file, with ffmpeg or as a looping animation.
//!
//! ```text
//! frames -> channel -> encoder thread -> animation encoder, or the input of ffmpeg -> partial file -> movie
//! ```
//!
//! The encoder runs on its own thread, so that the next frame is rendered in parallel, and so that a program that hangs can be cancelled.

use std::ffi::OsString;
use std::io::{self, BufWriter, Write};
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use super::movie_format::even;
use super::{
    FfmpegFormat, FrameFormat, LoopError, LoopFormat, LoopWriter, MovieFormat, PartialFile,
    UnknownMovieFormat, folder_of, read_frame, remove_leftovers,
};
use crate::time::FrameRate;
use crate::trace::EncodedFilm;

/// Time between two checks for cancellation and for the end of ffmpeg: short enough to be imperceptible, long enough to cost nothing.
const POLL_INTERVAL: Duration = Duration::from_millis(10);

/// An error of making a movie. No file is left.
#[derive(thiserror::Error)]
pub enum MovieError {
    /// The extension of the file name is not that of a movie.
    #[error("cannot make `{}`: {reason}", movie.display())]
    Format {
        /// The movie.
        movie: PathBuf,
        /// The valid extensions.
        reason: UnknownMovieFormat,
    },
    /// The folder of the movie does not exist.
    #[error(
        "`{}` cannot be written: there is no folder `{}`; create it first", movie.display(), folder_of(movie).display()
    )]
    NoFolder {
        /// The movie.
        movie: PathBuf,
    },
    /// The format requires ffmpeg, which cannot be started.
    #[error("`{}` is made by ffmpeg, which cannot be started: install it, or name a .gif or .apng", movie.display())]
    NoFfmpeg {
        /// The movie.
        movie: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// ffmpeg reported an error, or ended.
    #[error("ffmpeg could not make the movie: {0}")]
    Ffmpeg(String),
    /// ffmpeg has closed its input.
    #[error("ffmpeg takes no more frames")]
    Closed(#[source] io::Error),
    /// A frame file cannot be read.
    #[error("cannot read the frame `{}`: {reason}", frame.display())]
    Frame {
        /// The frame file.
        frame: PathBuf,
        /// The cause.
        reason: String,
    },
    /// A frame has another size than the first.
    #[error("the frames of a movie have one size, but one has {}x{} pixels, the first {}x{}", size.0, size.1, first.0, first.1)]
    Size {
        /// The size of the frame.
        size: (u32, u32),
        /// The size of the first frame.
        first: (u32, u32),
    },
    /// There are no frames.
    #[error("there are no frames for a movie")]
    Empty,
    /// The animation encoder reported an error.
    #[error("cannot write `{}`", movie.display())]
    Encoding {
        /// The movie.
        movie: PathBuf,
        /// The encoder's error.
        source: LoopError,
    },
    /// The file system reported an error.
    #[error("cannot write `{}`", movie.display())]
    File {
        /// The movie.
        movie: PathBuf,
        /// The system's error.
        source: io::Error,
    },
}

debug_as_message!(MovieError);

/// Checks that a movie can be made, before its frames are rendered: the format, the folder, and ffmpeg, if the format requires it. Removes
/// leftover files of killed processes from the folder.
///
/// # Errors
///
/// If the movie cannot be made.
pub fn check_movie(movie: &Path) -> Result<MovieFormat, MovieError> {
    let format = movie_format(movie)?;
    if !folder_of(movie).is_dir() {
        return Err(MovieError::NoFolder { movie: movie.to_owned() });
    }
    remove_leftovers(folder_of(movie));
    if let MovieFormat::Ffmpeg(_) = format {
        let mut version = Command::new("ffmpeg");
        version.arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        version.status().map_err(|source| MovieError::NoFfmpeg { movie: movie.to_owned(), source })?;
    }
    Ok(format)
}

/// Returns the format of a movie.
pub(crate) fn movie_format(movie: &Path) -> Result<MovieFormat, MovieError> {
    MovieFormat::of(movie).map_err(|reason| MovieError::Format { movie: movie.to_owned(), reason })
}

/// Makes a movie of frame files, shown at `rate`. Returns `false` if `cancelled` becomes true; no file is left then.
///
/// # Errors
///
/// If the movie cannot be made, or if a frame cannot be read.
pub fn write_movie(
    movie: &Path,
    frames: &[PathBuf],
    format: FrameFormat,
    rate: FrameRate,
    cancelled: &AtomicBool,
) -> Result<bool, MovieError> {
    let count = u32::try_from(frames.len()).unwrap_or(u32::MAX);
    let mut writer = MovieWriter::create(movie, count, rate)?;
    for frame in frames {
        let film =
            read_frame(frame, format).map_err(|reason| MovieError::Frame { frame: frame.clone(), reason })?;
        if !writer.add(film, cancelled)? {
            return Ok(false);
        }
    }
    writer.finish(cancelled)
}

/// A movie that is written frame by frame. The file is complete or absent: without [`finish`](Self::finish), none is left.
#[derive(Debug)]
pub struct MovieWriter {
    movie: PathBuf,
    format: MovieFormat,
    count: u32,
    rate: FrameRate,
    /// The encoder; `None` before the first frame, whose size it needs.
    encoder: Option<MovieEncoder>,
    // Dropped after the encoder, which writes the file.
    partial: PartialFile,
}

impl MovieWriter {
    /// Begins a movie of `count` frames in the format of the file's extension.
    ///
    /// # Errors
    ///
    /// As [`check_movie`], and if the file cannot be created.
    pub fn create(movie: &Path, count: u32, rate: FrameRate) -> Result<Self, MovieError> {
        let (format, movie) = (check_movie(movie)?, movie.to_owned());
        match PartialFile::create(folder_of(&movie)) {
            Ok(partial) => Ok(Self { movie, format, count, rate, encoder: None, partial }),
            Err(source) => Err(MovieError::File { movie, source }),
        }
    }

    /// Adds the next frame, which is encoded in parallel. Returns `false` if `cancelled` becomes true while the encoder is busy.
    ///
    /// # Errors
    ///
    /// If the frame differs in size from the first, or if the encoder fails.
    pub fn add(&mut self, film: EncodedFilm, cancelled: &AtomicBool) -> Result<bool, MovieError> {
        let size = (film.width(), film.height());
        let encoder = match &mut self.encoder {
            Some(encoder) => encoder,
            None => {
                let encoder = match self.format {
                    MovieFormat::Loop(format) => self.animation(format, size),
                    MovieFormat::Ffmpeg(format) => self.ffmpeg(format, size),
                };
                self.encoder.insert(encoder?)
            }
        };
        if size != encoder.size {
            return Err(MovieError::Size { size, first: encoder.size });
        }
        encoder.add(film, cancelled)
    }

    /// Finishes the movie and gives it its name. Returns `false` if `cancelled` becomes true; no file is left then.
    ///
    /// # Errors
    ///
    /// If there are no frames, if the encoder fails, or if the file system reports an error.
    pub fn finish(self, cancelled: &AtomicBool) -> Result<bool, MovieError> {
        let Self { movie, encoder, partial, .. } = self;
        let is_complete = encoder.ok_or(MovieError::Empty)?.finish(cancelled)?;
        if !is_complete {
            return Ok(false);
        }
        partial.place(&movie).map_err(|source| MovieError::File { movie, source })?;
        Ok(true)
    }

    fn file_error(&self, source: io::Error) -> MovieError {
        MovieError::File { movie: self.movie.clone(), source }
    }

    /// Starts the encoder of an animation.
    fn animation(&self, format: LoopFormat, size: (u32, u32)) -> Result<MovieEncoder, MovieError> {
        let out = self.partial.file().try_clone().map_err(|source| self.file_error(source))?;
        let (movie, count, rate) = (self.movie.clone(), self.count, self.rate);
        Ok(MovieEncoder::start(size, None, move |films| {
            let mut out = BufWriter::new(out);
            encode_animation(&mut out, format, size, count, rate, films)
                .map_err(|source| MovieError::Encoding { movie: movie.clone(), source })?;
            out.flush().map_err(|source| MovieError::File { movie, source })
        }))
    }

    /// Starts ffmpeg.
    fn ffmpeg(&self, format: FfmpegFormat, size: (u32, u32)) -> Result<MovieEncoder, MovieError> {
        let mut command = Command::new("ffmpeg");
        command.args(arguments(format, size, self.rate));
        // Without this prefix, ffmpeg would read a colon as the end of a protocol and a leading hyphen as an option.
        let mut target = OsString::from("file:");
        target.push(self.partial.lend().map_err(|source| self.file_error(source))?);
        command.arg(target).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        let child = command.spawn();
        let mut child = child.map_err(|source| MovieError::NoFfmpeg { movie: self.movie.clone(), source })?;
        let (input, errors) = (child.stdin.take(), child.stderr.take());
        let read = |errors| io::read_to_string(errors).unwrap_or_default();
        let messages = thread::spawn(move || errors.map(read).unwrap_or_default());
        let ffmpeg = Ffmpeg { child, messages: Some(messages) };
        Ok(MovieEncoder::start(size, Some(ffmpeg), move |mut films| {
            let Some(mut input) = input else { return Ok(()) };
            films.try_for_each(|film| input.write_all(film.bytes())).map_err(MovieError::Closed)
        }))
    }
}

/// A thread that encodes one frame while the next is rendered.
#[derive(Debug)]
struct MovieEncoder {
    size: (u32, u32),
    /// The queue; `None` once no more frames follow.
    films: Option<Sender<EncodedFilm>>,
    /// Receives a message whenever the thread is ready for a frame.
    ready: Receiver<()>,
    /// The thread; `None` once it has ended.
    thread: Option<JoinHandle<Result<(), MovieError>>>,
    ffmpeg: Option<Ffmpeg>,
}

impl MovieEncoder {
    fn start(
        size: (u32, u32),
        ffmpeg: Option<Ffmpeg>,
        encode: impl FnOnce(QueuedFilms) -> Result<(), MovieError> + Send + 'static,
    ) -> Self {
        let ((films, queued), (sender, ready)) = (channel(), channel());
        let thread = thread::spawn(move || encode(QueuedFilms { films: queued, ready: sender }));
        Self { size, films: Some(films), ready, thread: Some(thread), ffmpeg }
    }

    /// Submits a frame once the encoder is ready. Returns `false` on cancellation.
    fn add(&mut self, film: EncodedFilm, cancelled: &AtomicBool) -> Result<bool, MovieError> {
        loop {
            match self.ready.recv_timeout(POLL_INTERVAL) {
                Ok(()) => match self.films.as_ref().map(|films| films.send(film)) {
                    Some(Ok(())) => return Ok(true),
                    _ => break,
                },
                Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) if cancelled.load(Ordering::Relaxed) => return Ok(false),
                // ffmpeg may have ended while one of its children still has its input open, so that the thread waits.
                Err(RecvTimeoutError::Timeout) if self.has_failed()? => break,
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
        // The encoder has ended before its last frame.
        self.finish(cancelled)
    }

    /// Waits until the submitted frames are encoded. Returns `false` on cancellation.
    fn finish(&mut self, cancelled: &AtomicBool) -> Result<bool, MovieError> {
        self.films = None;
        loop {
            // Ctrl-C in a terminal also ends ffmpeg. Its end is noticed before the flag is read, so that such an end counts as cancellation.
            let is_done = self.thread.as_ref().is_none_or(JoinHandle::is_finished);
            let status = self.ffmpeg.as_mut().map(Ffmpeg::status).transpose()?;
            if cancelled.load(Ordering::Relaxed) {
                return Ok(false);
            }
            match (status, &mut self.ffmpeg) {
                (Some(Some(status)), Some(ffmpeg)) if !status.success() && ffmpeg.has_reported() => {
                    return Err(MovieError::Ffmpeg(ffmpeg.report(status)));
                }
                (Some(Some(status)), _) if is_done && status.success() => break,
                (None, _) if is_done => break,
                _ => thread::sleep(POLL_INTERVAL),
            }
        }
        let Some(thread) = self.thread.take() else { return Ok(true) };
        thread.join().unwrap_or_else(|panic| resume_unwind(panic)).map(|()| true)
    }

    /// Returns whether ffmpeg has failed.
    fn has_failed(&mut self) -> Result<bool, MovieError> {
        let status = self.ffmpeg.as_mut().map(Ffmpeg::status).transpose()?.flatten();
        Ok(status.is_some_and(|status| !status.success()))
    }
}

/// The frames for an encoder thread, which reports that it is ready before it waits for each.
struct QueuedFilms {
    films: Receiver<EncodedFilm>,
    ready: Sender<()>,
}

impl Iterator for QueuedFilms {
    type Item = EncodedFilm;

    fn next(&mut self) -> Option<EncodedFilm> {
        // Without a receiver, no frames follow.
        let _ = self.ready.send(());
        self.films.recv().ok()
    }
}

/// A running ffmpeg. It is killed unless it has ended.
#[derive(Debug)]
struct Ffmpeg {
    child: Child,
    /// Collects its error messages.
    messages: Option<JoinHandle<String>>,
}

impl Ffmpeg {
    /// Returns the exit status, or `None` while it runs.
    fn status(&mut self) -> Result<Option<ExitStatus>, MovieError> {
        self.child.try_wait().map_err(|error| MovieError::Ffmpeg(format!("cannot wait for it: {error}")))
    }

    /// Returns whether it has printed all its messages.
    fn has_reported(&self) -> bool {
        self.messages.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Returns its messages, or its exit status if there are none.
    fn report(&mut self, status: ExitStatus) -> String {
        let messages = self.messages.take().and_then(|messages| messages.join().ok()).unwrap_or_default();
        if messages.trim().is_empty() {
            format!("it ended with {status}")
        } else {
            messages.trim().to_owned()
        }
    }
}

impl Drop for Ffmpeg {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn encode_animation(
    out: impl Write,
    format: LoopFormat,
    size: (u32, u32),
    count: u32,
    rate: FrameRate,
    films: QueuedFilms,
) -> Result<(), LoopError> {
    let mut writer = LoopWriter::new(out, format, size, count, rate)?;
    for film in films {
        writer.add(&film)?;
    }
    writer.finish()
}

/// Returns ffmpeg's arguments before the output file. The input is sRGB; the output is BT.709 of limited range, as players expect. Odd
/// sides are made even by repeating the last column or row.
fn arguments(format: FfmpegFormat, (width, height): (u32, u32), rate: FrameRate) -> Vec<String> {
    let (frames, seconds) = rate.parts();
    let rate = format!("{frames}/{seconds}");
    let mut filter = String::new();
    let (even_width, even_height) = even((width, height));
    if (even_width, even_height) != (width, height) {
        let (right, bottom) = (even_width - width, even_height - height);
        filter +=
            &format!("pad={even_width}:{even_height},fillborders=right={right}:bottom={bottom}:mode=smear,");
    }
    filter += "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int,format=yuv420p";
    let size = format!("{width}x{height}");
    let input = [
        "-y",
        "-loglevel",
        "error",
        "-f",
        "rawvideo",
        "-pix_fmt",
        "rgb24",
        "-s",
        &size,
        "-r",
        &rate,
        "-i",
        "-",
    ];
    let tags = [
        "-colorspace",
        "bt709",
        "-color_primaries",
        "bt709",
        "-color_trc",
        "iec61966-2-1",
        "-color_range",
        "tv",
    ];
    let (filter, container) = (["-vf", &filter], ["-f", format.container()]);
    let all = input.iter().chain(&filter).chain(format.codec()).chain(&tags).chain(&container);
    all.map(|word| (*word).to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_sides_become_even() {
        let rate = FrameRate::new(24, 1).unwrap();
        let filter = |size| arguments(FfmpegFormat::Mp4, size, rate).join(" ");
        assert!(filter((3, 2)).contains("fillborders=right=1:bottom=0"));
        assert!(!filter((4, 2)).contains("pad="));
    }
}
