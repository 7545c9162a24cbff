//! Description of the path of the camera over the frames of its shot, for a page that draws it.

use std::time::{Duration, Instant};

use glam::DVec3;
use hecs::{Entity, World};
use serde::{Deserialize, Serialize};

use crate::components::{Camera, Order, Shape, Shot, Shots};
use crate::drawing::{CameraPath, CameraSample, draw_map, label};
use crate::engine::{Engine, EngineError};
use crate::systems::active_camera;
use crate::time::Timeline;

/// Maximum number of evenly spaced frames that are sampled: one for every few pixels of a path on a page.
const MOST_SAMPLES: u32 = 240;
/// Minimum number of evenly spaced frames, if there are as many.
const LEAST_SAMPLES: u32 = 8;
/// Maximum number of other frames that are sampled.
const MOST_KEYS: usize = 200;
/// Time that the samples may take, which delays pictures.
const MOST_TIME: Duration = Duration::from_millis(250);
/// Length of the drawn frustum, as a fraction of the extent of the path.
const FRUSTUM: f64 = 0.12;

/// The frames that are sampled in addition to evenly spaced ones.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PathRequest {
    /// The frames of keys.
    pub keys: Vec<u32>,
}

/// The path of the camera of a frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathInfo {
    /// Name of the camera.
    pub camera: String,
    /// The first and the last frame of the shot.
    pub frames: (u32, u32),
    /// Number of frames between evenly spaced samples.
    pub step: u32,
    /// The samples, ascending.
    pub samples: Vec<PathSample>,
    /// True if the eye does not move.
    pub is_still: bool,
    /// The number of frames, the length and the speed in words.
    pub about: String,
    /// Length of the drawn frustum in scene units.
    pub reach: f64,
    /// Notes about what is not sampled or not drawn.
    pub notes: Vec<String>,
    /// The map on which the path is drawn. Its grids have the numbers of the views.
    pub svg: String,
}

/// The camera in a frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathSample {
    /// Index of the frame.
    pub frame: u32,
    /// Position of the eye.
    pub eye: [f64; 3],
    /// The point that is looked at; `None` for a camera with a direction.
    pub target: Option<[f64; 3]>,
    /// Unit vectors to the right, up and forward.
    pub axes: [[f32; 3]; 3],
    /// Half the width and height of the view at distance 1 or, if rays are parallel, at any distance.
    pub half_size: [f64; 2],
    /// True if rays are parallel.
    pub is_orthographic: bool,
}

impl PathInfo {
    /// Samples the camera over the frames of the shot of a frame, to which the world returns. Returns `None` without a camera.
    pub(super) fn of(
        engine: &mut Engine,
        frame: u32,
        request: &PathRequest,
    ) -> Result<Option<Self>, EngineError> {
        let timeline = engine.timeline;
        engine.seek(timeline.time_of(frame))?;
        let Some(active) = active_camera(engine.world(), timeline.time_of(frame)) else { return Ok(None) };
        let camera = label(engine.world(), active.entity);
        let up = engine.world().get::<&Camera>(active.entity).map_or(DVec3::Y, |camera| camera.up);
        let frames = frames_of_shot(engine.world(), timeline, active.entity, frame);
        let shapes = engine.world().query::<(&Order, &Shape)>().iter().count();
        let sampled = Self::sample(engine, frames, &request.keys);
        engine.seek(timeline.time_of(frame))?;
        let (path, step) = sampled?;
        Ok(Self::describe(&path, camera, up, (frames, step), shapes))
    }

    /// Samples as many frames as there is time for. Returns the path and the number of frames between evenly spaced samples.
    fn sample(
        engine: &mut Engine,
        (first, last): (u32, u32),
        keys: &[u32],
    ) -> Result<(CameraPath, u32), EngineError> {
        let count = last - first + 1;
        let start = Instant::now();
        engine.advance(engine.timeline.time_of(first))?;
        engine.advance(engine.timeline.time_of(last.min(first + 1)))?;
        let fitting = 2.0 * MOST_TIME.as_secs_f64() / start.elapsed().as_secs_f64();
        let most = (1..=MOST_SAMPLES).rev().find(|most| f64::from(*most) <= fitting).unwrap_or(1);
        let step = count.div_ceil(most.max(LEAST_SAMPLES));
        let mut frames: Vec<u32> = (first..=last).step_by(step as usize).chain([last]).collect();
        frames.extend(keys.iter().take(MOST_KEYS).filter(|key| (first..=last).contains(key)));
        frames.sort_unstable();
        frames.dedup();
        let sampled = frames.len();
        let path = CameraPath::at(engine, frames.into_iter(), Some(Instant::now() + 2 * MOST_TIME))?;
        let spread_over = (sampled < count as usize).then_some(count as usize);
        Ok((CameraPath { spread_over, ..path }, step))
    }

    fn describe(
        path: &CameraPath,
        camera: String,
        up: DVec3,
        (frames, step): ((u32, u32), u32),
        shapes: usize,
    ) -> Option<Self> {
        let (first, end) = (path.samples.first()?, path.samples.last()?);
        let seen = || path.samples.iter().flat_map(|sample| [Some(sample.eye), sample.target]).flatten();
        let least = seen().fold(DVec3::INFINITY, DVec3::min);
        let extent = (seen().fold(DVec3::NEG_INFINITY, DVec3::max) - least).max_element();
        let mut notes = Vec::new();
        if end.frame < frames.1 {
            let frame = end.frame;
            notes.push(format!("The scene takes long: the path is drawn up to frame {frame} only."));
        }
        if path.shapes.len() < shapes {
            notes.push(format!("{} of {shapes} shapes are outlined.", path.shapes.len()));
        }
        let name = format!("Path of {camera} in two views: {}", path.describe());
        Some(Self {
            svg: draw_map(&name, seen(), &path.shapes, first.axes, up),
            camera,
            frames,
            step,
            is_still: path.is_still(),
            about: path.describe(),
            reach: if extent > 0.0 && extent.is_finite() { FRUSTUM * extent } else { 1.0 },
            notes,
            samples: path.samples.iter().map(PathSample::of).collect(),
        })
    }
}

impl PathSample {
    fn of(sample: &CameraSample) -> Self {
        Self {
            frame: sample.frame,
            eye: sample.eye.to_array(),
            target: sample.target.map(|target| target.to_array()),
            axes: sample.axes.map(|axis| axis.as_vec3().to_array()),
            half_size: sample.half_size,
            is_orthographic: sample.is_orthographic,
        }
    }
}

/// Returns the first and the last frame of the shots in a row that have this camera, around a frame.
fn frames_of_shot(world: &World, timeline: Timeline, camera: Entity, frame: u32) -> (u32, u32) {
    let shots = world.query::<&Shots>().iter().next().map(|shots| shots.0.clone()).unwrap_or_default();
    let start = |shot: &Shot| frames_before(timeline, shot.start);
    let is_other = |shot: &Shot| shot.camera != camera;
    let current = shots.partition_point(|shot| start(shot) <= frame).saturating_sub(1);
    let (before, after) = shots.split_at(current);
    let first = before.iter().rposition(is_other).map_or(0, |other| start(&shots[other + 1]));
    let last = after.iter().find(|shot| is_other(shot)).map_or(u32::MAX, start);
    // A shot without a camera shows the first camera.
    (first.min(frame), last.saturating_sub(1).clamp(frame, timeline.frame_count() - 1))
}

/// Returns the number of frames before a time in seconds.
fn frames_before(timeline: Timeline, seconds: f64) -> u32 {
    let (mut low, mut high) = (0, timeline.frame_count());
    while low < high {
        let middle = low + (high - low) / 2;
        if timeline.time_of(middle).seconds() < seconds {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    low
}
