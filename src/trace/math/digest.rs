//! Digests of numbers: equal ones have equal digests, and others never, as far as anybody knows.
//!
//! They are those of BLAKE3 (O'Connor, Aumasson, Neves, Wilcox-O'Hearn, "BLAKE3: one function, fast everywhere", 2020).

use glam::DVec3;
use rayon::prelude::*;

use crate::color::Rgb;

/// The bytes of numbers, one after the other. Zeros of either sign are alike, as no picture tells them apart.
#[derive(Default)]
pub(crate) struct Bytes(Vec<u8>);

impl Bytes {
    /// Adds a number.
    #[inline]
    pub(crate) fn number(&mut self, number: f64) {
        self.0.extend_from_slice(&(number + 0.0).to_le_bytes());
    }

    /// Adds the coordinates of vectors.
    pub(crate) fn vectors<const COUNT: usize>(&mut self, vectors: [DVec3; COUNT]) {
        vectors.into_iter().flat_map(|vector| vector.to_array()).for_each(|number| self.number(number));
    }

    /// Adds the channels of colours.
    pub(crate) fn colors<const COUNT: usize>(&mut self, colors: [Rgb; COUNT]) {
        colors.into_iter().flat_map(|color| color.to_array()).for_each(|channel| self.number(channel.into()));
    }

    /// Adds a whole number: a count, or which of several cases it is.
    pub(crate) fn count(&mut self, count: impl Into<u64>) {
        self.0.extend_from_slice(&count.into().to_le_bytes());
    }

    /// Adds a digest.
    pub(crate) fn digest(&mut self, digest: &Digest) {
        self.0.extend_from_slice(digest);
    }

    /// Returns the digest of all of them.
    pub(crate) fn finish(&self) -> Digest {
        *blake3::hash(&self.0).as_bytes()
    }
}

/// The digest of some bytes.
pub(crate) type Digest = [u8; 32];

/// Returns the digest of so many things, each of which writes its bytes; on the current rayon pool's threads.
pub(crate) fn digest_of_all(count: usize, write: impl Fn(usize, &mut Bytes) + Sync) -> Digest {
    /// How many a thread takes at a time. Digests depend on it.
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
