//! Numerical building blocks: extended-precision arithmetic, SIMD lanes and sample points.
//!
//! A [`Double`] is an unevaluated sum of two `f64` with about 106 bits (Dekker, "A Floating-Point Technique for Extending the Available
//! Precision", 1971; Joldes, Muller, Popescu, "Tight and Rigorous Error Bounds for Basic Building Blocks of Double-Word Arithmetic", 2017).
//! Sums of products are rounded once (Shewchuk, "Adaptive Precision Floating-Point Arithmetic", 1997). Only + - * / and square roots are
//! used, so that results are bit-identical on every machine. Extended precision is reserved for the few decisions and distances that need
//! it.

mod bounded_t;
mod compensated;
mod digest;
mod double;
mod elementary;
mod error_free;
mod exact;
mod lanes;
mod real;
mod real_lanes;
#[cfg(test)]
pub(crate) mod same_bits;
mod sample_keys;
mod sampling;
mod scaling;
mod simd_level;
mod sums;
mod vector;

pub(crate) use bounded_t::BoundedT;
pub(crate) use compensated::Compensated;
pub(crate) use digest::{Bytes, Digest, digest_of_all};
pub(crate) use double::Double;
pub(crate) use elementary::{exp, pow};
pub(crate) use exact::{Exact, Exact3, ExactRoot};
pub(crate) use lanes::{
    Colors, F64s, F64s3, HALF, LANES, Mask, Numbers, Scaled, Vectors, WHOLE, bits, bits8, bits16, finite3,
    half_lanes, half_of, lanes, lanes_where, mask, mask16, scaled_lanes, set_bits, splat, splat3,
};
pub(crate) use real::{
    Real, Truth, absolute, add, cross, dot, moderate, moderate3, negative, pick3, spread, subtract, times,
};
pub(crate) use sample_keys::SampleKeys;
pub use sampling::PixelSampling;
pub(crate) use sampling::on_disc;
pub(crate) use sampling::{Dimension, PixelSamples, disc};
pub(crate) use sampling::{mixed, uniform};
pub(crate) use scaling::scaled;
pub use simd_level::SimdLevel;
pub(crate) use sums::{exact_dot, offset_height, square_difference};
pub(crate) use vector::Double3;
