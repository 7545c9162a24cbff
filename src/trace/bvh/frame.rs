//! The coordinate frame in which boxes are stored in single precision.

use glam::DVec3;
use rayon::prelude::*;

use crate::trace::rays::PreparedRay;
use crate::trace::shapes::Bounds;

/// A frame with a median shape at its origin, scaled by a power of two so that all boxes lie within -1..=1, where `f32` is most precise. It
/// is a function of the shapes alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    origin: DVec3,
    scale: f64,
}

/// A box in the frame, rounded outwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FrameBox {
    pub(crate) min: [f32; 3],
    pub(crate) max: [f32; 3],
}

impl FrameBox {
    /// The empty box.
    pub(crate) const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// Returns the union of both boxes.
    #[inline]
    pub(crate) fn union(&self, other: &Self) -> Self {
        let smaller = |one: f32, other: f32| if one < other { one } else { other };
        let larger = |one: f32, other: f32| if one > other { one } else { other };
        Self {
            min: std::array::from_fn(|axis| smaller(self.min[axis], other.min[axis])),
            max: std::array::from_fn(|axis| larger(self.max[axis], other.max[axis])),
        }
    }

    /// Returns half the surface area, to which the probability that a ray hits the box is proportional.
    #[inline]
    pub(crate) fn half_area(&self) -> f32 {
        let [x, y, z] = std::array::from_fn(|axis| self.max[axis] - self.min[axis]);
        x * y + y * z + z * x
    }

    /// Returns the centre.
    #[inline]
    pub(crate) fn center(&self) -> [f32; 3] {
        std::array::from_fn(|axis| (self.min[axis] + self.max[axis]) * 0.5)
    }

    /// Returns whether it lies within -1..=1, as all boxes of a frame do.
    pub(super) fn is_inside(&self) -> bool {
        self.min.iter().all(|low| *low >= -1.0) && self.max.iter().all(|high| *high <= 1.0)
    }
}

impl Default for FrameBox {
    fn default() -> Self {
        Self::EMPTY
    }
}

/// A ray in the frame, for culling only.
///
/// The origin is an interval. Planes at which the ray enters are measured from the end that makes it enter earlier, planes at which it
/// leaves from the other end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameRay {
    pub(crate) near_origin: [f32; 3],
    pub(crate) far_origin: [f32; 3],
    pub(crate) inverse: [f32; 3],
    /// True if the ray runs down this axis and enters at the upper plane.
    pub(crate) downward: [bool; 3],
}

impl Default for Frame {
    /// Returns the frame of no shapes.
    fn default() -> Self {
        Self { origin: DVec3::ZERO, scale: 1.0 }
    }
}

impl Frame {
    /// Four times the largest shift of the origin by rounding to `f32`. The rounding of a shape's own test shifts the rays that it accepts
    /// by a few units in the last place of its distance, times the stretch of its map: for the worst map that the tree admits, this is a
    /// quarter of the remainder.
    pub(super) const SLACK: f64 = 1.0 / 4_194_304.0;

    /// 2^126. Boxes that begin farther away may have overflowed `f32`, so that limits beyond this are infinite.
    pub(super) const ENDLESS: f64 = f64::from_bits((1023 + 126) << 52);

    /// Computes the frame of `count` shapes, given by their indices.
    pub(super) fn of(count: usize, bounds: impl Fn(usize) -> Bounds + Sync) -> Self {
        /// Maximum number of shapes, evenly spread among all, of which the median is taken.
        const SAMPLE: usize = 4096;
        /// Factor by which boxes may grow when they are rounded outwards: less than two steps of `f32`.
        const ROUNDED_OUT: f64 = 1.0 + 2.0 * f32::EPSILON as f64;
        let median = |axis: usize| {
            let sample = (0..count).step_by(count.div_ceil(SAMPLE));
            let mut centers: Vec<f64> = sample.map(|index| bounds(index).center()[axis]).collect();
            let middle = centers.len() / 2;
            *centers.select_nth_unstable_by(middle, f64::total_cmp).1
        };
        if count == 0 {
            return Self::default();
        }
        let origin = DVec3::new(median(0), median(1), median(2));
        let reach = |index| {
            let bounds = bounds(index);
            (bounds.max - origin).abs().max((bounds.min - origin).abs()).max_element()
        };
        let reach = (0..count).into_par_iter().with_min_len(SAMPLE).map(reach).reduce(|| 0.0, f64::max);
        let exponent = if reach > 0.0 { libm::ilogb(reach * ROUNDED_OUT) + 1 } else { 0 };
        Self { origin, scale: libm::ldexp(1.0, -exponent.clamp(-1020, 1020)) }
    }

    /// Returns the point of the scene at the frame's origin.
    pub(super) fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Returns the length of a scene unit in the frame, a power of two.
    pub(super) fn scale(&self) -> f64 {
        self.scale
    }

    /// Transforms a box into the frame, rounded outwards.
    pub(crate) fn bounds(&self, bounds: &Bounds) -> FrameBox {
        let (min, max) = ((bounds.min - self.origin) * self.scale, (bounds.max - self.origin) * self.scale);
        FrameBox { min: min.to_array().map(below), max: max.to_array().map(above) }
    }

    /// Transforms a distance along a ray into the frame, rounded up.
    pub(crate) fn limit(&self, t: f64) -> f32 {
        let limit = t * self.scale;
        if limit > Self::ENDLESS { f32::INFINITY } else { above(limit) }
    }

    /// Transforms a ray into the frame.
    pub(crate) fn ray(&self, ray: &PreparedRay) -> FrameRay {
        /// Direction components below this may have reciprocals outside the range of `f32`; the ray then always passes the test of the
        /// axis.
        const SLOWEST: f64 = 1e-30;
        let origin = (ray.origin() - self.origin) * self.scale;
        let slack = Self::SLACK * (1.0 + origin.abs().max_element());
        let direction = ray.direction();
        let mut result =
            FrameRay { near_origin: [0.0; 3], far_origin: [0.0; 3], inverse: [0.0; 3], downward: [false; 3] };
        for axis in 0..3 {
            let (low, high) = (nearest(origin[axis] - slack), nearest(origin[axis] + slack));
            let d = direction[axis];
            let downward = d < 0.0;
            result.downward[axis] = downward;
            (result.near_origin[axis], result.far_origin[axis]) =
                if downward { (low, high) } else { (high, low) };
            if d == 0.0 {
                // (plane - origin) * infinity: enters infinitely early if inside, never if outside.
                result.inverse[axis] = f32::INFINITY;
            } else if d.abs() < SLOWEST {
                let outside = if downward { f32::NEG_INFINITY } else { f32::INFINITY };
                (result.near_origin[axis], result.far_origin[axis]) = (outside, -outside);
                result.inverse[axis] = if downward { -1.0 } else { 1.0 };
            } else {
                result.inverse[axis] = nearest(d.recip());
            }
        }
        result
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounding to f32 is the point")]
pub(super) fn nearest(value: f64) -> f32 {
    value as f32
}

/// Returns an `f32` that is certainly below a value computed with one or two roundings.
pub(super) fn below(value: f64) -> f32 {
    let rounded = nearest(value);
    // The nearest `f32` is off by at most half a step; one step down more than compensates for it.
    rounded.next_down()
}

/// Returns an `f32` that is certainly above a value computed with one or two roundings.
pub(super) fn above(value: f64) -> f32 {
    -below(-value)
}
