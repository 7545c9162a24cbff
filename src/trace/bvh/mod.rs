//! A bounding volume hierarchy that finds the shapes that a ray may hit, and nothing else.
//!
//! The tree stores boxes, a flag for each that holds a sphere, and leaf indices, but no shapes. It only culls shapes that a ray cannot hit,
//! and finds boxes and spheres that rays certainly pass through. All rounding is conservative, so that the picture does not depend on the
//! tree.
//!
//! - [`frame`]: the coordinate frame in which boxes are stored in `f32`, and the transformation of rays to it.
//! - [`node`]: a node, which tests eight boxes against one ray.
//! - [`build`]: builds a tree of nodes with eight children from boxes, and updates its boxes if few shapes have moved.
//! - [`traverse`]: traversal with one ray, with packets, and with bundles of rays.

mod build;
mod frame;
mod node;
#[cfg(test)]
mod tests;
mod traverse;

pub(crate) use build::{Builder, Refitter};
pub(crate) use node::LeafId;
pub(crate) use traverse::{
    Beam, Depth, Ends, FARTHEST, FramePacket, Frustum, FrustumVisitor, LeafBox, Limits, PACKETS, PARTS,
    PacketStack, PacketVisitor, Shaft, SlopeRange, Slopes, Stack,
};

use frame::Frame;
use node::Node;

use crate::trace::shapes::Bounds;

/// The bounds of a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) bounds: Bounds,
    /// True if the shape is a sphere that touches all sides of its bounds.
    pub(crate) round: bool,
}

/// The tree over the shapes that have bounds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    frame: Frame,
    nodes: Vec<Node>,
}
