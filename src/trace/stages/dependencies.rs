//! The dependencies of a tile's pixels on a scene: the regions that their rays pass through, and the materials at which they end.
//!
//! Rays of a packet are recorded together, and so are those of all samples of its pixels: each bounce, source packet and end has a slot. Slots only
//! group rays that pass through similar regions; any grouping is valid.

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
/// Number of packets of a bounce with the same source packet that are recorded apart: reflected and refracted rays.
const TURNS: usize = 2;
/// Number of slots of a bounce. Every other one is for endless rays.
const SLOTS_OF_BOUNCE: usize = PACKETS * TURNS * 2;

/// The parts of a scene on which the pixels of a tile depend.
#[derive(Clone, Debug, Default)]
pub(crate) struct TileDependencies {
    /// The hulls of the rays, by slot.
    hulls: Vec<(u16, RayHull)>,
    /// The materials at the ends of the rays, as a set of [bits](PreparedScene::material_bit).
    materials: u64,
}

/// Records the dependencies of a tile while its rays are traced.
#[derive(Debug)]
pub(super) struct DependencyRecorder {
    /// By bounce, source packet, turn and end.
    hulls: Vec<HullLanes>,
    materials: u64,
    /// By packet of the wavefront: the lights to which shadow rays are traced.
    lights: [u32; PACKETS],
    bounce: usize,
    /// By source packet: true if a packet of this bounce descends from it.
    seen: [bool; PACKETS],
}

/// The hull of the rays in each lane. Only the hulls of whole packets are needed, but the smallest and the largest lane are found once for
/// all of them.
#[derive(Clone, Debug)]
struct HullLanes {
    from: BoxLanes,
    to: BoxLanes,
    lights: u32,
    is_empty: bool,
}

/// A box in each lane.
#[derive(Clone, Debug)]
struct BoxLanes {
    min: [[f32; LANES]; 3],
    max: [[f32; LANES]; 3],
}

impl TileDependencies {
    /// Returns whether differences between two scenes may reach a pixel of the tile. `false` only if none can.
    pub(crate) fn may_be_reached(
        &self,
        differences: &ShapeDifferences,
        lights: &[(u32, LightRegion)],
    ) -> bool {
        if self.materials & differences.materials != 0 {
            return true;
        }
        // Most boxes are far from all rays of most tiles.
        let mut unions = [RayHull::EMPTY; 4];
        for (slot, hull) in &self.hulls {
            let is_later = usize::from(*slot) >= SLOTS_OF_BOUNCE;
            unions[2 * usize::from(is_later) + usize::from(hull.is_endless)].join(hull);
        }
        let may_intersect =
            |hull: &RayHull, bounds: &Bounds| !hull.is_empty() && hull.may_intersect(bounds, lights);
        differences.bounds.iter().any(|bounds| {
            unions.iter().any(|union| may_intersect(union, bounds))
                && self.hulls.iter().any(|(_, hull)| may_intersect(hull, bounds))
        })
    }

    fn join(&mut self, slot: u16, hull: &RayHull) {
        match self.hulls.iter_mut().find(|(other, _)| *other == slot) {
            Some((_, joined)) => joined.join(hull),
            None => self.hulls.push((slot, *hull)),
        }
    }
}

impl Default for DependencyRecorder {
    fn default() -> Self {
        Self {
            hulls: vec![HullLanes::EMPTY; BOUNCES * SLOTS_OF_BOUNCE],
            materials: 0,
            lights: [0; PACKETS],
            bounce: 0,
            seen: [false; PACKETS],
        }
    }
}

impl DependencyRecorder {
    /// Starts with the camera rays of a sample.
    pub(super) fn begin_sample(&mut self) {
        (self.bounce, self.seen, self.lights) = (0, [false; PACKETS], [0; PACKETS]);
    }

    /// Continues with the rays of the next bounce.
    pub(super) fn begin_bounce(&mut self) {
        (self.bounce, self.seen) = ((self.bounce + 1).min(BOUNCES - 1), [false; PACKETS]);
    }

    /// Records that shadow rays are traced to light number `index`.
    pub(super) fn note_light(&mut self, index: usize, light_samples: &[LightSamplePacket]) {
        for (lights, light_samples) in self.lights.iter_mut().zip(light_samples) {
            if light_samples.needs_shadow_ray != 0 {
                *lights |= light_bit(index);
            }
        }
    }

    /// Records that rays from a point in these directions hit nothing.
    pub(super) fn add_empty(&mut self, eye: DVec3, directions: CompactBounds) {
        let hull = &mut self.hulls[1];
        hull.from.join(CompactBounds::around(Bounds { min: eye, max: eye }));
        hull.to.join(directions);
        hull.is_empty = false;
    }

    /// Records the rays of a packet of the wavefront, with their hits.
    #[inline(always)]
    pub(super) fn add<S: Simd>(
        &mut self,
        simd: S,
        scene: &PreparedScene,
        (wavefront, packet): (&Wavefront, usize),
        (hits, surfaces): (&HitPacket, &SurfacePacket),
    ) {
        let rays = &wavefront.rays[packet];
        let lights = std::mem::take(&mut self.lights[packet]);
        if rays.lanes == 0 {
            return;
        }
        let slot = self.slot(&wavefront.slots[packet], rays.lanes);
        let hit = hits.ids.lanes(simd) & rays.lanes;
        if hit != 0 {
            let hull = &mut self.hulls[slot];
            hull.add_origins(simd, (wavefront, rays), hit);
            hull.to.extend(simd, ends(simd, rays, (hits, surfaces), hit), hit);
            (hull.lights, hull.is_empty) = (hull.lights | lights, false);
            self.materials |= match hits.ids.common(simd, hit) {
                Some(id) => scene.material_bit(id),
                None => lanes(hit)
                    .filter_map(|lane| hits.ids.get(lane))
                    .fold(0, |bits, id| bits | scene.material_bit(id)),
            };
        }
        let missed = rays.lanes & !hit;
        if missed != 0 {
            let hull = &mut self.hulls[slot + 1];
            hull.add_origins(simd, (wavefront, rays), missed);
            hull.to.extend(simd, directions(simd, rays), missed);
            hull.is_empty = false;
        }
    }

    /// Returns the slot of a packet whose rays end at surfaces. The next one is for those that hit nothing.
    fn slot(&mut self, slots: &[u32; LANES], active: u32) -> usize {
        let source_packet = slots[active.trailing_zeros() as usize % LANES] as usize / LANES % PACKETS;
        let turn = usize::from(std::mem::replace(&mut self.seen[source_packet], true));
        self.bounce * SLOTS_OF_BOUNCE + (source_packet * TURNS + turn) * 2
    }

    /// Moves what is recorded to the dependencies of a tile.
    #[inline(always)]
    pub(super) fn move_to(&mut self, tile: &mut TileDependencies) {
        for (slot, lanes) in (0..).zip(&mut self.hulls).filter(|(_, lanes)| !lanes.is_empty) {
            let is_endless = slot % 2 == 1;
            let (from, to) = (lanes.from.bounds(), lanes.to.bounds());
            tile.join(slot, &RayHull { from, to, lights: lanes.lights, is_endless });
            *lanes = HullLanes::EMPTY;
        }
        tile.materials |= std::mem::take(&mut self.materials);
    }
}

impl HullLanes {
    const EMPTY: Self = Self { from: BoxLanes::EMPTY, to: BoxLanes::EMPTY, lights: 0, is_empty: true };

    /// Extends the hull to contain the origins of rays.
    #[inline(always)]
    fn add_origins<S: Simd>(&mut self, simd: S, (wavefront, rays): (&Wavefront, &RayPacket), active: u32) {
        match wavefront.start {
            RayOrigin::Eye(eye) if self.is_empty => {
                self.from.join(CompactBounds::around(Bounds { min: eye, max: eye }));
            }
            // All camera rays of a picture start there.
            RayOrigin::Eye(_) => {}
            RayOrigin::Lens | RayOrigin::Anywhere => {
                self.from.extend(simd, rounded(simd, &rays.origins), active);
            }
        }
    }
}

impl BoxLanes {
    const EMPTY: Self = Self { min: [[f32::INFINITY; LANES]; 3], max: [[f32::NEG_INFINITY; LANES]; 3] };

    /// Extends the box of a lane to contain another one.
    fn join(&mut self, bounds: CompactBounds) {
        for axis in 0..3 {
            self.min[axis][0] = self.min[axis][0].min(bounds.min[axis]);
            self.max[axis][0] = self.max[axis][0].max(bounds.max[axis]);
        }
    }

    /// Extends the boxes of active lanes to contain points.
    #[inline(always)]
    fn extend<S: Simd>(&mut self, simd: S, points: [f32x16<S>; 3], active: u32) {
        let (active, none) = (mask16(simd, active), f32x16::splat(simd, f32::INFINITY));
        for (axis, points) in points.into_iter().enumerate() {
            let (min, max) = (&mut self.min[axis], &mut self.max[axis]);
            f32x16::load_array_ref(simd, min).min(active.select(points, none)).store_array(min);
            f32x16::load_array_ref(simd, max).max(active.select(points, -none)).store_array(max);
        }
    }

    /// Returns the box around those of all lanes.
    #[inline(always)]
    fn bounds(&self) -> CompactBounds {
        let (mut min, mut max) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            min[axis] = reduced(self.min[axis], f32::min);
            max[axis] = reduced(self.max[axis], f32::max);
        }
        CompactBounds::between(min, max)
    }
}

/// Combines all lanes. Halves are combined at a time, which takes vector instructions.
#[inline(always)]
fn reduced(mut lanes: [f32; LANES], combine: impl Fn(f32, f32) -> f32) -> f32 {
    let mut half = LANES / 2;
    while half > 0 {
        for lane in 0..half {
            lanes[lane] = combine(lanes[lane], lanes[lane + half]);
        }
        half /= 2;
    }
    lanes[0]
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
    let mut ends = rounded(simd, &surfaces.points);
    if active & !surfaces.lanes == 0 {
        return ends;
    }
    let (known, error) =
        (mask16(simd, surfaces.lanes), [hits.errors.load(simd, 0), hits.errors.load(simd, 1)]);
    let latest = [hits.ts.load(simd, 0) + error[0], hits.ts.load(simd, 1) + error[1]];
    for (axis, ends) in ends.iter_mut().enumerate() {
        let (origins, directions) = (rays.origins.axis(axis), rays.directions.axis(axis));
        let first = origins.load(simd, 0) + latest[0] * directions.load(simd, 0);
        let second = origins.load(simd, 1) + latest[1] * directions.load(simd, 1);
        *ends = known.select(*ends, first.narrow(second));
    }
    ends
}

/// Returns the directions of rays, each divided by its largest component.
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
        let is_camera_ray = |slot: u16| usize::from(slot) < SLOTS_OF_BOUNCE;
        self.hulls.retain(|(slot, hull)| match part {
            Forgotten::CameraRays => !is_camera_ray(*slot),
            Forgotten::LaterBounces => is_camera_ray(*slot),
            Forgotten::EndlessRays => !hull.is_endless,
            Forgotten::ShadowRays | Forgotten::Materials | Forgotten::Extents => true,
        });
        for (_, hull) in &mut self.hulls {
            match part {
                Forgotten::ShadowRays => hull.lights = 0,
                Forgotten::Extents => (hull.from.max, hull.to.max) = (hull.from.min, hull.to.min),
                _ => {}
            }
        }
        if part == Forgotten::Materials {
            self.materials = 0;
        }
    }
}
