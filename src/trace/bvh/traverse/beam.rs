//! Bundles of rays between a box and points, tested against shapes: camera rays, from surfaces to a light, or through a lens.
//!
//! A part of a bundle is half a packet. Let w be the axis of depth, measured from the centre of the box towards the points, and u an axis
//! across it. The rays of a part lie in the convex hull of the box and of the bounds of the part's points, and therefore below every line
//! u = a + b s that is above both boxes. The line used touches both boxes: at their near ends if it rises, at their far ends otherwise.
//!
//! ```text
//! for each shape:
//!     s = the depths of the shape, but for those before the box
//!     part may hit the shape = s begins before the part's limit
//!         and, for both axes across, the line above is above the shape's lower side at some s, and the line below below its upper side
//! ```
//!
//! 1. A line is above a box at some depth if it is at the box's near or far end. A sphere of radius r is beyond a line of slope b if its centre
//!    satisfies u - a - b s > r sqrt(1 + b^2): its box would be hit by more rays.
//! 2. For a box that is a single point (a pinhole, a point light), a is 0, and b are the slopes of the part's rays: such a beam is a
//!    [`Shaft`]. Its parts are bounded like a [frustum](super::frustum), more tightly than by the bounds of points.
//!
//! # Rounding errors
//!
//! Everything is computed in `f32` in the tree's frame, as for a [frustum](super::frustum), whose letters are used here.
//!
//! A sphere touches the sides of its box, which are rounded outwards by less than 3 e: their midpoint is off from its centre by less than 4 e,
//! and half their distance is at most e less than its radius. This contributes less than 5 e (1 + S). The product of radius and root is
//! rounded by less than 3 e (1 + S), and the other errors are the same as for boxes: less than 14 e (1 + E)(1 + S) in total. The rounding of a
//! sphere's own test is negligible.
//!
//! Lines that do not start at a point are rounded outwards by more than the error of their computation. With the box's size added to E, and S
//! the slope of the steepest line, the remaining error is less than half of the 16 e (1 + E)(1 + S) within which missed shapes are still
//! accepted.

use fearless_simd::{f32x16, mask32x16, prelude::*};
use glam::DVec3;

use super::depth::Depth;
use super::frustum::{FARTHEST, Frustum, LeafBox, SLACK};
use super::limits::Limits;
use super::slopes::{GROUPS, PartNumbers, Places, STEEPEST, Slopes, wider};
use crate::trace::bvh::{Tree, frame};
use crate::trace::math::{LANES, Vectors, bits16};

/// A bundle of rays between a box and points, divided into [`PARTS`](super::slopes::PARTS) parts. The box may be a point.
#[derive(Clone, Debug)]
pub(crate) struct Beam<const FROM_POINT: bool = false> {
    /// The frustum around all rays.
    pub(crate) frustum: Frustum,
    /// Half-extent of the box along the depth axis.
    ahead: f32,
    slack: f32,
    /// The lines that bound the rays from below, along the two axes across; `high` holds the lines above.
    pub(super) low: [Lines; 2],
    pub(super) high: [Lines; 2],
}

/// A bundle of rays with a common origin.
pub(crate) type Shaft = Beam<true>;

/// By part, the line u = start + slope s, and sqrt(1 + slope^2).
#[derive(Clone, Copy, Debug)]
pub(super) struct Lines {
    /// Unused for lines from a point.
    starts: PartNumbers,
    pub(super) slopes: PartNumbers,
    roots: PartNumbers,
}

impl Tree {
    /// Creates a shaft of the rays from a point with these slopes. `None` if there is no [frustum](Tree::frustum).
    #[inline(always)]
    pub(crate) fn shaft<S: Simd>(
        &self,
        simd: S,
        origin: DVec3,
        depth: Depth,
        slopes: &Slopes,
    ) -> Option<Shaft> {
        let frustum = self.frustum(origin, depth, &slopes.range(simd))?;
        let [[low_u, low_v], [high_u, high_v]] = [&slopes.low, &slopes.high];
        let low = [Lines::from_point(simd, low_u), Lines::from_point(simd, low_v)];
        let high = [Lines::from_point(simd, high_u), Lines::from_point(simd, high_v)];
        Some(Beam { ahead: 0.0, slack: frustum.slack, frustum, low, high })
    }

    /// Creates the beam between a box, given by its centre and half-extents, and the points of packets in some lanes. Also returns the
    /// depth up to which each part extends. `None` if points are too near to the box, too far from it or too far apart.
    #[inline(always)]
    pub(crate) fn beam<'a, S: Simd>(
        &self,
        simd: S,
        middle: DVec3,
        reach: DVec3,
        packets: impl Iterator<Item = (&'a Vectors, u32)> + Clone,
    ) -> Option<(Beam, Limits)> {
        let (points, lanes) = packets.clone().find(|(_, lanes)| *lanes != 0)?;
        let depth = Depth::along(points.get(lanes.trailing_zeros() as usize) - middle);
        let scale = self.scale();
        let places = Places::of(simd, (middle, scale), depth, packets)?;
        let reach = (reach * scale).to_array().map(frame::above);
        let [ahead, lateral @ ..] = depth.axes().map(|axis| reach[axis]);
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
        for (side, lateral) in lateral.into_iter().enumerate() {
            steepest = steepest.max(beam.high[side].draw(simd, &places, side, 1.0, ahead, lateral));
            steepest = steepest.max(beam.low[side].draw(simd, &places, side, -1.0, ahead, lateral));
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

    /// Returns the lines of these slopes through a point.
    #[inline(always)]
    fn from_point<S: Simd>(simd: S, slopes: &PartNumbers) -> Self {
        let mut lines = Self { slopes: *slopes, ..Self::NONE };
        for (root, slopes) in lines.roots.iter_mut().zip(slopes) {
            let slope = f32x16::load_array_ref(simd, slopes);
            (slope * slope + 1.0).sqrt().store_array(root);
        }
        lines
    }

    /// Computes the lines above the box, of half-extents `ahead` and `lateral`, and above the parts' bounds, along one of the axes across;
    /// the lines below them if the sense is -1. Returns the steepest slope of the parts that have points.
    #[inline(always)]
    fn draw<S: Simd>(
        &mut self,
        simd: S,
        places: &Places,
        side: usize,
        sense: f32,
        ahead: f32,
        lateral: f32,
    ) -> f32 {
        let (zero, mut steepest) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 0.0));
        for group in 0..GROUPS {
            let load = |numbers: &PartNumbers| f32x16::load_array_ref(simd, &numbers[group]);
            let (near, far) = (load(&places.low[0]), load(&places.high[0]));
            let most = if sense > 0.0 { load(&places.high[side + 1]) } else { -load(&places.low[side + 1]) };
            let rise = most - lateral;
            let slope = rise / rise.simd_gt(zero).select(near + ahead, far - ahead);
            let start = slope.abs() * ahead + lateral;
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
}

impl<const FROM_POINT: bool> Beam<FROM_POINT> {
    /// Returns a bit mask of the parts whose rays may hit a shape before their limits.
    #[inline(always)]
    pub(crate) fn parts<S: Simd>(&self, simd: S, bounds: &LeafBox, limits: &Limits) -> u32 {
        let mut parts = 0;
        for group in 0..GROUPS {
            let hit = if bounds.round {
                self.sphere_parts(simd, &bounds.planes, limits, group)
            } else {
                self.box_parts(simd, &bounds.planes, limits, group)
            };
            parts |= bits16(hit) << (group * LANES);
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
        let nearest = if FROM_POINT { 0.0 } else { -self.ahead - self.slack };
        let (near, far) = (splat(near.max(nearest)), splat(far));
        let mut hit = near.simd_le(limits.load(simd, group));
        for (side, across) in [u, v].into_iter().enumerate() {
            let lower = planes[across] - origin[across] - self.slack;
            let upper = planes[across + 3] - origin[across] + self.slack;
            let (low, high) = (load(&self.low[side].slopes), load(&self.high[side].slopes));
            let above = Self::from_start(simd, &self.high[side], group, (high * near).max(high * far));
            let below = Self::from_start(simd, &self.low[side], group, (low * near).min(low * far));
            hit &= splat(lower).simd_le(above) & splat(upper).simd_ge(below);
        }
        hit
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
        let mut hit = splat(along - radius - self.slack).simd_le(limits.load(simd, group));
        for (side, across) in [u, v].into_iter().enumerate() {
            let lateral = center[across] - origin[across];
            let (low, high) = (&self.low[side], &self.high[side]);
            let most =
                Self::from_start(simd, high, group, load(&high.slopes) * along) + load(&high.roots) * radius;
            let least =
                Self::from_start(simd, low, group, load(&low.slopes) * along) - load(&low.roots) * radius;
            hit &= splat(lateral - self.slack).simd_le(most) & splat(lateral + self.slack).simd_ge(least);
        }
        hit
    }

    /// Adds the starts of lines to their rise.
    #[inline(always)]
    fn from_start<S: Simd>(simd: S, lines: &Lines, group: usize, rise: f32x16<S>) -> f32x16<S> {
        if FROM_POINT { rise } else { f32x16::load_array_ref(simd, &lines.starts[group]) + rise }
    }
}

/// Returns the centre and the radius of the sphere that touches the sides of a box.
#[inline(always)]
pub(super) fn ball([x, y, z, upper_x, upper_y, upper_z]: &[f32; 6]) -> ([f32; 3], f32) {
    let middle = |lower: f32, upper: f32| (lower + upper) * 0.5;
    let center = [middle(*x, *upper_x), middle(*y, *upper_y), middle(*z, *upper_z)];
    (center, (upper_x - x).max(upper_y - y).max(upper_z - z) * 0.5)
}
