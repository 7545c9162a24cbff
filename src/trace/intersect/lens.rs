//! Closest hits of camera rays through a lens, and of parallel camera rays.
//!
//! The rays of a tile's samples start anywhere on the lens, or in a rectangle of the camera's plane if they are parallel, and reach about the
//! same region. The shapes that any of them may hit are therefore collected once per tile, by part, which is half a packet:
//!
//! ```text
//! find, once per tile:
//!     for each part: bound the points, behind all shapes of the tree, that its samples reach
//!     beam = bundle of all rays between the bounds of their starts and these bounds
//!     for each shape of the tree that the frustum of the beam may hit: store it with the parts that may hit it
//!     with more than MOST shapes: give up
//!     sort the shapes by their least depth
//!
//! lens_hits, once per sample:
//!     intersect all packets with the shapes outside the tree
//!     for each stored shape: intersect it with its parts, except those whose closest hits are all nearer than the shape
//! ```

use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::{dispatch, prelude::*};
use glam::DVec3;

use super::bundle::TilePackets;
use super::hit::HitPacket;
use super::intersector::ShapeQuery;
use super::reciprocals::Reciprocals;
use super::scratch::PacketScratch;
use super::scratch::Scratch;
use crate::trace::bvh::{Beam, FrustumVisitor, LeafBox, LeafId, Limits, PACKETS, Stack};
use crate::trace::math::{LANES, Vectors};
use crate::trace::rays::RayPacket;
use crate::trace::scene::{PreparedCamera, PreparedScene, Square};

/// Maximum number of candidates, the number of a tile's rays. Beyond it, traversing the tree is faster. Skipping a candidate costs a few
/// operations for all rays together.
const MOST: usize = PACKETS * LANES;

/// The shapes of the tree that rays of a tile's samples may hit. Reused to avoid allocations.
#[derive(Clone, Debug, Default)]
pub(crate) struct LensCandidates {
    /// `None` if there is no valid list.
    beam: Option<Beam>,
    /// Nearest first.
    shapes: Vec<LensCandidate>,
}

/// A shape that rays may hit.
#[derive(Clone, Copy, Debug)]
struct LensCandidate {
    leaf: LeafId,
    /// Parts that may hit it, as a bit mask.
    parts: u32,
    /// Lower bound of the depth at which it begins.
    near: f32,
}

impl LensCandidates {
    /// Collects the shapes that samples of a tile's pixels may hit. `squares` holds the pixels of each packet.
    pub(crate) fn find(
        &mut self,
        scene: &PreparedScene,
        camera: &PreparedCamera,
        squares: &[Option<Square>; PACKETS],
        scratch: &mut Scratch<'_>,
    ) {
        self.shapes.clear();
        self.beam = None;
        let Some(places) = places_beyond(scene, camera, squares) else { return };
        let points = places.iter().map(|(points, lanes)| (points, *lanes));
        let Scratch { stack, cancelled, .. } = scratch;
        dispatch!(scene.simd.level(), simd => {
            let (middle, reach) = camera.starts(squares);
            let Some((beam, limits)) = scene.tree.beam(simd, middle, reach, points) else { return };
            self.gather(simd, scene, (beam, limits), (stack, cancelled));
        });
    }

    /// Assigns every shape to all parts, for packets that no longer hold the pixels of their squares.
    pub(crate) fn mix_packets(&mut self) {
        self.shapes.iter_mut().for_each(|shape| shape.parts = u32::MAX);
    }

    /// Collects the shapes that the beam may hit, and sorts them.
    #[inline(always)]
    fn gather<S: Simd>(
        &mut self,
        simd: S,
        scene: &PreparedScene,
        (beam, limits): (Beam, Limits),
        (stack, cancelled): (&mut Stack, &AtomicBool),
    ) {
        let farthest = limits.farthest(simd);
        let mut visitor = Gathering { beam: &beam, limits, farthest, shapes: &mut self.shapes };
        scene.tree.visit_frustum(simd, &beam.frustum, farthest, stack, cancelled, &mut visitor);
        if self.shapes.len() <= MOST {
            self.shapes.sort_unstable_by(|one, other| {
                one.near.total_cmp(&other.near).then(one.leaf.cmp(&other.leaf))
            });
            self.beam = Some(beam);
        }
    }
}

/// Returns boxes around the points, behind all shapes of the tree, that the samples of pixels reach: two corners for each half packet, and the
/// lanes that hold them. `None` if some samples do not reach that depth.
fn places_beyond(
    scene: &PreparedScene,
    camera: &PreparedCamera,
    squares: &[Option<Square>; PACKETS],
) -> Option<[(Vectors, u32); PACKETS]> {
    let [.., view] = camera.axes();
    let (middle, _) = camera.starts(squares);
    let (axis, far) = scene.tree.beyond(middle, view);
    let mut places = [const { (Vectors::splat(DVec3::ZERO), 0) }; PACKETS];
    for ((corners, lanes), square) in places.iter_mut().zip(squares) {
        let Some(square) = square else { continue };
        for half in 0..2 {
            let [low, high] = camera.places_at((middle, axis, far), square, half)?;
            let first = half * LANES / 2;
            corners.set(first, low);
            corners.set(first + 1, high);
            *lanes |= 3 << first;
        }
    }
    Some(places)
}

/// Collects shapes during traversal.
struct Gathering<'a> {
    beam: &'a Beam,
    limits: Limits,
    farthest: f32,
    shapes: &'a mut Vec<LensCandidate>,
}

impl<S: Simd> FrustumVisitor<S> for Gathering<'_> {
    #[inline(always)]
    fn visit(&mut self, simd: S, leaf: LeafId, bounds: &LeafBox) -> f32 {
        let parts = self.beam.parts(simd, bounds, &self.limits);
        if parts != 0 {
            self.shapes.push(LensCandidate { leaf, parts, near: self.beam.nearest(bounds) });
        }
        if self.shapes.len() > MOST { f32::NEG_INFINITY } else { self.farthest }
    }
}

/// Finds the closest hits of the rays of one of the samples for which candidates were collected. `hits.undecided` holds the undecided lanes.
/// Returns `false`, without hits, if there is no candidate list.
pub(crate) fn lens_hits(
    scene: &PreparedScene,
    candidates: &LensCandidates,
    rays: &[RayPacket],
    hits: &mut [HitPacket],
    PacketScratch { reciprocals, .. }: &mut PacketScratch,
    cancelled: &AtomicBool,
) -> bool {
    let Some(beam) = &candidates.beam else { return false };
    hits.iter_mut().for_each(HitPacket::clear);
    reciprocals.iter_mut().for_each(Reciprocals::forget);
    let (depth, depth_limit) = (beam.depth(), |farthest| beam.depth_limit(farthest));
    let limits = Limits::NONE;
    let mut packets = TilePackets { scene, rays, hits, reciprocals, depth, depth_limit, limits };
    dispatch!(scene.simd.level(), simd => meet_all(simd, &mut packets, &candidates.shapes, cancelled));
    true
}

/// Intersects a sample's rays with the shapes that they may hit.
#[inline(always)]
fn meet_all<S: Simd>(
    simd: S,
    packets: &mut TilePackets<'_, impl Fn(f64) -> f32>,
    shapes: &[LensCandidate],
    cancelled: &AtomicBool,
) {
    if !packets.test_unbounded(simd, cancelled) {
        return;
    }
    for LensCandidate { leaf, parts, near } in shapes {
        let parts = parts & packets.limits.reaching(simd, *near);
        if parts == 0 {
            continue;
        }
        if cancelled.load(Ordering::Relaxed) {
            return;
        }
        packets.test_parts(simd, parts, ShapeQuery::leaf(packets.scene, *leaf));
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::trace::intersect::tests::{camera, compare, crowd, looking, point, scene, shape};
    use crate::trace::math::{PixelSampling, SimdLevel};
    use crate::trace::rays::TieLists;
    use crate::trace::scene::PixelKeys;

    /// Compares the hits of samples through a lens with the hits of single rays, at every SIMD level. Returns the smallest number of rays
    /// decided in packets at any level, and the number of rays.
    fn decided_through_lens(
        scene: &mut PreparedScene,
        camera: &PreparedCamera,
    ) -> Result<(usize, usize), TestCaseError> {
        let sampling = PixelSampling { samples: 16, seed: 5 };
        let mut squares = [None; 16];
        for (square, index) in squares.iter_mut().zip(0..) {
            *square = Some(Square { first: (index % 4 * 4, index / 4 * 4), size: (4, 4) });
        }
        let mut candidates = LensCandidates::default();
        let (mut least, mut all) = (usize::MAX, 0);
        for (name, level) in SimdLevel::all() {
            scene.simd = level;
            let mut scratch = Scratch::default();
            candidates.find(scene, camera, &squares, &mut scratch);
            let mut count = 0;
            all = 0;
            for index in [0, 5, 11] {
                let (mut packets, mut hits) = (vec![RayPacket::EMPTY; 16], vec![HitPacket::EMPTY; 16]);
                for (rays, square) in packets.iter_mut().zip(squares.iter().flatten()) {
                    let mut keys = PixelKeys::NONE;
                    let pixels = std::array::from_fn(|lane| square.pixel(lane));
                    keys.find(sampling.seed, (&pixels, square.lanes()), true);
                    dispatch!(level.level(), simd => camera.sample_rays(simd, sampling, &keys, &[index; LANES], rays));
                    all += rays.lanes.count_ones() as usize;
                }
                let packet_scratch = &mut PacketScratch::default();
                if lens_hits(scene, &candidates, &packets, &mut hits, packet_scratch, scratch.cancelled) {
                    for (rays, hits) in packets.iter().zip(&mut hits) {
                        count += compare(name, scene, rays, hits, &TieLists::default())?;
                    }
                }
            }
            least = least.min(count);
        }
        Ok((least, all))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn samples_through_a_lens_find_what_single_rays_find(
            shapes in prop::collection::vec(shape(), 1..14),
            eye in point(),
            view in point(),
            (aperture, focus) in (prop_oneof![Just(0.01), 0.1..2.0], prop_oneof![0.2..20.0, Just(1e3)]),
            wide in prop_oneof![Just(1.0), Just(0.01), Just(3.0)],
            far in prop_oneof![4 => Just(1.0), 1 => Just(50.0)],
            (is_orthographic, has_lens) in prop_oneof![3 => Just((false, true)), 1 => Just((true, true)), 2 => Just((true, false))],
        ) {
            let camera = camera(eye * far, looking(view), wide);
            let camera = if is_orthographic { camera.orthographic() } else { camera };
            let camera = if has_lens { camera.with_lens(aperture, focus) } else { camera };
            decided_through_lens(&mut scene(&shapes), &camera)?;
        }
    }

    /// Checks that packets decide most rays. Otherwise the comparison of lens samples with single rays could not fail.
    #[test]
    fn nearly_all_samples_through_a_lens_are_decided_at_once() {
        let (eye, view) = (DVec3::new(0.3, 2.0, -6.1), DVec3::new(0.01, -0.2, 1.0));
        let through_lens = camera(eye, view, 0.5).with_lens(0.3, 8.0);
        for camera in [through_lens, camera(eye, view, 2.0).orthographic()] {
            let (decided, all) = decided_through_lens(&mut crowd(), &camera).unwrap();
            assert!(all == 3 * 256 && decided + 8 >= all, "{decided} of {all}");
        }
    }
}
