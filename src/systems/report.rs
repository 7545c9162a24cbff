//! The cost report of a frame.

use std::sync::Arc;
use std::time::Duration;

use super::Plan;
use crate::time::Time;
use crate::trace::{Escalations, EstimatedError, FrameFingerprint, RayCounts, TileStats, TreeEnds};

/// The cost of a frame by phase, the statistics of its rays, and its plan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameReport {
    /// The moment of the frame.
    pub time: Time,
    /// The time spent on tracks, scripts and custom systems.
    pub animate: Duration,
    /// The time spent on world transforms and the kernel's arrays.
    pub prepare: Duration,
    /// The number of BVH builds. The BVH, the tree over the shapes, is kept if no shape has changed, and usually if few have.
    pub bvh_builds: u32,
    /// The number of BVH refits: the BVH was kept and adapted to the few shapes that had moved.
    pub bvh_refits: u32,
    /// The time spent on tracing rays.
    pub trace: Duration,
    /// The share of the image that was taken from a former one, 0 to 1: see [`RenderRequest::reuse`](super::RenderRequest::reuse).
    pub reused: f64,
    /// The fingerprint that identifies the image, if it is fully rendered.
    pub fingerprint: Option<FrameFingerprint>,
    /// The number of rays.
    pub rays: RayCounts,
    /// The statistics of each tile of 16 by 16 pixels, row by row from the top, if they were requested. Tiles at the right and lower borders
    /// may be smaller. Empty for the reference path.
    pub tile_stats: Arc<[TileStats]>,
    /// The estimated error of the image, if it has an error target: see [`Sampling::max_error`](crate::components::Sampling::max_error).
    pub error: Option<EstimatedError>,
    /// The number of rays that surfaces spawned but that were not traced.
    pub ends: TreeEnds,
    /// The colour of the image, if all of its pixels, at least two, are equal.
    pub one_color: Option<OneColor>,
    /// The number of escalations to more exact arithmetic.
    pub escalations: Escalations,
    /// The effects that the frame needs or omits, with reasons.
    pub plan: Option<Plan>,
    /// The least gains of the rounds, if a policy chose them. A [`Replay`](crate::trace::Replay) of them gives the same image.
    pub rounds: Vec<u32>,
}

/// The colour of an image of equal pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OneColor {
    /// Black.
    Black,
    /// Another colour.
    Other,
}

impl FrameReport {
    /// Creates an empty report of a frame.
    pub(crate) fn at(time: Time) -> Self {
        Self { time, ..Self::default() }
    }
}
