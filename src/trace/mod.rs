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
//! stage starts, and what a wave's surfaces reflect is the next wave's rays. Nothing recurses, and no ray allocates. Where
//! pixels have several samples, a tile goes through all that once for each of them: memory does not grow with their number.
//! Samples are added up in the order of their indices, in `f64`, in which the mean of equal samples is exactly their value.
//! Where samples lie is in [`mod@sampler`].
//!
//! Two paths answer what a ray meets: [`PreparedScene`]'s tree of bounding boxes, and the linear scan in
//! [`mod@reference`]. Both ask the same shapes the same questions, so that both make the same picture, bit for bit.
//!
#![doc = include_str!("numerics.md")]

mod bounds;
mod branch;
mod bvh;
mod camera;
mod contribution;
mod dielectric;
mod direct;
mod effects;
pub mod exact;
mod exposure;
mod film;
mod geometry;
mod guards;
mod light;
mod material;
mod media;
mod moment;
mod prepared;
mod ray;
pub mod reference;
mod root;
pub mod sampler;
mod shade;
mod shadow;
pub mod shapes;
mod surfaces;
mod surroundings;
mod ties;
mod tile;

pub use bounds::Bounds;
pub use camera::Camera;
pub use dielectric::Boundary;
pub use effects::{KernelChoice, Lighting, Paths};
pub use exposure::{Effort, Exposure, RayCounts, TreeEnds};
pub use film::Film;
pub use geometry::{Geometry, Precision, PreparedShape, Slot};
pub use guards::Guards;
pub use light::{Cone, Falloff, Light, LightSource};
pub use material::{Checker, Refraction, Squares, SurfaceMaterial};
pub use prepared::{Closest, Hit, PreparedScene, Search, Surface};
pub use ray::Ray;
pub use root::{Refined, Root};
pub use sampler::Sampling;
pub use surfaces::Surfaces;
pub use surroundings::{Background, Fog, Passage};
pub use ties::Ties;
