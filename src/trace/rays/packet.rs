//! Packets of sixteen rays.

use super::coincident_hits::CoincidentHits;
use super::ray::{PreparedRay, Rays};
use super::shape_id::ShapeIds;
use super::surface_exclusion::SurfaceExclusion;
use crate::trace::math::{F64s, LANES, Vectors};
use fearless_simd::Simd;
use glam::DVec3;

/// Up to sixteen rays, one per lane.
#[derive(Clone, Debug)]
pub(crate) struct RayPacket {
    pub(crate) origins: Vectors,
    pub(crate) directions: Vectors,
    /// Lanes that hold rays, as a bit mask.
    pub(crate) lanes: u32,
    /// The shapes that the rays leave.
    pub(crate) left: ShapeIds,
    /// Lanes whose rays leave a shape.
    pub(crate) departing: u32,
    /// Lanes whose rays go out of the shape that they leave.
    pub(crate) outward: u32,
    /// Lanes whose rays leave other shapes at the same point.
    pub(crate) tied: u32,
    ties: [CoincidentHits; LANES],
}

impl RayPacket {
    /// The packet without rays. The values in empty lanes are valid operands.
    pub(crate) const EMPTY: Self = Self {
        origins: Vectors::splat(DVec3::ZERO),
        directions: Vectors::splat(DVec3::ONE),
        lanes: 0,
        left: ShapeIds::NONE,
        departing: 0,
        outward: 0,
        tied: 0,
        ties: [CoincidentHits::NONE; LANES],
    };

    /// Removes all rays.
    #[inline]
    pub(crate) fn clear(&mut self) {
        (self.lanes, self.departing, self.outward, self.tied) = (0, 0, 0, 0);
        self.left = ShapeIds::NONE;
    }

    /// Removes all rays except those in some lanes.
    #[inline]
    pub(crate) fn keep(&mut self, lanes: u32) {
        self.lanes &= lanes;
        self.departing &= lanes;
        self.outward &= lanes;
        self.tied &= lanes;
    }

    /// Stores a ray in an empty lane.
    #[inline]
    pub(crate) fn set(&mut self, lane: usize, ray: &PreparedRay) {
        let bit = 1 << lane;
        self.origins.set(lane, ray.origin());
        self.directions.set(lane, ray.direction());
        self.lanes |= bit;
        if let Some(SurfaceExclusion { id, outward, ties }) = ray.exclusion().copied() {
            self.left.set(lane, Some(id));
            self.departing |= bit;
            if outward {
                self.outward |= bit;
            }
            if ties != CoincidentHits::NONE {
                self.tied |= bit;
                self.ties[lane] = ties;
            }
        }
    }

    /// Copies a ray of another packet into an empty lane.
    #[inline(always)]
    pub(crate) fn copy(&mut self, lane: usize, from: &Self, from_lane: usize) {
        let (bit, from_bit) = (1 << lane, 1 << from_lane);
        let bit_if = |mask: u32| if mask & from_bit == 0 { 0 } else { bit };
        self.origins.set(lane, from.origins.get(from_lane));
        self.directions.set(lane, from.directions.get(from_lane));
        self.left.set(lane, from.left.get(from_lane));
        self.lanes |= bit;
        self.departing |= bit_if(from.departing);
        self.outward |= bit_if(from.outward);
        self.tied |= bit_if(from.tied);
        if from.tied & from_bit != 0 {
            self.ties[lane] = from.ties[from_lane];
        }
    }

    /// Returns the lists of the other shapes that rays leave, for the rays that leave any.
    pub(crate) fn ties_mut(&mut self) -> impl Iterator<Item = &mut CoincidentHits> {
        let tied = self.tied;
        self.ties
            .iter_mut()
            .enumerate()
            .filter(move |(lane, _)| tied & (1 << lane) != 0)
            .map(|(_, ties)| ties)
    }

    /// Loads half of the rays.
    #[inline(always)]
    pub(crate) fn load<S: Simd>(&self, simd: S, half: usize) -> Rays<F64s<S>> {
        Rays { origin: self.origins.load(simd, half), direction: self.directions.load(simd, half) }
    }

    /// Returns the ray in a lane.
    #[inline]
    pub(crate) fn get(&self, lane: usize) -> PreparedRay {
        let bit = 1 << lane;
        let ties = if self.tied & bit == 0 { CoincidentHits::NONE } else { self.ties[lane] };
        let outward = self.outward & bit != 0;
        let left = self.left.get(lane).filter(|_| self.departing & bit != 0);
        let exclusion = left.map(|id| SurfaceExclusion { id, outward, ties });
        PreparedRay::scaled(self.origins.get(lane), self.directions.get(lane), exclusion)
    }
}
