//! Samples of the camera, frame by frame.

use std::time::Instant;

use glam::DVec3;

use super::{OutlinedShape, Steps, outlined_shapes};
use crate::components::Name;
use crate::engine::{Engine, EngineError};
use crate::systems::{ActiveCamera, active_camera, scene_camera};
use crate::time::{FrameList, Time};

/// The camera's path over the chosen frames.
pub struct CameraPath {
    /// Samples in ascending order of time. Frames without a finite camera have none.
    pub samples: Vec<CameraSample>,
    /// Number of chosen frames, if not each of them has a sample.
    pub spread_over: Option<usize>,
    /// Outlines of the scene's shapes at the first sample.
    pub shapes: Vec<OutlinedShape>,
}

/// The camera in one frame.
#[derive(Clone, Debug)]
pub struct CameraSample {
    pub frame: u32,
    pub seconds: f64,
    pub eye: DVec3,
    /// Unit vectors to the right, up and forward.
    pub axes: [DVec3; 3],
    /// Half the width and height of the view at distance 1 or, if rays are parallel, at any distance.
    pub half_size: [f64; 2],
    pub is_orthographic: bool,
    /// The point that the camera looks at, if it has a target.
    pub target: Option<DVec3>,
    /// The camera's name.
    pub camera: Option<String>,
}

impl CameraPath {
    /// Maximum number of samples; a drawing cannot show more.
    const MOST: u32 = 4000;

    /// Samples the camera at these frames, or at [`CameraPath::MOST`] of them, spread evenly, if there are more.
    pub fn of(engine: &mut Engine, frames: &FrameList) -> Result<Self, EngineError> {
        let chosen = frames.count();
        let frames = frames.spread(Self::MOST);
        let spread_over = (frames.count() < chosen).then_some(chosen);
        Ok(Self { spread_over, ..Self::at(engine, frames.frames(), None)? })
    }

    /// Samples the camera at frames in ascending order, until a time if one is given. The kernel's data stay those of another moment.
    pub fn at(
        engine: &mut Engine,
        frames: impl Iterator<Item = u32>,
        until: Option<Instant>,
    ) -> Result<Self, EngineError> {
        let (mut samples, mut shapes) = (Vec::new(), Vec::new());
        for frame in frames {
            if until.is_some_and(|until| Instant::now() >= until) {
                break;
            }
            let time = engine.timeline.time_of(frame);
            engine.advance(time)?;
            if samples.is_empty() {
                shapes = outlined_shapes(engine);
            }
            samples.extend(CameraSample::of(engine, frame, time));
        }
        Ok(Self { samples, spread_over: None, shapes })
    }

    /// Returns the shots: runs of samples of the same camera.
    pub fn shots(&self) -> impl Iterator<Item = &[CameraSample]> {
        self.samples.chunk_by(|one, next| one.camera == next.camera)
    }

    /// Returns the indices of the samples of a shot that are labelled with their time: the first, and the first at or after each round time.
    pub fn labelled(&self, shot: &[CameraSample]) -> impl Iterator<Item = usize> {
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
    pub fn speeds(&self) -> Rates {
        self.rates(|one, next| one.eye.distance(next.eye))
    }

    /// Returns the rotation rates between consecutive samples about any axis, in degrees per second.
    pub fn turn_rates(&self) -> Rates {
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
    pub fn is_still(&self) -> bool {
        self.shots().all(|shot| shot.iter().all(|sample| sample.eye == shot[0].eye))
    }

    /// Describes the path in one line.
    pub fn describe(&self) -> String {
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
    fn of(engine: &Engine, frame: u32, time: Time) -> Option<Self> {
        let camera = scene_camera(engine.world(), engine.effective_settings().film, time);
        let (eye, axes) = (camera.position(), camera.axes());
        let (columns, rows) = camera.resolution();
        let [width, height] = camera.pixel_size();
        let finite = eye.is_finite() && axes.iter().all(|axis| axis.is_finite());
        let active = active_camera(engine.world(), time);
        let target = active.and_then(|active| active.target).filter(|target| target.is_finite());
        let name = |active: ActiveCamera| Some(engine.world().get::<&Name>(active.entity).ok()?.0.clone());
        finite.then_some(Self {
            frame,
            seconds: time.seconds(),
            eye,
            axes,
            half_size: [0.5 * width * f64::from(columns), 0.5 * height * f64::from(rows)],
            is_orthographic: camera.is_orthographic(),
            target,
            camera: active.and_then(name),
        })
    }

    /// Formats the time and, if `named`, the name of the camera.
    pub fn describe(&self, named: bool) -> String {
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
pub struct Rates {
    /// Times of the first and the last sample in seconds.
    pub span: (f64, f64),
    /// Pairs of time in seconds and rate, shot by shot.
    pub shots: Vec<Vec<(f64, f64)>>,
}

impl Rates {
    /// Returns the lowest and the highest rate, or 0 if there are none.
    pub fn range(&self) -> (f64, f64) {
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
