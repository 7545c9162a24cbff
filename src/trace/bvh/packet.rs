//! Sixteen rays against boxes.
//!
//! A box's lower plane is measured from the upper end of a ray's origin, and its upper plane from the lower end, whichever way the
//! ray goes: both let it enter earlier and leave later. So a ray enters at the smaller quotient and leaves at the larger one.
//!
//! A quotient is (plane - origin) / speed, and computed as plane * inverse - origin * inverse, fused where the processor can. With
//! the unit roundoff e of 2^-24, planes within -1..=1 and origins up to E, rounding the second product does what a shift of the
//! origin by e E would do, and rounding the first, where it is rounded for itself, what a shift of the plane by e would do. That is
//! less than 2^-23 (1 + E), by which origins are widened in addition to what [single rays](super::frame::Frame::ray) are. What
//! is left is as it is there: a rounded reciprocal and a rounded difference, for which far sides are lengthened.
//!
//! Where all rays go the same way along every axis, eight boxes are asked at once first: their planes lie at least as far from the
//! outermost origin, and are come closer to with at least the slowest and at most the fastest ray. Of rays that end at one point it
//! is known better where they are: within the [frustum](super::frustum) from there.

use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::{f32x8, f32x16, prelude::*};

use super::Tree;
use super::frame::Frame;
use super::frustum::Frustum;
use super::node::{Child, LeafId, Link, Node, WIDTH};
use crate::trace::math::{
    F64s, F64s3, LANES, Numbers, Vectors, bits8, bits16, lanes, mask16, splat, splat3, subtract, times,
};
use crate::trace::rays::RayPacket;

/// An `f32` of every lane.
type Floats = [f32; LANES];

/// One of every axis.
type Ends = [Floats; 3];

/// Rays in the frame, for culling only, and how far they are followed.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct FramePacket {
    inverse: Ends,
    /// The ends of the origins times that, by axis.
    low: Ends,
    high: Ends,
    limits: Floats,
    /// The largest of the limits.
    farthest: f32,
    /// Lanes that still look for something.
    active: u32,
    /// For all rays that were in it at first.
    hull: Hull,
    scale: f64,
}

/// What all rays stay within.
#[derive(Clone, Copy, Debug)]
enum Hull {
    Shared(Shared),
    /// A frustum, up to a depth.
    Frustum(Frustum, f32),
    Unknown,
}

/// What rays have in common that go the same way along every axis.
#[derive(Clone, Copy, Debug)]
struct Shared {
    lowest: [f32; 3],
    highest: [f32; 3],
    /// The smallest and the largest reciprocal.
    inverse: [[f32; 2]; 3],
    downward: [bool; 3],
}

/// Nodes and shapes still to be visited; kept between rays so that none allocates.
#[derive(Clone, Debug, Default)]
pub(crate) struct PacketStack(Vec<Pending>);

/// A child that rays in some lanes may enter, the first of them here.
#[derive(Clone, Copy, Debug)]
struct Pending {
    entry: f32,
    child: Child,
    lanes: u32,
}

/// What is asked of every shape that rays of a packet may meet.
pub(crate) trait PacketVisitor<S: Simd> {
    /// Whether nearer shapes are better visited first.
    const NEAREST_FIRST: bool;

    /// Visits a shape with the rays in some lanes, and updates what is still of interest.
    fn visit(&mut self, simd: S, leaf: LeafId, lanes: u32, packet: &mut FramePacket);
}

impl FramePacket {
    /// Lets lanes look no further.
    #[inline(always)]
    pub(crate) fn finish(&mut self, lanes: u32) {
        self.active &= !lanes;
    }

    /// Follows rays no further than so.
    #[inline(always)]
    pub(crate) fn limit<S: Simd>(&mut self, simd: S, ts: &Numbers, errors: &Numbers) {
        /// More than rounding to `f32` may take away.
        const LONGER: f32 = 1.0 + 1.0 / 1_048_576.0;
        const LEAST: f32 = 1e-30;
        let scale = splat(simd, self.scale);
        let early = (ts.load(simd, 0) + errors.load(simd, 0)) * scale;
        let late = (ts.load(simd, 1) + errors.load(simd, 1)) * scale;
        let limits = early.narrow(late) * LONGER + LEAST;
        let endless = limits.simd_gt(f32x16::splat(simd, super::frame::nearest(Frame::ENDLESS)));
        let limits = endless.select(f32x16::splat(simd, f32::INFINITY), limits);
        limits.store_array(&mut self.limits);
        let none = f32x16::splat(simd, f32::NEG_INFINITY);
        self.farthest = mask16(simd, self.active).select(limits, none).reduce_max();
    }

    /// Returns which of some lanes may enter a child, and the first place where one does.
    #[inline(always)]
    fn enters<S: Simd>(&self, simd: S, planes: &[f32; 6], lanes: u32) -> (u32, f32x16<S>) {
        let load = |floats: &Floats| f32x16::load_array_ref(simd, floats);
        let mut entry = f32x16::splat(simd, 0.0);
        let mut exit = load(&self.limits);
        for axis in 0..3 {
            let inverse = load(&self.inverse[axis]);
            let at_lower = inverse.mul_sub(planes[axis], load(&self.high[axis]));
            let at_upper = inverse.mul_sub(planes[axis + 3], load(&self.low[axis]));
            let (near, far) = match &self.hull {
                Hull::Shared(shared) if shared.downward[axis] => (at_upper, at_lower),
                Hull::Shared(_) => (at_lower, at_upper),
                Hull::Frustum(..) | Hull::Unknown => (at_lower.min(at_upper), at_lower.max(at_upper)),
            };
            entry = entry.max(near);
            exit = exit.min(far);
        }
        (bits16(entry.simd_le(exit * Node::LENGTHEN)) & lanes, entry)
    }
}

impl Shared {
    /// Of rays in some lanes, by the ends of their origins, and their reciprocals.
    #[inline(always)]
    fn of<S: Simd>(simd: S, active: u32, (low, high, inverses): (&Ends, &Ends, &Ends)) -> Option<Self> {
        let mask = mask16(simd, active);
        let load = |floats: &Floats| f32x16::load_array_ref(simd, floats);
        let least =
            |floats: &Floats| mask.select(load(floats), f32x16::splat(simd, f32::INFINITY)).reduce_min();
        let most =
            |floats: &Floats| mask.select(load(floats), f32x16::splat(simd, f32::NEG_INFINITY)).reduce_max();
        let [mut lowest, mut highest] = [[0.0; 3]; 2];
        let (mut inverse, mut downward) = ([[0.0; 2]; 3], [false; 3]);
        for axis in 0..3 {
            (lowest[axis], highest[axis]) = (least(&low[axis]), most(&high[axis]));
            inverse[axis] = [least(&inverses[axis]), most(&inverses[axis])];
            downward[axis] = inverse[axis][1] < 0.0;
            if !downward[axis] && inverse[axis][0] < 0.0 {
                return None;
            }
        }
        Some(Self { lowest, highest, inverse, downward })
    }

    /// Returns which of a node's children a ray may enter before a limit, and no ray enters them before which places.
    #[inline(always)]
    fn entries<S: Simd>(&self, simd: S, node: &Node, limit: f32) -> (u32, f32x8<S>) {
        let splat = |number: f32| f32x8::splat(simd, number);
        let mut entry = splat(0.0);
        let mut exit = splat(limit);
        for axis in 0..3 {
            let lower = node.plane(simd, axis) - splat(self.highest[axis]);
            let upper = node.plane(simd, axis + 3) - splat(self.lowest[axis]);
            let (near, far) = if self.downward[axis] { (upper, lower) } else { (lower, upper) };
            let [slow, fast] = [splat(self.inverse[axis][0]), splat(self.inverse[axis][1])];
            entry = entry.max((near * slow).min(near * fast));
            exit = exit.min((far * slow).max(far * fast));
        }
        (node.used() & bits8(entry.simd_le(exit * Node::LENGTHEN)), entry)
    }
}

impl Frame {
    /// Half of the origins, clamped to finite numbers: the difference of infinities is NaN, and a lane with NaN enters no box.
    #[inline(always)]
    fn places<S: Simd>(&self, simd: S, origins: &Vectors, half: usize) -> F64s3<S> {
        /// Beyond all `f32`.
        const FARTHEST: f64 = 1e300;
        let shifted = subtract(origins.load(simd, half), splat3(simd, self.origin()));
        let farthest = splat(simd, FARTHEST);
        times(shifted, splat(simd, self.scale())).map(|place| place.min(farthest).max(-farthest))
    }
}

/// How far origins are widened.
#[inline(always)]
fn slack<S: Simd>([x, y, z]: F64s3<S>) -> F64s<S> {
    /// 2^-23 more.
    const SLACK: f64 = 1.5 * Frame::SLACK;
    (x.abs().max(y.abs()).max(z.abs()) + 1.0) * SLACK
}

/// Half of the reciprocals of one coordinate.
#[inline(always)]
fn inverse<S: Simd>(simd: S, directions: &Numbers, half: usize) -> F64s<S> {
    /// Slower than so a ray does not go: what it would enter later is entered, and there is nothing that it leaves before.
    const SLOWEST: f64 = 1e-30;
    let direction = directions.load(simd, half);
    let slowest = splat(simd, SLOWEST).copysign(direction);
    let slow = direction.abs().simd_lt(splat(simd, SLOWEST));
    splat(simd, 1.0) / slow.select(slowest, direction)
}

impl Tree {
    /// Makes rays in some lanes ready for culling. They may be known to stay within a frustum, up to a depth.
    #[inline(always)]
    pub(crate) fn packet<S: Simd>(
        &self,
        simd: S,
        rays: &RayPacket,
        active: u32,
        frustum: Option<(Frustum, f32)>,
    ) -> FramePacket {
        let [mut low, mut high, mut inverses] = [[[0.0; LANES]; 3]; 3];
        let [mut low_products, mut high_products] = [[[0.0; LANES]; 3]; 2];
        let places = [self.frame.places(simd, &rays.origins, 0), self.frame.places(simd, &rays.origins, 1)];
        let slacks = [slack(places[0]), slack(places[1])];
        for axis in 0..3 {
            let below = (places[0][axis] - slacks[0]).narrow(places[1][axis] - slacks[1]);
            let above = (places[0][axis] + slacks[0]).narrow(places[1][axis] + slacks[1]);
            let direction = rays.directions.axis(axis);
            let inverse = inverse(simd, direction, 0).narrow(inverse(simd, direction, 1));
            below.store_array(&mut low[axis]);
            above.store_array(&mut high[axis]);
            inverse.store_array(&mut inverses[axis]);
            (below * inverse).store_array(&mut low_products[axis]);
            (above * inverse).store_array(&mut high_products[axis]);
        }
        FramePacket {
            inverse: inverses,
            low: low_products,
            high: high_products,
            limits: [f32::INFINITY; LANES],
            farthest: f32::INFINITY,
            active,
            hull: match frustum {
                Some((frustum, depth)) => Hull::Frustum(frustum, depth),
                None => {
                    Shared::of(simd, active, (&low, &high, &inverses)).map_or(Hull::Unknown, Hull::Shared)
                }
            },
            scale: self.frame.scale(),
        }
    }

    /// Visits every shape that rays of a packet may meet before their limits, nearer ones first. Once `cancelled` is true the rest is
    /// left out.
    #[inline(always)]
    pub(crate) fn visit_packet<S: Simd, V: PacketVisitor<S>>(
        &self,
        simd: S,
        packet: &mut FramePacket,
        stack: &mut PacketStack,
        cancelled: &AtomicBool,
        visitor: &mut V,
    ) {
        let stack = &mut stack.0;
        stack.clear();
        let Some(mut node) = self.nodes.first() else { return };
        loop {
            push_children::<S, V>(simd, node, packet, stack);
            loop {
                let Some(Pending { entry, child, lanes }) = stack.pop() else { return };
                if entry > packet.farthest * Node::LENGTHEN || lanes & packet.active == 0 {
                    continue;
                }
                match child.read() {
                    Link::Node(index) => {
                        node = &self.nodes[index];
                        break;
                    }
                    Link::Leaf(_) if cancelled.load(Ordering::Relaxed) => return,
                    Link::Leaf(leaf) => visitor.visit(simd, leaf, lanes & packet.active, packet),
                }
                if packet.active == 0 {
                    return;
                }
            }
        }
    }
}

/// Puts a node's children that any ray may enter onto the stack, the farthest first where that matters.
#[inline(always)]
fn push_children<S: Simd, V: PacketVisitor<S>>(
    simd: S,
    node: &Node,
    packet: &FramePacket,
    stack: &mut Vec<Pending>,
) {
    let (candidates, entries) = match &packet.hull {
        Hull::Shared(shared) => shared.entries(simd, node, packet.farthest),
        Hull::Frustum(frustum, depth) => frustum.meets(simd, node, *depth),
        Hull::Unknown => (node.used(), f32x8::splat(simd, 0.0)),
    };
    let entries = *entries.as_array();
    let base = stack.len();
    for index in lanes(candidates) {
        let index = index % WIDTH;
        let (lanes, lane_entries) = packet.enters(simd, &node.bounds(index), packet.active);
        if lanes == 0 {
            continue;
        }
        let entry = if !V::NEAREST_FIRST {
            0.0
        } else if matches!(packet.hull, Hull::Shared(_)) {
            entries[index]
        } else {
            let never = f32x16::splat(simd, f32::INFINITY);
            mask16(simd, lanes).select(lane_entries, never).reduce_min()
        };
        let mut place = stack.len();
        stack.push(Pending { entry, child: node.children[index], lanes });
        while V::NEAREST_FIRST && place > base && stack[place - 1].entry < entry {
            stack.swap(place - 1, place);
            place -= 1;
        }
    }
}
