//! What shapes are called in the kernel.

/// Identifies a shape in the kernel's arrays. Ids are numbered in document order: of two surfaces at the same distance
/// the one with the lower id is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ShapeId(pub u32);

impl ShapeId {
    /// Returns it as an index into arrays of one entry a shape.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}
