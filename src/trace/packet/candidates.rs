//! What may stand between a light and the surfaces of a tile: found for all of them at once, so that each shadow ray is asked
//! of few shapes.
//!
//! Seen from a light, shadow rays have their origin in common, too. A shadow ray itself starts at a surface point and goes in a
//! rounded direction, which passes the light by 2^-52 of the distance, and it is followed at most 2^-36 of the distance beyond:
//! both are far less than what a [shaft](crate::trace::bvh::Shaft) accepts beside it, up to a distance.

use std::sync::atomic::AtomicBool;

use fearless_simd::{dispatch, prelude::*};
use glam::DVec3;

use crate::trace::bvh::{
    Depth, FARTHEST, FrustumVisitor, LeafBox, LeafId, Limits, PARTS, Shaft, SlopeRange, Slopes, Stack,
};
use crate::trace::math::{Numbers, Vectors, half_of, set_bits};
use crate::trace::query::Scratch;
use crate::trace::scene::PreparedScene;

/// More candidates than so are better found in the tree.
const MOST: usize = 12;

/// More shapes than so are not looked at: in a wide shaft there are many that matter to none of its parts.
const MOST_VISITS: usize = 128;

/// Fewer rays are not worth it.
const FEWEST: u32 = 32;

/// The shapes of the tree that may hide a light, half packet by half packet; kept for its memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Candidates {
    parts: [Vec<LeafId>; PARTS],
    /// Halves whose rays are to find them in the tree, as a bit mask.
    crowded: u32,
}

/// Where a light lies from the points of a packet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WaysToLight<'a> {
    pub(crate) directions: &'a Vectors,
    /// How many times as far the light is.
    pub(crate) limits: &'a Numbers,
    /// The lanes that ask.
    pub(crate) lanes: u32,
}

impl Candidates {
    /// Finds all shapes of the tree that may stand between a light and the points of packets. `false`, and nothing found, where
    /// they lie too far apart, or are too few to be worth it.
    pub(crate) fn find<'a>(
        &mut self,
        scene: &PreparedScene,
        light: DVec3,
        packets: impl Iterator<Item = WaysToLight<'a>> + Clone,
        scratch: &mut Scratch<'_>,
    ) -> bool {
        if packets.clone().map(|ways| ways.lanes.count_ones()).sum::<u32>() < FEWEST {
            return false;
        }
        self.parts.iter_mut().for_each(Vec::clear);
        self.crowded = 0;
        let Scratch { stack, cancelled, .. } = scratch;
        let search = (stack, *cancelled);
        dispatch!(scene.simd.level(), simd => gather(simd, scene, light, packets, self, search))
    }

    /// Returns whether there were too many shapes for all halves.
    pub(crate) fn all_crowded(&self) -> bool {
        self.crowded == u32::MAX
    }

    /// Returns the shapes of the tree that the rays of half of a packet have to be asked of; `None` where they have to find them
    /// themselves.
    #[inline]
    pub(crate) fn of(&self, packet: usize, half: usize) -> Option<&[LeafId]> {
        let part = packet * 2 + half;
        (self.crowded & (1 << part) == 0).then_some(self.parts[part].as_slice())
    }
}

#[inline(always)]
fn gather<'a, S: Simd>(
    simd: S,
    scene: &PreparedScene,
    light: DVec3,
    packets: impl Iterator<Item = WaysToLight<'a>> + Clone,
    candidates: &mut Candidates,
    (stack, cancelled): (&mut Stack, &AtomicBool),
) -> bool {
    let Some(first) = packets.clone().find(|ways| ways.lanes != 0) else { return false };
    // From the light to the points.
    let depth = Depth::along(-first.directions.get(first.lanes.trailing_zeros() as usize));
    let (mut slopes, mut farthest) = (Slopes::NONE, [f64::NEG_INFINITY; PARTS]);
    for (packet, ways) in packets.enumerate() {
        for half in 0..2 {
            if half_of(ways.lanes, half) == 0 {
                continue;
            }
            let back = (ways.directions, ways.lanes, half);
            let Some(range) = SlopeRange::of(simd, back, (depth, -1.0)) else { return false };
            slopes.set(packet * 2 + half, &range);
            farthest[packet * 2 + half] = depth.farthest(simd, back, (ways.limits.load(simd, half), -1.0));
        }
    }
    let Some(shaft) = scene.tree.shaft(simd, light, depth, &slopes) else { return false };
    if farthest.iter().any(|depth| depth * scene.tree.scale() > FARTHEST) {
        return false;
    }
    let mut limits = Limits::NONE;
    for (part, depth) in farthest.iter().enumerate() {
        limits.set(part, shaft.frustum.depth_limit(depth * scene.tree.scale()));
    }
    let farthest = limits.farthest(simd);
    let mut visitor = Visitor { shaft: &shaft, candidates, limits, farthest, visits: 0 };
    scene.tree.visit_frustum(simd, &shaft.frustum, farthest, stack, cancelled, &mut visitor);
    true
}

struct Visitor<'a> {
    shaft: &'a Shaft,
    candidates: &'a mut Candidates,
    limits: Limits,
    farthest: f32,
    visits: usize,
}

impl<S: Simd> FrustumVisitor<S> for Visitor<'_> {
    #[inline(always)]
    fn visit(&mut self, simd: S, leaf: LeafId, bounds: &LeafBox) -> f32 {
        self.visits += 1;
        if self.visits > MOST_VISITS {
            self.candidates.crowded = u32::MAX;
            return f32::NEG_INFINITY;
        }
        for part in set_bits(self.shaft.parts(simd, bounds, &self.limits)) {
            if self.candidates.parts[part].len() < MOST {
                self.candidates.parts[part].push(leaf);
            } else {
                self.candidates.crowded |= 1 << part;
                self.limits.set(part, f32::NEG_INFINITY);
                self.farthest = self.limits.farthest(simd);
            }
        }
        self.farthest
    }
}
