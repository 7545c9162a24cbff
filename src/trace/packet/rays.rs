//! Sixteen rays with a common origin, coordinate by coordinate.

use fearless_simd::{f64x8, mask32x8, mask64x8, prelude::*, u32x8};

use crate::trace::math::Root;
use crate::trace::query::Hit;
use crate::trace::rays::{Ray, ShapeId};
use crate::trace::shapes::SLOWEST;

/// How many rays a packet has.
pub(crate) const LANES: usize = 16;

/// Lanes of half a packet: as many `f64` as the widest vectors hold.
pub(super) const HALF: usize = LANES / 2;

/// A number of every ray.
pub(super) type Numbers = [[f64; HALF]; 2];

/// The same number of half of the rays.
pub(super) type F64s<S> = f64x8<S>;

/// No shape.
const MISS: u32 = u32::MAX;

/// The rays, and what they have met so far.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Packet {
    pub(super) direction: [Numbers; 3],
    /// 1 / direction, coordinate by coordinate.
    pub(super) inverse: [Numbers; 3],
    pub(super) inverse_square: Numbers,
    /// How fast each ray gains depth, in the tree's frame.
    depth: Numbers,
    /// Where the nearest hit is; infinity where there is none.
    t: Numbers,
    /// A bound of its error.
    error: Numbers,
    ids: [u32; LANES],
    /// How many lanes have rays, the first ones.
    count: usize,
    /// Rays with a coordinate of their direction so small that its reciprocal may not be finite.
    slow: u32,
    /// Rays that the scalar code has to decide.
    open: u32,
}

/// What half of the rays have to do with a shape.
pub(super) struct Verdicts<S: Simd> {
    pub(super) t: F64s<S>,
    pub(super) error: F64s<S>,
    /// Rays that certainly meet it, at `t`.
    pub(super) hit: mask64x8<S>,
    /// Rays of which it is not certain that they meet it or not.
    pub(super) open: mask64x8<S>,
}

impl Packet {
    /// Of no ray.
    pub(super) const EMPTY: Self = Self {
        direction: [[[1.0; HALF]; 2]; 3],
        inverse: [[[1.0; HALF]; 2]; 3],
        inverse_square: [[1.0; HALF]; 2],
        depth: [[0.0; HALF]; 2],
        t: [[f64::INFINITY; HALF]; 2],
        error: [[0.0; HALF]; 2],
        ids: [MISS; LANES],
        count: 0,
        slow: 0,
        open: 0,
    };

    /// Takes all rays out.
    pub(super) fn clear(&mut self) {
        self.t = [[f64::INFINITY; HALF]; 2];
        self.error = [[0.0; HALF]; 2];
        self.ids = [MISS; LANES];
        (self.count, self.slow, self.open) = (0, 0, 0);
    }

    /// Returns how many rays there are.
    #[inline]
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Returns how many halves of the lanes have rays.
    #[inline]
    pub(super) fn halves(&self) -> usize {
        self.count.div_ceil(HALF)
    }

    /// Puts a ray into the next lane.
    ///
    /// # Panics
    ///
    /// Where all lanes have rays.
    #[inline]
    pub(super) fn push(&mut self, ray: &Ray, depth: f64) {
        let (half, index) = (self.count / HALF, self.count % HALF);
        let direction = ray.direction();
        for axis in 0..3 {
            self.direction[axis][half][index] = direction[axis];
            self.inverse[axis][half][index] = direction[axis].recip();
        }
        self.inverse_square[half][index] = ray.inverse_square();
        self.depth[half][index] = depth;
        if direction.abs().min_element() <= SLOWEST {
            self.slow |= 1 << self.count;
        }
        self.count += 1;
    }

    /// Returns all lanes that have rays.
    #[inline]
    pub(super) fn all(&self) -> u32 {
        (1 << self.count) - 1
    }

    /// Returns the lanes of rays that boxes cannot be asked with.
    #[inline]
    pub(super) fn slow(&self) -> u32 {
        self.slow
    }

    /// Leaves such rays to the scalar code.
    #[inline]
    pub(super) fn leave_slow_open(&mut self) {
        self.open |= self.slow;
    }

    /// Leaves all rays to the scalar code.
    pub(super) fn leave_open(&mut self) {
        self.open = self.all();
    }

    /// Returns whether the scalar code has to decide what a ray meets.
    #[inline]
    pub(super) fn is_open(&self, lane: usize) -> bool {
        self.open & (1 << lane) != 0
    }

    /// Returns until where half of the rays may have their nearest hits.
    #[inline(always)]
    pub(super) fn latest<S: Simd>(&self, simd: S, half: usize) -> F64s<S> {
        load(simd, &self.t[half]) + load(simd, &self.error[half])
    }

    /// Takes a shape's verdicts on half of the rays into account. Of hits that may be at the same place none is taken for the
    /// nearer one: such rays are open. Says whether any hit is nearer than those before.
    #[inline(always)]
    pub(super) fn consider<S: Simd>(
        &mut self,
        simd: S,
        half: usize,
        verdicts: &Verdicts<S>,
        id: ShapeId,
    ) -> bool {
        let Verdicts { t, error, hit, open } = *verdicts;
        let (best, best_error) = (load(simd, &self.t[half]), load(simd, &self.error[half]));
        // What is infinitely far away is not met.
        let hit = hit & t.simd_lt(f64x8::splat(simd, f64::INFINITY));
        let not_farther = hit & (t - error).simd_le(best + best_error);
        let nearer = hit & (t + error).simd_lt(best - best_error);
        self.open |= (bits(not_farther) & !bits(nearer) | bits(open)) << (half * HALF);
        let any = nearer.any_true();
        if any {
            nearer.select(t, best).store_array(&mut self.t[half]);
            nearer.select(error, best_error).store_array(&mut self.error[half]);
            if let Some(ids) = self.ids[half * HALF..].first_chunk_mut::<HALF>() {
                let nearer = mask32x8::from_bitmask(simd, bits(nearer).into());
                nearer.select(u32x8::splat(simd, id.0), u32x8::load_array_ref(simd, ids)).store_array(ids);
            }
        }
        any
    }

    /// Takes a hit of one ray into account, likewise.
    pub(super) fn consider_one(&mut self, lane: usize, hit: &Hit) -> bool {
        let (half, index) = (lane / HALF % 2, lane % HALF);
        let best = Root::within(self.t[half][index], self.error[half][index]);
        if hit.root.latest() < best.earliest() {
            (self.t[half][index], self.error[half][index]) = (hit.root.t(), hit.root.error());
            self.ids[lane] = hit.id.0;
            return true;
        }
        if hit.root.earliest() <= best.latest() {
            self.open |= 1 << lane;
        }
        false
    }

    /// Returns the greatest depth at which any of the rays may have its nearest hit, in the tree's frame; infinity where one
    /// has none.
    #[inline(always)]
    pub(super) fn farthest<S: Simd>(&self, simd: S) -> f64 {
        let mut farthest = f64::NEG_INFINITY;
        for half in 0..self.halves() {
            let active = mask64x8::from_bitmask(simd, (self.all() >> (half * HALF) & 0xff).into());
            let depth = self.latest(simd, half) * load(simd, &self.depth[half]);
            let depth = active.select(depth, f64x8::splat(simd, f64::NEG_INFINITY));
            farthest = farthest.max(depth.reduce_max());
        }
        farthest
    }

    /// Returns what the ray in a lane meets first, as far as it was decided.
    pub(super) fn nearest(&self, lane: usize) -> Option<Hit> {
        let (half, index) = (lane / HALF % 2, lane % HALF);
        let root = Root::within(self.t[half][index], self.error[half][index]);
        (self.ids[lane] != MISS).then(|| Hit { root, id: ShapeId(self.ids[lane]), far: false })
    }
}

#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, numbers: &[f64; HALF]) -> F64s<S> {
    f64x8::load_array_ref(simd, numbers)
}

/// Lanes as bits of a `u32`.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "eight lanes")]
pub(super) fn bits<S: Simd>(mask: mask64x8<S>) -> u32 {
    mask.to_bitmask() as u32
}
