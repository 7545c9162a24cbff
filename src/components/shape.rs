//! Shapes.

use glam::DVec3;

/// A shape in its entity's own space. The world transform may be any invertible affine map, so that a sphere may become
/// an ellipsoid and a box may be turned or sheared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A sphere about the origin.
    Sphere {
        /// Scene units, greater than 0.
        radius: f64,
    },
    /// An infinite plane through the origin.
    Plane {
        /// Perpendicular to the plane; any length but zero.
        normal: DVec3,
    },
    /// A box about the origin, along the own axes.
    Box {
        /// Full edge lengths, scene units, greater than 0.
        size: DVec3,
    },
}
