//! The settings file next to the frames, which holds the samples that were selected for each frame. With it, the same frames are rendered
//! again independently of timing.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, ensure};
use serde::{Deserialize, Serialize};

use rayreel::accuracy::FrameSamples;
use rayreel::components::Sampling;
use rayreel::output::write_bytes;
use rayreel::scene::input::{self, InputKind};
use rayreel::sequence::FrameRequest;

/// The samples that were selected for frames, and the results.
#[derive(Debug, Default)]
pub(super) struct SettingsFile {
    frames: BTreeMap<PictureKey, FrameRecord>,
}

/// Key of a picture: the number of a frame, or the bits of a moment's time in seconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum PictureKey {
    Frame(u32),
    Moment(u64),
}

/// The samples that were selected for a frame, and the results.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct FrameRecord {
    /// Number of the frame; `null` for a moment that is not a frame.
    pub(super) frame: Option<u32>,
    /// Time on the timeline, in seconds.
    pub(super) time: f64,
    pub(super) samples: u32,
    pub(super) max_error: f32,
    /// Estimated error in 8-bit levels; `null` if the pixels have too few samples for an estimate.
    #[serde(default)]
    pub(super) estimated_error: Option<f64>,
    #[serde(default)]
    pub(super) samples_per_pixel: f64,
    #[serde(default)]
    pub(super) seconds: f64,
    /// The deadline in seconds that the samples were selected for, if there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) deadline_seconds: Option<f64>,
    /// Minimum gains of the adaptive rounds, if they do not follow from `max_error`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) rounds: Option<Vec<u32>>,
}

/// Contents of the settings file.
#[derive(Serialize, Deserialize)]
struct SettingsContent {
    #[serde(default)]
    rayreel: String,
    #[serde(default)]
    scene: String,
    frames: Vec<FrameRecord>,
}

impl SettingsFile {
    /// Reads and validates a settings file.
    pub(super) fn read(file: &Path) -> anyhow::Result<Self> {
        let name = file.display();
        /// Maximum size in bytes, enough for more frames than a sequence has.
        const MOST: u64 = 1 << 28;
        let bytes =
            input::read(file, InputKind::Refused, MOST).with_context(|| format!("cannot read `{name}`"))?;
        let content: SettingsContent = serde_json::from_slice(&bytes).with_context(|| {
            format!("`{name}` is not a file of settings, as render --max-error and --deadline write it")
        })?;
        for FrameRecord { time, samples, max_error, .. } in &content.frames {
            let most = Sampling::LARGEST_COUNT;
            ensure!(
                (1..=most).contains(samples),
                "`{name}` has {samples} `samples` at {time} s: write 1 to {most}"
            );
            let most = Sampling::LARGEST_ERROR;
            ensure!(
                (0.0..=most).contains(max_error),
                "`{name}` has a `max_error` of {max_error} at {time} s: write 0 to {most}"
            );
        }
        Ok(Self { frames: content.frames.into_iter().map(|frame| (frame.picture(), frame)).collect() })
    }

    /// Returns the samples of a frame.
    pub(super) fn samples_of(&self, request: &FrameRequest) -> Option<FrameSamples> {
        let FrameRecord { samples, max_error, rounds, .. } =
            self.frames.get(&PictureKey::of_request(request))?;
        Some(FrameSamples { samples: *samples, max_error: *max_error, rounds: rounds.clone() })
    }

    /// Returns the samples that were selected for a frame under this deadline, and the seconds that it took.
    pub(super) fn of_deadline(&self, request: &FrameRequest, deadline: f64) -> Option<(FrameSamples, f64)> {
        let frame = self.frames.get(&PictureKey::of_request(request))?;
        let is_it = frame.deadline_seconds == Some(deadline);
        is_it.then(|| self.samples_of(request)).flatten().map(|samples| (samples, frame.seconds))
    }

    /// Returns the entry of a picture.
    pub(super) fn get(&self, picture: &PictureKey) -> Option<&FrameRecord> {
        self.frames.get(picture)
    }

    /// Inserts a frame, replacing its existing entry.
    pub(super) fn put(&mut self, frame: FrameRecord) {
        self.frames.insert(frame.picture(), frame);
    }

    /// Inserts the entries of another file, except for the pictures in `own`.
    pub(super) fn put_others(&mut self, other: Self, own: &BTreeMap<PictureKey, FrameRequest>) {
        self.frames.extend(other.frames.into_iter().filter(|(picture, _)| !own.contains_key(picture)));
    }

    /// Writes the file atomically.
    pub(super) fn write(&self, file: &Path, scene: &Path) -> anyhow::Result<()> {
        let content = SettingsContent {
            rayreel: env!("CARGO_PKG_VERSION").to_owned(),
            scene: scene.display().to_string(),
            frames: self.frames.values().cloned().collect(),
        };
        Ok(write_bytes(file, format!("{}\n", serde_json::to_string_pretty(&content)?).as_bytes())?)
    }
}

impl FrameRecord {
    fn picture(&self) -> PictureKey {
        PictureKey::of(self.frame, self.time)
    }
}

impl PictureKey {
    /// Returns the key of a frame request.
    pub(super) fn of_request(request: &FrameRequest) -> Self {
        Self::of(request.frame, request.time.seconds())
    }

    fn of(frame: Option<u32>, time: f64) -> Self {
        frame.map_or(Self::Moment(time.to_bits()), Self::Frame)
    }
}
