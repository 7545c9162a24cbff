//! The kernel: prepared arrays in, [`Film`] out. It knows no entities, no clock and no files, and nothing in it can
//! fail: whatever could be wrong was refused before a scene was prepared.
//!
//! ```text
//! Camera -> camera ray -> closest hit -> refined surface point -> shadow rays, light by light -> shading
//!               ^                                                                                 |
//!               +---------------- mirrored and refracted rays, generation by generation <----------+
//! ```
//!
//! The picture is made tile by tile ([`Exposure`]), and a tile sample by sample: memory does not grow with their number.
//! Samples are added up in the order of their indices, in `f64`, in which the mean of equal samples is exactly their value.
//! Where samples lie is in [`mod@sampler`].
//!
//! # What a picture needs, and no more
//!
//! A kernel is compiled for every combination of what is asked of lights, which rays go on from surfaces, and the extras
//! ([`KernelChoice`]): in each, the code of what it leaves out does not exist. Which one a moment needs its
//! [plan](crate::systems::Plan) says. What an effect computes does not depend on which others are compiled in, so that the
//! planned kernel, the full one and the reference path make the same bits.
//!
//! Absent effects cost next to nothing: planned kernels take 3.7 % (ambient) and 4.3 % (diffuse) more instructions than minimal
//! ones, written in `benches/effects` for just that. The full one is beside them, in million instructions for a frame of 480 x 270 (`benches/instructions`), and in milliseconds on one thread
//! (`cargo bench --bench effects`):
//!
//! | | minimal | planned | full | milliseconds |
//! |---|---|---|---|---|
//! | ambient light only | 196.4 | 203.6 | 213.1 | 20.9 |
//! | point lights without shadows |  | 282.0 | 357.6 | 30.0 |
//! | point lights with shadows | 500.6 | 522.4 | 633.5 | 59.7 |
//! | highlights |  | 620.8 | 702.2 | 83.5 |
//! | spot lights |  | 488.3 | 554.0 | 53.2 |
//! | falloff |  | 555.9 | 637.3 | 66.1 |
//! | area lights, 4 samples |  | 1839.1 | 2077.2 | 259.8 |
//! | mirrors |  | 562.9 | 677.6 | 63.3 |
//! | clear media |  | 800.1 | 825.3 | 90.0 |
//! | clear media, Fresnel |  | 1209.2 | 1243.9 | 149.3 |
//! | clear media, absorption |  | 809.1 | 834.3 | 93.6 |
//! | checker |  | 573.9 | 655.2 | 64.7 |
//! | fog |  | 562.7 | 645.1 | 67.6 |
//! | gradient |  | 518.5 | 634.0 | 57.3 |
//! | 4 samples a pixel |  | 2210.8 | 2675.3 | 271.8 |
//! | 4 samples, a lens |  | 2385.7 | 2850.0 | 284.4 |
//! | 4 samples, motion blur |  | 2211.3 | 2675.8 | 306.5 |
//!
//! # Trees of rays
//!
//! A sample's rays are a tree: every surface may send on a mirrored and a refracted ray. It ends where a ray's contribution could
//! not show, by a guaranteed bound (what is cut in a sample adds up to less than [`PreparedScene::cutoff`]), at the last
//! generation, and at 4096 rays; rays beyond the last two see the background untraced. How many it was is in [`TreeEnds`].
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
pub use ray::{Limit, Ray};
pub use root::{Refined, Root};
pub use sampler::Sampling;
pub use surfaces::Surfaces;
pub use surroundings::{Background, Fog, Passage};
pub use ties::Ties;
