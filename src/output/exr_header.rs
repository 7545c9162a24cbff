//! The beginning of OpenEXR files, which builds without the feature `exr` read, too.

use std::io::Read;

/// Magic number of OpenEXR files.
pub(super) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// Name, type and length of the attribute that holds the corners of the picture.
const WINDOW_BEGINS: [&[u8]; 3] = [b"dataWindow", b"\0box2i\0", &[16, 0, 0, 0]];

/// Returns the width and height from the beginning of a file.
pub(super) fn size(file: impl Read) -> Option<(u32, u32)> {
    /// Upper bound on the size of all attributes in bytes.
    const BEGINNING: u64 = 8192;
    let mut bytes = Vec::new();
    file.take(BEGINNING).read_to_end(&mut bytes).ok()?;
    let place = after(&bytes, &WINDOW_BEGINS).filter(|_| bytes.starts_with(&MAGIC))?;
    let (corners, _) = bytes[place..].as_chunks::<4>();
    let [left, top, right, bottom] = *corners.first_chunk()?;
    let [left, top, right, bottom] =
        [left, top, right, bottom].map(|corner| i64::from(i32::from_le_bytes(corner)));
    let side = |first: i64, last: i64| u32::try_from(last - first + 1).ok();
    Some((side(left, right)?, side(top, bottom)?))
}

/// Returns the position after the first occurrence of `these` in `bytes`.
pub(super) fn after(bytes: &[u8], these: &[&[u8]]) -> Option<usize> {
    let these = these.concat();
    bytes.windows(these.len()).position(|window| window == these).map(|place| place + these.len())
}
