//! Colour: linear light inside, bytes outside.
//!
//! Everything between a scene file and a frame file is linear `f32` RGB in which 1.0 stands for the file's 255.
//! A [`Transfer`] says how file colours become linear and how linear pixels become bytes; nothing else in the
//! crate knows about 255 or about sRGB.

mod transfer;

pub use transfer::Transfer;

/// Linear RGB light: a radiance, an intensity or a reflectance per channel. 1.0 is full, more is brighter;
/// never negative, never NaN.
pub type Rgb = glam::Vec3;
