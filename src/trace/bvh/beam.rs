//! Bundles of rays between a box and points, tested against shapes: from surfaces to an area light, or through a lens.
//!
//! A part of a bundle is half a packet. Let w be the axis of depth, measured from the centre of the box towards the points, and u an axis
//! across it. The rays of a part lie in the convex hull of the box and of the bounds of the part's points, and therefore below every line
//! u = a + b s that is above both boxes. The line used touches both boxes: at their near ends if it rises, at their far ends otherwise. For
//! a box that is a single point, these lines are the sides of a [shaft](super::shaft) with slopes b; a is the contribution of the box's
//! size.
//!
//! # Rounding errors
//!
//! Everything is computed in `f32` in the tree's frame, as for a [frustum](super::frustum). Lines are rounded outwards by more than the
//! error of their computation. With the box's size added to E, and S the slope of the steepest line, the remaining error is less than half
//! of the 16 e (1 + E)(1 + S) within which missed shapes are still accepted.

use fearless_simd::{f32x16, mask32x16, prelude::*};
use glam::DVec3;

use super::depth::Depth;
use super::frustum::{FARTHEST, Frustum, LeafBox, SLACK};
use super::shaft::{Limits, ball};
use super::slopes::{GROUPS, PartNumbers, Places, STEEPEST, wider};
use super::{Tree, frame};
use crate::trace::math::{LANES, Vectors, bits16};

/// A bundle of rays between a box and points.
#[derive(Clone, Debug)]
pub(crate) struct Beam {
    /// The frustum around all rays.
    pub(crate) frustum: Frustum,
    /// Half-extent of the box along the depth axis.
    ahead: f32,
    slack: f32,
    /// The lines that bound the rays from below, along the two axes across; `high` holds the lines above.
    low: [Lines; 2],
    high: [Lines; 2],
}

/// By part, the line u = start + slope s, and sqrt(1 + slope^2).
#[derive(Clone, Copy, Debug)]
struct Lines {
    starts: PartNumbers,
    slopes: PartNumbers,
    roots: PartNumbers,
}

impl Tree {
    /// Creates the beam between a box, given by its centre and half-extents, and the points of packets in some lanes. Also returns the
    /// depth up to which each part extends. `None` if points are too near to the box, too far from it or too far apart.
    #[inline(always)]
    pub(crate) fn beam<'a, S: Simd>(
        &self,
        simd: S,
        (middle, reach): (DVec3, DVec3),
        packets: impl Iterator<Item = (&'a Vectors, u32)> + Clone,
    ) -> Option<(Beam, Limits)> {
        let (points, lanes) = packets.clone().find(|(_, lanes)| *lanes != 0)?;
        let depth = Depth::along(points.get(lanes.trailing_zeros() as usize) - middle);
        let scale = self.scale();
        let places = Places::of(simd, (middle, scale), depth, packets)?;
        let reach = (reach * scale).to_array().map(frame::above);
        let [ahead, beside @ ..] = depth.axes().map(|axis| reach[axis]);
        let range = places.slopes(simd, ahead)?;
        if f64::from(places.deepest(simd)) > FARTHEST {
            return None;
        }
        let mut beam = Beam {
            frustum: self.frustum(middle, depth, &range)?,
            ahead,
            slack: 0.0,
            low: [Lines::NONE; 2],
            high: [Lines::NONE; 2],
        };
        let mut steepest = range.steepest();
        for (side, beside) in beside.into_iter().enumerate() {
            let size = (ahead, beside);
            steepest = steepest.max(beam.high[side].draw(simd, &places, (side, 1.0), size));
            steepest = steepest.max(beam.low[side].draw(simd, &places, (side, -1.0), size));
        }
        let size = reach.into_iter().fold(0.0, f32::max);
        let extent =
            beam.frustum.origin.into_iter().fold(size, |extent, place| extent.max(place.abs() + size));
        beam.slack = frame::above(SLACK * (1.0 + f64::from(extent)) * (1.0 + f64::from(steepest)));
        // Rays deviate from the rays of the box's centre by at most the box's size, along the depth too.
        beam.frustum.slack += size * (1.0 + range.steepest()) * (1.0 + 4.0 * f32::EPSILON);
        let limits = Limits::around(simd, &places.high[0], beam.slack);
        (steepest <= STEEPEST).then_some((beam, limits))
    }
}

impl Tree {
    /// Returns the dominant axis of a direction, and the signed distance along it from a point beyond which there are no shapes.
    pub(crate) fn beyond(&self, place: DVec3, direction: DVec3) -> (usize, f64) {
        let axis = direction.abs().max_position();
        let from = (place - self.frame.origin())[axis] * self.scale();
        // All shapes lie within -1..=1, except for rounding.
        let far = (from.abs() + 1.0) * (1.0 + SLACK) / self.scale();
        (axis, far.copysign(direction[axis]))
    }
}

impl Lines {
    const NONE: Self = Self {
        starts: [[0.0; LANES]; GROUPS],
        slopes: [[0.0; LANES]; GROUPS],
        roots: [[0.0; LANES]; GROUPS],
    };

    /// Computes the lines above the box, of half-extents `ahead` and `beside`, and above the parts' bounds, along one of the axes across;
    /// the lines below them if the sense is -1. Returns the steepest slope of the parts that have points.
    #[inline(always)]
    fn draw<S: Simd>(
        &mut self,
        simd: S,
        places: &Places,
        (side, sense): (usize, f32),
        (ahead, beside): (f32, f32),
    ) -> f32 {
        let (zero, mut steepest) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 0.0));
        for group in 0..GROUPS {
            let load = |numbers: &PartNumbers| f32x16::load_array_ref(simd, &numbers[group]);
            let (near, far) = (load(&places.low[0]), load(&places.high[0]));
            let most = if sense > 0.0 { load(&places.high[side + 1]) } else { -load(&places.low[side + 1]) };
            let rise = most - beside;
            let slope = rise / rise.simd_gt(zero).select(near + ahead, far - ahead);
            let start = slope.abs() * ahead + beside;
            let (slope, start) = (slope + wider(slope) * 4.0, start + wider(start) * 4.0);
            steepest = near.simd_le(far).select(slope.abs(), zero).max(steepest);
            (start * sense).store_array(&mut self.starts[group]);
            (slope * sense).store_array(&mut self.slopes[group]);
            (slope * slope + 1.0).sqrt().store_array(&mut self.roots[group]);
        }
        steepest.reduce_max()
    }
}

impl Beam {
    pub(crate) fn depth(&self) -> Depth {
        self.frustum.depth
    }

    /// Returns the depth up to which boxes are of interest to rays that start on the box and extend no farther than `farthest`.
    pub(crate) fn depth_limit(&self, farthest: f64) -> f32 {
        frame::above(farthest + f64::from(self.ahead) + f64::from(self.slack))
    }

    /// Returns a lower bound of the depth at which a shape begins.
    pub(crate) fn nearest(&self, bounds: &LeafBox) -> f32 {
        let Frustum { depth, origin, .. } = &self.frustum;
        let [near, _] = depth.near_and_far();
        let near = bounds.planes[near] - origin[depth.axes()[0]];
        if depth.upwards { near - self.slack } else { -near - self.slack }
    }

    /// Returns a bit mask of the parts whose rays may hit a shape before their limits.
    #[inline(always)]
    pub(crate) fn parts<S: Simd>(&self, simd: S, bounds: &LeafBox, limits: &Limits) -> u32 {
        let mut parts = 0;
        for group in 0..GROUPS {
            let met = if bounds.round {
                self.sphere_parts(simd, &bounds.planes, limits, group)
            } else {
                self.box_parts(simd, &bounds.planes, limits, group)
            };
            parts |= bits16(met) << (group * LANES);
        }
        parts
    }

    #[inline(always)]
    fn box_parts<S: Simd>(&self, simd: S, planes: &[f32; 6], limits: &Limits, group: usize) -> mask32x16<S> {
        let splat = |number: f32| f32x16::splat(simd, number);
        let load = |numbers: &PartNumbers| f32x16::load_array_ref(simd, &numbers[group]);
        let Frustum { depth, origin, .. } = &self.frustum;
        let [w, u, v] = depth.axes();
        let [near, far] = depth.near_and_far();
        let (near, far) = (planes[near] - origin[w], planes[far] - origin[w]);
        let (near, far) = if depth.upwards { (near, far) } else { (-near, -far) };
        let (near, far) = (splat(near.max(-self.ahead - self.slack)), splat(far));
        let mut met = near.simd_le(limits.load(simd, group));
        for (side, across) in [u, v].into_iter().enumerate() {
            let lower = planes[across] - origin[across] - self.slack;
            let upper = planes[across + 3] - origin[across] + self.slack;
            let (low, high) = (&self.low[side], &self.high[side]);
            let (start, slope) = (load(&high.starts), load(&high.slopes));
            met &= splat(lower).simd_le((slope * near).max(slope * far) + start);
            let (start, slope) = (load(&low.starts), load(&low.slopes));
            met &= splat(upper).simd_ge((slope * near).min(slope * far) + start);
        }
        met
    }

    #[inline(always)]
    fn sphere_parts<S: Simd>(
        &self,
        simd: S,
        planes: &[f32; 6],
        limits: &Limits,
        group: usize,
    ) -> mask32x16<S> {
        let splat = |number: f32| f32x16::splat(simd, number);
        let load = |numbers: &PartNumbers| f32x16::load_array_ref(simd, &numbers[group]);
        let Frustum { depth, origin, .. } = &self.frustum;
        let [w, u, v] = depth.axes();
        let (center, radius) = ball(planes);
        let along = center[w] - origin[w];
        let along = if depth.upwards { along } else { -along };
        let mut met = splat(along - radius - self.slack).simd_le(limits.load(simd, group));
        for (side, across) in [u, v].into_iter().enumerate() {
            let beside = center[across] - origin[across];
            let (low, high) = (&self.low[side], &self.high[side]);
            let most = load(&high.starts) + load(&high.slopes) * along + load(&high.roots) * radius;
            let least = load(&low.starts) + load(&low.slopes) * along - load(&low.roots) * radius;
            met &= splat(beside - self.slack).simd_le(most) & splat(beside + self.slack).simd_ge(least);
        }
        met
    }
}
