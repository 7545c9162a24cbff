//! The dependencies of a tile's pixels on a scene: the regions that their rays pass through, and the materials at which they end.
//!
//! All rays of a bounce that end at surfaces share a hull, and so do those that hit nothing. Hulls of single packets would keep at most 1 % more of the
//! pixels between frames of the shipped scenes, in sixteen times the memory and at 1.7 times the cost (ambient_only).

use fearless_simd::{f32x16, prelude::*};
use glam::DVec3;

use super::ray_hull::{LightRegion, RayHull, light_bit};
use super::tile::PACKETS;
use super::wavefront::{RayOrigin, Wavefront};
use crate::trace::intersect::{HitPacket, SurfacePacket};
use crate::trace::math::{LANES, Vectors, lanes, mask16};
use crate::trace::rays::RayPacket;
use crate::trace::scene::{PreparedScene, ShapeDifferences};
use crate::trace::shading::LightSamplePacket;
use crate::trace::shapes::{Bounds, CompactBounds};

/// Number of bounces that are recorded apart. Later ones join the last.
const BOUNCES: usize = 4;

/// All lanes, as a bit mask.
const ALL: u32 = (1 << LANES) - 1;

/// The parts of a scene on which the pixels of a tile depend.
#[derive(Clone, Debug)]
pub(crate) struct TileDependencies {
    /// By bounce: the hulls of the rays that end at surfaces, and of those that hit nothing.
    hulls: [[RayHull; 2]; BOUNCES],
    /// The materials at the ends of the rays, as a set of [bits](PreparedScene::material_bit).
    materials: u64,
}

/// Records the dependencies of a tile while its rays are traced.
#[derive(Debug, Default)]
pub(super) struct DependencyRecorder {
    dependencies: TileDependencies,
    /// By bounce, as in the dependencies: the hulls, not yet reduced over the lanes.
    lanes: Box<[[HullLanes; 2]; BOUNCES]>,
    /// The lights to which shadow rays are traced from the wavefront's hits.
    lights: u32,
    bounce: usize,
}

/// The hull of the rays in each lane. The smallest and the largest lane are found once for all samples of a tile.
#[derive(Clone, Copy, Debug)]
struct HullLanes {
    from: BoxLanes,
    to: BoxLanes,
    is_empty: bool,
}

/// A box in each lane. Vectors are not split by the lines of the cache.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct BoxLanes {
    min: [[f32; LANES]; 3],
    max: [[f32; LANES]; 3],
}

impl Default for TileDependencies {
    fn default() -> Self {
        let endless = RayHull { is_endless: true, ..RayHull::EMPTY };
        Self { hulls: [[RayHull::EMPTY, endless]; BOUNCES], materials: 0 }
    }
}

impl TileDependencies {
    /// Returns whether differences between two scenes may reach a pixel of the tile. `false` only if none can.
    pub(crate) fn may_be_reached(
        &self,
        differences: &ShapeDifferences,
        lights: &[(u32, LightRegion)],
    ) -> bool {
        let may_intersect = |hull: &RayHull| {
            !hull.is_empty() && differences.bounds.iter().any(|bounds| hull.may_intersect(bounds, lights))
        };
        self.materials & differences.materials != 0 || self.hulls.as_flattened().iter().any(may_intersect)
    }

    fn join(&mut self, other: &Self) {
        let hulls = self.hulls.as_flattened_mut().iter_mut().zip(other.hulls.as_flattened());
        hulls.for_each(|(hull, other)| hull.join(other));
        self.materials |= other.materials;
    }
}

impl DependencyRecorder {
    /// Starts with the camera rays of a sample.
    pub(super) fn begin_sample(&mut self) {
        (self.bounce, self.lights) = (0, 0);
    }

    /// Continues with the rays of the next bounce.
    pub(super) fn begin_bounce(&mut self) {
        self.bounce = (self.bounce + 1).min(BOUNCES - 1);
    }

    /// Records that shadow rays are traced to light number `index`.
    pub(super) fn note_light(&mut self, index: usize, light_samples: &[LightSamplePacket]) {
        if light_samples.iter().any(|light_samples| light_samples.needs_shadow_ray != 0) {
            self.lights |= light_bit(index);
        }
    }

    /// Records that rays from a point in these directions hit nothing.
    pub(super) fn add_empty(&mut self, eye: DVec3, directions: CompactBounds) {
        let from = CompactBounds::around(Bounds { min: eye, max: eye });
        self.dependencies.hulls[0][1].join(&RayHull { from, to: directions, lights: 0, is_endless: true });
    }

    /// Records the rays of the wavefront, with their hits.
    #[inline(always)]
    pub(super) fn add<S: Simd>(
        &mut self,
        simd: S,
        scene: &PreparedScene,
        wavefront: &Wavefront,
        (hits, surfaces): (&[HitPacket; PACKETS], &[SurfacePacket; PACKETS]),
    ) {
        let [ended, endless] = &mut self.lanes[self.bounce];
        for packet in 0..wavefront.count {
            let (rays, hits) = (&wavefront.rays[packet], &hits[packet]);
            let hit = hits.ids.lanes(simd) & rays.lanes;
            if hit != 0 {
                ended.add(simd, (wavefront, rays), ends(simd, rays, (hits, &surfaces[packet]), hit), hit);
                self.dependencies.materials |= match hits.ids.common(simd, hit) {
                    Some(id) => scene.material_bit(id),
                    None => lanes(hit)
                        .filter_map(|lane| hits.ids.get(lane))
                        .fold(0, |bits, id| bits | scene.material_bit(id)),
                };
            }
            let missed = rays.lanes & !hit;
            if missed != 0 {
                endless.add(simd, (wavefront, rays), directions(simd, rays), missed);
            }
        }
        if let RayOrigin::Eye(eye) = wavefront.start {
            let [x, y, z] = eye.as_vec3().to_array();
            let eye = [f32x16::splat(simd, x), f32x16::splat(simd, y), f32x16::splat(simd, z)];
            for hull in [ended, endless] {
                if !hull.is_empty {
                    hull.from.extend(simd, eye, ALL);
                }
            }
        }
        self.dependencies.hulls[self.bounce][0].lights |= std::mem::take(&mut self.lights);
    }

    /// Moves what is recorded to the dependencies of a tile.
    pub(super) fn move_to(&mut self, tile: &mut TileDependencies) {
        tile.join(&std::mem::take(&mut self.dependencies));
        for (hull, lanes) in tile.hulls.as_flattened_mut().iter_mut().zip(self.lanes.as_flattened_mut()) {
            if !lanes.is_empty {
                hull.from.join(&lanes.from.bounds());
                hull.to.join(&lanes.to.bounds());
                *lanes = HullLanes::default();
            }
        }
    }
}

impl Default for HullLanes {
    fn default() -> Self {
        let none = BoxLanes { min: [[f32::INFINITY; LANES]; 3], max: [[f32::NEG_INFINITY; LANES]; 3] };
        Self { from: none, to: none, is_empty: true }
    }
}

impl HullLanes {
    /// Extends the hull to contain active rays to their ends, or in their directions. A common origin is up to the caller.
    #[inline(always)]
    fn add<S: Simd>(
        &mut self,
        simd: S,
        (wavefront, rays): (&Wavefront, &RayPacket),
        to: [f32x16<S>; 3],
        active: u32,
    ) {
        if !matches!(wavefront.start, RayOrigin::Eye(_)) {
            self.from.extend(simd, rounded(simd, &rays.origins), active);
        }
        self.to.extend(simd, to, active);
        self.is_empty = false;
    }
}

impl BoxLanes {
    /// Extends the boxes to contain the points in the active lanes.
    #[inline(always)]
    fn extend<S: Simd>(&mut self, simd: S, points: [f32x16<S>; 3], active: u32) {
        let inside = mask16(simd, active);
        for (axis, points) in points.into_iter().enumerate() {
            let (min, max) = (&mut self.min[axis], &mut self.max[axis]);
            let (least, most) = (f32x16::load_array_ref(simd, min), f32x16::load_array_ref(simd, max));
            // On x86, the second operand is the result if one of them is NaN: what was recorded is kept.
            let (mut lower, mut higher) = (points.min(least), points.max(most));
            if active != ALL {
                (lower, higher) = (inside.select(lower, least), inside.select(higher, most));
            }
            lower.store_array(min);
            higher.store_array(max);
        }
    }

    /// Returns the box around those of all lanes.
    fn bounds(&self) -> CompactBounds {
        // A comparison is one instruction; `f32::min`, which also ignores NaN on its left, takes several.
        let lower = |least, lane| if lane < least { lane } else { least };
        let higher = |most, lane| if lane > most { lane } else { most };
        let min = self.min.map(|lanes| lanes.into_iter().fold(f32::INFINITY, lower));
        let max = self.max.map(|lanes| lanes.into_iter().fold(f32::NEG_INFINITY, higher));
        CompactBounds::between(min, max)
    }
}

#[inline(always)]
fn rounded<S: Simd>(simd: S, vectors: &Vectors) -> [f32x16<S>; 3] {
    [vectors.axis(0).rounded(simd), vectors.axis(1).rounded(simd), vectors.axis(2).rounded(simd)]
}

/// Returns the ends of rays: their surface points or, where these are not needed, the points at the upper bounds of their `t`.
#[inline(always)]
fn ends<S: Simd>(
    simd: S,
    rays: &RayPacket,
    (hits, surfaces): (&HitPacket, &SurfacePacket),
    active: u32,
) -> [f32x16<S>; 3] {
    if active & !surfaces.lanes == 0 {
        return rounded(simd, &surfaces.points);
    }
    let latest = [
        hits.ts.load(simd, 0) + hits.errors.load(simd, 0),
        hits.ts.load(simd, 1) + hits.errors.load(simd, 1),
    ];
    let known = mask16(simd, surfaces.lanes);
    let mut ends = [f32x16::splat(simd, 0.0); 3];
    for (axis, ends) in ends.iter_mut().enumerate() {
        let (origins, directions) = (rays.origins.axis(axis), rays.directions.axis(axis));
        let first = origins.load(simd, 0) + latest[0] * directions.load(simd, 0);
        let second = origins.load(simd, 1) + latest[1] * directions.load(simd, 1);
        *ends = first.narrow(second);
        if surfaces.lanes != 0 {
            *ends = known.select(surfaces.points.axis(axis).rounded(simd), *ends);
        }
    }
    ends
}

/// Returns the directions of rays, each divided by its largest component: boxes around them are smaller.
#[inline(always)]
fn directions<S: Simd>(simd: S, rays: &RayPacket) -> [f32x16<S>; 3] {
    let [x, y, z] = rounded(simd, &rays.directions);
    let longest = x.abs().max(y.abs()).max(z.abs());
    [x / longest, y / longest, z / longest]
}

/// A part of what is recorded, without which pixels that change are missed.
#[cfg(test)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Forgotten {
    CameraRays,
    LaterBounces,
    EndlessRays,
    ShadowRays,
    Materials,
    /// All rays of a packet but those at one corner of their origins and ends.
    Extents,
}

#[cfg(test)]
impl TileDependencies {
    /// Removes a part of what is recorded.
    pub(crate) fn forget(&mut self, part: Forgotten) {
        let [none, no_endless] = Self::default().hulls[0];
        for (bounce, hulls) in self.hulls.iter_mut().enumerate() {
            match part {
                Forgotten::CameraRays if bounce == 0 => *hulls = [none, no_endless],
                Forgotten::LaterBounces if bounce > 0 => *hulls = [none, no_endless],
                Forgotten::EndlessRays => hulls[1] = no_endless,
                Forgotten::ShadowRays => hulls[0].lights = 0,
                Forgotten::Extents => {
                    for hull in hulls {
                        (hull.from.max, hull.to.max) = (hull.from.min, hull.to.min);
                    }
                }
                _ => {}
            }
        }
        if part == Forgotten::Materials {
            self.materials = 0;
        }
    }
}
