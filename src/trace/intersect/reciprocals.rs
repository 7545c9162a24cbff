//! Reciprocals of a packet's rays, computed when a shape first needs them.

use fearless_simd::prelude::*;
use glam::DVec3;

use crate::trace::math::{F64s, F64s3, Numbers, Vectors, bits, dot, splat};
use crate::trace::rays::RayPacket;
use crate::trace::shapes::SLOWEST;

/// The reciprocals of a packet's direction components and of its squared directions, each valid only if its flag is set.
#[derive(Clone, Debug)]
pub(super) struct Reciprocals {
    directions: Vectors,
    directions_known: bool,
    /// Lanes with a direction component so small that its reciprocal may not be finite.
    slow: u32,
    squares: Numbers,
    squares_known: bool,
}

impl Reciprocals {
    pub(super) const UNKNOWN: Self = Self {
        directions: Vectors::splat(DVec3::ONE),
        directions_known: false,
        slow: 0,
        squares: Numbers::splat(1.0),
        squares_known: false,
    };

    /// Invalidates the reciprocals, for other rays.
    #[inline(always)]
    pub(super) fn forget(&mut self) {
        (self.directions_known, self.squares_known) = (false, false);
    }

    /// Returns 1 / direction of half of the rays, component by component, and the lanes of the whole packet in which it may not be finite.
    #[inline(always)]
    pub(super) fn of_directions<S: Simd>(
        &mut self,
        simd: S,
        rays: &RayPacket,
        half: usize,
    ) -> (F64s3<S>, u32) {
        if !self.directions_known {
            (self.directions_known, self.slow) = (true, 0);
            for half in 0..2 {
                let mut direction = rays.directions.load(simd, half);
                for coordinate in &mut direction {
                    let slow = coordinate.abs().simd_le(splat(simd, SLOWEST));
                    self.slow |= bits(slow, half);
                    *coordinate = splat(simd, 1.0) / *coordinate;
                }
                self.directions.store(half, direction);
            }
        }
        (self.directions.load(simd, half), self.slow)
    }

    /// Returns 1 / direction.direction of half of the rays.
    #[inline(always)]
    pub(super) fn of_squares<S: Simd>(&mut self, simd: S, rays: &RayPacket, half: usize) -> F64s<S> {
        if !self.squares_known {
            self.squares_known = true;
            for half in 0..2 {
                let direction = rays.directions.load(simd, half);
                self.squares.store(half, splat(simd, 1.0) / dot(direction, direction));
            }
        }
        self.squares.load(simd, half)
    }
}
