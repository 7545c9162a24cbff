//! `rayreel render --movie`: one file of all frames, once they are there.

use std::ffi::OsString;
use std::io::{self, BufWriter, Write};
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use anyhow::{Context, anyhow, bail, ensure};

use rayreel::output::{LoopFormat, LoopWriter, PartialFile, folder_of, read_frame, remove_leftovers};
use rayreel::time::FrameRate;
use rayreel::trace::EncodedFilm;

use super::interrupt::{POLL_INTERVAL, unless_cancelled};
use super::settings::RenderSettings;

/// Who makes a movie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Maker {
    Loop(LoopFormat),
    Ffmpeg {
        /// The format of the file, by ffmpeg's name.
        container: &'static str,
        /// Arguments for the codec.
        codec: &'static [&'static str],
    },
}

/// As good as one sees, in a file that plays everywhere and while it is still being loaded.
const H264: &[&str] = &["-c:v", "libx264", "-crf", "17", "-movflags", "+faststart"];
const VP9: &[&str] = &["-c:v", "libvpx-vp9", "-crf", "20", "-b:v", "0"];

impl Maker {
    /// Returns who makes a file of this name.
    pub(super) fn of(movie: &Path) -> Result<Self, String> {
        let ending = movie.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        match ending.to_ascii_lowercase().as_str() {
            "gif" => Ok(Self::Loop(LoopFormat::Gif)),
            "apng" => Ok(Self::Loop(LoopFormat::Apng)),
            "mp4" => Ok(Self::Ffmpeg { container: "mp4", codec: H264 }),
            "mov" => Ok(Self::Ffmpeg { container: "mov", codec: H264 }),
            "mkv" => Ok(Self::Ffmpeg { container: "matroska", codec: H264 }),
            "webm" => Ok(Self::Ffmpeg { container: "webm", codec: VP9 }),
            _ => {
                Err("a movie ends in .mp4, .mov, .mkv or .webm, made by ffmpeg, or in .gif or .apng"
                    .to_owned())
            }
        }
    }
}

/// Returns an error if a movie cannot be made here, before anything is rendered for it. Removes what killed processes left in its folder.
pub(super) fn ensure_possible(movie: &Path) -> anyhow::Result<()> {
    let maker = Maker::of(movie).map_err(|message| anyhow!(message))?;
    let folder = folder_of(movie);
    ensure!(
        folder.is_dir(),
        "`{}` cannot be written: there is no folder `{}`; create it first",
        movie.display(),
        folder.display()
    );
    remove_leftovers(folder);
    if matches!(maker, Maker::Ffmpeg { .. }) {
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

/// Returns the rate at which frames of a timeline play as fast as the timeline: frames that are equally far apart last as long as
/// their distance.
fn played(rate: FrameRate, frames: impl Iterator<Item = u32>) -> FrameRate {
    let frames: Vec<u32> = frames.collect();
    let mut steps = frames.windows(2).map(|pair| pair[1] - pair[0]);
    let step = steps.next().filter(|step| steps.all(|other| other == *step)).unwrap_or(1);
    let (numerator, denominator) = rate.parts();
    FrameRate::new(numerator, denominator.saturating_mul(step)).unwrap_or(rate)
}

/// Makes a movie of the frames, which are all there. Returns `false` after cancellation; then nothing is left of it.
pub(super) fn make(
    movie: &Path,
    settings: &RenderSettings,
    rate: FrameRate,
    cancelled: &AtomicBool,
) -> anyhow::Result<bool> {
    let maker = Maker::of(movie).map_err(|message| anyhow!(message))?;
    let rate = played(rate, settings.ascending().filter_map(|shot| shot.frame));
    let (format, unwritable) = (settings.sequence.format(), format!("cannot write `{}`", movie.display()));
    let files: Vec<PathBuf> = settings.ascending().map(|shot| shot.file(&settings.sequence)).collect();
    let count = u32::try_from(files.len()).context("there are too many frames")?;
    let read = move |file: &PathBuf| {
        read_frame(file, format)
            .map_err(|reason| anyhow!("cannot read the frame `{}`: {reason}", file.display()))
    };
    let Some(first) = files.first().map(read).transpose()? else { bail!("there are no frames for a movie") };
    let frames = files.into_iter().map(move |file| read(&file));
    let partial = PartialFile::create(folder_of(movie)).with_context(|| unwritable.clone())?;
    let is_whole = match maker {
        Maker::Loop(format) => {
            let size = (first.width(), first.height());
            let file = partial.file().try_clone().with_context(|| unwritable.clone())?;
            let context = unwritable.clone();
            let encoded = unless_cancelled(cancelled, move || -> anyhow::Result<()> {
                let mut out = BufWriter::new(file);
                let mut writer = LoopWriter::new(&mut out, format, size, (count, rate))?;
                for film in frames {
                    writer.add(&film?).with_context(|| context.clone())?;
                }
                writer.finish().with_context(|| context.clone())?;
                out.flush().context(context)
            });
            encoded.transpose()?.is_some()
        }
        Maker::Ffmpeg { container, codec } => {
            let mut command = Command::new("ffmpeg");
            command.args(arguments(codec, &first, rate)).args(["-f", container]);
            // Otherwise a colon would end the name of a protocol, and a hyphen begin an option.
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
    if is_whole {
        partial.place(movie).context(unwritable)?;
    }
    Ok(is_whole)
}

/// Returns ffmpeg's arguments before the file: sRGB in, BT.709 of limited range out, as players expect it, and even sides, for which a
/// last row or column is repeated.
fn arguments(codec: &[&str], first: &EncodedFilm, rate: FrameRate) -> Vec<String> {
    let (frames, seconds) = rate.parts();
    let size = format!("{}x{}", first.width(), first.height());
    let rate = format!("{frames}/{seconds}");
    let mut filter = String::new();
    let odd = [first.width() % 2, first.height() % 2];
    if odd != [0, 0] {
        filter += "pad=ceil(iw/2)*2:ceil(ih/2)*2,";
        filter += &format!("fillborders=right={}:bottom={}:mode=smear,", odd[0], odd[1]);
    }
    filter += "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int,format=yuv420p";
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

/// Lets ffmpeg encode frames. Returns `false` after cancellation, which ends ffmpeg.
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
        // Ctrl-C in a terminal ends ffmpeg, too, so that its end is looked at first.
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
        let told = listener.join().ok().flatten().and_then(Result::ok).unwrap_or_default();
        let reason =
            if told.trim().is_empty() { format!("it ended with {status}") } else { told.trim().to_owned() };
        bail!("ffmpeg could not make the movie: {reason}");
    }
    feeder.join().unwrap_or_else(|panic| resume_unwind(panic))?;
    Ok(true)
}

/// Gives frames to ffmpeg.
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
    use super::*;

    #[test]
    fn endings_tell_who_makes_a_movie() {
        assert_eq!(Maker::of(Path::new("a.GIF")), Ok(Maker::Loop(LoopFormat::Gif)));
        assert_eq!(Maker::of(Path::new("a.b.webm")), Ok(Maker::Ffmpeg { container: "webm", codec: VP9 }));
        assert!(Maker::of(Path::new("mp4")).is_err());
    }

    #[test]
    fn movies_of_every_nth_frame_last_as_long_as_their_timeline() {
        let rate = FrameRate::new(60, 1).unwrap();
        assert_eq!(played(rate, (0..60).step_by(4)).parts(), (60, 4));
        assert_eq!(played(rate, 7..9).parts(), (60, 1));
        assert_eq!(played(rate, [0, 1, 5].into_iter()).parts(), (60, 1));
        assert_eq!(played(rate, [3].into_iter()).parts(), (60, 1));
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
