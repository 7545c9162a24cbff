//! Rays, and the surfaces that they leave.

mod coincident_hits;
mod packet;
mod ray;
mod shadow_limit;
mod shape_id;
mod surface_exclusion;
mod view;

pub(crate) use packet::RayPacket;
pub use ray::PreparedRay;
pub(crate) use ray::Rays;
pub(crate) use shadow_limit::{FAR, ShadowLimit};
pub use shape_id::ShapeId;
pub(crate) use shape_id::ShapeIds;
pub(crate) use surface_exclusion::SurfaceExclusion;

pub(crate) use coincident_hits::{CoincidentHits, Tie, TieLists};
pub(crate) use view::RayView;
