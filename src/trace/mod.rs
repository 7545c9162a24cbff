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
//! Geometry is `f64` and colour is linear `f32`. There is no epsilon anywhere for a user to tune:
//!
//! - *Verdicts.* A shape answers with `t` and a bound of its error ([`Root`]). What the bound leaves open (does a ray graze
//!   or miss, is the origin on the surface or behind it, which of two surfaces is nearer, does something stand before the
//!   light) is decided with a hundred bits or more ([`mod@exact`]), box edges with exact signs.
//! - *Distances.* What is seen gets a Newton step with a residual of a hundred bits; point and distance are rounded once.
//! - *Culling* is in `f32`, rounded outwards, and allows for the shapes' own rounding: the tree never decides anything.
//! - *Rays that leave a surface* know the shape they leave, and what coincided with it there, each in its sense. They skip
//!   it when they leave outwards, and meet only its far side when they leave inwards. All other shapes count from t = 0.
//! - *Ties* of t go to the first in document order.
//!
//! Held against exact arithmetic of 400 bits on 100 000 random rays in each of 14 categories (`tests/oracle.rs`;
//! `RAYREEL_CASES=100000`), wherever the exact margin is more than 2^-90:
//!
//! | category | hits | median ulp | worst ulp | wrong verdicts |
//! |---|---|---|---|---|
//! | sphere, ordinary | 2443 | 0.25 | 0.50 | 0 |
//! | sphere, far and tiny | 72704 | 0.25 | 0.50 | 0 |
//! | sphere, huge ground | 49288 | 0.25 | 0.50 | 0 |
//! | sphere, near tangency | 38843 | 0.25 | 0.50 | 0 |
//! | sphere, origin inside | 100000 | 0.25 | 0.50 | 0 |
//! | sphere, origin nearly on it | 75147 | 0.25 | 0.50 | 0 |
//! | sphere, behind | 1919 | 0.24 | 0.50 | 0 |
//! | sphere, any scale | 5540 | 0.25 | 0.50 | 0 |
//! | plane, ordinary and grazing | 50037 | 0.25 | 0.50 | 0 |
//! | box, ordinary | 7861 | 0.25 | 0.50 | 0 |
//! | box, from inside | 65426 | 0.25 | 0.50 | 0 |
//! | box, along faces | 71227 | 0.25 | 0.50 | 0 |
//! | box, through edges and corners | 100000 | 0.25 | 0.50 | 0 |
//! | box, thin, any scale | 3595 | 0.25 | 0.50 | 0 |
//!
//! What it costs so far, against the same kernel with plain `f64` shapes: 25 % to 45 % of a frame's tracing time.

mod bounds;
mod bvh;
mod camera;
pub mod exact;
mod film;
mod geometry;
mod guards;
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
pub use geometry::{Geometry, Precision, PreparedShape, Slot};
pub use guards::Guards;
pub use light::{Light, LightSource};
pub use prepared::{Closest, Hit, PreparedScene, Surface};
pub use ray::Ray;
pub use render::{Effort, RayCounts, render};
pub use root::{Refined, Root};
pub use shade::SurfaceMaterial;
pub use ties::Ties;
