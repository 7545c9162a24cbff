//! Ids of shapes in the kernel.

use fearless_simd::{prelude::*, u32x16};

use crate::trace::math::{LANES, WHOLE, bits16, mask16};

/// Identifies a shape in the kernel's arrays. Ids are stable while the scene is updated, and independent of the document order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ShapeId(pub u32);

impl ShapeId {
    /// Returns the index into arrays with one entry per shape.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A shape, or none, for each of sixteen lanes.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct ShapeIds([u32; LANES]);

impl ShapeIds {
    /// Larger than any id: there are at most 2^28 shapes.
    const MISSING: u32 = u32::MAX;

    /// No shape in any lane.
    pub(crate) const NONE: Self = Self([Self::MISSING; LANES]);

    /// Returns the same shape in every lane.
    #[inline(always)]
    pub(crate) fn splat(id: ShapeId) -> Self {
        Self([id.0; LANES])
    }

    /// Returns the shape of a lane.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Option<ShapeId> {
        let id = self.0[lane % LANES];
        (id != Self::MISSING).then_some(ShapeId(id))
    }

    /// Sets the shape of a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, id: Option<ShapeId>) {
        self.0[lane % LANES] = id.map_or(Self::MISSING, |id| id.0);
    }

    /// Sets the shape of the lanes in a bit mask.
    #[inline(always)]
    pub(crate) fn replace<S: Simd>(&mut self, simd: S, lanes: u32, id: ShapeId) {
        let mask = mask16(simd, lanes);
        let before = u32x16::load_array_ref(simd, &self.0);
        mask.select(u32x16::splat(simd, id.0), before).store_array(&mut self.0);
    }

    /// Returns the lanes with this shape, as a bit mask.
    #[inline(always)]
    pub(crate) fn lanes_of<S: Simd>(&self, simd: S, id: ShapeId) -> u32 {
        bits16(u32x16::load_array_ref(simd, &self.0).simd_eq(u32x16::splat(simd, id.0)))
    }

    /// Returns the lanes with any shape, as a bit mask.
    #[inline(always)]
    pub(crate) fn lanes<S: Simd>(&self, simd: S) -> u32 {
        !self.lanes_of(simd, ShapeId(Self::MISSING)) & WHOLE
    }

    /// Returns the shape of the first of some lanes, if all of them have the same one.
    #[inline(always)]
    pub(crate) fn common<S: Simd>(&self, simd: S, lanes: u32) -> Option<ShapeId> {
        let first = ShapeId(self.0[lanes.trailing_zeros() as usize % LANES]);
        (lanes & !self.lanes_of(simd, first) == 0).then_some(first)
    }
}
