//! Conversion of path, orbit and turns tracks to motions.

use glam::DVec3;

use super::document::TrackDocument;
use super::playback::easing;
use crate::animation::{Orbit, Pace, Path, Playback, Turns};
use crate::components::Motion;

/// Returns the motion along a path or an orbit, or by turns; `None` for other tracks and for invalid ones.
pub(super) fn motion_along<T>(document: &TrackDocument<T>, playback: Playback) -> Option<Motion> {
    match document {
        TrackDocument::Keys(_)
        | TrackDocument::Along
        | TrackDocument::Script(_)
        | TrackDocument::ScriptFile(_) => None,
        TrackDocument::Path { points, closed, start, duration, speed, ease } => {
            let points: Vec<DVec3> = points.iter().map(|point| DVec3::from(*point)).collect();
            let path = Path::new(&points, *closed)?;
            let duration = duration.or_else(|| Some(path.length() / (*speed)?))?;
            let pace = Pace { start: *start, duration, ease: easing(*ease), playback };
            Some(path.paced(pace).into())
        }
        TrackDocument::Orbit { center, radius, axis, height, from, turns, start, duration, ease } => {
            let orbit = Orbit::new(DVec3::from(*center), DVec3::from(*axis), *radius, *height)?;
            let pace = Pace { start: *start, duration: *duration, ease: easing(*ease), playback };
            Some(orbit.turned(from / 360.0, *turns).paced(pace).into())
        }
        TrackDocument::Turns { axis, turns, from, start, duration, ease } => {
            let pace = Pace { start: *start, duration: *duration, ease: easing(*ease), playback };
            Some(Turns::new(DVec3::from(*axis), *from, *turns, pace)?.into())
        }
    }
}
