//! Colour: linear light inside, bytes outside.
//!
//! Everything between a scene file and a frame file is linear `f32` RGB in which 1.0 stands for the file's 255.
//! A [`Transfer`] says how file colours become linear and how linear pixels become bytes; nothing else in the
//! crate knows about 255 or about sRGB.

mod encoding;
mod error_norm;
mod transfer;

pub use encoding::{Encoding, Linear};
pub use error_norm::ErrorNorm;
pub use transfer::Transfer;

/// Linear RGB light: a radiance, an intensity or a reflectance per channel. 1.0 is full, more is brighter;
/// never negative, never NaN.
pub type Rgb = glam::Vec3;

/// Rounds a share or a channel to the precision of colours.
#[expect(clippy::cast_possible_truncation, reason = "colour is f32")]
pub(crate) fn to_f32(value: f64) -> f32 {
    value as f32
}
