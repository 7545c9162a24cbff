//! The kernel: prepared arrays in, [`Film`] out. It knows no entities, no clock and no files, and nothing in it can
//! fail: whatever could be wrong was refused before a scene was prepared.
//!
//! # From pixel to film
//!
//! Files in the order in which a camera ray goes through them:
//!
//! 1. `exposure` hands out the picture's tiles over all threads ([`Exposure`]), and `stages/sample` follows one sample of each of a
//!    tile's pixels: memory does not grow with their number.
//! 2. `scene/camera` makes the camera ray; where samples lie is in `math/sampling` ([`Sampling`]).
//! 3. `query/closest_hit` finds what it meets first, through `bvh/traverse`; `query/guaranteed` asks the shapes, which are defined in
//!    `shapes`.
//! 4. `query/closest_hit` refines the winner to a surface point, where light or a mirror asks for it.
//! 5. `light/direct` adds what each light brings there, and proposes shadow rays; `light/transmission` answers what comes through, by
//!    `query/occlusion` and `query/crossings`.
//! 6. `light/secondary` makes the mirrored and the refracted ray, `stages/select` keeps those of the next generation that can still
//!    show, by `light/contribution`. They go on at 3.
//! 7. `stages/follow` adds what each ray brings to its pixel, breadth first; `exposure` adds samples up in the order of their indices,
//!    in `f64`, in which the mean of equal samples is exactly their value, and `film` holds the result.
//!
//! Folders import one way: `math` <- `rays` <- `shapes` <- `bvh` <- `scene` <- `query` <- `light` <- `stages`. What a scene holds is in
//! `scene`, what rays ask of it in `query`, and what light does in `light`, which `stages` and [`mod@reference`] share.
//!
//! # What a picture needs, and no more
//!
//! A kernel is compiled for every combination of what is asked of lights, which rays go on from surfaces, and the extras
//! ([`KernelChoice`]): in each, the code of what it leaves out does not exist. Which one a moment needs its
//! [plan](crate::systems::Plan) says. What an effect computes does not depend on which others are compiled in, so that the
//! planned kernel, the full one and the reference path make the same bits.
//!
//! Absent effects cost nothing to speak of: planned kernels take as many instructions as minimal ones, within 1 %, which are written in
//! `benches/effects` for just that. In million instructions for a frame of 480 x 270 (`benches/instructions`), and
//! the planned kernel in milliseconds on one thread (`cargo bench --bench effects`):
//!
//! | | minimal | planned | full | milliseconds |
//! |---|---|---|---|---|
//! | ambient light only | 196.6 | 197.3 | 203.4 | 22.2 |
//! | point lights without shadows |  | 274.2 | 337.9 | 31.5 |
//! | point lights with shadows | 500.1 | 504.6 | 619.9 | 54.2 |
//! | highlights |  | 623.4 | 692.4 | 92.7 |
//! | spot lights |  | 485.9 | 537.2 | 62.5 |
//! | falloff |  | 554.6 | 623.6 | 71.3 |
//! | area lights, 4 samples |  | 1856.0 | 2103.8 | 275.6 |
//! | mirrors |  | 543.0 | 663.0 | 61.7 |
//! | clear media |  | 785.2 | 810.4 | 92.1 |
//! | clear media, Fresnel |  | 1190.2 | 1225.2 | 144.9 |
//! | clear media, absorption |  | 794.2 | 819.3 | 94.8 |
//! | checker |  | 572.6 | 641.6 | 67.4 |
//! | fog |  | 566.3 | 634.8 | 71.8 |
//! | gradient |  | 505.0 | 620.3 | 59.3 |
//! | 4 samples a pixel |  | 2223.4 | 2689.0 | 270.3 |
//! | 4 samples, a lens |  | 2398.2 | 2863.7 | 291.3 |
//! | 4 samples, motion blur |  | 2223.9 | 2689.5 | 266.2 |
//!
//! # Trees of rays
//!
//! A sample's rays are a tree: every surface may send on a mirrored and a refracted ray. It ends where a ray's contribution could
//! not show, by a guaranteed bound (what is cut in a sample adds up to less than [`PreparedScene::cutoff`]), at the last
//! generation, and at 4096 rays; rays beyond the last two see the background untraced. How many it was is in [`TreeEnds`].
//!
//! Two paths answer what a ray meets: [`PreparedScene`]'s tree of bounding boxes, and the linear scan of the
//! [reference path](mod@reference). Both ask the same shapes the same questions, so that both make the same picture, bit for bit.
//!
#![doc = include_str!("numerics.md")]

mod bvh;
mod effects;
mod effort;
mod exposure;
mod film;
mod light;
pub mod math;
mod query;
mod rays;
pub mod reference;
mod scene;
pub mod shapes;
mod stages;

pub use effects::{KernelChoice, Lighting, Paths};
pub use effort::{Effort, RayCounts, TreeEnds};
pub use exposure::{Exposure, Signals};
pub use film::Film;
pub use light::Boundary;
pub use math::{Root, Sampling};
pub use query::{ClosestHit, Escalations, Hit, Search, SurfacePoint};
pub use rays::{Limit, Ray, ShapeId, Ties};
pub use scene::{
    Background, Camera, Checker, CheckerPattern, Cone, Falloff, Fog, Geometry, Light, LightSource,
    MaterialSummary, Passage, Precision, PreparedScene, PreparedShape, Refraction, SurfaceMaterial,
};
pub use shapes::{Bounds, RefinedHit};
