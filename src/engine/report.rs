//! What a frame cost.

use std::time::Duration;

use crate::time::Time;
use crate::trace::{Guards, RayCounts, TreeEnds};

/// What the last frame cost, phase by phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameReport {
    /// The frame's moment.
    pub time: Time,
    /// Tracks and own systems.
    pub animate: Duration,
    /// World transforms and the kernel's arrays.
    pub prepare: Duration,
    /// Rays.
    pub trace: Duration,
    /// How many of them.
    pub rays: RayCounts,
    /// How many were not traced, though a surface sent them on.
    pub ends: TreeEnds,
    /// How often arithmetic had to be helped.
    pub guards: Guards,
}

impl Default for FrameReport {
    fn default() -> Self {
        let none = Duration::ZERO;
        Self {
            time: Time::ZERO,
            animate: none,
            prepare: none,
            trace: none,
            rays: RayCounts::default(),
            ends: TreeEnds::default(),
            guards: Guards::default(),
        }
    }
}
