//! Colour: linear light inside, bytes outside.
//!
//! Everything between a scene file and a frame file is linear `f32` RGB in which 1.0 stands for the file's 255. A [`Transfer`] defines the
//! conversions from file colours to linear light, and from linear pixels to output bytes.

mod encoding;
mod error_norm;
mod ramp;
mod srgb;
mod transfer;

pub use encoding::{Encoding, Linear};
pub use error_norm::ErrorNorm;
pub use ramp::ColorRamp;
pub(crate) use srgb::hex_channels;
pub use srgb::{HexError, hex, srgb};
pub use transfer::Transfer;

/// Linear RGB light: a radiance, an intensity or a reflectance per channel. 1.0 is full, more is brighter. It is never negative and never
/// NaN.
pub type Rgb = glam::Vec3;

/// Returns the blend of two colours as light: `share`, 0 to 1, of the second one. Each is exact where it is alone.
#[must_use]
#[inline]
pub fn blend(one: Rgb, other: Rgb, share: f32) -> Rgb {
    one * (1.0 - share) + other * share
}

/// Rounds a fraction or a channel to the precision of colours.
#[expect(clippy::cast_possible_truncation, reason = "colour is f32")]
pub(crate) fn to_f32(value: f64) -> f32 {
    value as f32
}
