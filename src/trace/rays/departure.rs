//! What a ray knows of the surface that it leaves.

use super::shape_id::ShapeId;
use super::ties::Ties;

/// The surface a ray leaves. Instead of moving the origin off the surface by some epsilon, the ray skips what it leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Departure {
    /// The shape that is left, or the first in document order of those that equal it.
    pub(crate) id: ShapeId,
    /// Whether the ray goes out of it; else it goes into it.
    pub(crate) outward: bool,
    /// What else is left there.
    pub(crate) ties: Ties,
}
