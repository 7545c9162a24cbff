//! Ray queries on a scene: closest hits, and occlusion of lights.

mod cast;
mod certain_crossings;
mod closest_hit;
mod crossings;
mod escalations;
mod hit;
mod hit_packet;
mod intersector;
mod linear_scan;
mod naive;
mod nearest;
mod occlusion;
mod robust;
mod scratch;

pub use cast::{CastHit, CastRay};
pub(crate) use crossings::{Crossed, Crossing, Look};
pub use escalations::Escalations;
pub use hit::{ShapeHit, SurfacePoint};
pub(crate) use hit_packet::{HitPacket, SurfacePacket};
pub(crate) use linear_scan::closest;
pub(crate) use naive::Naive;
pub(crate) use robust::NEAR;
pub(crate) use scratch::Scratch;
