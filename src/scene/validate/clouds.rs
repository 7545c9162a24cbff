//! Validation of the settings of clouds. Their files are checked when they are opened, and the rest as entities.

use super::{At, Problems, check};
use crate::scene::document::{CloudDocument, ColorByDocument, FramesDocument, SceneDocument, ShapeDocument};
use crate::time::{FrameRate, Time};

pub(super) fn validate(document: &SceneDocument, scene: &At<'_>, problems: &mut Problems) {
    let list = scene.field("clouds");
    for (index, cloud) in document.clouds.iter().enumerate() {
        let at = list.index(index);
        look(cloud, &at, problems);
        frames(&cloud.frames, &at.field("frames"), problems);
    }
}

fn look(cloud: &CloudDocument, at: &At<'_>, problems: &mut Problems) {
    if !matches!(cloud.shape, ShapeDocument::Sphere { .. } | ShapeDocument::Box { .. }) {
        let help = "write `Sphere(radius: 1)` or `Box(size: (1, 1, 1))`";
        problems.add(&at.field("shape"), "particles are spheres or boxes", "another shape", help);
    }
    if cloud.color.is_some() && cloud.color_by.is_some() {
        let message = "the cloud has both `color` and `color_by`";
        problems.add(&at.field("color"), message, "one too many", "keep one of the two");
    }
    if let Some(ColorByDocument::Map { range: Some((least, greatest)), .. }) = cloud.color_by {
        let color_by = at.field("color_by");
        let range = color_by.field("range");
        let is_good = [least, greatest]
            .into_iter()
            .zip(0..)
            .all(|(end, index)| check::number(end, &range.index(index), problems));
        if is_good && least == greatest {
            let help = "write the numbers of the first and the last colour, as (0, 3)";
            problems.add(&range, "a range of a single number", "empty", help);
        }
    }
}

fn frames(frames: &FramesDocument, at: &At<'_>, problems: &mut Problems) {
    let start = at.field("start");
    if check::number(frames.start, &start, problems) && start_time(frames.start).is_none() {
        let message = "the start of the frames is beyond a million seconds, or has more than nine decimals";
        problems.add(&start, message, "not exact", "write seconds, as 1.5");
    }
    if frame_rate(frames).is_none() {
        let message =
            format!("frames per second are written with numbers from 1 to {}", FrameRate::LARGEST_PART);
        let help = "write a whole number, as 24, or a ratio, as (30000, 1001)";
        problems.add(&at.field("fps"), message, "out of range", help);
    }
}

/// Returns the magnitude of a start as an exact time.
pub(in crate::scene) fn start_time(start: f64) -> Option<Time> {
    start.abs().to_string().parse().ok()
}

/// Returns the frames per second of a data file.
pub(in crate::scene) fn frame_rate(frames: &FramesDocument) -> Option<FrameRate> {
    let part = |value: u64| u32::try_from(value).ok();
    FrameRate::new(part(frames.fps.numerator)?, part(frames.fps.denominator)?)
}
