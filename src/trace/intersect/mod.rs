//! Queries of rays on the scene: closest hits, occlusion of lights, and crossings with transparent shapes; each for single rays and for
//! packets of sixteen.
//!
//! The formulas of `shapes`, which are generic over numbers and lanes, give every `t` and every error bound the same bits for one ray and for
//! sixteen, at every vector width. If a comparison is ambiguous, or two hits may coincide, the lane of a packet stays undecided, and its ray
//! escalates to the query for single rays, which defines the result.
//!
//! - [`intersector`]: intersection with a shape of any kind; [`robust`] or [`naive`] for single rays.
//! - [`closest_hit`]: closest hits; [`bundle`]: of packets with a common origin; [`lens`]: of packets through a lens.
//! - [`mod@refine`]: refinement of a packet's hits to surface points; [`hit`]: hits and surface points.
//! - [`occlusion`]: occlusion of a light at surface points; [`candidates`]: possible occluders for all packets of a tile.
//! - [`crossings`]: crossings of shadow rays with transparent shapes; [`certain_crossings`]: their number, where a fast count is certain.
//! - [`cast`]: closest hits of rays given by users.
//! - [`reciprocals`]: reciprocals of ray directions, computed once per packet; [`scratch`]: memory reused between queries.

mod bundle;
mod candidates;
mod cast;
mod certain_crossings;
mod closest_hit;
mod crossings;
#[cfg(test)]
mod extremes;
mod hit;
mod intersector;
mod lens;
mod naive;
mod occlusion;
mod reciprocals;
mod refine;
mod robust;
mod scratch;
#[cfg(test)]
mod tests;
mod unseen;

pub(crate) use bundle::bundle_hits;
pub(crate) use candidates::{Candidates, LightBox, LitPoints, ShadowRays};
pub use cast::{CastHit, CastRay};
pub(crate) use closest_hit::closest_hits;
pub(crate) use crossings::{Crossed, CrossedPacket, Crossing, CrossingDetail};
pub(crate) use hit::{HitPacket, SurfacePacket};
pub use hit::{ShapeHit, SurfacePoint};
pub use intersector::Escalations;
pub(crate) use lens::{LensCandidates, lens_hits};
pub(crate) use naive::Naive;
pub(crate) use occlusion::{Occluders, Occlusion, ShadowPacket, occluded};
pub(crate) use refine::refine;
pub(crate) use scratch::{PacketScratch, Scratch};
pub(crate) use unseen::UnseenShape;
