//! Fingerprints: numbers that equal things share, and different things hardly ever do.

/// The fingerprint of a sequence of numbers. Zeros of either sign are equal.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Fingerprint(u64);

impl Fingerprint {
    /// Adds the next number.
    #[inline]
    pub(super) fn add(&mut self, number: f64) {
        // The multiplier of Knuth's multiplicative hashing, The Art of Computer Programming 3, section 6.4, for 64 bits.
        const MULTIPLIER: u64 = 0x9e37_79b9_7f4a_7c15;
        self.0 = (self.0.rotate_left(29) ^ (number + 0.0).to_bits()).wrapping_mul(MULTIPLIER);
    }

    /// Returns the fingerprint of all numbers added so far.
    #[inline]
    pub(super) fn finish(self) -> u64 {
        self.0 ^ self.0 >> 32
    }
}

/// A set of fingerprints that reports each one as certainly absent or possibly present.
pub(super) struct BloomFilter(Vec<u64>);

impl BloomFilter {
    /// Creates an empty set with at least this many bits.
    pub(super) fn new(bits: usize) -> Self {
        Self(vec![0; bits.div_ceil(64).next_power_of_two()])
    }

    /// Adds a fingerprint, and returns whether it may have been present before.
    #[inline]
    pub(super) fn insert(&mut self, fingerprint: u64) -> bool {
        let (word, bit) = self.place(fingerprint);
        let before = self.0[word];
        self.0[word] |= bit;
        before & bit != 0
    }

    /// Returns whether a fingerprint may have been added.
    #[inline]
    pub(super) fn may_contain(&self, fingerprint: u64) -> bool {
        let (word, bit) = self.place(fingerprint);
        self.0[word] & bit != 0
    }

    fn place(&self, fingerprint: u64) -> (usize, u64) {
        ((fingerprint / 64) as usize & (self.0.len() - 1), 1 << (fingerprint % 64))
    }
}
