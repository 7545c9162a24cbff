//! A picture as it is in a file.

/// A picture as it is in a file.
pub(super) struct Picture {
    /// Columns and rows.
    pub(super) size: (u32, u32),
    /// Red, green and blue of pixel after pixel, row by row from the top.
    pub(super) rgb: Vec<u8>,
    /// What stands where the provenance should.
    pub(super) provenance: Option<String>,
}
