//! The coordinates in which boxes are kept in single precision.

use glam::DVec3;
use rayon::prelude::*;

use crate::trace::rays::Ray;
use crate::trace::shapes::Bounds;

/// Moves a median shape to the origin and scales by a power of two so that all boxes lie within -1..=1, where `f32` has
/// its digits. It is a function of the shapes alone.
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
    /// A box around nothing.
    pub(crate) const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// The box around both.
    #[inline]
    pub(crate) fn union(&self, other: &Self) -> Self {
        let smaller = |one: f32, other: f32| if one < other { one } else { other };
        let larger = |one: f32, other: f32| if one > other { one } else { other };
        Self {
            min: std::array::from_fn(|axis| smaller(self.min[axis], other.min[axis])),
            max: std::array::from_fn(|axis| larger(self.max[axis], other.max[axis])),
        }
    }

    /// Half the surface, by which the chance that a ray meets it goes.
    #[inline]
    pub(crate) fn half_area(&self) -> f32 {
        let [x, y, z] = std::array::from_fn(|axis| self.max[axis] - self.min[axis]);
        x * y + y * z + z * x
    }

    /// The middle.
    #[inline]
    pub(crate) fn center(&self) -> [f32; 3] {
        std::array::from_fn(|axis| (self.min[axis] + self.max[axis]) * 0.5)
    }

    /// Returns whether it lies within -1..=1, as a frame's boxes do.
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
/// The origin is an interval. Planes that the ray enters by are measured from the end that lets it enter earlier, planes it
/// leaves by from the other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameRay {
    pub(crate) near_origin: [f32; 3],
    pub(crate) far_origin: [f32; 3],
    pub(crate) inverse: [f32; 3],
    /// Whether the ray runs down this axis, entering by the upper plane.
    pub(crate) downward: [bool; 3],
}

impl Default for Frame {
    /// The frame of no shapes.
    fn default() -> Self {
        Self { origin: DVec3::ZERO, scale: 1.0 }
    }
}

impl Frame {
    /// Four times what rounding to `f32` can shift the origin by. The shapes' own rounding shifts what they accept by a
    /// few units in the last place of their distance, and by as many times more as their maps stretch: for the worst map
    /// that is let into the tree, a quarter of what is left.
    pub(super) const SLACK: f64 = 1.0 / 4_194_304.0;

    /// 2^126: what begins farther away may have overflowed `f32`, so that limits beyond are infinite.
    pub(super) const ENDLESS: f64 = f64::from_bits((1023 + 126) << 52);

    /// The frame of so many shapes, given by their indices.
    pub(super) fn of(count: usize, bounds: impl Fn(usize) -> Bounds + Sync) -> Self {
        /// Of how many shapes, evenly spread among all, the median is taken.
        const SAMPLE: usize = 4096;
        /// By what factor boxes may grow when they are rounded outwards: by less than two steps.
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

    /// The point of the scene that is the frame's origin.
    pub(super) fn origin(&self) -> DVec3 {
        self.origin
    }

    /// How long a unit of the scene is.
    pub(super) fn scale(&self) -> f64 {
        self.scale
    }

    /// A box, rounded outwards.
    pub(crate) fn bounds(&self, bounds: &Bounds) -> FrameBox {
        let (min, max) = ((bounds.min - self.origin) * self.scale, (bounds.max - self.origin) * self.scale);
        FrameBox { min: min.to_array().map(below), max: max.to_array().map(above) }
    }

    /// A distance along a ray, rounded up.
    pub(crate) fn limit(&self, t: f64) -> f32 {
        let limit = t * self.scale;
        if limit > Self::ENDLESS { f32::INFINITY } else { above(limit) }
    }

    /// A ray.
    pub(crate) fn ray(&self, ray: &Ray) -> FrameRay {
        /// Below this a component's reciprocal would leave `f32`: such a ray never fails the axis.
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
                // (plane - origin) * infinity: infinitely early where inside, never where outside.
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

/// An `f32` that is certainly below a value which was computed with one or two roundings.
pub(super) fn below(value: f64) -> f32 {
    let rounded = nearest(value);
    // The nearest f32 is off by at most half a step, which one step down more than makes up for.
    rounded.next_down()
}

/// An `f32` that is certainly above a value which was computed with one or two roundings.
pub(super) fn above(value: f64) -> f32 {
    -below(-value)
}
