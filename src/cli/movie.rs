//! `rayreel render --movie`: encodes the finished frames into one file.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use rayreel::output::{LoopFormat, MovieFormat, gif_delays, write_movie};
use rayreel::time::{FrameRate, Timeline};

use super::settings::OutputSettings;

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
            Ok(format @ MovieFormat::Ffmpeg(_)) if size != format.size(size) => {
                let (width, height) = format.size(size);
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

/// Makes a movie of the frames, which must all be rendered. Returns `false` on cancellation; no file is left then.
pub(super) fn make(
    movie: &Path,
    settings: &OutputSettings,
    rate: FrameRate,
    cancelled: &AtomicBool,
) -> anyhow::Result<bool> {
    let frames: Vec<u32> = settings.ascending().filter_map(|request| request.frame).collect();
    let files: Vec<PathBuf> = settings.ascending().map(|request| request.file(&settings.sequence)).collect();
    Ok(write_movie(movie, &files, settings.sequence.format(), played(rate, &frames), cancelled)?)
}

#[cfg(test)]
mod tests {
    use rayreel::time::FrameList;

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
}
