//! Geometric visibility of surfaces in pixels, without sampling.
//!
//! For every pixel of a tile, decides whether more than one surface can show in it: an edge, two surfaces that touch, a border of
//! a pattern, or a shape smaller than the pixel. Samples can miss all of these; the geometric search cannot. The decision is
//! conservative: a pixel without a [feature](Feature) shows a single smooth surface, or the background. The sun, the
//! stars and steep parts of a gradient are features of the pixels that show the background (`sky`).
//!
//! ```text
//! for each shape that can be hit through the tile:          (the tree's frustum traversal)
//!     find its outline: functions that are positive inside  (`outline`)
//! for each square of pixels, and for each pixel in it:
//!     find the shapes seen there: whether they cover it fully, and bounds of their inverse depth
//!     the cover is the nearest shape that covers it fully; discard the shapes that are certainly behind it
//! for each shape that remains in a pixel:
//!     it is the cover     -> no feature, unless it shows two faces or a border of a pattern
//!     it covers it fully  -> edge: surfaces may intersect
//!     it covers a part    -> feature of the shape's size
//! ```
//!
//! With an open shutter, fast shapes may skip pixels between two instants: `motion` determines how many instants must be searched in each tile.
//!
//! Images of small shapes in mirrors and small highlights are found shape by shape (`images`), at the point that reflects them (`mirror`).
//!
//! With a lens, every pixel sees a disc of each plane: squares are widened by the circle of confusion. The result depends only on the
//! shapes, not on the order in which the tree visits them.

mod images;
mod mirror;
mod motion;
mod outline;
mod sky;

use std::sync::atomic::AtomicBool;

use fearless_simd::{Simd, dispatch};
use glam::{DVec2, DVec3};

use crate::color::to_f32;
use crate::trace::bvh::{Depth, FrustumVisitor, LeafBox, LeafId, SlopeRange};
use crate::trace::intersect::Scratch;
use crate::trace::math::{Bytes, LANES, Vectors, WHOLE, lanes, lanes_where};
use crate::trace::rays::ShapeId;
use crate::trace::scene::{PatternLayout, PreparedCamera, PreparedScene, SIDE};
use crate::trace::shading::most_radiance;
use crate::trace::stages::{PACKETS, TILE, TILE_PIXELS, Tile};
pub(crate) use images::{HiddenImage, Images, images};
pub(crate) use motion::MotionTracker;
use outline::{Covers, Outline, Squares, TileRays, where_less};
use sky::add_sky;

/// The smallest feature that the samples of a pixel can miss.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Feature {
    /// Fraction of the pixel that the feature covers: 0 if a single surface shows, 1 for features larger than a pixel.
    pub(crate) area: f32,
    /// Upper bound of the radiance in any channel; 0 for edges of large shapes, whose radiance nearby samples measure.
    pub(crate) radiance: f32,
}

impl Feature {
    /// The edge of a large shape.
    pub(crate) const EDGE: Self = Self { area: 1.0, radiance: 0.0 };
    /// No feature: a single surface shows.
    pub(crate) const NONE: Self = Self { area: 0.0, radiance: 0.0 };

    /// Keeps the more important of the two features: with the larger product of area and radiance, then the larger area.
    pub(crate) fn join(&mut self, other: Self) {
        // A total order makes the result independent of the order of the features.
        let key = |feature: &Self| (feature.area * feature.radiance, feature.area);
        if key(&other) > key(self) {
            *self = other;
        }
    }
}

/// The features of a tile's pixels, and the shapes that fully cover them.
#[derive(Clone, Debug)]
pub(crate) struct TileFeatures {
    /// Features by pixel index in the tile.
    features: [Feature; TILE_PIXELS],
    covers: [CoverPacket; PACKETS],
    /// With an open shutter: a digest of all that determines them.
    pub(crate) digest: u64,
}

/// The large shapes in the pixels of a packet, by which instants of an open shutter are compared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CoverPacket {
    /// The shapes that fully cover the pixels; [`UNCOVERED`] if none does.
    pub(crate) ids: [ShapeId; LANES],
    /// With an open shutter: sums of the digests of shapes with a border in the pixel, and of the camera's view of them.
    pub(crate) borders: [u64; LANES],
    /// Upper bounds of the radiance of these shapes.
    pub(crate) radiance: [f32; LANES],
}

impl CoverPacket {
    /// Creates the same cover in all pixels, without borders and radiance.
    pub(crate) const fn all(id: ShapeId) -> Self {
        Self { ids: [id; LANES], borders: [0; LANES], radiance: [0.0; LANES] }
    }

    /// Adds a shape that covers some pixels.
    #[inline(always)]
    fn add_cover(&mut self, pixels: u32, shape: &SeenShape) {
        for lane in lanes(pixels) {
            self.ids[lane] = shape.id;
            self.radiance[lane] = self.radiance[lane].max(shape.radiance);
        }
    }

    /// Adds a shape that has a border in some pixels.
    #[inline(always)]
    fn add_border(&mut self, pixels: u32, shape: &SeenShape) {
        for lane in lanes(pixels) {
            self.borders[lane] = self.borders[lane].wrapping_add(shape.digest);
            self.radiance[lane] = self.radiance[lane].max(shape.radiance);
        }
    }
}

/// The cover of pixels without one. No shape has this id: there are at most 2^28.
pub(crate) const UNCOVERED: ShapeId = ShapeId(u32::MAX);

impl TileFeatures {
    /// Returns the features and covers of a packet's pixels.
    #[inline(always)]
    pub(crate) fn of(&self, packet: usize) -> (&[Feature], &CoverPacket) {
        (&self.features[packet * LANES..][..LANES], &self.covers[packet])
    }
}

/// The features of a tile that other instants of an open shutter have shown.
#[derive(Clone, Debug)]
pub(crate) struct KnownFeatures {
    /// The digest of the features at the last instant; 0 before the first.
    pub(crate) digest: u64,
    /// By packet, the radiance of features of a pixel's area; negative for smaller features.
    pub(crate) radiance: [[f32; LANES]; PACKETS],
}

impl KnownFeatures {
    /// Nothing is known.
    pub(crate) const NONE: Self = Self { digest: 0, radiance: [[-1.0; LANES]; PACKETS] };

    /// Returns the pixels of a packet to which no feature of at most this radiance adds anything.
    fn outshine(&self, packet: usize, radiance: f32) -> u32 {
        lanes_where(|lane| self.radiance[packet][lane] >= radiance)
    }
}

/// Reusable memory of the search.
#[derive(Debug)]
pub(crate) struct FeatureScratch {
    seen: Vec<SeenShape>,
    found: TileFeatures,
}

impl Default for FeatureScratch {
    fn default() -> Self {
        Self { seen: Vec::new(), found: unknown() }
    }
}

/// A shape seen through a tile.
#[derive(Debug)]
struct SeenShape {
    id: ShapeId,
    outline: Outline,
    /// Half the side of the square around a pixel's centre in which the pixel sees the shape, in pixels.
    half: f64,
    /// Upper bound of the shape's radiance.
    radiance: f32,
    /// Coverage of the squares of the tile's packets.
    blocks: Covers<PACKETS>,
    /// With an open shutter: a digest of all that determines the shape's image.
    digest: u64,
}

/// Maximum number of shapes for a linear scan if the tree cannot be traversed.
const FEW: usize = 4096;

/// The search for the features of pixels at an instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FeatureSearch<'a> {
    scene: &'a PreparedScene,
    camera: &'a PreparedCamera,
    /// With an open shutter: digests of the camera, and of the camera and the surroundings of shapes.
    digests: Option<[u64; 2]>,
}

impl<'a> FeatureSearch<'a> {
    /// Creates a search. `is_open` is true if the shutter is open.
    pub(crate) fn new(scene: &'a PreparedScene, camera: &'a PreparedCamera, is_open: bool) -> Self {
        let digests = is_open.then(|| {
            let mut bytes = Bytes::default();
            camera.write(&mut bytes);
            let view = bytes.short_digest();
            bytes.count(view);
            scene.write_surroundings(&mut bytes);
            [view, bytes.short_digest()]
        });
        Self { scene, camera, digests }
    }

    /// Finds the features of a tile's pixels by traversing the tree. `None` if nothing has changed since the last instant.
    pub(crate) fn features<'s>(
        &self,
        (tile, known): (&Tile, &KnownFeatures),
        (scratch, search): (&'s mut FeatureScratch, &mut Scratch<'_>),
    ) -> Option<&'s TileFeatures> {
        let Self { scene, camera, .. } = *self;
        let see_all = |rays: &TileRays, seen: &mut Vec<SeenShape>| {
            let Scratch { stack, cancelled, .. } = search;
            let ids = scene.unbounded.iter().copied();
            let mut is_known = self.see_each(ids, rays, seen);
            let is_whole = !camera.has_lens()
                && dispatch!(scene.simd.level(), simd => {
                    let visitor = &mut FeatureVisitor { scene, camera, rays, seen, known: true };
                    let is_whole = visit(simd, visitor, tile, stack, cancelled);
                    is_known &= visitor.known;
                    is_whole
                });
            let ids = scene.leaves.ids();
            is_known && (is_whole || ids.len() <= FEW && self.see_each(ids, rays, seen))
        };
        self.find((tile, known), scratch, see_all)
    }

    /// Finds the features of a tile's pixels by a linear scan of all shapes. `None` if nothing has changed since the last instant.
    pub(crate) fn reference_features<'s>(
        &self,
        of_tile: (&Tile, &KnownFeatures),
        scratch: &'s mut FeatureScratch,
    ) -> Option<&'s TileFeatures> {
        let Self { scene, camera, .. } = *self;
        let is_feasible = !camera.has_lens() || scene.leaves.ids().len() <= FEW;
        let ids = scene.unbounded.iter().copied().chain(scene.leaves.ids());
        self.find(of_tile, scratch, |rays, seen| is_feasible && self.see_each(ids, rays, seen))
    }

    /// Finds the features of a tile's pixels, given the search for all shapes seen through it, which returns `false` if any outline is unknown.
    fn find<'s>(
        &self,
        (tile, known): (&Tile, &KnownFeatures),
        FeatureScratch { seen, found }: &'s mut FeatureScratch,
        see_all: impl FnOnce(&TileRays, &mut Vec<SeenShape>) -> bool,
    ) -> Option<&'s TileFeatures> {
        let Self { scene, camera, .. } = *self;
        *found = unknown();
        let Some(rays) = tile_rays(camera, tile) else { return Some(found) };
        seen.clear();
        if see_all(&rays, seen) {
            found.digest = self.digest(seen);
            if self.digests.is_some() && found.digest == known.digest {
                return None;
            }
            resolve(scene, (&rays, tile, known), seen, found);
        }
        add_sky(scene, camera, tile, found);
        Some(found)
    }

    /// Appends the shapes that may be seen through a tile. Returns `false` if an outline is unknown.
    fn see_each(
        &self,
        mut ids: impl Iterator<Item = ShapeId>,
        rays: &TileRays,
        seen: &mut Vec<SeenShape>,
    ) -> bool {
        ids.all(|id| see(self.scene, self.camera, rays, id, seen))
    }

    /// With an open shutter, computes the digests of the shapes seen through a tile, and returns one of all that determines the tile's
    /// features. Otherwise returns 0.
    fn digest(&self, seen: &mut [SeenShape]) -> u64 {
        let Some([view, around]) = self.digests else { return 0 };
        let mut bytes = Bytes::default();
        for shape in seen.iter_mut() {
            bytes.count(view);
            self.scene.write_shape(shape.id, &mut bytes);
            shape.digest = bytes.short_digest();
        }
        // A sum does not depend on the order of shapes.
        seen.iter().fold(around, |sum, shape| sum.wrapping_add(shape.digest))
    }
}

/// Returns an edge in every pixel: any number of surfaces may show.
fn unknown() -> TileFeatures {
    TileFeatures {
        features: [Feature::EDGE; TILE_PIXELS],
        covers: [CoverPacket::all(UNCOVERED); PACKETS],
        digest: 0,
    }
}

/// Returns the rays of a tile; `None` if they are not finite, or parallel, since outlines are perspective images.
fn tile_rays(camera: &PreparedCamera, tile: &Tile) -> Option<TileRays> {
    let first = camera.through(f64::from(tile.i), f64::from(tile.j));
    let steps = camera.steps();
    let middle = first + (steps[0] + steps[1]) * MIDDLE;
    let eye = camera.position();
    let is_known = eye.is_finite() && middle.is_finite() && middle.length_squared() > 0.0;
    (is_known && !camera.is_orthographic()).then_some(TileRays { eye, middle, steps })
}

/// Distance from the centre of a tile's first pixel to the middle of the tile along either axis, in pixels.
const MIDDLE: f64 = (TILE as f64 - 1.0) / 2.0;

/// Distance from a pixel's centre to just beyond its edge. The margin exceeds the margin of [`TileRays::may_meet`].
const WIDER: f64 = 0.5 + 1e-5;

/// Half a pixel, and a margin that exceeds the rounding of sample positions.
const HALF: f64 = 0.5 + 1e-9;

/// Appends a shape if it may be seen through the tile. Returns `false` if its outline is unknown.
fn see(
    scene: &PreparedScene,
    camera: &PreparedCamera,
    rays: &TileRays,
    id: ShapeId,
    seen: &mut Vec<SeenShape>,
) -> bool {
    if let Some(bounds) = scene.geometry().bounds(id).filter(|_| !camera.has_lens())
        && !rays.may_meet(&bounds)
    {
        return true;
    }
    let Ok(outline) = Outline::of(scene.geometry().shape(id), rays) else { return false };
    let half = HALF + if camera.has_lens() { confusion(scene, camera, id).min(WIDEST) } else { 0.0 };
    if let Some(mut outline) = outline {
        if half > 1.0 {
            // The image of the shape is spread over the circle of confusion.
            outline.area /= 4.0 * half * half;
        }
        let blocks = dispatch!(scene.simd.level(), _simd => outline.covers(&BLOCKS.widened(half)));
        if blocks.seen != 0 {
            let radiance = most_radiance(scene, scene.material(id));
            seen.push(SeenShape { id, outline, half, radiance, blocks, digest: 0 });
        }
    }
    true
}

/// Limit of circles of confusion in pixels: finite, and larger than any film.
const WIDEST: f64 = 1e6;

/// Returns the radius of the largest circle of confusion of a shape, in pixels.
fn confusion(scene: &PreparedScene, camera: &PreparedCamera, id: ShapeId) -> f64 {
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

/// Collects the shapes of the tree that are seen through a tile.
struct FeatureVisitor<'a> {
    scene: &'a PreparedScene,
    camera: &'a PreparedCamera,
    rays: &'a TileRays,
    seen: &'a mut Vec<SeenShape>,
    known: bool,
}

impl<S: Simd> FrustumVisitor<S> for FeatureVisitor<'_> {
    #[inline(always)]
    fn visit(&mut self, _: S, leaf: LeafId, _: &LeafBox) -> f32 {
        self.known &= see(self.scene, self.camera, self.rays, self.scene.leaves.id(leaf), self.seen);
        f32::INFINITY
    }
}

/// Visits the shapes of the tree that can be hit through the tile. Returns `false` if there is no frustum.
#[inline(always)]
fn visit<S: Simd>(
    simd: S,
    visitor: &mut FeatureVisitor<'_>,
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
    // The main axis of `TileRays::may_meet`, so that both tests agree.
    let depth = Depth::along(visitor.rays.middle);
    let slopes = SlopeRange::of(simd, (&corners, 0b1111), (depth, 1.0));
    let tree = &visitor.scene.tree;
    let Some(frustum) = slopes.and_then(|slopes| tree.frustum(camera.position(), depth, &slopes)) else {
        return false;
    };
    tree.visit_frustum(simd, &frustum, f32::INFINITY, stack, cancelled, visitor);
    true
}

/// Minimum area in pixels of a large shape, or of a part of a pattern. The first samples of some of its pixels hit it, and neighbouring pixels
/// are compared with them.
const LARGE: f64 = 16.0;

/// Half the side of a packet's square, between the centres of its outermost pixels.
const HALF_BLOCK: f64 = (SIDE as f64 - 1.0) / 2.0;

/// The squares of a tile's packets, bounded by the centres of their outermost pixels.
const BLOCKS: Squares<PACKETS> = {
    let (mut x, mut y) = ([0.0; PACKETS], [0.0; PACKETS]);
    let across = (TILE / SIDE) as usize;
    let mut packet = 0;
    while packet < PACKETS {
        x[packet] = (packet % across) as f64 * SIDE as f64 + HALF_BLOCK - MIDDLE;
        y[packet] = (packet / across) as f64 * SIDE as f64 + HALF_BLOCK - MIDDLE;
        packet += 1;
    }
    Squares { x, y, half: HALF_BLOCK }
};

/// Determines the features of each pixel from the shapes that are seen through the tile. First resolves squares of four by four pixels:
/// shapes behind a shape that covers a square fully are skipped in its pixels.
fn resolve(
    scene: &PreparedScene,
    (rays, tile, known): (&TileRays, &Tile, &KnownFeatures),
    seen: &[SeenShape],
    found: &mut TileFeatures,
) {
    found.features = [Feature::NONE; TILE_PIXELS];
    dispatch!(scene.simd.level(), _simd => {
        let mut covers = Vec::with_capacity(seen.len());
        let mut nearest = NearestCovers::<PACKETS>::new();
        seen.iter().for_each(|shape| nearest.update(shape, &shape.blocks));
        let in_sight: Vec<u32> = seen.iter().map(|shape| nearest.visible(&shape.blocks)).collect();
        for (packet, square) in (0..PACKETS).filter_map(|packet| Some((packet, tile.square(packet)?))) {
            let pixels = pixels(packet);
            let shapes = seen.iter().zip(&in_sight).filter(|(_, packets)| *packets >> packet & 1 == 1);
            covers.clear();
            covers.extend(shapes.map(|(shape, _)| (shape, shape.covers(packet, &pixels))));
            let brightest = covers.iter().map(|(shape, _)| shape.radiance).fold(0.0, f32::max);
            let known = known.outshine(packet, brightest);
            let mut nearest = NearestCovers::<LANES>::new();
            covers.iter().for_each(|(shape, cover)| nearest.update(shape, cover));
            let place = |lane: usize| DVec2::new(pixels.x[lane], pixels.y[lane]);
            let (features, whole) = (&mut found.features[packet * LANES..], &mut found.covers[packet]);
            for (shape, cover) in &covers {
                let visible = nearest.visible(cover) & square.lanes();
                let first = visible & nearest.of(shape.id);
                whole.add_cover(first, shape);
                if let Some(pattern) = scene.material(shape.id).pattern.as_deref() {
                    for lane in lanes(shape.bordered(first & !known, &pattern.layout, rays, packet)) {
                        let at = (place(lane), shape.half);
                        let Some(width) = shape.part_width(&pattern.layout, rays, at) else { continue };
                        // Narrow parts are many, and fill the pixel together.
                        features[lane].join(shape.feature(f64::max(width * width, 1.0)));
                        whole.add_border(1 << lane, shape);
                    }
                }
                let edges = first & !cover.one_face | visible & !first & cover.whole;
                lanes(edges).for_each(|lane| features[lane].join(Feature::EDGE));
                let (parts, feature) = (visible & !first & !cover.whole, shape.feature(shape.outline.area));
                lanes(parts).for_each(|lane| features[lane].join(feature));
                if feature == Feature::EDGE {
                    whole.add_border(parts, shape);
                }
            }
        }
    });
}

/// Returns the centres of a packet's pixels as squares of size 0.
#[inline(always)]
fn pixels(packet: usize) -> Squares<LANES> {
    let (x, y) = (BLOCKS.x[packet] - HALF_BLOCK, BLOCKS.y[packet] - HALF_BLOCK);
    let side = SIDE as usize;
    Squares {
        x: std::array::from_fn(|lane| x + (lane % side) as f64),
        y: std::array::from_fn(|lane| y + (lane / side) as f64),
        half: 0.0,
    }
}

/// The nearest shape that covers each square fully: the greatest lower bound of inverse depth, 0 if there is none.
struct NearestCovers<const N: usize> {
    depth: [f64; N],
    ids: [ShapeId; N],
}

impl<const N: usize> NearestCovers<N> {
    fn new() -> Self {
        Self { depth: [0.0; N], ids: [UNCOVERED; N] }
    }

    /// Updates the nearest covers with a shape.
    #[inline(always)]
    fn update(&mut self, shape: &SeenShape, cover: &Covers<N>) {
        for lane in 0..N {
            let (depth, id) = (cover.depth[0][lane], self.ids[lane]);
            // Ties are resolved by id, independently of the order of shapes.
            let is_nearer = depth > self.depth[lane] || (depth == self.depth[lane] && shape.id.0 < id.0);
            if is_nearer && depth > 0.0 && (cover.whole & cover.seen) >> lane & 1 == 1 {
                (self.depth[lane], self.ids[lane]) = (depth, shape.id);
            }
        }
    }

    /// Returns the squares in which a shape may be visible in front of the nearest cover.
    #[inline(always)]
    fn visible(&self, cover: &Covers<N>) -> u32 {
        cover.seen & !where_less(&cover.depth[1], &self.depth)
    }

    /// Returns the squares in which a shape is the nearest cover.
    #[inline(always)]
    fn of(&self, id: ShapeId) -> u32 {
        (0..N).fold(0, |mask, lane| mask | u32::from(self.ids[lane] == id) << lane)
    }
}

impl SeenShape {
    /// Computes the shape's coverage of the pixels of a packet.
    #[inline(always)]
    fn covers(&self, packet: usize, pixels: &Squares<LANES>) -> Covers<LANES> {
        if self.fills(packet) {
            let depth = self.blocks.depth.map(|bounds| [bounds[packet]; LANES]);
            return Covers { seen: WHOLE, whole: WHOLE, one_face: WHOLE, depth };
        }
        self.outline.covers(&pixels.widened(self.half))
    }

    /// Returns whether a single face of the shape covers the square of a packet.
    fn fills(&self, packet: usize) -> bool {
        (self.blocks.whole & self.blocks.one_face) >> packet & 1 == 1
    }

    /// Returns the feature of a pixel at the border of the shape, or of a part of its pattern, with an area in pixels.
    fn feature(&self, area: f64) -> Feature {
        if area < LARGE {
            Feature { area: to_f32(area.min(1.0)), radiance: self.radiance }
        } else {
            Feature::EDGE
        }
    }

    /// Returns the pixels of a packet that may show a border of the shape's pattern, among those it covers: none if the packet's square
    /// shows no border.
    fn bordered(&self, covered: u32, layout: &PatternLayout, rays: &TileRays, packet: usize) -> u32 {
        let square = (DVec2::new(BLOCKS.x[packet], BLOCKS.y[packet]), HALF_BLOCK + self.half);
        let is_smooth = covered != 0 && self.fills(packet) && self.part_width(layout, rays, square).is_none();
        if is_smooth { 0 } else { covered }
    }

    /// Returns the [width](PatternLayout::part_width) of the narrowest part of the shape's pattern, relative to a square around a place in the
    /// tile, if it shows a border.
    fn part_width(
        &self,
        layout: &PatternLayout,
        rays: &TileRays,
        (middle, half): (DVec2, f64),
    ) -> Option<f64> {
        let places = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (0.0, 0.0)].map(DVec2::from);
        layout.part_width(self.outline.points(rays, places.map(|from| middle + from * half)))
    }
}

#[cfg(test)]
mod tests;
