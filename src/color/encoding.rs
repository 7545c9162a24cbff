//! What a film keeps of light.

use super::Rgb;

/// How a film keeps its pixels: as linear light, or as output bytes, by a [`Transfer`](super::Transfer).
pub trait Encoding: Copy + Send + Sync {
    /// What is kept of a pixel.
    type Pixel: Copy + Send + Sync;

    /// Returns black pixels, without a write to their memory: the system hands it out zeroed, page by page, to the threads that
    /// write to it first.
    fn black(self, count: usize) -> Vec<Self::Pixel>;

    /// Encodes linear pixels, whose channels are finite and 0 or more, one by one.
    fn encode_all<const COUNT: usize>(self, linear: [Rgb; COUNT]) -> [Self::Pixel; COUNT];
}

/// Linear light as it is.
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
