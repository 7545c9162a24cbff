//! What searches keep between rays.

use std::sync::atomic::{AtomicBool, Ordering};

use super::crossings::{Crossed, Crossing};
use super::escalations::Escalations;
use super::nearest::TiedHitLists;
use crate::trace::bvh::Stack;
use crate::trace::rays::TieLists;

/// What searches need besides the scene, kept between rays so that none allocates.
#[derive(Clone, Debug)]
pub(crate) struct Scratch<'a> {
    /// Once it is true nobody waits for answers, and any will do.
    pub(crate) cancelled: &'a AtomicBool,
    pub(crate) stack: Stack,
    pub(crate) escalations: Escalations,
    /// What the surfaces are tied with that rays of this tile have found.
    pub(crate) ties: TieLists,
    /// What is met where the closest hits are, besides those.
    pub(crate) tied_hits: TiedHitLists,
    /// The clear shapes in a shadow ray's way, in any order.
    pub(crate) crossed: Vec<Crossed>,
    /// Where it crosses them.
    pub(crate) crossings: Vec<Crossing>,
}

/// For searches that always come to their end.
static NEVER: AtomicBool = AtomicBool::new(false);

impl<'a> Scratch<'a> {
    pub(crate) fn new(cancelled: &'a AtomicBool) -> Self {
        Self {
            cancelled,
            stack: Stack::default(),
            escalations: Escalations::default(),
            ties: TieLists::default(),
            tied_hits: TiedHitLists::default(),
            crossed: Vec::new(),
            crossings: Vec::new(),
        }
    }

    /// Returns whether nobody waits any more.
    #[inline(always)]
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

impl Default for Scratch<'_> {
    /// For searches that always come to their end.
    fn default() -> Self {
        Self::new(&NEVER)
    }
}
