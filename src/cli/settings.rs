//! What was typed, checked and completed.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};

use rayreel::Time;
use rayreel::components::FilmSettings;
use rayreel::output::{FrameFormat, Sequence};
use rayreel::time::{FrameList, Timeline};

use super::args::{Format, RenderArguments};

/// One picture to be made.
#[derive(Clone, Debug)]
pub(super) struct Shot {
    /// `None` for a moment that is no frame.
    pub(super) frame: Option<u32>,
    pub(super) time: Time,
    pub(super) path: PathBuf,
}

/// Which pictures to make, and where to put them.
#[derive(Debug)]
pub(super) struct RenderSettings {
    pub(super) shots: Vec<Shot>,
    pub(super) sequence: Sequence,
    pub(super) size: Option<(u32, u32)>,
    pub(super) threads: Option<usize>,
}

impl RenderSettings {
    /// What the arguments mean for a scene with this timeline.
    pub(super) fn new(arguments: &RenderArguments, timeline: Timeline) -> anyhow::Result<Self> {
        let last = timeline.frame_count() - 1;
        let name = scene_name(&arguments.scene)?;
        let directory = arguments.out.clone().unwrap_or_else(|| Path::new("out").join(&name));
        let format = match arguments.format {
            Format::Png => FrameFormat::Png,
            Format::Ppm => FrameFormat::Ppm,
        };
        let sequence = Sequence::new(directory, name, last, format);
        let shots = match (arguments.at, &arguments.frames) {
            (Some(time), _) => vec![Shot { frame: None, time, path: sequence.moment(time) }],
            (None, frames) => {
                let frames = frames.clone().unwrap_or_else(|| FrameList::all(last + 1));
                if frames.last() > last {
                    bail!("there is no frame {}: {}", frames.last(), timeline_in_words(timeline));
                }
                let shot = |index| Shot {
                    frame: Some(index),
                    time: timeline.time_of(index),
                    path: sequence.frame(index),
                };
                frames.frames().into_iter().map(shot).collect()
            }
        };
        if let Some((width, height)) = arguments.size {
            let side = 1..=FilmSettings::LARGEST_SIDE;
            ensure!(
                side.contains(&width) && side.contains(&height),
                "--size {width}x{height}: each side must be from 1 to {} pixels",
                FilmSettings::LARGEST_SIDE
            );
            ensure!(
                u64::from(width) * u64::from(height) <= FilmSettings::LARGEST_AREA,
                "--size {width}x{height}: a film has at most {} pixels",
                FilmSettings::LARGEST_AREA
            );
        }
        Ok(Self { shots, sequence, size: arguments.size, threads: arguments.threads.map(usize::from) })
    }
}

/// The file's name without its ending.
fn scene_name(path: &Path) -> anyhow::Result<String> {
    let stem = path.file_stem().with_context(|| format!("`{}` does not name a file", path.display()))?;
    Ok(stem.to_string_lossy().into_owned())
}

fn timeline_in_words(timeline: Timeline) -> String {
    match timeline.frame_count() {
        1 => "the scene is a single frame, 0".to_owned(),
        count => format!(
            "the timeline of {} s at {} frames a second has frames 0 to {}",
            timeline.duration,
            timeline.rate.per_second(),
            count - 1
        ),
    }
}
