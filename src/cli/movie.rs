//! `rayreel render --movie`: one file of all frames, once they are there.

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use anyhow::{Context, anyhow, bail, ensure};

use rayreel::output::{LoopFormat, LoopWriter, folder_of, read_frame, write_bytes};
use rayreel::time::FrameRate;
use rayreel::trace::EncodedFilm;

use super::settings::RenderSettings;

/// Who makes a movie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Maker {
    Loop(LoopFormat),
    /// With these arguments for the codec.
    Ffmpeg(&'static [&'static str]),
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
            "mp4" | "mov" | "mkv" => Ok(Self::Ffmpeg(H264)),
            "webm" => Ok(Self::Ffmpeg(VP9)),
            _ => {
                Err("a movie ends in .mp4, .mov, .mkv or .webm, made by ffmpeg, or in .gif or .apng"
                    .to_owned())
            }
        }
    }
}

/// Returns an error if a movie cannot be made here, before anything is rendered for it.
pub(super) fn ensure_possible(movie: &Path) -> anyhow::Result<()> {
    let maker = Maker::of(movie).map_err(|message| anyhow!(message))?;
    let folder = folder_of(movie);
    ensure!(
        folder.is_dir(),
        "`{}` cannot be written: there is no folder `{}`; create it first",
        movie.display(),
        folder.display()
    );
    if matches!(maker, Maker::Ffmpeg(_)) {
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

/// Makes a movie of the frames, which are all there.
pub(super) fn make(movie: &Path, settings: &RenderSettings, rate: FrameRate) -> anyhow::Result<()> {
    let maker = Maker::of(movie).map_err(|message| anyhow!(message))?;
    let rate = played(rate, settings.ascending().filter_map(|shot| shot.frame));
    let files: Vec<PathBuf> = settings.ascending().map(|shot| shot.file(&settings.sequence)).collect();
    let frame = |file: &PathBuf| {
        read_frame(file, settings.sequence.format())
            .map_err(|reason| anyhow!("cannot read the frame `{}`: {reason}", file.display()))
    };
    let Some(first) = files.first().map(frame).transpose()? else { bail!("there are no frames for a movie") };
    let frames = files.iter().map(frame);
    match maker {
        Maker::Loop(format) => {
            let count = u32::try_from(files.len()).context("there are too many frames")?;
            let (size, mut bytes) = ((first.width(), first.height()), Vec::new());
            let mut writer = LoopWriter::new(&mut bytes, format, size, (count, rate))?;
            for film in frames {
                writer.add(&film?)?;
            }
            writer.finish()?;
            Ok(write_bytes(movie, &bytes)?)
        }
        Maker::Ffmpeg(codec) => encode(movie, codec, (&first, rate), frames),
    }
}

/// Lets ffmpeg encode a movie, which gets its name once it is whole.
fn encode(
    movie: &Path,
    codec: &[&str],
    (first, rate): (&EncodedFilm, FrameRate),
    frames: impl Iterator<Item = anyhow::Result<EncodedFilm>>,
) -> anyhow::Result<()> {
    let partial = partial_of(movie)?;
    let arguments = arguments(codec, first, rate);
    // Otherwise names such as `a:b.mp4` and `-d/a.mp4` would be a protocol and an option.
    let mut target = OsString::from("file:");
    target.push(&partial);
    let mut command = Command::new("ffmpeg");
    command.args(&arguments).arg(&target);
    let begun = command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn();
    let child = begun.with_context(|| {
        format!(
            "`{}` is made by ffmpeg, which cannot be started; the frames are there: install it and run the same command again",
            movie.display()
        )
    })?;
    let encoded = feed(child, frames).and_then(|()| {
        std::fs::rename(&partial, movie).with_context(|| format!("cannot write `{}`", movie.display()))
    });
    if encoded.is_err() {
        let _ = std::fs::remove_file(&partial);
    }
    encoded
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

/// Returns the name of a movie while it is made: hidden, beside its place, and with the same ending.
fn partial_of(movie: &Path) -> anyhow::Result<PathBuf> {
    let name = movie.file_name().with_context(|| format!("`{}` does not name a file", movie.display()))?;
    let mut partial = OsString::from(format!(".{}.", std::process::id()));
    partial.push(name);
    Ok(movie.with_file_name(partial))
}

/// Gives frames to ffmpeg, and waits for its end.
fn feed(mut child: Child, frames: impl Iterator<Item = anyhow::Result<EncodedFilm>>) -> anyhow::Result<()> {
    let mut fed = Ok(());
    if let Some(mut input) = child.stdin.take() {
        for film in frames {
            fed = film.and_then(|film| input.write_all(film.bytes()).context("ffmpeg takes no more frames"));
            if fed.is_err() {
                break;
            }
        }
    }
    let output = child.wait_with_output().context("cannot wait for ffmpeg")?;
    if !output.status.success() {
        let told = String::from_utf8_lossy(&output.stderr);
        bail!("ffmpeg could not make the movie: {}", told.trim());
    }
    fed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_tell_who_makes_a_movie() {
        assert_eq!(Maker::of(Path::new("a.GIF")), Ok(Maker::Loop(LoopFormat::Gif)));
        assert_eq!(Maker::of(Path::new("a.b.webm")), Ok(Maker::Ffmpeg(VP9)));
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
