//! The conversions of file colours to linear light, and of linear light to output bytes.

use std::sync::LazyLock;

use super::{Encoding, Rgb};

/// The conversion of file colours (0..=255 per channel) to linear light, and of linear light to output bytes.
///
/// Both conversions of a transfer are inverse: a file colour that reaches a pixel unchanged is output as its own bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Transfer {
    /// sRGB: file colours are decoded at load and pixels are encoded on output (IEC 61966-2-1). For pictures on screens.
    #[default]
    Srgb,
    /// Linear throughout: byte = floor(255 v + 0.5). This is the arithmetic of the classic local illumination model.
    Classic,
}

impl Transfer {
    /// Returns the linear light of a file colour whose channels are in 0..=255.
    ///
    /// ```
    /// use rayreel::color::Transfer;
    /// let half = Transfer::Srgb.decode([255.0, 188.0, 0.0]);
    /// assert!((half.y - 0.503).abs() < 1e-3);
    /// assert_eq!(Transfer::Srgb.encode(half), [255, 188, 0]);
    /// ```
    #[must_use]
    pub fn decode(self, file: [f64; 3]) -> Rgb {
        let linear = file.map(|channel| {
            let value = channel / 255.0;
            match self {
                Self::Classic => value,
                Self::Srgb => srgb_to_linear(value),
            }
        });
        rounded(linear)
    }

    /// Returns the file colour of linear light, the inverse of [`decode`](Self::decode) to the precision of `f32`. Light beyond 1 gives
    /// channels beyond 255.
    pub(crate) fn channels(self, linear: Rgb) -> [f64; 3] {
        linear.to_array().map(|channel| {
            255.0
                * match self {
                    Self::Classic => f64::from(channel),
                    Self::Srgb => linear_to_srgb(f64::from(channel)),
                }
        })
    }

    /// Returns the output values of a linear pixel, from 0 to 255, before they are rounded to bytes. Values outside 0..=1 are clamped.
    #[must_use]
    pub fn encode_unrounded(self, pixel: Rgb) -> [f64; 3] {
        self.channels(Rgb::from_array(pixel.to_array().map(clamped)))
    }

    /// Returns the output values of a linear pixel in 16 bits, from 0 to 65535: 257 times the 8-bit values, with 257 times their
    /// resolution. Values outside 0..=1 are clamped.
    #[must_use]
    pub fn encode_16(self, pixel: Rgb) -> [u16; 3] {
        pixel.to_array().map(|channel| {
            let value = match self {
                Self::Classic => f64::from(clamped(channel)),
                Self::Srgb => linear_to_srgb(f64::from(clamped(channel))),
            };
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "it is from 0 to 65535"
            )]
            let code = (65_535.0 * value + 0.5) as u16;
            code
        })
    }

    /// Returns the output bytes of a linear pixel. Values outside 0..=1 are clamped.
    #[must_use]
    pub fn encode(self, pixel: Rgb) -> [u8; 3] {
        let [encoded] = self.encode_all([pixel]);
        encoded
    }
}

/// Encodes pixels as [`Transfer::encode`] does, in less time per pixel.
impl Encoding for Transfer {
    type Pixel = [u8; 3];

    fn black(self, count: usize) -> Vec<[u8; 3]> {
        vec![[0; 3]; count]
    }

    #[inline(always)]
    fn encode_all<const COUNT: usize>(self, linear: [Rgb; COUNT]) -> [[u8; 3]; COUNT] {
        let mut encoded = [[0; 3]; COUNT];
        match self {
            Self::Classic => {
                for (encoded, pixel) in encoded.iter_mut().zip(linear) {
                    *encoded = [classic_byte(pixel.x), classic_byte(pixel.y), classic_byte(pixel.z)];
                }
            }
            Self::Srgb => {
                let levels = &*LEVELS;
                for (encoded, pixel) in encoded.iter_mut().zip(linear) {
                    *encoded = [levels.byte(pixel.x), levels.byte(pixel.y), levels.byte(pixel.z)];
                }
            }
        }
        encoded
    }
}

/// Clamps to 0..=1; NaN becomes 0.
#[inline]
fn clamped(linear: f32) -> f32 {
    let positive = if linear > 0.0 { linear } else { 0.0 };
    if positive < 1.0 { positive } else { 1.0 }
}

#[expect(clippy::cast_possible_truncation, reason = "rounding to f32 is the point")]
fn rounded(linear: [f64; 3]) -> Rgb {
    Rgb::from_array(linear.map(|channel| channel as f32))
}

/// Computes floor(255 v + 0.5) after clamping, in f64, where the product of a byte and an f32 is exact.
///
/// Adding 2^52 rounds a number to the nearest integer, which is then in its last bits. Ties are rounded to the even integer. The only tie
/// is at v = 1/2, where 128 is both even and correct: 255 m / 2^n = k + 1/2 requires a k for which 255 divides 2 k + 1.
#[expect(clippy::cast_possible_truncation, reason = "the last byte is asked for")]
#[inline]
fn classic_byte(linear: f32) -> u8 {
    const TWO_TO_52: f64 = 4_503_599_627_370_496.0;
    (255.0 * f64::from(clamped(linear)) + TWO_TO_52).to_bits() as u8
}

/// Decodes sRGB, 0..=1 to 0..=1.
fn srgb_to_linear(encoded: f64) -> f64 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) }
}

/// Encodes a number of 0 or more as sRGB.
fn linear_to_srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055 }
}

static LEVELS: LazyLock<SrgbLevels> = LazyLock::new(SrgbLevels::new);

/// The sRGB encoding by comparison with the 255 decision levels half-way between neighbouring codes. It is the exact inverse of decoding,
/// and needs no power function per pixel.
struct SrgbLevels {
    /// The smallest `f32` of every code but 0, followed by infinity.
    least: [f32; 256],
    /// The code of the smallest number in every bucket. The numbers of a bucket, from 2^-13 to 1, have the same exponent and the same first
    /// seven bits of the mantissa. A bucket has at most two codes.
    first: [u8; Self::ROOM],
}

impl SrgbLevels {
    /// The number of low bits in which the numbers of a bucket differ.
    const SHIFT: u32 = f32::MANTISSA_DIGITS - 1 - 7;
    /// The bucket of 2^-13. All smaller numbers have code 0.
    const START: u32 = (127 - 13) << 7;
    /// The number of buckets: 13 powers of two, and 1.
    const BUCKETS: usize = 13 * 128 + 1;
    /// The length of `first`: a power of two, so that the remainder is a valid index.
    const ROOM: usize = Self::BUCKETS.next_power_of_two();

    fn new() -> Self {
        let mut least = [f32::INFINITY; 256];
        for (code, least) in (0u8..255).zip(&mut least) {
            let level = srgb_to_linear((f64::from(code) + 0.5) / 255.0);
            #[expect(
                clippy::cast_possible_truncation,
                reason = "the neighbour above is taken where it is too small"
            )]
            let near = level as f32;
            *least = if f64::from(near) < level { near.next_up() } else { near };
        }
        let mut first = [0; Self::ROOM];
        for (bucket, first) in (Self::START..).zip(&mut first[..Self::BUCKETS]) {
            let number = f32::from_bits(bucket << Self::SHIFT);
            #[expect(clippy::cast_possible_truncation, reason = "there are 255 levels")]
            let code = least.partition_point(|least| *least <= number) as u8;
            *first = code;
        }
        Self { least, first }
    }

    /// Returns the code of a number, clamped to 0..=1.
    #[inline]
    fn byte(&self, linear: f32) -> u8 {
        let linear = clamped(linear);
        let bucket = (linear.to_bits() >> Self::SHIFT).saturating_sub(Self::START) as usize;
        let code = self.first[bucket % Self::ROOM];
        code + u8::from(self.least[usize::from(code)] <= linear)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_colours_come_back_from_light() {
        for transfer in [Transfer::Classic, Transfer::Srgb] {
            for code in 0..=2550 {
                let channel = f64::from(code) / 10.0;
                let [back, _, _] = transfer.channels(transfer.decode([channel; 3]));
                assert!((back - channel).abs() < 2e-5, "{transfer:?}, {channel}: {back}");
            }
        }
    }

    #[test]
    fn every_byte_survives_both_transfers() {
        for byte in 0..=255u8 {
            for transfer in [Transfer::Classic, Transfer::Srgb] {
                let linear = transfer.decode([f64::from(byte); 3]);
                assert_eq!(transfer.encode(linear), [byte; 3], "{transfer:?}");
            }
        }
    }

    #[test]
    fn sixteen_bits_are_nearest_to_the_light() {
        for byte in 0..=255_u8 {
            for transfer in [Transfer::Classic, Transfer::Srgb] {
                let linear = transfer.decode([byte.into(); 3]);
                // The rounding of a byte's light to `f32` does not change the result.
                assert_eq!(transfer.encode_16(linear), [u16::from(byte) * 257; 3], "{transfer:?}");
            }
        }
        let code = |value: f32| Transfer::Classic.encode_16(Rgb::splat(value))[0];
        assert_eq!([-1.0, 0.5, 0.25, 7.0, f32::NAN].map(code), [0, 32_768, 16_384, 65_535, 0]);
    }

    #[test]
    fn classic_rounds_half_up_and_clamps() {
        let byte = |value: f32| Transfer::Classic.encode(Rgb::splat(value))[0];
        assert_eq!(byte(-1.0), 0);
        assert_eq!(byte(0.5), 128); // 127.5 + 0.5
        assert_eq!(byte(0.498), 127);
        assert_eq!(byte(7.0), 255);
    }

    #[test]
    fn srgb_bytes_are_those_of_a_plain_search() {
        let levels: Vec<f64> =
            (0..255u8).map(|code| srgb_to_linear((f64::from(code) + 0.5) / 255.0)).collect();
        let near_levels = levels.iter().flat_map(|level| {
            let near = rounded([*level; 3]).x;
            [near.next_down().next_down(), near.next_down(), near, near.next_up(), near.next_up().next_up()]
        });
        let everywhere = (0..=f32::to_bits(1.5)).step_by(997).map(f32::from_bits);
        for linear in near_levels.chain(everywhere) {
            let plain = levels.partition_point(|level| *level <= f64::from(linear));
            assert_eq!(usize::from(LEVELS.byte(linear)), plain, "{linear}");
        }
        assert_eq!([-1.0, -0.0, f32::NAN, f32::INFINITY].map(|linear| LEVELS.byte(linear)), [0, 0, 0, 255]);
    }

    #[test]
    fn srgb_agrees_with_the_standard_formula() {
        for step in 0..=4096u16 {
            let linear = f64::from(step) / 4096.0;
            let encoded = if linear <= 0.003_130_8 {
                12.92 * linear
            } else {
                1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
            };
            let byte = Transfer::Srgb.encode(rounded([linear; 3]))[0];
            assert!((f64::from(byte) - 255.0 * encoded).abs() <= 0.501, "{linear}");
        }
    }
}
