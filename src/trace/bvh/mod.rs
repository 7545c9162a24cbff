//! A tree of bounding boxes that says which shapes a ray may meet, and nothing else.
//!
//! The tree knows boxes, which of them hold spheres, and numbers of leaves, never shapes. It is only ever asked to leave out what a ray cannot
//! meet, and which boxes and spheres rays go through for certain: every rounding in it goes the cautious way, so that the picture does
//! not depend on it.
//!
//! - [`frame`]: the coordinates in which boxes are kept in `f32`, and rays in those coordinates.
//! - [`build`]: from boxes to a tree of nodes with eight children. [`morton`] finds neighbours, [`ploc`] makes a binary tree of
//!   them, and [`collapse`] pulls its levels together.
//! - [`refit`]: what is done instead where few shapes have moved.
//! - [`node`]: one node, eight boxes against one ray.
//! - [`traverse`]: from the root to the leaves, nearest first, with one ray.
//! - [`packet`]: the same with sixteen rays.
//! - [`frustum`]: the same with all rays from one point within some slopes, eight boxes at once; [`shaft`]: which of many bundles in
//!   it may meet a shape, and [`cover`] which of them all do; [`beam`]: the same of rays from a box; [`slopes`] and [`depth`]: what
//!   they are made of.

mod beam;
mod build;
mod collapse;
mod cover;
mod depth;
mod frame;
mod frustum;
mod index;
mod morton;
mod node;
mod packet;
mod ploc;
mod refit;
mod shaft;
mod slopes;
#[cfg(test)]
mod tests;
mod traverse;

pub(crate) use beam::Beam;
pub(crate) use build::Builder;
pub(crate) use depth::Depth;
pub(crate) use frustum::{FARTHEST, Frustum, FrustumVisitor, LeafBox};
pub(crate) use node::LeafId;
pub(crate) use packet::{FramePacket, PacketStack, PacketVisitor};
pub(crate) use refit::Refitter;
pub(crate) use shaft::{Limits, Shaft};
pub(crate) use slopes::{Ends, PACKETS, PARTS, SlopeRange, Slopes};
pub(crate) use traverse::Stack;

use frame::Frame;
use node::Node;

use crate::trace::shapes::Bounds;

/// Where a shape is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) bounds: Bounds,
    /// Whether it is a sphere that touches all sides of them.
    pub(crate) round: bool,
}

/// The tree over the shapes that have bounds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    frame: Frame,
    nodes: Vec<Node>,
}
