//! Queries of packets of sixteen rays, in vectors of the processor's width.
//!
//! The scalar code in `shapes` and `query` defines the result. This code executes the same operations in the same order for sixteen rays at
//! once, so that every `t` and every error bound has the same bits at every vector width. If a comparison is ambiguous, or two hits may
//! coincide, the lane stays undecided, and its ray escalates to the scalar code.
//!
//! - [`leaves`] and [`slabs`]: intersection of half a packet with a shape of one kind; [`shape_query`]: with a shape of any kind.
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
