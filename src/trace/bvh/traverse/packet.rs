//! Packets of sixteen rays, tested against boxes.
//!
//! A box's lower plane is measured from the upper end of a ray's origin, and its upper plane from the lower end, for either sign of the
//! direction: both make the ray enter earlier and leave later. A ray therefore enters at the smaller quotient and leaves at the larger one.
//!
//! A quotient is (plane - origin) / direction, computed as plane * inverse - origin * inverse, fused if the processor supports it. With
//! unit roundoff e = 2^-24, planes within -1..=1 and origins up to E, rounding the second product is equivalent to a shift of the origin by
//! e E, and rounding the first, if it is rounded separately, to a shift of the plane by e. Together they are less than 2^-23 (1 + E), by
//! which origins are widened in addition to the widening for [single rays](crate::trace::bvh::frame::Frame::ray). The remaining errors are the same as
//! for single rays: a rounded reciprocal and a rounded difference, for which far sides are lengthened.
//!
//! If all rays have the same direction sign along every axis, eight boxes at once are tested first against common bounds: every plane is at
//! least as far from a ray as from the outermost origin, and is approached at least as fast as by the slowest ray and at most as fast as by
//! the fastest one. Rays that end at one point have tighter bounds: the [frustum](super::frustum) from that point.

use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::{f32x8, f32x16, prelude::*};

use super::frustum::Frustum;
use crate::trace::bvh::Tree;
use crate::trace::bvh::frame::Frame;
use crate::trace::bvh::node::{Child, LeafId, Link, Node, WIDTH};
use crate::trace::math::{
    F64s, F64s3, LANES, Numbers, Vectors, bits8, bits16, lanes, mask16, splat, splat3, subtract, times,
};
use crate::trace::rays::RayPacket;

/// One `f32` per lane.
type Floats = [f32; LANES];

/// One value per axis and lane.
type AxisLanes = [Floats; 3];

/// Rays in the frame, for culling only, and their limits.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct FramePacket {
    inverse: AxisLanes,
    /// The lower ends of the origins times `inverse`, by axis; `high` holds the upper ends.
    low: AxisLanes,
    high: AxisLanes,
    limits: Floats,
    /// The largest limit.
    farthest: f32,
    /// Active lanes, as a bit mask.
    active: u32,
    /// The common bounds of all rays that were active at first.
    hull: Hull,
    scale: f64,
}

/// The common bounds of the rays of a packet.
#[derive(Clone, Copy, Debug)]
enum Hull {
    SharedBounds(SharedBounds),
    /// A frustum, up to a depth.
    Frustum(Frustum, f32),
    Unknown,
}

/// Bounds of rays with the same direction sign along every axis.
#[derive(Clone, Copy, Debug)]
struct SharedBounds {
    lowest: [f32; 3],
    highest: [f32; 3],
    /// The smallest and the largest reciprocal of the directions.
    inverse: [[f32; 2]; 3],
    downward: [bool; 3],
}

/// Traversal stack. Reused between packets to avoid allocations.
#[derive(Clone, Debug, Default)]
pub(crate) struct PacketStack(Vec<PendingPacket>);

/// A child that rays in some lanes may enter, the first of them at distance `entry`.
#[derive(Clone, Copy, Debug)]
struct PendingPacket {
    entry: f32,
    child: Child,
    lanes: u32,
}

/// Callback for every shape that rays of a packet may hit.
pub(crate) trait PacketVisitor<S: Simd> {
    /// True if nearer shapes should be visited first.
    const NEAREST_FIRST: bool;

    /// Visits a shape with the rays in some lanes, and updates the packet's active lanes and limits.
    fn visit(&mut self, simd: S, leaf: LeafId, lanes: u32, packet: &mut FramePacket);
}

impl FramePacket {
    /// Deactivates lanes.
    #[inline(always)]
    pub(crate) fn finish(&mut self, lanes: u32) {
        self.active &= !lanes;
    }

    /// Sets the limits of the rays to `ts` plus `errors`, rounded up.
    #[inline(always)]
    pub(crate) fn limit<S: Simd>(&mut self, simd: S, ts: &Numbers, errors: &Numbers) {
        /// Factor larger than the relative error of rounding to `f32`.
        const LONGER: f32 = 1.0 + 1.0 / 1_048_576.0;
        const LEAST: f32 = 1e-30;
        let scale = splat(simd, self.scale);
        let early = (ts.load(simd, 0) + errors.load(simd, 0)) * scale;
        let late = (ts.load(simd, 1) + errors.load(simd, 1)) * scale;
        let limits = early.narrow(late) * LONGER + LEAST;
        let endless = limits.simd_gt(f32x16::splat(simd, crate::trace::bvh::frame::nearest(Frame::ENDLESS)));
        let limits = endless.select(f32x16::splat(simd, f32::INFINITY), limits);
        limits.store_array(&mut self.limits);
        let none = f32x16::splat(simd, f32::NEG_INFINITY);
        self.farthest = mask16(simd, self.active).select(limits, none).reduce_max();
    }

    /// Returns the lanes, among the given ones, whose rays may enter a child, and the entry distance of every lane.
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
                Hull::SharedBounds(shared) if shared.downward[axis] => (at_upper, at_lower),
                Hull::SharedBounds(_) => (at_lower, at_upper),
                Hull::Frustum(..) | Hull::Unknown => (at_lower.min(at_upper), at_lower.max(at_upper)),
            };
            entry = entry.max(near);
            exit = exit.min(far);
        }
        (bits16(entry.simd_le(exit * Node::LENGTHEN)) & lanes, entry)
    }
}

impl SharedBounds {
    /// Computes the bounds of rays in some lanes from both ends of their origins and their reciprocals; `None` if their direction signs
    /// differ.
    #[inline(always)]
    fn of<S: Simd>(
        simd: S,
        active: u32,
        (low, high, inverses): (&AxisLanes, &AxisLanes, &AxisLanes),
    ) -> Option<Self> {
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

    /// Returns a bit mask of the node's children that a ray may enter before a limit, and lower bounds of the entry distances.
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
    /// Returns half of the origins in the frame, clamped to finite numbers: the difference of infinities is NaN, and a lane with NaN enters
    /// no box.
    #[inline(always)]
    fn places<S: Simd>(&self, simd: S, origins: &Vectors, half: usize) -> F64s3<S> {
        /// Larger than every `f32`.
        const FARTHEST: f64 = 1e300;
        let shifted = subtract(origins.load(simd, half), splat3(simd, self.origin()));
        let farthest = splat(simd, FARTHEST);
        let mut places = times(shifted, splat(simd, self.scale()));
        // Not `map`: lanes in its closure might not be inlined, and lose the processor's instructions.
        for place in &mut places {
            *place = place.min(farthest).max(-farthest);
        }
        places
    }
}

/// Returns the distances by which origins are widened.
#[inline(always)]
fn slack<S: Simd>([x, y, z]: F64s3<S>) -> F64s<S> {
    /// 2^-23 more than for single rays.
    const SLACK: f64 = 1.5 * Frame::SLACK;
    (x.abs().max(y.abs()).max(z.abs()) + 1.0) * SLACK
}

/// Returns the reciprocals of one direction component for half of the rays.
#[inline(always)]
fn inverse<S: Simd>(simd: S, directions: &Numbers, half: usize) -> F64s<S> {
    /// Minimum magnitude of a direction component. Slower rays are tested at this speed: they enter boxes earlier than they should, and
    /// leave none too early.
    const SLOWEST: f64 = 1e-30;
    let direction = directions.load(simd, half);
    let slowest = splat(simd, SLOWEST).copysign(direction);
    let slow = direction.abs().simd_lt(splat(simd, SLOWEST));
    splat(simd, 1.0) / slow.select(slowest, direction)
}

impl Tree {
    /// Prepares rays in some lanes for culling. `frustum`, if known, bounds them up to a depth.
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
                None => SharedBounds::of(simd, active, (&low, &high, &inverses))
                    .map_or(Hull::Unknown, Hull::SharedBounds),
            },
            scale: self.frame.scale(),
        }
    }

    /// Visits every shape that rays of a packet may hit before their limits, nearer ones first if [`PacketVisitor::NEAREST_FIRST`]. Stops
    /// once `cancelled` is true.
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
                let Some(PendingPacket { entry, child, lanes }) = stack.pop() else { return };
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

/// Pushes a node's children that any ray may enter onto the stack, the farthest first if [`PacketVisitor::NEAREST_FIRST`].
#[inline(always)]
fn push_children<S: Simd, V: PacketVisitor<S>>(
    simd: S,
    node: &Node,
    packet: &FramePacket,
    stack: &mut Vec<PendingPacket>,
) {
    let (candidates, entries) = match &packet.hull {
        Hull::SharedBounds(shared) => shared.entries(simd, node, packet.farthest),
        Hull::Frustum(frustum, depth) => frustum.intersect(simd, node, *depth),
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
        } else if matches!(packet.hull, Hull::SharedBounds(_)) {
            entries[index]
        } else {
            let never = f32x16::splat(simd, f32::INFINITY);
            mask16(simd, lanes).select(lane_entries, never).reduce_min()
        };
        let mut place = stack.len();
        stack.push(PendingPacket { entry, child: node.children[index], lanes });
        while V::NEAREST_FIRST && place > base && stack[place - 1].entry < entry {
            stack.swap(place - 1, place);
            place -= 1;
        }
    }
}
