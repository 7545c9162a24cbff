//! What shapes are called in the kernel.

/// A shape's place in the kernel's arrays. Slots are numbered in document order: of two surfaces at the same distance
/// the one with the lower slot is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ShapeId(pub u32);

impl ShapeId {
    /// As an index into per-slot arrays.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}
