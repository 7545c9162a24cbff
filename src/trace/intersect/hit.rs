//! Hits of rays with shapes, and the surface points there, of single rays and of packets.

use fearless_simd::Simd;
use glam::DVec3;

use crate::trace::math::{
    BoundedT, Double, Double3, F64s, LANES, Mask, Numbers, Vectors, moderate, moderate3, scaled,
};
use crate::trace::rays::{CoincidentHits, FAR, PreparedRay, RayPacket, ShapeId, ShapeIds, SurfaceExclusion};

/// An intersection of a ray with a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeHit {
    /// The ray parameter, with its error bound.
    pub(crate) root: BoundedT,
    /// The shape.
    pub id: ShapeId,
    /// True if this is the far side of a shape that the ray left inwards.
    pub far: bool,
}

/// The closest hit of a ray: the first in document order of all hits at exactly the same `t`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ClosestHit {
    /// The hit.
    pub(crate) hit: ShapeHit,
    /// The other hits at the same `t`.
    pub(crate) tied: TiedHits,
}

/// A list in [`TiedHitLists`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TiedHits {
    pub(super) start: u32,
    pub(super) count: u32,
}

impl TiedHits {
    pub(super) const NONE: Self = Self { start: 0, count: 0 };

    #[inline]
    pub(crate) fn is_empty(self) -> bool {
        self.count == 0
    }
}

/// Lists of the hits at the same `t` as the closest hits of rays, one list after another.
#[derive(Clone, Debug, Default)]
pub(crate) struct TiedHitLists(pub(super) Vec<ShapeHit>);

impl TiedHitLists {
    /// Returns a list, in no particular order. The first of equal shapes in document order represents all of them.
    pub(crate) fn of(&self, tied: TiedHits) -> &[ShapeHit] {
        let TiedHits { start, count } = tied;
        if count == 0 { &[] } else { &self.0[start as usize..][..count as usize] }
    }

    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }
}

/// A surface point found by a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The hit that was refined to this point.
    pub hit: ShapeHit,
    /// The first in document order of the shape and all shapes equal to it.
    pub(crate) first_equal: ShapeId,
    /// The other coincident shapes at the point, none of them equal to it.
    pub(crate) ties: CoincidentHits,
    /// The parameter of the ray that found it, accurate to some bits beyond an `f64`.
    pub t: Double,
    /// The position on the surface.
    pub point: DVec3,
    /// The outward unit normal; for a plane, its own normal.
    pub normal: DVec3,
    /// True if the ray came from the side to which the normal points.
    pub from_outside: bool,
}

impl SurfacePoint {
    /// Returns the normal on the side from which the ray came.
    #[must_use]
    pub fn facing_normal(&self) -> DVec3 {
        if self.from_outside { self.normal } else { -self.normal }
    }

    /// Returns the distance from the origin of the ray that found the point: t |d| in double-double, rounded once.
    #[must_use]
    pub fn distance(&self, ray: &PreparedRay) -> f64 {
        let direction = Double3::from(ray.direction());
        self.times(direction.dot(direction).sqrt())
    }

    /// Returns the distance from the origin of the ray that found the point, along a unit vector.
    #[must_use]
    pub fn depth(&self, ray: &PreparedRay, axis: DVec3) -> f64 {
        self.times(Double3::from(ray.direction()).dot(Double3::from(axis)))
    }

    /// Returns the product of `t` and a number of at most 2^402, rounded once.
    fn times(&self, number: Double) -> f64 {
        /// 2^600
        const LARGER: f64 = f64::from_bits((1023 + 600) << 52);
        if self.t.rounded() < FAR {
            (self.t * number).rounded()
        } else {
            // Scaled so that no product overflows while it is split into halves.
            (self.t.scaled(LARGER.recip()) * number).rounded() * LARGER
        }
    }

    /// Returns the surface exclusion of a ray that starts here, on the side given by `outward`.
    #[inline(always)]
    pub(crate) fn exclusion(&self, outward: bool) -> SurfaceExclusion {
        SurfaceExclusion { id: self.first_equal, outward, ties: self.ties }
    }

    /// Returns a ray that leaves the surface on the side given by `outward`.
    #[must_use]
    #[inline]
    pub(crate) fn leave(&self, outward: bool, direction: DVec3) -> Option<PreparedRay> {
        self.point.is_finite().then_some(())?;
        let (direction, _) = scaled(direction)?;
        Some(PreparedRay::departing(self.point, direction, self.exclusion(outward)))
    }
}

/// The closest hits of a packet, lane by lane.
#[derive(Clone, Debug)]
pub(crate) struct HitPacket {
    /// The ray parameters; infinity in lanes without a hit.
    pub(crate) ts: Numbers,
    /// The error bounds of the ray parameters.
    pub(crate) errors: Numbers,
    /// The shapes that are hit.
    pub(crate) ids: ShapeIds,
    /// Lanes that hit the far side of a shape that the ray left inwards.
    pub(crate) far: u32,
    /// Lanes with other hits at the same `t`.
    pub(crate) tied: u32,
    ties: [TiedHits; LANES],
    /// Undecided lanes, which have to be traced as single rays.
    pub(crate) undecided: u32,
}

/// The surface points of a packet's hits, lane by lane.
#[derive(Clone, Debug)]
pub(crate) struct SurfacePacket {
    /// Lanes that have a point.
    pub(crate) lanes: u32,
    pub(crate) points: Vectors,
    /// The outward unit normals.
    pub(crate) normals: Vectors,
    /// Lanes whose rays came from the side to which the normal points.
    pub(crate) from_outside: u32,
    /// The ray parameters: rounded values in `ts`, the remainders in `rests`.
    pub(crate) ts: Numbers,
    pub(crate) rests: Numbers,
    /// The first in document order of all shapes equal to the visible one.
    pub(crate) first_equals: ShapeIds,
    /// Lanes with other coincident surfaces at the point.
    pub(crate) tied: u32,
    ties: [CoincidentHits; LANES],
}

impl HitPacket {
    /// No hits.
    pub(crate) const EMPTY: Self = Self {
        ts: Numbers::splat(f64::INFINITY),
        errors: Numbers::splat(0.0),
        ids: ShapeIds::NONE,
        far: 0,
        tied: 0,
        ties: [TiedHits::NONE; LANES],
        undecided: 0,
    };

    /// Removes all hits.
    #[inline]
    pub(crate) fn clear(&mut self) {
        self.ts = Numbers::splat(f64::INFINITY);
        self.errors = Numbers::splat(0.0);
        self.ids = ShapeIds::NONE;
        (self.far, self.tied, self.undecided) = (0, 0, 0);
    }

    /// Returns the closest hit in a lane, as decided so far.
    #[inline]
    pub(crate) fn get(&self, lane: usize) -> Option<ClosestHit> {
        let bit = 1 << lane;
        let id = self.ids.get(lane)?;
        let root = BoundedT::within(self.ts.get(lane), self.errors.get(lane));
        let hit = ShapeHit { root, id, far: self.far & bit != 0 };
        let tied = if self.tied & bit == 0 { TiedHits::NONE } else { self.ties[lane] };
        Some(ClosestHit { hit, tied })
    }

    /// Sets the closest hit in a lane, and marks the lane as decided.
    #[inline]
    pub(crate) fn set(&mut self, lane: usize, closest: Option<ClosestHit>) {
        let bit = 1 << lane;
        self.undecided &= !bit;
        self.far &= !bit;
        self.tied &= !bit;
        self.ids.set(lane, closest.map(|closest| closest.hit.id));
        let Some(ClosestHit { hit, tied }) = closest else { return };
        self.ts.set(lane, hit.root.t());
        self.errors.set(lane, hit.root.error());
        if hit.far {
            self.far |= bit;
        }
        if !tied.is_empty() {
            self.tied |= bit;
            self.ties[lane] = tied;
        }
    }
}

impl SurfacePacket {
    /// No surface points.
    pub(crate) const EMPTY: Self = Self {
        lanes: 0,
        points: Vectors::splat(DVec3::ZERO),
        normals: Vectors::splat(DVec3::Y),
        from_outside: 0,
        ts: Numbers::splat(0.0),
        rests: Numbers::splat(0.0),
        first_equals: ShapeIds::NONE,
        tied: 0,
        ties: [CoincidentHits::NONE; LANES],
    };

    /// Removes all points.
    #[inline]
    pub(crate) fn clear(&mut self) {
        (self.lanes, self.from_outside, self.tied) = (0, 0, 0);
    }

    /// Replaces the list of the other coincident surfaces at the point in a lane.
    pub(crate) fn set_ties(&mut self, lane: usize, ties: CoincidentHits) {
        self.tied = self.tied & !(1 << lane) | u32::from(ties != CoincidentHits::NONE) << lane;
        self.ties[lane] = ties;
    }

    /// Returns the surface point in a lane, with its hit.
    #[inline]
    pub(crate) fn get(&self, lane: usize, hits: &HitPacket) -> Option<SurfacePoint> {
        let bit = 1 << lane;
        Some(SurfacePoint {
            hit: hits.get(lane)?.hit,
            first_equal: self.first_equals.get(lane)?,
            ties: if self.tied & bit == 0 { CoincidentHits::NONE } else { self.ties[lane] },
            t: Double { high: self.ts.get(lane), low: self.rests.get(lane) },
            point: self.points.get(lane),
            normal: self.normals.get(lane),
            from_outside: self.from_outside & bit != 0,
        })
    }

    /// Returns the distances of the points from the origins of the rays that found them, in half of the lanes, and the lanes in which they
    /// equal [`SurfacePoint::distance`].
    #[inline(always)]
    pub(crate) fn distances<S: Simd>(&self, simd: S, rays: &RayPacket, half: usize) -> (F64s<S>, Mask<S>) {
        let t = Double { high: self.ts.load(simd, half), low: self.rests.load(simd, half) };
        let direction = rays.directions.load(simd, half);
        let [x, y, z] = direction;
        let squares = [Double::product(x, x), Double::product(y, y), Double::product(z, z)];
        let length = (squares[0] + squares[1] + squares[2]).root_of_positive();
        ((t * length).high, moderate(t.high) & moderate3(direction))
    }

    /// Sets the surface point of a lane that has none. The visible shape, whose hit is also set in `hits`, can differ from the first one hit.
    #[inline]
    pub(crate) fn set(&mut self, lane: usize, point: &SurfacePoint, hits: &mut HitPacket) {
        let bit = 1 << lane;
        hits.ids.set(lane, Some(point.hit.id));
        hits.far = hits.far & !bit | u32::from(point.hit.far) << lane;
        self.lanes |= bit;
        self.points.set(lane, point.point);
        self.normals.set(lane, point.normal);
        self.ts.set(lane, point.t.rounded());
        self.rests.set(lane, point.t.rest());
        self.first_equals.set(lane, Some(point.first_equal));
        if point.from_outside {
            self.from_outside |= bit;
        }
        if point.ties != CoincidentHits::NONE {
            self.tied |= bit;
            self.ties[lane] = point.ties;
        }
    }
}
