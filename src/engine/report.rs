//! The cost of a frame.

use std::time::Duration;

use crate::time::Time;
use crate::trace::{Escalations, EstimatedError, FrameFingerprint, RayCounts, TreeEnds};

/// The cost of the last frame, phase by phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameReport {
    /// The frame's moment.
    pub time: Time,
    /// The time spent on tracks, scripts and custom systems.
    pub animate: Duration,
    /// The time spent on world transforms and the kernel's arrays.
    pub prepare: Duration,
    /// How often the BVH, the tree over the shapes, was built. It is kept where no shape has changed, and mostly where few have.
    pub bvh_builds: u32,
    /// How often the BVH was kept, and made to fit around the few shapes that had moved.
    pub bvh_refits: u32,
    /// The time spent on rays.
    pub trace: Duration,
    /// What identifies the picture, once it is rendered in full.
    pub fingerprint: Option<FrameFingerprint>,
    /// The number of rays.
    pub rays: RayCounts,
    /// The estimate of the picture's error, if it has a target: see
    /// [`Sampling::max_error`](crate::components::Sampling::max_error).
    pub error: Option<EstimatedError>,
    /// The number of rays not traced, though a surface sent them on.
    pub ends: TreeEnds,
    /// How often arithmetic had to be escalated.
    pub escalations: Escalations,
}

impl Default for FrameReport {
    fn default() -> Self {
        let none = Duration::ZERO;
        Self {
            time: Time::ZERO,
            animate: none,
            prepare: none,
            bvh_builds: 0,
            bvh_refits: 0,
            trace: none,
            fingerprint: None,
            rays: RayCounts::default(),
            error: None,
            ends: TreeEnds::default(),
            escalations: Escalations::default(),
        }
    }
}
