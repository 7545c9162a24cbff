//! Many rays at once: bundles of camera rays in vectors of the width that the processor has.
//!
//! What a ray meets is defined by the scalar code in `shapes` and `query`. Here the same operations are made in the same order
//! for sixteen rays at once, so that every `t` and every bound of its error has the same bits, whatever the width. Where a
//! verdict is not certain, or two hits may be at the same place, nothing is decided here: the ray is left to the scalar code.
//!
//! - [`bundle`]: a tile's rays, sorted into packets, and what they meet.
//! - [`candidates`]: what may stand between a light and a tile's surfaces.
//! - [`rays`]: sixteen rays, and what each of them has met so far.
//! - [`leaves`]: one shape against the rays of a packet.

mod bundle;
mod candidates;
mod leaves;
mod rays;
#[cfg(test)]
mod tests;

pub(crate) use bundle::Bundle;
pub(crate) use candidates::Candidates;
pub(crate) use rays::LANES;
