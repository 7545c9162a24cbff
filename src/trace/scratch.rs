//! What is kept between rays.

use std::sync::atomic::{AtomicBool, Ordering};

use super::Guards;
use super::bvh::Stack;
use super::media::Nesting;
use super::shadow::{Crossed, Crossing, Filter};

/// What searches need besides the scene, kept between rays so that none allocates.
#[derive(Clone, Debug)]
pub(super) struct Scratch<'a> {
    /// Once it is true nobody waits for answers, and any will do.
    pub(super) cancelled: &'a AtomicBool,
    pub(super) stack: Stack,
    pub(super) guards: Guards,
    /// Clear solids that rays of this tile are inside of.
    pub(super) nesting: Nesting,
    /// The clear shapes in a shadow ray's way, in any order.
    pub(super) crossed: Vec<Crossed>,
    /// Where it crosses them.
    pub(super) crossings: Vec<Crossing>,
    pub(super) filters: Vec<Filter>,
}

/// For searches that always come to their end.
static NEVER: AtomicBool = AtomicBool::new(false);

impl<'a> Scratch<'a> {
    pub(super) fn new(cancelled: &'a AtomicBool) -> Self {
        Self {
            cancelled,
            stack: Stack::default(),
            guards: Guards::default(),
            nesting: Nesting::default(),
            crossed: Vec::new(),
            crossings: Vec::new(),
            filters: Vec::new(),
        }
    }

    /// Does nobody wait any more?
    #[inline(always)]
    pub(super) fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

impl Default for Scratch<'_> {
    /// For searches that always come to their end.
    fn default() -> Self {
        Self::new(&NEVER)
    }
}
