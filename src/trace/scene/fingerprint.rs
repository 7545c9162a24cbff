//! Numbers that equal things have in common, and others hardly ever.

/// The fingerprint of a sequence of numbers. Zeros of either sign are alike.
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

    /// Returns the fingerprint of all numbers so far.
    #[inline]
    pub(super) fn finish(self) -> u64 {
        self.0 ^ self.0 >> 32
    }
}
