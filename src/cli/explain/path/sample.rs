//! Samples of the camera, frame by frame.

use glam::DVec3;

use rayreel::components::Name;
use rayreel::systems::{ActiveCamera, active_camera};
use rayreel::time::FrameList;
use rayreel::{Engine, EngineError, Time};

use rayreel::drawing::{OutlinedShape, Steps, outlined_shapes};

/// The camera's path over the chosen frames.
pub(super) struct CameraPath {
    /// Samples in ascending order of time. Frames without a finite camera have none.
    pub(super) samples: Vec<CameraSample>,
    /// Number of chosen frames, if there are too many to sample each.
    pub(super) spread_over: Option<usize>,
    /// Outlines of the scene's shapes at the first sample.
    pub(super) shapes: Vec<OutlinedShape>,
}

/// The camera in one frame.
#[derive(Clone, Debug)]
pub(super) struct CameraSample {
    pub(super) seconds: f64,
    pub(super) eye: DVec3,
    /// Unit vectors to the right, up and forward.
    pub(super) axes: [DVec3; 3],
    /// The point that the camera looks at, if it has a target.
    pub(super) target: Option<DVec3>,
    /// The camera's name.
    pub(super) camera: Option<String>,
}

impl CameraPath {
    /// Maximum number of samples; a drawing cannot show more.
    const MOST: u32 = 4000;

    /// Samples the camera at these frames, or at [`CameraPath::MOST`] of them, spread evenly, if there are more.
    pub(super) fn of(engine: &mut Engine, frames: &FrameList) -> Result<Self, EngineError> {
        let chosen = frames.count();
        let frames = frames.spread(Self::MOST);
        let spread_over = (frames.count() < chosen).then_some(chosen);
        let (mut samples, mut shapes) = (Vec::with_capacity(frames.count()), Vec::new());
        for frame in frames.frames() {
            let time = engine.timeline.time_of(frame);
            engine.seek(time)?;
            if samples.is_empty() {
                shapes = outlined_shapes(engine);
            }
            if let Some(sample) = CameraSample::of(engine, time) {
                samples.push(sample);
            }
        }
        Ok(Self { samples, spread_over, shapes })
    }

    /// Returns the shots: runs of samples of the same camera.
    pub(super) fn shots(&self) -> impl Iterator<Item = &[CameraSample]> {
        self.samples.chunk_by(|one, next| one.camera == next.camera)
    }

    /// Returns the indices of the samples of a shot that are labelled with their time: the first, and the first at or after each round time.
    pub(super) fn labelled(&self, shot: &[CameraSample]) -> impl Iterator<Item = usize> {
        let (from, to) = self.span();
        let size = Steps::over(to - from, 12.0).size();
        let round = move |sample: &CameraSample| (sample.seconds / size + 1e-9).floor();
        let rounds: Vec<f64> = shot.iter().map(round).collect();
        let is_round = |index: &usize| match index.checked_sub(1) {
            Some(before) => rounds[*index] > rounds[before],
            None => true,
        };
        (0..shot.len()).filter(is_round).collect::<Vec<_>>().into_iter()
    }

    /// Returns the times of the first and the last sample in seconds.
    fn span(&self) -> (f64, f64) {
        let seconds = |sample: &CameraSample| sample.seconds;
        (self.samples.first().map_or(0.0, seconds), self.samples.last().map_or(0.0, seconds))
    }

    /// Returns the speeds between consecutive samples, in scene units per second.
    pub(super) fn speeds(&self) -> Rates {
        self.rates(|one, next| one.eye.distance(next.eye))
    }

    /// Returns the rotation rates between consecutive samples about any axis, in degrees per second.
    pub(super) fn turn_rates(&self) -> Rates {
        self.rates(|one, next| one.turned_to(next).to_degrees())
    }

    fn rates(&self, change: impl Fn(&CameraSample, &CameraSample) -> f64) -> Rates {
        let rate = |pair: &[CameraSample]| {
            let [one, next] = [&pair[0], &pair[1]];
            (0.5 * (one.seconds + next.seconds), change(one, next) / (next.seconds - one.seconds))
        };
        Rates {
            span: self.span(),
            shots: self.shots().map(|shot| shot.windows(2).map(rate).collect()).collect(),
        }
    }

    /// Returns whether the eye stands still throughout every shot.
    pub(super) fn is_still(&self) -> bool {
        self.shots().all(|shot| shot.iter().all(|sample| sample.eye == shot[0].eye))
    }

    /// Describes the path in one line.
    pub(super) fn describe(&self) -> String {
        let count = match (self.samples.len(), self.spread_over) {
            (count, Some(chosen)) => format!("{count} of {chosen} frames"),
            (1, None) => "1 frame".to_owned(),
            (count, None) => format!("{count} frames"),
        };
        let shots = match self.shots().count() {
            0 | 1 => String::new(),
            count => format!(" in {count} shots"),
        };
        let path = if self.is_still() { "the eye stands still".to_owned() } else { self.describe_path() };
        let turning = match self.turn_rates().range().1 {
            0.0 => String::new(),
            most => format!(", turning by up to {} degrees a second", short(most)),
        };
        format!("{count}{shots}, {path}{turning}")
    }

    fn describe_path(&self) -> String {
        let steps = self.shots().flat_map(|shot| shot.windows(2));
        let length: f64 = steps.map(|pair| pair[0].eye.distance(pair[1].eye)).sum();
        let (least, most) = self.speeds().range();
        let speed = match [least, most].map(short) {
            [least, most] if least == most => most,
            [least, most] => format!("{least} to {most}"),
        };
        format!("a path of {} units at {speed} units a second", short(length))
    }
}

impl CameraSample {
    fn of(engine: &Engine, time: Time) -> Option<Self> {
        let prepared = engine.prepared()?.camera();
        let (eye, axes) = (prepared.position(), prepared.axes());
        let finite = eye.is_finite() && axes.iter().all(|axis| axis.is_finite());
        let active = active_camera(engine.world(), time);
        let target = active.and_then(|active| active.target).filter(|target| target.is_finite());
        let name = |active: ActiveCamera| Some(engine.world().get::<&Name>(active.entity).ok()?.0.clone());
        finite.then_some(Self { seconds: time.seconds(), eye, axes, target, camera: active.and_then(name) })
    }

    /// Formats the time and, if `named`, the name of the camera.
    pub(super) fn describe(&self, named: bool) -> String {
        let seconds = format!("{:.3}", self.seconds);
        let seconds = seconds.trim_end_matches('0').trim_end_matches('.');
        match &self.camera {
            Some(name) if named => format!("{name}, {seconds} s"),
            _ => format!("{seconds} s"),
        }
    }

    /// Returns the angle in radians of the rotation from this orientation to the next. The sum of the squared differences of the axes is
    /// 8 sin^2(angle / 2).
    fn turned_to(&self, next: &Self) -> f64 {
        let squares: f64 =
            self.axes.iter().zip(next.axes).map(|(one, next)| one.distance_squared(next)).sum();
        2.0 * libm::asin((0.125 * squares).sqrt().min(1.0))
    }
}

/// A rate per second over time, shot by shot.
pub(super) struct Rates {
    /// Times of the first and the last sample in seconds.
    pub(super) span: (f64, f64),
    /// Pairs of time in seconds and rate, shot by shot.
    pub(super) shots: Vec<Vec<(f64, f64)>>,
}

impl Rates {
    /// Returns the lowest and the highest rate, or 0 if there are none.
    pub(super) fn range(&self) -> (f64, f64) {
        let rates = || self.shots.iter().flatten().map(|(_, rate)| *rate);
        (rates().reduce(f64::min).unwrap_or(0.0), rates().reduce(f64::max).unwrap_or(0.0))
    }
}

/// Formats a number with about three significant digits.
fn short(value: f64) -> String {
    match value.abs() {
        size if size >= 1e6 || size > 0.0 && size < 1e-3 => format!("{value:.2e}"),
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}
