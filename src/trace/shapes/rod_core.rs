//! The common part of rods, which are cylinders and capsules, and of their images under affine maps.
//!
//! Both consist of the points near an axis from `start` to `stop`: with p the vector from `start` and d the vector from `start` to `stop`,
//! the points on their side satisfy |p x d|^2 = radius^2 |d|^2. No direction is normalized, so that the numbers of a rod define it exactly.
//! A cylinder ends in two planes; a capsule ends in two spheres. Both are convex: a line enters and leaves them at most once.
//!
//! ```text
//! cylinder: the latest entry and the earliest exit of the side and of the slab between the planes
//! capsule:  for the entry and for the exit: where the line hits the side beyond an end, the sphere at that end decides instead
//! ```
//!
//! A line that is nearly parallel to the axis hits the side at uncertain `t`, if at all. If its distance from the axis at one end is less
//! than the radius by more than it can change up to the other end, it enters and leaves through the ends.

use glam::DVec3;

use super::end_planes::EndPlanes;
use super::exact_rod::ExactRod;
use super::intersection::{Face, Intersections};
use super::slabs::FaceMasks;
use super::sphere::{U, newton_step, unit};
use crate::trace::math::{
    BoundedT, Compensated, Double, Double3, Real, Truth, add, cross, dot, moderate, moderate3, negative,
    pick3, spread, subtract, times,
};
use crate::trace::rays::Rays;

/// A rod in coordinates relative to the start of its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RodCore {
    /// The vector from the start to the stop.
    pub(super) stop: DVec3,
    /// The same with its remainder, times a power of two that brings the largest component near 1.
    pub(super) axis: [DVec3; 2],
    /// Length of `axis`.
    pub(super) length: f64,
    /// The product of the vector from the start to the stop with `axis`.
    height: f64,
    pub(super) radius: f64,
    /// The radius times the length of `axis`, and its square.
    reach: f64,
    square: Double,
    /// The planes of a cylinder's ends, in world space; `None` for a capsule.
    pub(super) planes: Option<EndPlanes>,
}

/// Rays in a rod's own coordinates.
#[derive(Clone, Copy)]
pub(super) struct OwnRays<R> {
    /// The origins, relative to the start of the axis.
    pub(super) origin: [R; 3],
    /// The stop of the axis, relative to the origins.
    pub(super) to_stop: [R; 3],
    pub(super) direction: [R; 3],
    /// Bound of the relative error of these vectors.
    pub(super) u: f64,
}

/// Points near a rod, in its own coordinates.
#[derive(Clone, Copy)]
pub(super) struct OwnPlace<R> {
    pub(super) from_start: Compensated<R>,
    pub(super) from_stop: Compensated<R>,
}

/// The `t` at which lines enter and leave a sphere or an infinite cylinder.
#[derive(Clone, Copy)]
struct Chord<R: Real> {
    near: BoundedT<R>,
    far: BoundedT<R>,
    missed: R::Mask,
    /// Lines that certainly pass through.
    clear: R::Mask,
}

/// The `t` at which lines enter and leave a rod, with the faces: axis 0 is the side, axis 1 the ends.
struct RodCrossing<R: Real> {
    entry: BoundedT<R>,
    exit: BoundedT<R>,
    entry_face: FaceMasks<R>,
    exit_face: FaceMasks<R>,
    missed: R::Mask,
    undecided: R::Mask,
}

/// A Newton step to a surface, and the outward normal in a rod's own coordinates.
#[derive(Clone, Copy)]
pub(super) struct OwnStep<R: Real> {
    pub(super) step: R,
    pub(super) normal: [R; 3],
    pub(super) found: R::Mask,
}

/// 2^-57: a fraction of half a unit in the last place.
const NEGLIGIBLE: f64 = f64::from_bits((1023 - 57) << 52);

/// 2^-96: several times the rounding error of compensated products.
const COMPENSATED: f64 = f64::from_bits((1023 - 96) << 52);

/// Returns where lines pass through a sphere, or an infinite cylinder as seen along its axis. `size` bounds the terms of `to_center`, and
/// `roughness` the relative error of `direction`.
///
/// With `nearest`, the vector from the centre to the closest point of the line, half the chord is the square root of r^2 - nearest^2. An
/// error of `e` in `nearest` changes it by about |nearest| e / half. All bounds are several times as wide.
#[inline(always)]
fn chord<R: Real>(
    to_center: [R; 3],
    direction: [R; 3],
    (size, roughness): (R, R),
    (radius, squared_radius): (f64, f64),
    u: f64,
) -> Chord<R> {
    let square = dot(direction, direction);
    let speed = square.sqrt();
    let middle = dot(to_center, direction) / square;
    let nearest = subtract(to_center, times(direction, middle));
    let squared_nearest = dot(nearest, nearest);
    let distance = dot(to_center, to_center).sqrt();
    let error = size * (8.0 * u) + distance * (roughness * 3.0 + 4.0 * U);
    let q = square.of(squared_radius) - squared_nearest;
    let q_error = ((squared_nearest.sqrt() + radius) * error + error * error) * 4.0
        + square.of(16.0 * U * squared_radius);
    let half = q.sqrt();
    let t_error = (error * 2.0 + q_error / half + half * (roughness * 2.0 + 8.0 * U)) / speed;
    let half = half / speed;
    Chord {
        near: BoundedT::within(middle - half, t_error),
        far: BoundedT::within(middle + half, t_error),
        missed: q.less(-q_error),
        clear: q.greater(q_error * 256.0),
    }
}

impl<R: Real> RodCrossing<R> {
    /// Returns the first hits at `t >= 0`.
    #[inline(always)]
    fn first(&self) -> Intersections<R> {
        Intersections::first([self.entry, self.exit], self.missed, self.undecided)
    }

    /// Returns the exits of rays that start on the rod and go inwards.
    #[inline(always)]
    fn last(&self) -> Intersections<R> {
        let hit = self.exit.earliest().greater(self.exit.t().of(0.0)) & !self.undecided & !self.missed;
        Intersections { root: self.exit, hit, undecided: !hit }
    }

    /// Returns the faces that rays hit near `t`, or through which they leave if they are `inside`.
    #[inline(always)]
    fn face(&self, t: R, inside: R::Mask) -> FaceMasks<R> {
        let enters = !inside & (t + t).less(self.entry.t() + self.exit.t());
        let (entry, exit) = (self.entry_face, self.exit_face);
        let either = |one: R::Mask, other: R::Mask| (enters & one) | (!enters & other);
        let at = [0, 1, 2].map(|axis: usize| either(entry.at[axis], exit.at[axis]));
        let certain = either(entry.certain, exit.certain) & !self.undecided & !self.missed;
        FaceMasks { at, upper: either(entry.upper, exit.upper), certain }
    }
}

impl RodCore {
    /// Creates a rod around an axis. `None` if the axis has no direction.
    pub(super) fn new(axis: Double3, radius: f64, planes: Option<EndPlanes>) -> Option<Self> {
        let stop = axis.rounded();
        let largest = stop.abs().max_element();
        if !(largest > 0.0 && largest.is_finite()) {
            return None;
        }
        let power = libm::ldexp(1.0, -libm::ilogb(largest).clamp(-1000, 1000));
        let scaled = axis.times_power(power);
        let squared_length = scaled.dot(scaled);
        let square = Double::product(radius, radius) * squared_length;
        Some(Self {
            stop,
            axis: [scaled.rounded(), scaled.rest()],
            length: squared_length.sqrt().rounded(),
            height: (squared_length / power.into()).rounded(),
            radius,
            reach: square.sqrt().rounded(),
            square,
            planes,
        })
    }

    /// Finds where lines enter and leave. `rays` are the lines in world space.
    #[inline(always)]
    fn cross<R: Real>(&self, rays: &Rays<R>, own: &OwnRays<R>) -> RodCrossing<R> {
        let like = own.origin[0];
        let axis = spread(like, self.axis[0]);
        let (across, turned) = (cross(own.origin, axis), cross(own.direction, axis));
        let size = dot(own.origin, own.origin).sqrt() * self.length;
        let speed = dot(own.direction, own.direction).sqrt() * self.length;
        let turned_size = dot(turned, turned).sqrt();
        let roughness = speed * (8.0 * own.u) / turned_size;
        // Not `greater`: a direction exactly along the axis makes it infinite or not a number.
        let parallel = !roughness.less(like.of(1.0 / 1024.0));
        let sides =
            chord(negative(across), turned, (size, roughness), (self.reach, self.square.rounded()), own.u);
        let never = like.less(like);
        let (mut inside, mut outside) = (never, never);
        if parallel.any() {
            (inside, outside) = self.along_axis(own, (size, speed, turned_size));
        }
        let missed = (parallel & outside) | (!parallel & sides.missed);
        let undecided = (parallel & !inside) | (!parallel & !sides.clear);
        let sides = Chord { missed, clear: !undecided, ..sides };
        match &self.planes {
            Some(planes) => planes_crossing(planes, rays, sides, parallel),
            None => self.ends_crossing(own, sides, (size, speed), parallel),
        }
    }

    /// Returns the lines, nearly parallel to the axis, that certainly stay nearer to it than the radius between both ends, and those that
    /// stay farther away. Beyond the ends, the spheres of a capsule reach as far as its radius.
    #[inline(always)]
    fn along_axis<R: Real>(&self, own: &OwnRays<R>, (size, speed, turned): (R, R, R)) -> (R::Mask, R::Mask) {
        let like = own.origin[0];
        let axis = spread(like, self.axis[0]);
        let rate = dot(own.direction, axis);
        let t = -dot(own.origin, axis) / rate;
        let place = cross(add(own.origin, times(own.direction, t)), axis);
        let distance = dot(place, place).sqrt();
        let drift = (turned + speed * (8.0 * own.u)) * ((self.height + 2.0 * self.reach) * 1.01) / rate.abs();
        let error = (size + t.abs() * speed) * (32.0 * own.u) + drift + self.reach * (8.0 * U);
        let reach = like.of(self.reach);
        ((distance + error).less(reach), (distance - error).greater(reach))
    }

    /// Finds where lines enter and leave a capsule.
    #[inline(always)]
    fn ends_crossing<R: Real>(
        &self,
        own: &OwnRays<R>,
        sides: Chord<R>,
        (size, speed): (R, R),
        parallel: R::Mask,
    ) -> RodCrossing<R> {
        let like = own.origin[0];
        let axis = spread(like, self.axis[0]);
        let (start, rate) = (dot(own.origin, axis), dot(own.direction, axis));
        let upwards = rate.greater(like.of(0.0));
        let (to_start, stop_size) = (negative(own.origin), like.of(self.height));
        // In the space before a map, errors of the origins are relative to their own sizes.
        let ball_error = if own.u > U { (size + stop_size) * (1.0 / self.length) } else { like.of(0.0) };
        // The `t` at one of the two ends of the chord, its face, and whether lines miss the rod there, or may do so.
        let end = |side: BoundedT<R>, is_entry: bool| {
            let height = start + side.t() * rate;
            let error =
                (size + stop_size + side.t().abs() * speed) * (8.0 * own.u) + side.error() * rate.abs();
            let first = if is_entry { !upwards } else { upwards };
            let (low, high) = (like.of(0.0), like.of(self.height));
            let at_stop = (parallel & first) | (!parallel & (height - error).greater(high));
            let at_start = (parallel & !first) | (!parallel & (height + error).less(low));
            let at_side = !parallel & (height - error).greater(low) & (height + error).less(high);
            let at_end = at_start | at_stop;
            let center = pick3(at_stop, own.to_stop, to_start);
            let ball_size = dot(center, center).sqrt() + ball_error;
            let ball = chord(
                center,
                own.direction,
                (ball_size, like.of(8.0 * own.u)),
                (self.radius, self.radius * self.radius),
                own.u,
            );
            let on_ball = if is_entry { ball.near } else { ball.far };
            let face = FaceMasks {
                at: [at_side, at_end, at_end & !at_end],
                upper: at_stop,
                certain: at_side | at_end,
            };
            let (missed, open) = (at_end & ball.missed, !at_side & !(at_end & ball.clear));
            (BoundedT::pick(at_side, side, on_ball), face, missed, open)
        };
        let (entry, entry_face, no_entry, entry_open) = end(sides.near, true);
        let (exit, exit_face, no_exit, exit_open) = end(sides.far, false);
        let missed = sides.missed | (sides.clear & (no_entry | no_exit));
        let undecided = !sides.clear | entry_open | exit_open;
        RodCrossing { entry, exit, entry_face, exit_face, missed, undecided }
    }

    /// Returns the certain first hits at `t >= 0`. `None` if all rays certainly miss.
    #[inline(always)]
    pub(super) fn intersections<R: Real>(
        &self,
        rays: &Rays<R>,
        own: &OwnRays<R>,
    ) -> Option<Intersections<R>> {
        let crossing = self.cross(rays, own);
        (!crossing.missed).any().then(|| crossing.first())
    }

    /// Finds the exits of rays that start on the rod and go inwards.
    #[inline(always)]
    pub(super) fn exits<R: Real>(&self, rays: &Rays<R>, own: &OwnRays<R>) -> Intersections<R> {
        self.cross(rays, own).last()
    }

    /// Returns the face that is hit at `t`, or through which rays leave if they are `inside`.
    #[inline(always)]
    pub(super) fn face<R: Real>(
        &self,
        rays: &Rays<R>,
        own: &OwnRays<R>,
        t: R,
        inside: R::Mask,
    ) -> FaceMasks<R> {
        self.cross(rays, own).face(t, inside)
    }

    /// Returns the Newton step from points near the side or near the sphere at an end. It is found if the neglected part of the step and
    /// its rounding errors are negligible beside `t`.
    #[inline(always)]
    pub(super) fn step<R: Real>(
        &self,
        place: &OwnPlace<R>,
        direction: [R; 3],
        t: R,
        (face, u): (&FaceMasks<R>, f64),
    ) -> OwnStep<R> {
        let side = self.side_step(place.from_start, direction, t, u);
        if self.planes.is_some() {
            return side;
        }
        let from_center = Compensated::pick(face.upper, place.from_stop, place.from_start);
        let end = self.ball_step(from_center, direction, t, u);
        let at_side = face.at[0];
        OwnStep {
            step: R::pick(at_side, side.step, end.step),
            normal: pick3(at_side, side.normal, end.normal),
            found: (at_side & side.found) | (!at_side & end.found),
        }
    }

    #[inline(always)]
    fn side_step<R: Real>(&self, from_start: Compensated<R>, direction: [R; 3], t: R, u: f64) -> OwnStep<R> {
        let [axis, rest] = self.axis.map(|part| spread(t, part));
        let across = from_start.cross_exact(axis, rest);
        let turned = cross(direction, axis);
        let square = Double { high: t.of(self.square.high), low: t.of(self.square.low) };
        let residual = across.beyond_square(square);
        let (near, own) = (across.rounded(), from_start.rounded());
        let half_slope = dot(near, turned);
        let step = newton_step(residual, half_slope * 2.0);
        let distance = dot(near, near).sqrt();
        let speed = dot(direction, direction).sqrt() * self.length;
        let size = dot(own, own).sqrt() * self.length;
        let neglected = dot(turned, turned) * step * step
            + step.abs() * distance * speed * (16.0 * u)
            + size * distance * (COMPENSATED * (u / U));
        let normal = cross(axis, across.moved(times(turned, step)));
        OwnStep {
            step,
            normal: unit(normal),
            found: neglected.less_or_equal(half_slope.abs() * t * NEGLIGIBLE)
                & moderate3(own)
                & moderate3(near),
        }
    }

    #[inline(always)]
    fn ball_step<R: Real>(&self, from_center: Compensated<R>, direction: [R; 3], t: R, u: f64) -> OwnStep<R> {
        let radius = t.of(self.radius);
        let own = from_center.rounded();
        let half_slope = dot(own, direction);
        let step = newton_step(from_center.beyond(radius), half_slope * 2.0);
        let (distance, square) = (dot(own, own).sqrt(), dot(direction, direction));
        let neglected = square * step * step
            + step.abs() * distance * square.sqrt() * (16.0 * u)
            + distance * distance * (COMPENSATED * (u / U));
        OwnStep {
            step,
            normal: unit(from_center.moved(times(direction, step))),
            found: neglected.less_or_equal(half_slope.abs() * t * NEGLIGIBLE)
                & moderate3(own)
                & moderate(radius),
        }
    }

    /// Returns the outward normal at a point of the side or of the sphere at an end, in the rod's own coordinates. `way` is the remainder of
    /// the point.
    pub(super) fn normal(&self, place: &OwnPlace<f64>, way: DVec3, face: Face) -> DVec3 {
        let [axis, rest] = self.axis;
        let normal: DVec3 = match (face.axis, face.upper) {
            (0, _) => {
                let across = place.from_start.cross_exact(axis, rest).moved(way.cross(axis));
                axis.cross(across.into())
            }
            (_, false) => place.from_start.moved(way).into(),
            (_, true) => place.from_stop.moved(way).into(),
        };
        unit(normal.into()).into()
    }

    /// Returns whether a point is certainly nearer to the infinite axis than the radius, or certainly not; `None` if that is uncertain.
    fn is_within(&self, own: DVec3, u: f64) -> Option<bool> {
        let distance = own.cross(self.axis[0]).length();
        let error = own.length() * self.length * (16.0 * u) + self.reach * (8.0 * U);
        if distance + error < self.reach {
            return Some(true);
        }
        (distance - error > self.reach).then_some(false)
    }

    /// Returns whether a point is strictly inside. `own` is the point in the rod's own coordinates with the relative error `u`, `exact` the
    /// same exactly.
    pub(super) fn contains(
        &self,
        point: DVec3,
        (own, u): (DVec3, f64),
        exact: impl FnOnce() -> ExactRod,
    ) -> bool {
        if self.planes.is_some_and(|planes| !planes.contains(point)) {
            return false;
        }
        match self.is_within(own, u) {
            Some(false) => false,
            Some(true) if self.planes.is_some() => true,
            _ => exact().contains(self.planes.is_some()),
        }
    }
}

/// Finds where lines enter and leave a cylinder.
#[inline(always)]
fn planes_crossing<R: Real>(
    planes: &EndPlanes,
    rays: &Rays<R>,
    sides: Chord<R>,
    parallel: R::Mask,
) -> RodCrossing<R> {
    let like = rays.origin[0];
    let always = BoundedT::within(like.of(f64::NEG_INFINITY), like.of(0.0));
    let forever = BoundedT::within(like.of(f64::INFINITY), like.of(0.0));
    let (near, far) =
        (BoundedT::pick(parallel, always, sides.near), BoundedT::pick(parallel, forever, sides.far));
    let slab = planes.roots(rays);
    let entry_side = slab.entry.t().less(near.t());
    let exit_side = far.t().less(slab.exit.t());
    let face = |at_side: R::Mask, one: &BoundedT<R>, other: &BoundedT<R>, upper: R::Mask| FaceMasks {
        at: [at_side, !at_side, at_side & !at_side],
        upper,
        certain: !one.may_equal(other),
    };
    RodCrossing {
        entry: near.later(slab.entry),
        exit: far.earlier(slab.exit),
        entry_face: face(entry_side, &near, &slab.entry, !slab.upwards),
        exit_face: face(exit_side, &far, &slab.exit, slab.upwards),
        missed: sides.missed | slab.outside,
        undecided: !sides.clear | slab.undecided,
    }
}
