//! Queries of packets of sixteen rays, in vectors of the processor's width.
//!
//! The formulas of `shapes`, which are generic over numbers and lanes, give every `t` and every error bound the same bits for one ray and for
//! sixteen, at every vector width. If a comparison is ambiguous, or two hits may coincide, the lane stays undecided, and its ray escalates to
//! the code for single rays in `query`, which defines the result.
//!
//! - [`shape_query`]: intersection of half a packet with a shape of any kind.
//! - [`closest_hit`]: closest hits of a packet; [`bundle`]: of packets with a common origin; [`lens`]: of packets through a lens;
//!   [`tile_packets`]: the code that [`bundle`] and [`lens`] share.
//! - [`occlusion`]: occlusion of a light at surface points; [`crossings`]: crossings of shadow rays with transparent shapes; [`candidates`]:
//!   possible occluders for all packets of a tile; [`occluder_kind`]: classification of occluders.
//! - [`refine`]: refinement of hits to surface points.
//! - [`reciprocals`]: reciprocals of ray directions, computed once per packet; [`scratch`]: memory reused between queries.

mod bundle;
mod candidates;
mod closest_hit;
mod crossings;
#[cfg(test)]
mod extremes;
mod lens;
mod occluder_kind;
mod occlusion;
mod reciprocals;
mod refine;
mod scratch;
mod shape_query;
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
