//! `rayreel render --movie`: encodes the finished frames into one file.

use std::ffi::OsString;
use std::io::{self, BufWriter, Write};
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use anyhow::{Context, anyhow, bail, ensure};

use rayreel::output::{
    FrameFormat, LoopFormat, LoopWriter, PartialFile, folder_of, gif_delays, read_frame, remove_leftovers,
};
use rayreel::time::{FrameRate, Timeline};
use rayreel::trace::EncodedFilm;

use super::interrupt::{POLL_INTERVAL, unless_cancelled};
use super::movie_format::MovieFormat;
use super::settings::OutputSettings;

/// Returns an error, before anything is rendered, if the movie cannot be made. Removes leftover files of killed processes from its folder.
pub(super) fn ensure_possible(movie: &Path) -> anyhow::Result<()> {
    let format = MovieFormat::of(movie).map_err(|message| anyhow!(message))?;
    let folder = folder_of(movie);
    ensure!(
        folder.is_dir(),
        "`{}` cannot be written: there is no folder `{}`; create it first",
        movie.display(),
        folder.display()
    );
    remove_leftovers(folder);
    if matches!(format, MovieFormat::Ffmpeg { .. }) {
        let mut version = Command::new("ffmpeg");
        version.arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        version.status().with_context(|| {
            format!(
                "`{}` is made by ffmpeg, which cannot be started: install it, or name a .gif or .apng",
                movie.display()
            )
        })?;
    }
    Ok(())
}

/// Returns the distance between consecutive frames, or `None` if it varies.
fn step(frames: &[u32]) -> Option<u32> {
    let mut steps = frames.windows(2).map(|pair| pair[1] - pair[0]);
    let step = steps.next().unwrap_or(1);
    steps.all(|other| other == step).then_some(step)
}

/// Returns the rate at which the given frames play at the speed of their timeline: equally spaced frames last as long as their distance.
/// Unevenly spaced frames play at `rate`.
fn played(rate: FrameRate, frames: &[u32]) -> FrameRate {
    let (numerator, denominator) = rate.parts();
    FrameRate::new(numerator, denominator.saturating_mul(step(frames).unwrap_or(1))).unwrap_or(rate)
}

/// Differences between a movie and its timeline or frames.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Remarks {
    pub(super) warnings: Vec<String>,
    pub(super) notes: Vec<String>,
}

impl Remarks {
    /// Collects the remarks on a movie of frames of this size.
    pub(super) fn new(
        movie: &Path,
        size: (u32, u32),
        timeline: Timeline,
        frames: impl Iterator<Item = u32>,
    ) -> Self {
        let frames: Vec<u32> = frames.collect();
        let mut remarks = Self::default();
        match MovieFormat::of(movie) {
            Ok(MovieFormat::Loop(LoopFormat::Gif)) => {
                let count = u32::try_from(frames.len()).unwrap_or(u32::MAX);
                let delays = gif_delays(played(timeline.rate, &frames), count);
                let omitted = delays.iter().filter(|delay| **delay == 0).count();
                if omitted > 0 {
                    remarks.warnings.push(format!(
                        "a GIF plays at most 50 frames per second: {omitted} of {count} frames are omitted; .apng and .mp4 keep all frames"
                    ));
                }
            }
            Ok(MovieFormat::Ffmpeg { .. }) if size != even(size) => {
                let (width, height) = even(size);
                remarks.notes.push(format!(
                    "the movie is {width}x{height}, not {}x{}: its pixel format requires even sides, so the last column or row is repeated",
                    size.0, size.1
                ));
            }
            _ => {}
        }
        remarks.notes.extend(Self::of_steps(timeline, &frames));
        remarks
    }

    /// Returns a remark if the frames are unevenly spaced or if the movie ends after the timeline.
    fn of_steps(timeline: Timeline, frames: &[u32]) -> Option<String> {
        let seconds = |frames: u32| (timeline.time_of(frames).seconds() * 1e3).round() / 1e3;
        let (count, last) = (timeline.frame_count(), *frames.last()?);
        let Some(step) = step(frames) else {
            return Some(format!(
                "the frames of the movie are unevenly spaced, and each is shown for {} s; to keep the speed of the timeline, give --frames one range with one stride",
                seconds(1)
            ));
        };
        let beyond = last.saturating_add(step).saturating_sub(count);
        (beyond > 0).then(|| {
            format!(
                "the movie ends {} s after the timeline: with a stride of {step}, its last frame is shown beyond the end",
                seconds(beyond)
            )
        })
    }
}

/// Rounds both sides up to even numbers.
fn even((width, height): (u32, u32)) -> (u32, u32) {
    (width.next_multiple_of(2), height.next_multiple_of(2))
}

/// Makes a movie of the frames, which must all be rendered. Returns `false` on cancellation; no file is left then.
pub(super) fn make(
    movie: &Path,
    settings: &OutputSettings,
    rate: FrameRate,
    cancelled: &AtomicBool,
) -> anyhow::Result<bool> {
    let frames: Vec<u32> = settings.ascending().filter_map(|request| request.frame).collect();
    let files = settings.ascending().map(|request| request.file(&settings.sequence)).collect();
    make_of(movie, files, settings.sequence.format(), played(rate, &frames), cancelled)
}

/// Makes a movie of these files. Returns `false` on cancellation; no file is left then.
pub(super) fn make_of(
    movie: &Path,
    files: Vec<PathBuf>,
    format: FrameFormat,
    rate: FrameRate,
    cancelled: &AtomicBool,
) -> anyhow::Result<bool> {
    let movie_format = MovieFormat::of(movie).map_err(|message| anyhow!(message))?;
    let unwritable = format!("cannot write `{}`", movie.display());
    let count = u32::try_from(files.len()).context("there are too many frames")?;
    let read = move |file: &PathBuf| {
        read_frame(file, format)
            .map_err(|reason| anyhow!("cannot read the frame `{}`: {reason}", file.display()))
    };
    let Some(first) = files.first().map(read).transpose()? else { bail!("there are no frames for a movie") };
    let frames = files.into_iter().map(move |file| read(&file));
    let partial = PartialFile::create(folder_of(movie)).with_context(|| unwritable.clone())?;
    let is_complete = match movie_format {
        MovieFormat::Loop(format) => {
            let size = (first.width(), first.height());
            let file = partial.file().try_clone().with_context(|| unwritable.clone())?;
            let context = unwritable.clone();
            let encoded = unless_cancelled(cancelled, move || -> anyhow::Result<()> {
                let mut out = BufWriter::new(file);
                let mut writer = LoopWriter::new(&mut out, format, size, count, rate)?;
                for film in frames {
                    writer.add(&film?).with_context(|| context.clone())?;
                }
                writer.finish().with_context(|| context.clone())?;
                out.flush().context(context)
            });
            encoded.transpose()?.is_some()
        }
        MovieFormat::Ffmpeg { container, codec } => {
            let mut command = Command::new("ffmpeg");
            command.args(arguments(codec, &first, rate)).args(["-f", container]);
            // Without this prefix, ffmpeg would read a colon as the end of a protocol and a leading hyphen as an option.
            let mut target = OsString::from("file:");
            target.push(partial.lend().with_context(|| unwritable.clone())?);
            command.arg(target).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
            let child = command.spawn().with_context(|| {
                format!(
                    "`{}` is made by ffmpeg, which cannot be started; the frames are there: install it and run the same command again",
                    movie.display()
                )
            })?;
            encode(child, frames, cancelled)?
        }
    };
    if is_complete {
        partial.place(movie).context(unwritable)?;
    }
    Ok(is_complete)
}

/// Returns ffmpeg's arguments before the output file. The input is sRGB; the output is BT.709 of limited range, as players expect. Odd
/// sides are made even by repeating the last column or row.
fn arguments(codec: &[&str], first: &EncodedFilm, rate: FrameRate) -> Vec<String> {
    let (frames, seconds) = rate.parts();
    let rate = format!("{frames}/{seconds}");
    let mut filter = String::new();
    let (width, height) = (first.width(), first.height());
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
    let filter = ["-vf", &filter];
    let all = input.iter().chain(&filter).chain(codec).chain(&tags);
    all.map(|word| (*word).to_owned()).collect()
}

/// Encodes frames with ffmpeg. Returns `false` on cancellation, which kills ffmpeg.
fn encode(
    mut child: Child,
    frames: impl Iterator<Item = anyhow::Result<EncodedFilm>> + Send + 'static,
    cancelled: &AtomicBool,
) -> anyhow::Result<bool> {
    let (input, errors) = (child.stdin.take(), child.stderr.take());
    let feeder = thread::spawn(move || feed(input, frames));
    let listener = thread::spawn(move || errors.map(io::read_to_string));
    let status = loop {
        let ended = child.try_wait().context("cannot wait for ffmpeg")?;
        // Ctrl-C in a terminal also ends ffmpeg. The exit status is read before the flag, so that such an exit counts as cancellation.
        if cancelled.load(Ordering::Relaxed) {
            let _ = child.kill();
            let _ = child.wait();
            return Ok(false);
        }
        match ended {
            Some(status) if listener.is_finished() && (feeder.is_finished() || !status.success()) => {
                break status;
            }
            _ => thread::sleep(POLL_INTERVAL),
        }
    };
    if !status.success() {
        let text = listener.join().ok().flatten().and_then(Result::ok).unwrap_or_default();
        let reason =
            if text.trim().is_empty() { format!("it ended with {status}") } else { text.trim().to_owned() };
        bail!("ffmpeg could not make the movie: {reason}");
    }
    feeder.join().unwrap_or_else(|panic| resume_unwind(panic))?;
    Ok(true)
}

/// Writes frames to the standard input of ffmpeg.
fn feed(
    input: Option<ChildStdin>,
    frames: impl Iterator<Item = anyhow::Result<EncodedFilm>>,
) -> anyhow::Result<()> {
    let mut input = input.context("ffmpeg has no input")?;
    for film in frames {
        input.write_all(film?.bytes()).context("ffmpeg takes no more frames")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use rayreel::time::FrameList;

    use super::super::movie_format::H264;
    use super::*;

    #[test]
    fn movies_of_every_nth_frame_last_as_long_as_their_timeline() {
        let rate = FrameRate::new(60, 1).unwrap();
        let every_fourth: Vec<u32> = (0..60).step_by(4).collect();
        assert_eq!(played(rate, &every_fourth).parts(), (60, 4));
        assert_eq!(played(rate, &[7, 8]).parts(), (60, 1));
        assert_eq!(played(rate, &[0, 1, 5]).parts(), (60, 1));
        assert_eq!(played(rate, &[3]).parts(), (60, 1));
    }

    #[test]
    fn remarks_cover_omitted_frames_odd_sizes_and_uneven_steps() {
        let remarks = |movie: &str, size, per_second, frames: &str| {
            let rate = FrameRate::new(per_second, 1).unwrap();
            let timeline = Timeline { rate, duration: 1.0 };
            let frames: FrameList = frames.parse().unwrap();
            let frames = frames.within(timeline.frame_count());
            let Remarks { warnings, notes } = Remarks::new(Path::new(movie), size, timeline, frames.frames());
            [warnings.join("; "), notes.join("; ")]
        };
        let nothing = [String::new(), String::new()];
        for movie in ["a.gif", "a.apng", "a.mp4", "a.webm"] {
            assert_eq!(remarks(movie, (32, 18), 50, "0-"), nothing);
            assert_eq!(remarks(movie, (32, 18), 60, "0-x2"), nothing);
            assert_eq!(remarks(movie, (32, 18), 24, "5"), nothing);
            // The movie does not reach the end of the timeline.
            assert_eq!(remarks(movie, (32, 18), 24, "1-10x4"), nothing);
            assert!(remarks(movie, (32, 18), 10, "0-x3")[1].starts_with("the movie ends 0.2 s after"));
            assert!(remarks(movie, (32, 18), 10, "0-x3")[1].contains("with a stride of 3"));
            let unequal = &remarks(movie, (32, 18), 10, "0-6x3,7")[1];
            assert!(unequal.contains("unevenly spaced, and each is shown for 0.1 s"), "{unequal}");
        }
        for (movie, warns, notes) in [
            ("a.gif", true, false),
            ("a.apng", false, false),
            ("a.mp4", false, true),
            ("a.webm", false, true),
        ] {
            let [warning, _] = remarks(movie, (32, 18), 60, "0-");
            assert_eq!(warning.contains("20 of 60 frames are omitted"), warns, "{movie}: {warning}");
            for (odd, even) in [((31, 18), "32x18"), ((32, 17), "32x18"), ((1, 1), "2x2")] {
                let [_, note] = remarks(movie, odd, 24, "0-");
                assert_eq!(note.contains(even), notes, "{movie}: {note}");
            }
        }
    }

    #[test]
    fn odd_sides_become_even() {
        let rate = FrameRate::new(24, 1).unwrap();
        let filter = |width, height| {
            let film =
                EncodedFilm::from_bytes(width, height, &vec![0; (3 * width * height) as usize]).unwrap();
            arguments(H264, &film, rate).join(" ")
        };
        assert!(filter(3, 2).contains("fillborders=right=1:bottom=0"));
        assert!(!filter(4, 2).contains("pad="));
    }
}
