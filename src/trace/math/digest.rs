//! Digests of numbers. Equal inputs have equal digests; no two different inputs with equal digests are known.
//!
//! The hash function is BLAKE3 (O'Connor, Aumasson, Neves, Wilcox-O'Hearn, "BLAKE3: one function, fast everywhere", 2020).

use glam::DVec3;
use rayon::prelude::*;

use crate::color::Rgb;

/// Concatenated bytes of numbers. Zeros of either sign have equal bytes, because no image depends on the sign of a zero.
#[derive(Default)]
pub(crate) struct Bytes(Vec<u8>);

impl Bytes {
    /// Appends a number.
    #[inline]
    pub(crate) fn number(&mut self, number: f64) {
        self.0.extend_from_slice(&(number + 0.0).to_le_bytes());
    }

    /// Appends the coordinates of vectors.
    pub(crate) fn vectors<const COUNT: usize>(&mut self, vectors: [DVec3; COUNT]) {
        vectors.into_iter().flat_map(|vector| vector.to_array()).for_each(|number| self.number(number));
    }

    /// Appends the channels of colours.
    pub(crate) fn colors<const COUNT: usize>(&mut self, colors: [Rgb; COUNT]) {
        colors.into_iter().flat_map(|color| color.to_array()).for_each(|channel| self.number(channel.into()));
    }

    /// Appends an integer: a count, or the index of an enum variant.
    pub(crate) fn count(&mut self, count: impl Into<u64>) {
        self.0.extend_from_slice(&count.into().to_le_bytes());
    }

    /// Appends a digest.
    pub(crate) fn digest(&mut self, digest: &Digest) {
        self.0.extend_from_slice(digest);
    }

    /// Returns the digest of the bytes.
    pub(crate) fn finish(&self) -> Digest {
        *blake3::hash(&self.0).as_bytes()
    }

    /// Returns the first 64 bits of the digest of the bytes, and removes the bytes.
    pub(crate) fn short_digest(&mut self) -> u64 {
        let digest = self.finish();
        self.0.clear();
        digest.first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes))
    }
}

/// A BLAKE3 digest.
pub(crate) type Digest = [u8; 32];

/// Returns the digest of `count` items. `write` appends the bytes of the item with the given index. Runs on the current rayon pool's
/// threads.
pub(crate) fn digest_of_all(count: usize, write: impl Fn(usize, &mut Bytes) + Sync) -> Digest {
    /// Number of items in a parallel chunk. Digests depend on it.
    const TOGETHER: usize = 4096;
    let parts = (0..count.div_ceil(TOGETHER)).into_par_iter().map(|part| {
        let mut bytes = Bytes::default();
        (part * TOGETHER..count.min((part + 1) * TOGETHER)).for_each(|index| write(index, &mut bytes));
        bytes.finish()
    });
    let mut all = Bytes::default();
    all.count(count as u64);
    for part in parts.collect::<Vec<Digest>>() {
        all.digest(&part);
    }
    all.finish()
}
