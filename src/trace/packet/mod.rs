//! Sixteen rays at once, in vectors of the width that the processor has.
//!
//! What a ray meets is defined by the scalar code in `shapes` and `query`. Here the same operations are made in the same order
//! for sixteen rays at once, so that every `t` and every bound of its error has the same bits, whatever the width. Where a
//! verdict is not certain, or two hits may be at the same place, nothing is decided here: the ray is left to the scalar code.
//!
//! - [`leaves`] and [`slabs`]: one shape of a kind against half of a packet's rays; [`verdicts`]: a shape of any kind.
//! - [`closest_hit`]: the nearest of what a packet's rays meet; [`bundle`]: the same of packets of rays from one point, and
//!   [`lens`] of those from a lens; [`tile_packets`]: what both ask of packets.
//! - [`occlusion`]: what stands between surface points and a light, and [`crossings`]: where it is clear; [`candidates`]: what may, for all packets of a tile;
//!   [`roles`]: which shapes do.
//! - [`refine`]: the surface points that hits stand for.
//! - [`reciprocals`]: quotients that shapes ask of rays; [`scratch`]: what is kept for its memory.

mod bundle;
mod candidates;
mod closest_hit;
mod crossings;
#[cfg(test)]
mod extremes;
mod leaves;
mod lens;
mod occluder_kind;
mod occlusion;
mod reciprocals;
mod refine;
mod scratch;
mod shape_query;
mod slabs;
#[cfg(test)]
mod tests;
mod tile_packets;

pub(crate) use bundle::bundle_hits;
pub(crate) use candidates::{Candidates, LightBox, LitPoints, WaysToLight};
pub(crate) use closest_hit::closest_hits;
pub(crate) use crossings::CrossedPacket;
pub(crate) use lens::{LensCandidates, lens_hits};
pub(crate) use occluder_kind::Occluders;
pub(crate) use occlusion::{Occlusion, ShadowPacket, occluded};
pub(crate) use refine::refine;
pub(crate) use scratch::PacketScratch;
