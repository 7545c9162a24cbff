//! What is in the way of a shadow ray.

use crate::trace::rays::ShapeId;

/// What a clear solid does to a shadow ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Filter {
    pub(crate) id: ShapeId,
    pub(crate) crossings: u32,
    /// How far the ray goes in it, as far as it is the last entered.
    pub(crate) length: f64,
}
