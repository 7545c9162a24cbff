//! The kernel: prepared arrays in, [`Film`] out. It has no entities, no clock and no files, and its operations cannot fail: all input is
//! validated before a scene is prepared.
//!
//! # From pixel to film
//!
//! The files, in the order in which a camera ray passes through them:
//!
//! 1. `render/job` distributes the picture's tiles over all threads. `stages/sample` traces one sample of each of a tile's pixels through the
//!    stages, each a function over the arrays in `stages/buffers`: memory does not grow with the number of samples. Rays and their data are in
//!    packets of sixteen (`rays/packet`); `math/lanes` has the arithmetic on lanes. Lanes that packets leave undecided, because of an
//!    ambiguous comparison, coincident hits or a number out of range, are decided by the code for single rays, which defines the correct
//!    result.
//! 2. `stages/sample` generates the first wavefront of camera rays, with `scene/camera`. The positions of samples come from `math/sampling`,
//!    and in lanes from `math/sample_keys`.
//! 3. `stages/sample` finds the closest hit of each ray. Packets with a common origin, such as camera rays of a pinhole, traverse the tree
//!    together (`intersect/bundle`, `bvh/traverse/frustum`, `bvh/traverse/beam`). For a lens, the shapes that any sample of a tile can hit are
//!    collected once (`intersect/lens`). Other packets traverse the tree one after the other, and undecided lanes as single rays
//!    (`intersect/closest_hit`, `bvh/traverse/packet`, `bvh/traverse`). `intersect/intersector` intersects rays with the shapes, which are
//!    defined in `shapes`; `intersect/robust` decides what error bounds leave ambiguous.
//! 4. `stages/surfaces` refines hits to surface points with `intersect/refine`, where lighting, a medium or secondary rays need them, and adds
//!    ambient light.
//! 5. `stages/direct_light` loops over the lights. `shading/direct_packet` computes the unoccluded contribution of a light at each surface
//!    point, `shading/direct` for a single lane; `shading/area_light_samples` chooses the sample points on area lights. Shadow rays are traced
//!    with `intersect/occlusion` and, through transparent shapes, `intersect/crossings`. `stages/transparent_shadows` attenuates the light by
//!    transparent shapes, `shading/transmission` for single rays. The light that remains is added. The possible occluders between a tile and a
//!    light at a place are collected once for all samples of the light, by `intersect/candidates` and `bvh/traverse/beam`. Ambient light that
//!    can be occluded is the first of the lights: a dome about each point.
//! 6. `stages/sample` adds the radiance of each ray to its pixel, in the order of the wavefront, after attenuation by fog and media along the
//!    ray (`shading/passage_packet`). A tile's pixels are stored by packet of its camera rays, and light is added to them lane by lane.
//! 7. `stages/next_rays` spawns reflected and refracted rays, with `shading/secondary_packet` and `shading/refraction_packet`, and
//!    `shading/secondary` for single lanes: the queue of the next bounce (`stages/ray_queue`). `stages/cutoff` drops the rays whose
//!    contribution is negligible, by the bounds in `shading/contribution` and, if samples can have several rays, by the state of all of them in
//!    `stages/trees`. The others continue at 3. `stages/compaction` compacts them into wavefronts: packets with enough active lanes are kept, the
//!    rays of others are merged.
//! 8. `render/job` sums samples in the order of their indices (`render/accumulator`), in `f64`, in which the mean of equal samples is exactly their
//!    value. `render/film` holds the result; a single sample is stored there directly. If a picture has an error target, `render/adaptive` evaluates the
//!    sums between rounds and chooses the pixels that get more samples.
//!
//! Folders import one way: `math` <- `rays` <- `shapes` <- `bvh` <- `scene` <- `intersect` <- `shading` <- `stages` <- `render`. `scene` holds the
//! scene data, `intersect` the queries of rays and of packets, `shading` the light transport, which `stages` and `reference` share, and
//! `render` the pictures made of samples.
//!
//! # Effects
//!
//! The [plan](crate::systems::Plan) of a moment determines its effects: the lighting, the secondary rays, and the extras (`effects`). Stages
//! that no effect needs are skipped, and the others omit unneeded work. The result of an effect does not depend on the other effects, so a
//! planned picture, a picture with all effects and the picture of the reference path are bit-identical. `benches/record` lists the cost of
//! each effect, planned and with all others, as measured by `benches/instructions` and `cargo bench --bench effects`.
//!
//! # Classes of rays
//!
//! Camera rays, secondary rays and shadow rays may see different shapes (`scene/ray_visibility`). Then each class has a scene of its own, with a
//! tree of the shapes that it sees, so that no query tests for visibility; if all rays see all shapes, there is one scene. Where a ray ends
//! and rays of another class start, `shading/handover` determines the surfaces that they leave and the media that they are in, from the
//! shapes that `intersect/unseen` finds; in the stages it does so before direct light (`stages/handover`) and before the next rays.
//!
//! # Ray trees
//!
//! The rays of a sample form a tree: every surface can spawn a reflected and a refracted ray. A path ends where a ray's contribution is
//! negligible, by a proven bound (the contributions cut from a sample add up to less than the scene's cutoff), at the last bounce, and at 4096
//! rays; rays beyond the last two limits see the background untraced. [`TreeEnds`] counts these rays.
//! The reference path keeps the tree of a sample, with the terms of its light, in a [`RayTree`]; an [`Equation`] explains a hit.
//!
//! # Passes
//!
//! Besides radiance, `render/passes` computes the depth, normal, position and other values of the ray through each pixel's centre, for other
//! programs.
//!
//! # Fingerprints
//!
//! Everything that the kernel receives for a frame, and nothing else, determines the frame's fingerprint (`render/fingerprint`): frames with
//! equal fingerprints have equal pixels, at any time and on any machine. [`SEMANTICS`] counts the changes in the meaning of numbers.
//!
//! # Reference path
//!
//! Closest hits have two implementations: the scene's tree of bounding boxes, and the linear scan of the reference path, in `reference`. Both
//! run the same queries on the same shapes, so that both render the same picture, bit for bit.
//!
#![doc = include_str!("numerics.md")]

mod bvh;
mod effects;
mod intersect;
pub(crate) mod math;
mod ray_tree;
mod rays;
pub(crate) mod reference;
mod render;
mod render_stats;
mod scene;
mod shading;
#[doc(hidden)]
pub mod shapes;
mod stages;
#[cfg(test)]
mod tests;

pub use intersect::{Escalations, ShapeHit, SurfacePoint};
pub use math::{PixelSampling, SimdLevel};
pub use ray_tree::{
    LightReach, LitSurface, RayEnd, RayKind, RayTree, SurfaceTerms, TracedLightSample, TracedRay,
};
pub use rays::{PreparedRay, ShapeId};
pub(crate) use render::adaptive::{Convergence, ErrorTarget, InstantOrder, block, round_policy};
pub use render::adaptive::{EstimatedError, Outlook, Replay, RoundPolicy, SharedRoundPolicy};
pub use render::film::{EncodedFilm, Film};
pub(crate) use render::film_overlay::FilmOverlay;
pub(crate) use render::fingerprint::{FrameConstants, FrameHasher};
pub use render::fingerprint::{FrameFingerprint, NotAFingerprint, SEMANTICS};
pub use render::image::RenderedImage;
pub(crate) use render::job::{FinishedJob, SampleMemory, SamplePlan};
pub use render::job::{RenderJob, RenderProgress};
pub use render::passes::{Pass, PassPixel, Passes, UnknownPass};
pub use render::reuse::ReusablePicture;
pub(crate) use render::reuse::{InstantInputs, TileReuse};
pub use render::tile_work::Signals;
pub use render_stats::{RayCounts, TileStats, TreeEnds};
pub use scene::{
    Attenuation, BackgroundTerms, GradientTerms, PassageTerms, Precision, PreparedCamera, SkyLight,
};
pub(crate) use scene::{
    Cone, FogLayer, MaterialPalette, MaterialTable, PatternFunction, PatternLayout, PatternedSurface,
    PreparedFalloff, PreparedFog, PreparedPattern, PreparedSky, PreparedStars, PreparedSun,
};
pub use shading::{LightTerms, RefractionTerms, SecondaryTerms, Unlit};
pub use shapes::{Equation, Interval, RodEnds};
#[cfg(feature = "live")]
pub(crate) use stages::TILE;
pub(crate) use stages::Tile;

// The kernel's arrays, for tests and benchmarks; not part of the library's interface.
#[doc(hidden)]
pub use {
    effects::{Effects, Lighting, Paths},
    intersect::{CastHit, CastRay},
    reference::render as render_reference,
    scene::{
        BvhUpdate, Geometry, LightSource, PreparedAmbientOcclusion, PreparedBackground, PreparedLight,
        PreparedScene, PreparedShape, RayClass, RayVisibility, Refraction, SceneChanges, ShapeChange,
        SurfaceMaterial,
    },
    shapes::Bounds,
};
