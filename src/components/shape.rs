//! Shapes.

use glam::DVec3;

/// A shape in its entity's own space. The world transform may be any invertible affine map, so that a sphere can become an ellipsoid, and a
/// box can be rotated or sheared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A sphere about the origin.
    Sphere {
        /// The radius in scene units, greater than 0.
        radius: f64,
    },
    /// An infinite plane through the origin.
    Plane {
        /// The normal of the plane; any nonzero length.
        normal: DVec3,
    },
    /// A box about the origin, aligned with the entity's own axes.
    Box {
        /// The full edge lengths in scene units, greater than 0.
        size: DVec3,
    },
    /// A solid cylinder with flat ends: the points within `radius` of an axis.
    Cylinder {
        /// The radius in scene units, greater than 0.
        radius: f64,
        /// The centre of one end.
        from: DVec3,
        /// The centre of the other end.
        to: DVec3,
    },
    /// A solid capsule, with round ends: the points within `radius` of the segment between two points.
    Capsule {
        /// The radius in scene units, greater than 0.
        radius: f64,
        /// One end of the segment.
        from: DVec3,
        /// The other end of the segment.
        to: DVec3,
    },
}
