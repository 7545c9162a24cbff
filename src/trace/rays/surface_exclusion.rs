//! The surface that a ray leaves.

use super::coincident_hits::CoincidentHits;
use super::shape_id::ShapeId;

/// The surface that a ray leaves. The ray skips this surface; its origin is not offset by an epsilon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfaceExclusion {
    /// The shape that is left; of equal shapes, the first in document order.
    pub(crate) id: ShapeId,
    /// True if the ray goes out of the shape; otherwise it goes into the shape.
    pub(crate) outward: bool,
    /// Other shapes that are left at the same point.
    pub(crate) ties: CoincidentHits,
}
