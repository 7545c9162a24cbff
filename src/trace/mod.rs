//! The kernel: prepared arrays in, [`Film`] out. It knows no entities, no clock and no files, and nothing in it can
//! fail: whatever could be wrong was refused before a scene was prepared.
//!
//! ```text
//! Camera -> camera rays -> closest hits -> refined surface points -> shadow rays, light by light -> shading
//!               ^                                                                                     |
//!               +------------------------------- next rays <------------------------------------------+
//! ```
//!
//! The picture is made tile by tile, each tile in waves: every stage runs over all rays of the tile before the next
//! stage starts, and what a wave's surfaces reflect is the next wave's rays. Nothing recurses, and no ray allocates.
//!
//! Two paths answer what a ray meets: [`PreparedScene`]'s tree of bounding boxes, and the linear scan in
//! [`mod@reference`]. Both ask the same shapes the same questions, so that both make the same picture, bit for bit.
//!
//! # Numbers
//!
//! Geometry is `f64` and colour is linear `f32`. No offset keeps a ray from meeting the surface it starts on: a ray
//! knows the shape it leaves. Of surfaces at equal distance the first in document order is seen.

mod bounds;
mod bvh;
mod camera;
pub mod exact;
mod film;
mod geometry;
mod light;
mod prepared;
mod ray;
pub mod reference;
mod render;
mod root;
mod shade;
pub mod shapes;
mod stages;
mod ties;

pub use bounds::Bounds;
pub use camera::Camera;
pub use film::Film;
pub use geometry::{Geometry, PreparedShape, Slot};
pub use light::{Light, LightSource};
pub use prepared::{Closest, Hit, PreparedScene, Surface};
pub use ray::Ray;
pub use render::{RayCounts, render};
pub use root::Root;
pub use shade::SurfaceMaterial;
pub use ties::Ties;
