//! Ray queries on a scene: closest hits, and occlusion of lights.

mod cast;
mod certain_crossings;
mod closest_hit;
mod crossings;
mod escalations;
mod guaranteed;
mod hit;
mod hit_packet;
mod intersector;
mod linear_scan;
mod nearest;
mod occlusion;
mod scratch;
mod textbook;

pub use cast::{CastHit, CastRay};
pub(crate) use closest_hit::with_intersector;
pub(crate) use crossings::{Crossed, Crossing, Look};
pub use escalations::Escalations;
pub(crate) use guaranteed::NEAR;
pub use hit::{ShapeHit, SurfacePoint};
pub(crate) use hit_packet::{HitPacket, SurfacePacket};
pub(crate) use intersector::Intersector;
pub(crate) use linear_scan::closest;
pub(crate) use scratch::Scratch;
pub(crate) use textbook::Textbook;
