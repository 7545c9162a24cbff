//! Lighting buffers that are reused from ray to ray.

use std::sync::atomic::AtomicBool;

use super::filter::Filter;
use super::medium_stack::MediumStacks;
use crate::trace::intersect::{Naive, Scratch};

/// Buffers that lighting needs in addition to the scene, reused from ray to ray to avoid allocation.
#[derive(Clone, Debug, Default)]
pub(crate) struct LightScratch<'a> {
    /// Buffers of ray queries.
    pub(crate) search: Scratch<'a>,
    /// Stacks of transparent solids that contain rays of this tile.
    pub(crate) media: MediumStacks,
    /// Effects of the transparent solids along a shadow ray.
    pub(crate) filters: Vec<Filter>,
}

impl<'a> LightScratch<'a> {
    /// Creates empty buffers. `cancelled` is set on cancellation; results are then unspecified.
    pub(crate) fn new(cancelled: &'a AtomicBool, naive: Option<&'a Naive>) -> Self {
        Self { search: Scratch::new(cancelled, naive), media: MediumStacks::default(), filters: Vec::new() }
    }
}
