//! A bounding volume hierarchy that finds the shapes that a ray may hit, and nothing else.
//!
//! The tree stores boxes, a flag for each that holds a sphere, and leaf indices, but no shapes. It only culls shapes that a ray cannot hit,
//! and finds boxes and spheres that rays certainly pass through. All rounding is conservative, so that the picture does not depend on the
//! tree.
//!
//! - [`frame`]: the coordinate frame in which boxes are stored in `f32`, and the transformation of rays to it.
//! - [`build`]: builds a tree of nodes with eight children from boxes. [`morton`] sorts neighbours together, [`ploc`] clusters them into a
//!   binary tree, and [`collapse`] merges its levels.
//! - [`refit`]: updates the boxes instead of rebuilding the tree if few shapes have moved.
//! - [`node`]: a node, which tests eight boxes against one ray.
//! - [`traverse`]: traversal with one ray from the root to the leaves, nearest first.
//! - [`packet`]: traversal with sixteen rays.
//! - [`frustum`]: traversal with all rays from one point whose slopes lie in a range, eight boxes at once. [`beam`] finds the parts of a
//!   bundle, between a point or a box and points, that may hit a shape before their [`limits`], and [`cover`] the parts whose rays all hit it.
//!   [`slopes`] and [`depth`] compute the data that they share.

mod beam;
mod build;
mod collapse;
mod cover;
mod depth;
mod frame;
mod frustum;
mod index;
mod limits;
mod morton;
mod node;
mod packet;
mod ploc;
mod refit;
mod slopes;
#[cfg(test)]
mod tests;
mod traverse;

pub(crate) use beam::{Beam, Shaft};
pub(crate) use build::Builder;
pub(crate) use depth::Depth;
pub(crate) use frustum::{FARTHEST, Frustum, FrustumVisitor, LeafBox};
pub(crate) use limits::Limits;
pub(crate) use node::LeafId;
pub(crate) use packet::{FramePacket, PacketStack, PacketVisitor};
pub(crate) use refit::Refitter;
pub(crate) use slopes::{Ends, PACKETS, PARTS, SlopeRange, Slopes};
pub(crate) use traverse::Stack;

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
