//! What shapes are called in the kernel.

/// Identifies a shape in the kernel's arrays. It stays the same shape's while the scene is
/// updated, and says nothing of the order of shapes in the document.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ShapeId(pub u32);

impl ShapeId {
    /// Returns it as an index into arrays of one entry a shape.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}
