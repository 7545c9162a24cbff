//! What a frame cost.

use std::time::Duration;

use crate::time::Time;
use crate::trace::{Escalations, RayCounts, TreeEnds};

/// What the last frame cost, phase by phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameReport {
    /// The frame's moment.
    pub time: Time,
    /// Tracks and own systems.
    pub animate: Duration,
    /// World transforms and the kernel's arrays.
    pub prepare: Duration,
    /// How often the tree over the shapes was built. It is kept where no shape has changed.
    pub trees: u32,
    /// Rays.
    pub trace: Duration,
    /// How many of them.
    pub rays: RayCounts,
    /// How many were not traced, though a surface sent them on.
    pub ends: TreeEnds,
    /// How often arithmetic had to be helped.
    pub escalations: Escalations,
}

impl Default for FrameReport {
    fn default() -> Self {
        let none = Duration::ZERO;
        Self {
            time: Time::ZERO,
            animate: none,
            prepare: none,
            trees: 0,
            trace: none,
            rays: RayCounts::default(),
            ends: TreeEnds::default(),
            escalations: Escalations::default(),
        }
    }
}
