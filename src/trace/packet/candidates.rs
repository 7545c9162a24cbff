//! What may stand between a light and the surfaces of a tile: found for all of them at once, so that each shadow ray is asked
//! of few shapes.
//!
//! Seen from a light, shadow rays have their origin in common, too. A shadow ray itself starts at a surface point and goes in a
//! rounded direction, which passes the light by 2^-52 of the distance, and it is followed at most 2^-36 of the distance beyond:
//! both are far less than what a [shaft](crate::trace::bvh::Shaft) accepts beside it.

use std::sync::atomic::AtomicBool;

use fearless_simd::{dispatch, prelude::*};
use glam::DVec3;

use crate::trace::bvh::{Depth, Limits, PARTS, Planes, Shaft, ShaftVisitor, Slopes, Stack};
use crate::trace::query::Scratch;
use crate::trace::rays::{Limit, ShapeId};
use crate::trace::scene::PreparedScene;

/// More candidates than so are better found by each ray in the tree.
const MOST: usize = 12;

/// More shapes than so are not looked at: in a wide shaft there are many that matter to none of its parts.
const MOST_VISITS: usize = 128;

/// Fewer rays are not worth it.
const FEWEST: usize = 32;

/// The shapes of the tree that may hide a light, part by part; kept for its memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Candidates {
    parts: [Vec<ShapeId>; PARTS],
    /// Parts whose rays are to find them in the tree, as a bit mask.
    crowded: u32,
}

impl Candidates {
    /// Finds all shapes of the tree that may stand between a light and where rays to it start. Of each ray the part, the scaled
    /// direction and the limit are given; those near each other belong in one part. `false`, and nothing found,
    /// where they go too far apart, or are too few to be worth it.
    pub(crate) fn find(
        &mut self,
        scene: &PreparedScene,
        rays: impl Iterator<Item = (usize, DVec3, Limit)>,
        scratch: &mut Scratch<'_>,
    ) -> bool {
        let Some((shaft, limits)) = shaft(scene, rays) else { return false };
        self.parts.iter_mut().for_each(Vec::clear);
        self.crowded = 0;
        let Scratch { stack, cancelled, .. } = scratch;
        let search = (stack, *cancelled);
        dispatch!(scene.simd.level(), simd => gather(simd, scene, (&shaft, limits), self, search));
        true
    }

    /// Returns the shapes of the tree that the rays of a part have to be asked of; `None` where they have to find them
    /// themselves.
    #[inline]
    pub(crate) fn of(&self, part: usize) -> Option<&[ShapeId]> {
        (self.crowded & (1 << part) == 0).then_some(self.parts[part].as_slice())
    }
}

/// Makes a shaft from a light to where rays start, and how far it reaches, part by part.
fn shaft(
    scene: &PreparedScene,
    rays: impl Iterator<Item = (usize, DVec3, Limit)>,
) -> Option<(Shaft, Limits)> {
    let mut rays = rays.peekable();
    let (_, direction, limit) = *rays.peek()?;
    let (light, depth) = (limit.place(), Depth::along(-direction));
    let mut count = 0;
    let (mut slopes, mut farthest) = ([Slopes::NONE; PARTS], [f64::NEG_INFINITY; PARTS]);
    for (part, direction, limit) in rays {
        let (speed, across) = depth.slopes(-direction)?;
        slopes[part].add(across);
        farthest[part] = farthest[part].max(speed * limit.t());
        count += 1;
    }
    if count < FEWEST {
        return None;
    }
    let shaft = scene.tree.shaft(light, depth, &slopes)?;
    let limits = farthest.map(|depth| shaft.depth_limit(depth * scene.tree.scale()));
    Some((shaft, Limits(limits)))
}

#[inline(always)]
fn gather<S: Simd>(
    simd: S,
    scene: &PreparedScene,
    (shaft, limits): (&Shaft, Limits),
    candidates: &mut Candidates,
    (stack, cancelled): (&mut Stack, &AtomicBool),
) {
    let mut visitor = Visitor { shaft, candidates, limits, visits: 0 };
    let limit = visitor.limits.farthest(simd);
    scene.tree.visit_shaft(simd, shaft, limit, stack, cancelled, &mut visitor);
}

struct Visitor<'a> {
    shaft: &'a Shaft,
    candidates: &'a mut Candidates,
    limits: Limits,
    visits: usize,
}

impl<S: Simd> ShaftVisitor<S> for Visitor<'_> {
    #[inline(always)]
    fn visit(&mut self, simd: S, id: ShapeId, bounds: &Planes) -> f32 {
        self.visits += 1;
        if self.visits > MOST_VISITS {
            self.candidates.crowded = u32::MAX;
            return f32::NEG_INFINITY;
        }
        let mut parts = self.shaft.parts(simd, bounds, &self.limits);
        while parts != 0 {
            let part = parts.trailing_zeros() as usize % PARTS;
            parts &= parts - 1;
            if self.candidates.parts[part].len() < MOST {
                self.candidates.parts[part].push(id);
            } else {
                self.candidates.crowded |= 1 << part;
                self.limits.0[part] = f32::NEG_INFINITY;
            }
        }
        self.limits.farthest(simd)
    }
}
