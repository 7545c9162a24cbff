//! Conversion of indices to 32 bits.

/// Converts an index to 32 bits. Shape indices are below 2^28.
pub(super) fn to_u32(index: usize) -> u32 {
    debug_assert!(u32::try_from(index).is_ok(), "{index}");
    u32::try_from(index).unwrap_or(u32::MAX)
}
