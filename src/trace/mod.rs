//! The kernel: prepared arrays in, [`Film`] out. It knows no entities, no clock and no files, and nothing in it can
//! fail: whatever could be wrong was refused before a scene was prepared.
//!
//! # From pixel to film
//!
//! Files in the order in which a camera ray goes through them:
//!
//! 1. `exposure` hands out the picture's tiles over all threads. `stages/sample` takes one sample of each of a tile's
//!    pixels through the stages, each a function over the arrays in `stages/buffers`: memory does not grow with the number of
//!    samples. Rays go in packets of sixteen (`rays/packet`), and so does all that is known of them; the arithmetic on lanes is in
//!    `math/lanes`. What packets leave open, by a contested verdict, a tie or a number out of range, single rays decide, whose code
//!    defines what is right.
//! 2. `stages/camera_rays` makes the first wave of rays, by `scene/camera`; where samples lie is in `math/sampling`, in lanes in
//!    `math/sample_keys`.
//! 3. `stages/closest_hits` finds what each ray meets first. Packets from one point, as a camera's are, go through the tree
//!    together, by `packet/bundle`, `bvh/frustum` and `bvh/shaft`; what all samples of a tile through a lens may meet is found once, by
//!    `packet/lens` and `bvh/beam`; other packets go one after the other, by `packet/closest_hit` and `bvh/packet`. Single rays
//!    are followed by `query/closest_hit`, which walks the tree (`bvh/traverse`) and asks the shapes (`query/guaranteed`), which are
//!    defined in `shapes`.
//! 4. `stages/surfaces` refines hits to surface points, where light, a medium or a mirror asks for them, by `packet/refine`, and adds
//!    ambient light.
//! 5. `stages/direct_light` goes through the lights: what one could add at each point is proposed, by `light/direct_packet`, and in
//!    a single lane by `light/direct`; its places, if it has a size, are chosen by `light/light_places`. `stages/shadows` follows the
//!    proposals' shadow rays, by `packet/occlusion` and, through clear shapes, `packet/crossings`, and singly by `query/occlusion` and
//!    `query/crossings`. What clear shapes leave is in `stages/clear_shadows`, singly in `light/transmission`, and what comes through is
//!    added. Which shapes may hide a light from the tile that is not infinitely far away is found once, for all of its samples, by
//!    `packet/candidates`, `bvh/shaft` and, if it has a size, `bvh/beam`.
//! 6. `stages/sums` adds what each ray brings to its pixel, in the order of the wave, after fog and media on the way have taken theirs
//!    (`light/passage_packet`). A tile's pixels are kept packet by packet of its camera rays, whose light is added in their lanes.
//! 7. `stages/next_rays` makes mirrored and refracted rays, by `light/secondary_packet` and `light/refraction_packet`, and singly by
//!    `light/secondary`: the next generation (`stages/generation`). `stages/select` keeps those that can still show, by
//!    `light/contribution`, and where samples may have several of them, by what `stages/trees` knows of them all. They go on at 3, whole
//!    packets as they are and others put together, by `stages/packing`, as many at a time as a wave has room for.
//! 8. `exposure` adds samples up in the order of their indices (`tile_light`), in `f64`, in which the mean of equal samples is exactly
//!    their value, and `film` holds the result; a single sample goes there at once. Where a picture is to have a certain error,
//!    `adaptive` looks at the sums from time to time, and says which pixels get more samples.
//!
//! Folders import one way: `math` <- `rays` <- `shapes` <- `bvh` <- `scene` <- `query` <- `light`, `packet` <- `stages`. What a scene
//! holds is in `scene`, what rays ask of it in `query`, what many rays ask of it at once in `packet`, and what light does in `light`,
//! which `stages` and `reference` share.
//!
//! # What a picture needs, and no more
//!
//! What is asked of lights, which rays go on from surfaces, and whether there are extras (`effects`) follows from the
//! [plan](crate::systems::Plan) of a moment. A stage that none of them needs is not entered, and the others leave out the work. What an
//! effect computes does not depend on which others there are, so that a planned picture, one with all effects and the
//! reference path's have the same bits. What each effect costs, planned and with all others, is in `benches/record`, by
//! `benches/instructions` and `cargo bench --bench effects`.
//!
//! # Trees of rays
//!
//! A sample's rays are a tree: every surface may send on a mirrored and a refracted ray. It ends where a ray's contribution could
//! not show, by a guaranteed bound (what is cut in a sample adds up to less than the scene's cut-off), at the last
//! generation, and at 4096 rays; rays beyond the last two see the background untraced. How many it was is in [`TreeEnds`].
//!
//! # What pixels meet first
//!
//! Beside light, depth, normal, position and the like can be told of the ray through each pixel's middle (`passes`), for other programs.
//!
//! # What identifies a picture
//!
//! Everything that the kernel receives for a frame, and nothing else, has a fingerprint (`frame_fingerprint`): frames of equal
//! fingerprints have equal pixels, today, tomorrow and on another machine. [`SEMANTICS`] counts the changes of what numbers mean.
//!
//! Two paths answer what a ray meets: the scene's tree of bounding boxes, and the linear scan of the
//! reference path, in `reference`. Both ask the same shapes the same questions, so that both make the same picture, bit for bit.
//!
#![doc = include_str!("numerics.md")]

mod adaptive;
mod bvh;
mod effects;
mod effort;
mod exposure;
mod film;
mod frame_fingerprint;
mod light;
#[doc(hidden)]
pub mod math;
mod packet;
mod passes;
mod query;
mod rays;
#[doc(hidden)]
pub mod reference;
mod scene;
#[doc(hidden)]
pub mod shapes;
mod stages;
#[cfg(test)]
mod tests;
mod tile_light;
mod tile_work;
mod visibility;
mod work_queue;

pub(crate) use adaptive::{Convergence, ErrorTarget, InstantOrder, block, round_policy};
pub use adaptive::{EstimatedError, Outlook, Replay, RoundPolicy, SharedRoundPolicy};
pub use effort::{RayCounts, TreeEnds};
pub(crate) use exposure::{Developed, SampleMemory, SamplePlan};
pub use exposure::{Exposure, ExposureProgress};
pub use film::{AlphaFilm, EncodedFilm, Film};
pub(crate) use frame_fingerprint::{FrameConstants, FrameHasher};
pub use frame_fingerprint::{FrameFingerprint, NotAFingerprint, SEMANTICS};
pub use math::Sampling;
pub use passes::{Pass, PassPixel, Passes, UnknownPass};
pub use query::Escalations;
pub use scene::{Camera, Precision};
pub use tile_work::Signals;

// What tests, benchmarks and explanations of pixels ask of the kernel itself: no part of the library's face.
#[doc(hidden)]
pub use {
    effects::{Effects, Lighting, Paths},
    effort::Effort,
    light::Boundary,
    math::{Root, SimdLevel},
    query::{CastHit, CastRay, Hit, SurfacePoint},
    rays::{Ray, ShapeId},
    scene::{
        Background, BvhUpdate, Checker, CheckerPattern, Cone, Falloff, Fog, Geometry, Light, LightSource,
        MaterialSummary, MaterialTable, Passage, PreparedScene, PreparedShape, Refraction, SceneChanges,
        ShapeChange, SurfaceMaterial,
    },
    shapes::{Bounds, RefinedHit},
};
