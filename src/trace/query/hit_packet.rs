//! What sixteen rays meet.

use fearless_simd::Simd;
use glam::DVec3;

use super::hit::{ClosestHit, Hit, SurfacePoint, TiedHits};
use crate::trace::math::{
    Double, DoubleLanes, F64s, LANES, Mask, Numbers, Root, Vectors, moderate, moderate3,
};
use crate::trace::rays::{RayPacket, ShapeIds, Ties};

/// What rays meet first, lane by lane.
#[derive(Clone, Debug)]
pub(crate) struct HitPacket {
    /// Infinity where nothing is met.
    pub(crate) ts: Numbers,
    /// Bounds of their errors.
    pub(crate) errors: Numbers,
    /// What is met.
    pub(crate) ids: ShapeIds,
    /// Lanes in which it is the far side of a shape that the ray left inwards.
    pub(crate) far: u32,
    /// Lanes in which something else is met at the same place.
    pub(crate) tied: u32,
    ties: [TiedHits; LANES],
    /// Lanes of rays that have to be followed one by one.
    pub(crate) open: u32,
}

/// Where on surfaces that is, lane by lane.
#[derive(Clone, Debug)]
pub(crate) struct SurfacePacket {
    /// Lanes that have a point.
    pub(crate) lanes: u32,
    pub(crate) points: Vectors,
    /// The outward unit normals.
    pub(crate) normals: Vectors,
    /// Lanes whose rays came from the side that the normal points to.
    pub(crate) from_outside: u32,
    /// The rays' parameters there, rounded, and what rounding left over.
    pub(crate) ts: Numbers,
    pub(crate) rests: Numbers,
    /// The first in document order of all shapes that equal what is met.
    pub(crate) first_equals: ShapeIds,
    /// Lanes in which there are other surfaces at the point.
    pub(crate) tied: u32,
    ties: [Ties; LANES],
}

impl HitPacket {
    /// Of rays that have met nothing.
    pub(crate) const EMPTY: Self = Self {
        ts: Numbers::splat(f64::INFINITY),
        errors: Numbers::splat(0.0),
        ids: ShapeIds::NONE,
        far: 0,
        tied: 0,
        ties: [TiedHits::NONE; LANES],
        open: 0,
    };

    /// Forgets all hits.
    #[inline]
    pub(crate) fn clear(&mut self) {
        self.ts = Numbers::splat(f64::INFINITY);
        self.errors = Numbers::splat(0.0);
        self.ids = ShapeIds::NONE;
        (self.far, self.tied, self.open) = (0, 0, 0);
    }

    /// Returns what is met in a lane, as far as that is decided.
    #[inline]
    pub(crate) fn get(&self, lane: usize) -> Option<ClosestHit> {
        let bit = 1 << lane;
        let id = self.ids.get(lane)?;
        let root = Root::within(self.ts.get(lane), self.errors.get(lane));
        let hit = Hit { root, id, far: self.far & bit != 0 };
        let tied = if self.tied & bit == 0 { TiedHits::NONE } else { self.ties[lane] };
        Some(ClosestHit { hit, tied })
    }

    /// Decides what is met in a lane.
    #[inline]
    pub(crate) fn set(&mut self, lane: usize, closest: Option<ClosestHit>) {
        let bit = 1 << lane;
        self.open &= !bit;
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
    /// Without points.
    pub(crate) const EMPTY: Self = Self {
        lanes: 0,
        points: Vectors::splat(DVec3::ZERO),
        normals: Vectors::splat(DVec3::Y),
        from_outside: 0,
        ts: Numbers::splat(0.0),
        rests: Numbers::splat(0.0),
        first_equals: ShapeIds::NONE,
        tied: 0,
        ties: [Ties::NONE; LANES],
    };

    /// Forgets all points.
    #[inline]
    pub(crate) fn clear(&mut self) {
        (self.lanes, self.from_outside, self.tied) = (0, 0, 0);
    }

    /// Returns the point in a lane that has one, and what was met there.
    #[inline]
    pub(crate) fn get(&self, lane: usize, hits: &HitPacket) -> Option<SurfacePoint> {
        let bit = 1 << lane;
        Some(SurfacePoint {
            hit: hits.get(lane)?.hit,
            first_equal: self.first_equals.get(lane)?,
            ties: if self.tied & bit == 0 { Ties::NONE } else { self.ties[lane] },
            t: Double { high: self.ts.get(lane), low: self.rests.get(lane) },
            point: self.points.get(lane),
            normal: self.normals.get(lane),
            from_outside: self.from_outside & bit != 0,
        })
    }

    /// Returns how far points are from the origins of the rays that found them, in half of the lanes, and in which of these that is
    /// what [`SurfacePoint::distance`] says.
    #[inline(always)]
    pub(crate) fn distances<S: Simd>(&self, simd: S, rays: &RayPacket, half: usize) -> (F64s<S>, Mask<S>) {
        let t = DoubleLanes { high: self.ts.load(simd, half), low: self.rests.load(simd, half) };
        let direction = rays.directions.load(simd, half);
        let [x, y, z] = direction;
        let squares = [DoubleLanes::product(x, x), DoubleLanes::product(y, y), DoubleLanes::product(z, z)];
        let length = (squares[0] + squares[1] + squares[2]).sqrt();
        ((t * length).high, moderate(simd, t.high) & moderate3(simd, direction))
    }

    /// Puts a point into a lane that has none. What is seen there may be another shape than the one that was met first.
    #[inline]
    pub(crate) fn set(&mut self, lane: usize, point: &SurfacePoint, hits: &mut HitPacket) {
        let bit = 1 << lane;
        hits.ids.set(lane, Some(point.hit.id));
        self.lanes |= bit;
        self.points.set(lane, point.point);
        self.normals.set(lane, point.normal);
        self.ts.set(lane, point.t.rounded());
        self.rests.set(lane, point.t.rest());
        self.first_equals.set(lane, Some(point.first_equal));
        if point.from_outside {
            self.from_outside |= bit;
        }
        if point.ties != Ties::NONE {
            self.tied |= bit;
            self.ties[lane] = point.ties;
        }
    }
}
