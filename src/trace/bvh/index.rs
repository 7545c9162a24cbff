//! Indices in 32 bits.

/// Returns an index in 32 bits, of which a scene has fewer than 2^28.
pub(super) fn to_u32(index: usize) -> u32 {
    debug_assert!(u32::try_from(index).is_ok(), "{index}");
    u32::try_from(index).unwrap_or(u32::MAX)
}
