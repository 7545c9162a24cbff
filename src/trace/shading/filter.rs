//! Effects of transparent solids on shadow rays.

use crate::trace::rays::ShapeId;

/// The effect of a transparent solid on a shadow ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Filter {
    pub(crate) id: ShapeId,
    /// Number of times that the ray crosses the surface of the solid.
    pub(crate) crossings: u32,
    /// Length of the ray inside the solid while it is the last entered one.
    pub(crate) length: f64,
}
