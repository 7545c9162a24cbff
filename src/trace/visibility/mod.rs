//! Visibility of surfaces in pixels, from geometry instead of samples.
//!
//! For every pixel of a tile it is decided whether more than one surface can show in it: an edge, two surfaces that touch, a border between
//! squares of a checker, or a shape smaller than the pixel. Samples can miss all of those; geometry cannot. The decision is conservative:
//! a pixel without a [feature](Feature) shows a single smooth surface, or the background.
//!
//! ```text
//! for each shape that can be hit through the tile:          (the tree's frustum traversal)
//!     find its outline: functions that are positive inside  (`outline`)
//!     for each pixel: covered whole, touched, or missed, and bounds of its inverse depth
//!     the pixel's cover is the nearest shape that covers it whole
//! for each shape again, for each pixel:
//!     touched, and not behind the cover for certain -> feature of the shape's size
//!     covered, but perhaps not behind the cover     -> edge, where surfaces may cross
//! ```
//!
//! With a lens every pixel sees a disc of each plane: squares are widened by the circle of confusion. The result depends on the shapes alone,
//! not on the order in which the tree offers them.

mod outline;

use std::sync::atomic::AtomicBool;

use fearless_simd::{Simd, dispatch};
use glam::{DVec2, DVec3};

use crate::color::to_f32;
use crate::trace::bvh::{Depth, FrustumVisitor, LeafBox, LeafId, SlopeRange};
use crate::trace::light::most_radiance;
use crate::trace::math::{LANES, Vectors, lanes};
use crate::trace::query::Scratch;
use crate::trace::rays::ShapeId;
use crate::trace::scene::{Camera, PreparedScene, SIDE};
use crate::trace::stages::{PACKETS, TILE, TILE_PIXELS, Tile};
use outline::{Cover, Outline, Rays};

/// The smallest thing that samples of a pixel can miss.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Feature {
    /// The part of the pixel that it covers, 0 where a single surface shows, 1 for what is larger than a pixel.
    pub(crate) area: f32,
    /// A bound of its radiance, in any channel; 0 for edges of large shapes, which samples nearby show.
    pub(crate) radiance: f32,
}

impl Feature {
    /// An edge of a large shape.
    pub(crate) const EDGE: Self = Self { area: 1.0, radiance: 0.0 };
    /// A single surface.
    pub(crate) const NONE: Self = Self { area: 0.0, radiance: 0.0 };

    /// Keeps the one that matters more: what is small and may be bright.
    pub(crate) fn join(&mut self, other: Self) {
        // A total order, so that it does not matter which comes first.
        let key = |feature: &Self| (feature.area * feature.radiance, feature.area);
        if key(&other) > key(self) {
            *self = other;
        }
    }
}

/// The features of a tile's pixels, and what covers those without.
#[derive(Clone, Debug)]
pub(crate) struct TileFeatures {
    /// By the pixel's index in the tile.
    features: [Feature; TILE_PIXELS],
    covers: [Option<Covering>; TILE_PIXELS],
}

/// The shape that covers a pixel, and a bound of its radiance.
pub(crate) type Covering = (ShapeId, f32);

impl TileFeatures {
    /// Returns the feature and the cover of a pixel, by its index in the tile.
    pub(crate) fn of(&self, pixel: usize) -> (Feature, Option<Covering>) {
        (self.features[pixel], self.covers[pixel])
    }
}

/// The memory of the search.
#[derive(Debug, Default)]
pub(crate) struct FeatureScratch {
    seen: Vec<Seen>,
}

#[derive(Debug)]
struct Seen {
    id: ShapeId,
    outline: Outline,
    /// Half of the side of the square that a pixel sees of it.
    half: f64,
}

/// More shapes are not searched one by one where the tree cannot be.
const FEW: usize = 4096;

/// Finds the features of a tile's pixels at an instant, by the tree. While the shutter is open even large shapes may pass between samples.
pub(crate) fn features(
    scene: &PreparedScene,
    camera: &Camera,
    (tile, is_open): (&Tile, bool),
    (scratch, search): (&mut FeatureScratch, &mut Scratch<'_>),
) -> TileFeatures {
    let Some(rays) = tile_rays(camera, tile) else { return unknown() };
    scratch.seen.clear();
    let Scratch { stack, cancelled, .. } = search;
    let ids = scene.beside.iter().copied();
    let mut known =
        ids.map(|id| see(scene, camera, &rays, id, &mut scratch.seen)).fold(true, |all, one| all & one);
    let whole = !camera.has_lens()
        && dispatch!(scene.simd.level(), simd => {
            let visitor = &mut Visitor { scene, camera, rays: &rays, seen: &mut scratch.seen, known: true };
            let whole = visit(simd, visitor, tile, stack, cancelled);
            known &= visitor.known;
            whole
        });
    if !whole {
        if scene.leaves.ids().len() > FEW {
            return unknown();
        }
        let ids = scene.leaves.ids();
        known &=
            ids.map(|id| see(scene, camera, &rays, id, &mut scratch.seen)).fold(true, |all, one| all & one);
    }
    if known { resolve(scene, &rays, (tile, is_open), &scratch.seen) } else { unknown() }
}

/// Finds the features of a tile's pixels by a linear scan of all shapes.
pub(crate) fn reference_features(
    scene: &PreparedScene,
    camera: &Camera,
    tile: &Tile,
    is_open: bool,
) -> TileFeatures {
    let ids = scene.beside.iter().copied().chain(scene.leaves.ids());
    let (Some(rays), mut seen) = (tile_rays(camera, tile), Vec::new()) else { return unknown() };
    if camera.has_lens() && scene.leaves.ids().len() > FEW {
        return unknown();
    }
    let known = ids.map(|id| see(scene, camera, &rays, id, &mut seen)).fold(true, |all, one| all & one);
    if known { resolve(scene, &rays, (tile, is_open), &seen) } else { unknown() }
}

/// Every pixel may show anything.
fn unknown() -> TileFeatures {
    TileFeatures { features: [Feature::EDGE; TILE_PIXELS], covers: [None; TILE_PIXELS] }
}

/// Returns the rays of a tile. `None` if they are not finite.
fn tile_rays(camera: &Camera, tile: &Tile) -> Option<Rays> {
    let first = camera.through(f64::from(tile.i), f64::from(tile.j));
    let steps = camera.steps();
    let middle = first + (steps[0] + steps[1]) * MIDDLE;
    let eye = camera.position();
    (eye.is_finite() && middle.is_finite() && middle.length_squared() > 0.0).then_some(Rays {
        eye,
        middle,
        steps,
    })
}

/// From the centre of a tile's first pixel to the tile's middle, in pixels along either side.
const MIDDLE: f64 = (TILE as f64 - 1.0) / 2.0;

/// From a pixel's centre to beyond its edge, farther than that of [`Rays::may_meet`].
const WIDER: f64 = 0.5 + 1e-5;

/// Half of a pixel, and a little more than what rounding moves samples by.
const HALF: f64 = 0.5 + 1e-9;

/// Adds what is seen of a shape through the tile. Returns `false` if that is not known.
fn see(scene: &PreparedScene, camera: &Camera, rays: &Rays, id: ShapeId, seen: &mut Vec<Seen>) -> bool {
    if let Some(bounds) = scene.geometry().bounds(id).filter(|_| !camera.has_lens())
        && !rays.may_meet(&bounds)
    {
        return true;
    }
    let Ok(outline) = Outline::of(scene.geometry().shape(id), rays) else { return false };
    /// Wider than any tile, and a number.
    const WIDEST: f64 = 1e6;
    let half = HALF + if camera.has_lens() { confusion(scene, camera, id).min(WIDEST) } else { 0.0 };
    if let Some(mut outline) = outline {
        if half > 1.0 {
            // Spread over the circle of confusion.
            outline.area /= 4.0 * half * half;
        }
        if outline.cover(DVec2::ZERO, TILE as f64 / 2.0 + half).is_some() {
            seen.push(Seen { id, outline, half });
        }
    }
    true
}

/// Returns the radius of the largest circle of confusion of a shape, in pixels.
fn confusion(scene: &PreparedScene, camera: &Camera, id: ShapeId) -> f64 {
    let [right, down] = camera.steps().map(DVec3::length);
    let Some(bounds) = scene.geometry().bounds(id) else {
        return camera.confusion([0.0, f64::INFINITY], right.min(down));
    };
    let [.., view] = camera.axes();
    let (middle, reach) =
        (bounds.min.midpoint(bounds.max) - camera.position(), (bounds.max - bounds.min).length() / 2.0);
    let depth = middle.dot(view) / camera.distance();
    let reach = reach / camera.distance();
    let nearest = if depth > reach { 1.0 / (depth - reach) } else { f64::INFINITY };
    camera.confusion([1.0 / (depth + reach).max(f64::MIN_POSITIVE), nearest], right.min(down))
}

/// Shapes of the tree on their way into the list.
struct Visitor<'a> {
    scene: &'a PreparedScene,
    camera: &'a Camera,
    rays: &'a Rays,
    seen: &'a mut Vec<Seen>,
    known: bool,
}

impl<S: Simd> FrustumVisitor<S> for Visitor<'_> {
    #[inline(always)]
    fn visit(&mut self, _: S, leaf: LeafId, _: &LeafBox) -> f32 {
        self.known &= see(self.scene, self.camera, self.rays, self.scene.leaves.id(leaf), self.seen);
        f32::INFINITY
    }
}

/// Visits the shapes of the tree that can be hit through the tile. `false` where there is no frustum.
#[inline(always)]
fn visit<S: Simd>(
    simd: S,
    visitor: &mut Visitor<'_>,
    tile: &Tile,
    stack: &mut crate::trace::bvh::Stack,
    cancelled: &AtomicBool,
) -> bool {
    let camera = visitor.camera;
    let (left, top) = (f64::from(tile.i) - WIDER, f64::from(tile.j) - WIDER);
    let (right, bottom) =
        (left + f64::from(TILE) + 2.0 * WIDER - 1.0, top + f64::from(TILE) + 2.0 * WIDER - 1.0);
    let mut corners = Vectors::splat(DVec3::ZERO);
    for (lane, (column, row)) in
        [(left, top), (right, top), (left, bottom), (right, bottom)].into_iter().enumerate()
    {
        corners.set(lane, camera.through(column, row));
    }
    // The axis of [`Rays::may_meet`], so that both agree.
    let depth = Depth::along(visitor.rays.middle);
    let slopes = SlopeRange::of(simd, (&corners, 0b1111), (depth, 1.0));
    let tree = &visitor.scene.tree;
    let Some(frustum) = slopes.and_then(|slopes| tree.frustum(camera.position(), depth, &slopes)) else {
        return false;
    };
    tree.visit_frustum(simd, &frustum, f32::INFINITY, stack, cancelled, visitor);
    true
}

/// Shapes of so many pixels are met by first samples of some of their pixels, with which others are compared.
const LARGE: f64 = 16.0;

/// Decides what each pixel shows of the shapes that are seen through the tile.
fn resolve(
    scene: &PreparedScene,
    rays: &Rays,
    (tile, is_open): (&Tile, bool),
    seen: &[Seen],
) -> TileFeatures {
    let mut found = TileFeatures { features: [Feature::NONE; TILE_PIXELS], covers: [None; TILE_PIXELS] };
    // Of each pixel: the index of its cover, and that one's bounds of inverse depth.
    let mut nearest: [(usize, [f64; 2], bool); TILE_PIXELS] = [(usize::MAX, [0.0; 2], true); TILE_PIXELS];
    for (index, shape) in seen.iter().enumerate() {
        for_pixels(
            tile,
            shape,
            |_, _| false,
            |pixel, _, cover| {
                if cover.whole && cover.depth[0] > nearest[pixel].1[0] {
                    nearest[pixel] = (index, cover.depth, cover.one_face);
                }
            },
        );
    }
    // By packet: the least inverse depth of its pixels' covers.
    let farthest: [f64; PACKETS] = std::array::from_fn(|packet| {
        nearest[packet * LANES..][..LANES].iter().map(|(_, depth, _)| depth[0]).fold(f64::INFINITY, f64::min)
    });
    for (index, shape) in seen.iter().enumerate() {
        let material = scene.material(shape.id);
        let radiance = most_radiance(scene, material);
        let feature = if is_open || shape.outline.area < LARGE {
            Feature { area: to_f32(shape.outline.area.min(1.0)), radiance }
        } else {
            Feature::EDGE
        };
        let hidden = |packet: usize, cover: &Cover| cover.depth[1] < farthest[packet];
        for_pixels(tile, shape, hidden, |pixel, place, cover| {
            let (first, depth, one_face) = nearest[pixel];
            let own = &mut found.features[pixel];
            if first == index {
                found.covers[pixel] = Some((shape.id, radiance));
                let checkered = material.checker.as_deref().is_some_and(|checker| {
                    let point = |offset: DVec2| shape.outline.point(rays, place + offset * shape.half);
                    let corners =
                        [DVec2::NEG_ONE, DVec2::new(1.0, -1.0), DVec2::new(-1.0, 1.0), DVec2::ONE].map(point);
                    !checker.squares.holds(corners)
                });
                if !one_face {
                    own.join(Feature::EDGE);
                }
                if checkered {
                    own.join(Feature { area: 1.0, radiance });
                }
            } else if cover.depth[1] >= depth[0] {
                own.join(if cover.whole { Feature::EDGE } else { feature });
            }
        });
    }
    found
}

/// Passes on the pixels of a tile in which a shape is seen: index, place from the tile's middle, and how. Squares of four by four pixels that it
/// covers whole, or is not seen in, are decided at once. Packets for which `skips` holds are passed over.
#[inline(always)]
fn for_pixels(
    tile: &Tile,
    shape: &Seen,
    skips: impl Fn(usize, &Cover) -> bool,
    mut each: impl FnMut(usize, DVec2, Cover),
) {
    const BLOCK: f64 = (SIDE as f64 - 1.0) / 2.0;
    for (packet, square) in (0..PACKETS).filter_map(|packet| Some((packet, tile.square(packet)?))) {
        let first =
            DVec2::new(f64::from(square.first.0 - tile.i), f64::from(square.first.1 - tile.j)) - MIDDLE;
        let Some(block) = shape.outline.cover(first + BLOCK, shape.half + BLOCK) else { continue };
        if skips(packet, &block) {
            continue;
        }
        for lane in lanes(square.lanes()) {
            let place = first + DVec2::new((lane % SIDE as usize) as f64, (lane / SIDE as usize) as f64);
            let decided = block.whole && block.one_face;
            let cover = if decided { Some(block) } else { shape.outline.cover(place, shape.half) };
            if let Some(cover) = cover {
                each(packet * LANES + lane, place, cover);
            }
        }
    }
}

#[cfg(test)]
mod tests;
