//! A picture as it is in a file.

/// A picture as it is in a file.
pub(super) struct Picture {
    /// Columns and rows.
    pub(super) size: (u32, u32),
    /// The bytes of its pixels, in the order of its format.
    pub(super) bytes: Vec<u8>,
    /// What stands where the provenance should.
    pub(super) provenance: Option<String>,
}
