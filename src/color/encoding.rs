//! Encodings of the pixels of a film.

use std::fmt;

use super::Rgb;

/// The encoding of a film's pixels: linear light, or output bytes by a [`Transfer`](super::Transfer).
pub trait Encoding: Copy + PartialEq + fmt::Debug + Send + Sync {
    /// An encoded pixel.
    type Pixel: Copy + PartialEq + fmt::Debug + Send + Sync;

    /// Returns black pixels without writing to their memory. The system provides zeroed pages to the threads that write to them first.
    fn black(self, count: usize) -> Vec<Self::Pixel>;

    /// Encodes linear pixels one by one. Their channels are finite and 0 or more.
    fn encode_all<const COUNT: usize>(self, linear: [Rgb; COUNT]) -> [Self::Pixel; COUNT];
}

/// Linear light without conversion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Linear;

impl Encoding for Linear {
    type Pixel = Rgb;

    fn black(self, count: usize) -> Vec<Rgb> {
        bytemuck::zeroed_vec(count)
    }

    #[inline(always)]
    fn encode_all<const COUNT: usize>(self, linear: [Rgb; COUNT]) -> [Rgb; COUNT] {
        linear
    }
}
