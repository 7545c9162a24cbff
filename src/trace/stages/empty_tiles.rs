//! Tiles whose camera rays hit nothing: their rays are not traced.
//!
//! All rays through the centres of a tile's pixels lie between the rays through its corner pixels. Along a row, and along a column, directions
//! change linearly. Slopes, being ratios of linear functions, are therefore monotonic as long as all corners lie ahead, and their extremes are
//! at the corners. The rounding errors of the rays in between are far below the slack of [frusta](crate::trace::bvh).

use std::ops::RangeInclusive;

use fearless_simd::{dispatch, prelude::*};
use glam::DVec3;

use super::buffers::TileBuffers;
use super::slots::Sample;
use super::tile::{PACKETS, Tile};
use crate::color::Rgb;
use crate::trace::bvh::{Depth, FrustumVisitor, LeafBox, LeafId, SlopeRange};
use crate::trace::intersect::Scratch;
use crate::trace::math::{Colors, Vectors, lanes};
use crate::trace::scene::{Precision, PreparedCamera, SIDE};
use crate::trace::shading::RenderContext;
use crate::trace::shapes::CompactBounds;

/// Fills a tile's pixels with the background's colour if their rays certainly hit nothing. Otherwise, or if the colour of such rays needs more
/// work, changes nothing and returns `false`.
pub(super) fn fill_empty_tile(sample: &Sample<'_>, buffers: &mut TileBuffers<'_>) -> bool {
    let Sample { context, tile, .. } = *sample;
    let Some(color) = sight_of_nothing(context) else { return false };
    let Some(directions) = directions_to_nothing(context, &tile, &mut buffers.scratch.search) else {
        return false;
    };
    if let Some(recorder) = &mut buffers.recorder {
        recorder.add_empty(context.camera.position(), directions);
    }
    for packet in 0..PACKETS {
        if let Some(square) = tile.square(packet) {
            let pixels = &mut buffers.pixels[packet];
            if square.size == (SIDE, SIDE) {
                *pixels = Colors::splat(color);
            } else {
                lanes(square.lanes()).for_each(|lane| pixels.set(lane, color));
            }
        }
    }
    buffers.rays_traced.camera += u64::from(tile.width * tile.height);
    true
}

/// Returns the common colour of all rays that hit nothing. `None` if it can differ between rays, or if empty tiles cannot be detected.
fn sight_of_nothing(context: &RenderContext<'_>) -> Option<Rgb> {
    let scene = context.scene;
    let alike = context.sampling.samples <= 1
        && !context.camera.is_orthographic()
        && scene.precision == Precision::Robust
        && scene.unbounded.is_empty()
        && (scene.fog.density == 0.0 || !scene.fog.hides_background)
        && !context.may_start_inside();
    // Same operations as the accumulation in a pixel.
    scene.constant_miss_radiance().filter(|_| alike).map(|color| Rgb::ZERO + Rgb::ONE * color)
}

/// Returns a box around the directions of a tile's rays if all of its pixels certainly have a ray, and none of these rays can hit a shape of
/// the tree.
fn directions_to_nothing(
    context: &RenderContext<'_>,
    tile: &Tile,
    scratch: &mut Scratch<'_>,
) -> Option<CompactBounds> {
    let (eye, tree) = (context.camera.position(), &context.scene.tree);
    let corners = corners(context.camera, tile).filter(|_| eye.is_finite())?;
    let depth = Depth::along(corners.get(0));
    dispatch!(context.scene.simd.level(), simd => {
        let slopes = SlopeRange::of(simd, (&corners, FOUR), (depth, 1.0))?;
        let frustum = tree.frustum(eye, depth, &slopes)?;
        let mut shapes = AnyShape(false);
        tree.visit_frustum(simd, &frustum, f32::INFINITY, &mut scratch.stack, scratch.cancelled, &mut shapes);
        (!shapes.0).then(|| slopes.directions(depth))
    })
}

/// Returns the directions from the eye to the centres of the corner pixels, in the first four lanes. `None` if some may not form a ray.
fn corners(camera: &PreparedCamera, tile: &Tile) -> Option<Vectors> {
    /// Squared lengths far from overflow and underflow.
    const USUAL: RangeInclusive<f64> = 1e-100..=1e100;
    let (right, bottom) = (tile.i + tile.width - 1, tile.j + tile.height - 1);
    let pixels = [(tile.i, tile.j), (right, tile.j), (tile.i, bottom), (right, bottom)];
    let mut corners = Vectors::splat(DVec3::ZERO);
    for (lane, (i, j)) in pixels.into_iter().enumerate() {
        let towards = camera.towards(i, j);
        if !USUAL.contains(&towards.length_squared()) {
            return None;
        }
        corners.set(lane, towards);
    }
    Some(corners)
}

/// The lanes of the corners, as a bit mask.
const FOUR: u32 = 0b1111;

/// True if any shape was visited.
struct AnyShape(bool);

impl<S: Simd> FrustumVisitor<S> for AnyShape {
    #[inline(always)]
    fn visit(&mut self, _: S, _: LeafId, _: &LeafBox) -> f32 {
        self.0 = true;
        f32::NEG_INFINITY
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use proptest::prelude::*;

    use super::*;
    use crate::trace::shapes::Sphere;
    use crate::trace::{
        Effects, Geometry, Lighting, Paths, PixelSampling, PreparedScene, PreparedShape, SurfaceMaterial,
    };

    const SIZE: (u32, u32) = (70, 45);
    const EFFECTS: Effects = Effects { lighting: Lighting::None, paths: Paths::Straight, extras: false };

    /// Returns the empty tiles of a film, with spheres in front of the camera. Checks that the rays of such a tile lie in the box of directions.
    fn empty_tiles(camera: &PreparedCamera, spheres: &[Sphere]) -> Vec<Tile> {
        let mut geometry = Geometry::default();
        for sphere in spheres {
            geometry.push(PreparedShape::Sphere(*sphere));
        }
        let scene = PreparedScene::new(geometry, vec![SurfaceMaterial::default(); spheres.len()]);
        let context = RenderContext::new(&scene, camera, PixelSampling::default(), EFFECTS);
        let never = AtomicBool::new(false);
        let is_empty = |tile: &Tile| {
            let Some(bounds) = directions_to_nothing(&context, tile, &mut Scratch::new(&never, None)) else {
                return false;
            };
            let along = (0..3).find(|axis| bounds.min[*axis] == bounds.max[*axis]).unwrap();
            for (i, j) in (tile.j..tile.j + tile.height)
                .flat_map(|j| (tile.i..tile.i + tile.width).map(move |i| (i, j)))
            {
                let towards = camera.towards(i, j);
                let direction = (towards / towards[along].abs()).to_array();
                let is_inside = |axis: usize| {
                    (f64::from(bounds.min[axis])..=f64::from(bounds.max[axis])).contains(&direction[axis])
                };
                assert!((0..3).all(is_inside), "{direction:?} {bounds:?}");
            }
            true
        };
        Tile::all(SIZE).filter(is_empty).collect()
    }

    #[test]
    fn most_tiles_around_a_small_sphere_are_empty() {
        let camera =
            PreparedCamera::new(DVec3::new(0.0, 0.0, -5.0), DVec3::Z, DVec3::Y, 1.0, (1.0, 0.64), SIZE);
        let empty = |spheres: &[Sphere]| empty_tiles(&camera, spheres).len();
        assert_eq!(empty(&[]), 15);
        assert_eq!(empty(&[Sphere { center: DVec3::new(0.0, 0.0, -9.0), radius: 3.0 }]), 15);
        // It overlaps two tiles.
        assert_eq!(empty(&[Sphere { center: DVec3::ZERO, radius: 0.4 }]), 13);
    }

    fn number(range: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-range..range).prop_map(DVec3::from_array)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn a_tile_with_a_tiny_sphere_in_a_ray_of_its_own_is_not_empty(
            (eye, view, up) in (number(10.0), number(1.0), number(1.0)),
            (width, distance) in (0.1..4.0, 0.1..100.0),
            (column, row) in (0..SIZE.0, 0..SIZE.1),
        ) {
            let camera = PreparedCamera::new(eye, view, up, 1.0, (width, width * 0.64), SIZE);
            let center = camera.ray(column, row).unwrap().at(distance);
            // A second sphere, behind the camera, must not hide the first.
            let behind = Sphere { center: eye - view.normalize_or(DVec3::Z) * 5.0, radius: 1.0 };
            let empty = empty_tiles(&camera, &[Sphere { center, radius: 1e-9 }, behind]);
            let holds = |tile: &Tile| {
                (tile.i..tile.i + tile.width).contains(&column) && (tile.j..tile.j + tile.height).contains(&row)
            };
            prop_assert!(!empty.iter().any(holds), "{:?}", empty);
        }
    }
}
