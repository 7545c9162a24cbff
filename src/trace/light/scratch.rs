//! What lighting keeps between rays.

use std::sync::atomic::AtomicBool;

use super::filter::Filter;
use super::medium_stack::MediumStacks;
use crate::trace::query::Scratch;

/// Holds what lighting needs besides the scene, kept between rays so that none allocates.
#[derive(Clone, Debug, Default)]
pub(crate) struct LightScratch<'a> {
    /// What searches need.
    pub(crate) search: Scratch<'a>,
    /// Clear solids that rays of this tile are inside of.
    pub(crate) media: MediumStacks,
    /// What the clear solids in a shadow ray's way do to it.
    pub(crate) filters: Vec<Filter>,
}

impl<'a> LightScratch<'a> {
    /// Once `cancelled` is true nobody waits for answers, and any will do.
    pub(crate) fn new(cancelled: &'a AtomicBool) -> Self {
        Self { search: Scratch::new(cancelled), media: MediumStacks::default(), filters: Vec::new() }
    }
}
