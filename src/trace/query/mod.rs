//! What rays ask of a scene: the closest hit, and what stands before a light.

mod certain_crossings;
mod closest_hit;
mod crossings;
mod escalations;
mod guaranteed;
mod hit;
mod intersector;
mod linear_scan;
mod occlusion;
mod scratch;
mod textbook;

pub use closest_hit::Search;
pub(crate) use crossings::{Crossed, Look};
pub use escalations::Escalations;
pub use hit::{ClosestHit, Hit, SurfacePoint};
pub(crate) use intersector::Intersector;
pub(crate) use linear_scan::closest;
pub(crate) use scratch::Scratch;
pub(crate) use textbook::Textbook;
