//! Crossings of shadow rays with the surfaces of transparent shapes, of single rays and of packets.

use fearless_simd::prelude::*;

use super::hit::{HitPacket, ShapeHit, SurfacePacket};
use super::intersector::{Intersector, ShapeQuery, exit};
use super::refine::{RefineInput, refine_one};
use crate::trace::math::{F64s, Numbers, Vectors, bits, dot, half_lanes, half_of, mask, splat};
use crate::trace::rays::{RayPacket, RayView, Rays, ShadowLimit, ShapeId, ShapeIds};
use crate::trace::scene::{Geometry, PreparedScene};
use crate::trace::shapes::RefinedHit;

/// A transparent shape on the path of a shadow ray.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Crossed {
    /// The number of crossings with its surface. Their positions are not computed.
    Times(ShapeId, u32),
    /// The first hit, which lies before the light.
    At(ShapeHit),
}

/// A crossing of a shadow ray with a transparent shape's surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub(crate) t: f64,
    pub(crate) id: ShapeId,
    pub(crate) entering: bool,
}

/// The detail of a query for crossings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CrossingDetail {
    /// The number of crossings if the fast count is certain, otherwise the first hit.
    Count,
    /// The first hit.
    FirstHit,
}

impl Crossed {
    /// Queries a transparent shape. `None` if the ray does not hit it before the limit.
    #[inline]
    pub(crate) fn new(
        geometry: &Geometry,
        id: ShapeId,
        (ray, limit): (&RayView<'_>, &ShadowLimit),
        detail: CrossingDetail,
        intersector: &mut Intersector<'_>,
    ) -> Option<Self> {
        let certain = if detail == CrossingDetail::Count {
            intersector.certain_crossings(geometry, id, ray, limit)
        } else {
            None
        };
        match certain {
            Some(0) => None,
            Some(times) => Some(Self::Times(id, times)),
            None => {
                let hit = intersector.intersect(geometry, id, ray)?;
                intersector.is_before(geometry, &hit, ray, limit).then_some(Self::At(hit))
            }
        }
    }

    /// Returns the same result for another shape that equals this one.
    pub(crate) fn by(self, id: ShapeId) -> Self {
        match self {
            Self::Times(_, times) => Self::Times(id, times),
            Self::At(hit) => Self::At(ShapeHit { id, ..hit }),
        }
    }

    pub(crate) fn id(&self) -> ShapeId {
        match self {
            Self::Times(id, _) => *id,
            Self::At(hit) => hit.id,
        }
    }

    /// Appends the crossings of the ray with the shape's surface.
    pub(crate) fn cross(
        &self,
        scene: &PreparedScene,
        (ray, limit): (&RayView<'_>, &ShadowLimit),
        crossings: &mut Vec<Crossing>,
        intersector: &mut Intersector<'_>,
    ) {
        let hit = match self {
            Self::At(hit) => Some(*hit),
            // The ray refers to equal shapes by the first of them.
            Self::Times(id, _) => intersector
                .intersect(scene.geometry(), scene.first_equal(*id), ray)
                .map(|hit| ShapeHit { id: *id, ..hit }),
        };
        let Some(hit) = hit else { return };
        let RefinedHit { t, point, normal } = intersector.refine(scene.geometry(), ray, &hit);
        let (t, id) = (t.rounded(), hit.id);
        let entering = !hit.far && ray.direction().dot(normal) < 0.0;
        crossings.push(Crossing { t, id, entering });
        if entering && let Some(on) = scene.geometry().far_side(id, point, ray.direction()) {
            let t = t + on;
            if t < limit.t() {
                crossings.push(Crossing { t, id, entering: false });
            }
        }
    }
}

/// The crossings of shadow rays with the surface of a transparent shape before the light.
#[derive(Clone, Debug)]
pub(crate) struct CrossedPacket {
    pub(crate) id: ShapeId,
    /// Lanes of rays that cross the shape. `ts` are the first crossings.
    pub(crate) lanes: u32,
    ts: Numbers,
    /// Lanes of rays that enter the shape at the first crossing. The other rays leave it there.
    entering: u32,
    /// Lanes of rays that enter the shape and leave it again before the light, at `far_ts`.
    pub(crate) leaving: u32,
    far_ts: Numbers,
    /// Lanes of rays that pass through another solid inside the shape, from `gap_ts` to `gap_far_ts`.
    gapped: u32,
    gap_ts: Numbers,
    gap_far_ts: Numbers,
}

impl CrossedPacket {
    /// Creates the crossings of rays in some lanes that cross a shape once, at their origins.
    pub(crate) fn once(id: ShapeId, lanes: u32) -> Self {
        let ts = Numbers::splat(0.0);
        Self { id, lanes, ts, entering: 0, leaving: 0, far_ts: ts, gapped: 0, gap_ts: ts, gap_far_ts: ts }
    }

    /// Returns the lengths of the paths through the shape, from entry to exit, minus the gaps.
    #[inline(always)]
    pub(crate) fn lengths<S: Simd>(&self, simd: S, directions: &Vectors) -> Numbers {
        let mut lengths = Numbers::splat(0.0);
        for half in 0..2 {
            let direction = directions.load(simd, half);
            let per_t = dot(direction, direction).sqrt();
            let (near, far) = (self.ts.load(simd, half), self.far_ts.load(simd, half));
            let mut length = positive(simd, (far - near) * per_t);
            if half_of(self.gapped, half) != 0 {
                let before = (self.gap_ts.load(simd, half) - near) * per_t;
                let after = (far - self.gap_far_ts.load(simd, half)) * per_t;
                let both = positive(simd, before) + positive(simd, after);
                length = mask(simd, self.gapped, half).select(both, length);
            }
            lengths.store(half, length);
        }
        lengths
    }

    /// Returns the lanes whose rays leave one of the two shapes before they enter the other.
    #[inline(always)]
    pub(crate) fn apart<S: Simd>(&self, simd: S, other: &Self) -> u32 {
        let mut apart = 0;
        for half in 0..2 {
            let before = self.far_ts.load(simd, half).simd_lt(other.ts.load(simd, half));
            let after = other.far_ts.load(simd, half).simd_lt(self.ts.load(simd, half));
            apart |= bits(before | after, half);
        }
        apart
    }

    /// Records the paths through another shape as gaps, for the rays in some lanes that enter it after this shape and leave it before. A lane
    /// holds one gap at most. Returns the lanes in which a gap was added.
    #[inline(always)]
    pub(crate) fn leave_gaps<S: Simd>(&mut self, simd: S, inner: &Self, active: u32) -> u32 {
        let mut within = 0;
        for half in 0..2 {
            let enters = self.ts.load(simd, half).simd_lt(inner.ts.load(simd, half));
            let leaves = inner.far_ts.load(simd, half).simd_lt(self.far_ts.load(simd, half));
            within |= bits(enters & leaves, half);
        }
        let new = within & active & !self.gapped;
        if new != 0 {
            for half in 0..2 {
                let gaps = mask(simd, new, half);
                let gap = gaps.select(inner.ts.load(simd, half), self.gap_ts.load(simd, half));
                let far_gap = gaps.select(inner.far_ts.load(simd, half), self.gap_far_ts.load(simd, half));
                self.gap_ts.store(half, gap);
                self.gap_far_ts.store(half, far_gap);
            }
            self.gapped |= new;
        }
        new
    }

    /// Returns the first and the second crossing of the ray in a lane.
    #[inline]
    pub(crate) fn of(&self, lane: usize) -> [Option<Crossing>; 2] {
        let has = |lanes: u32| lanes & (1 << lane) != 0;
        let (id, entering) = (self.id, has(self.entering));
        let first = has(self.lanes).then(|| Crossing { t: self.ts.get(lane), id, entering });
        let then = has(self.leaving).then(|| Crossing { t: self.far_ts.get(lane), id, entering: false });
        [first, then]
    }
}

/// Returns the maximum of each number and 0.
#[inline(always)]
fn positive<S: Simd>(simd: S, numbers: F64s<S>) -> F64s<S> {
    let zero = splat(simd, 0.0);
    numbers.simd_gt(zero).select(numbers, zero)
}

/// The hits of one transparent shape, and their surface points. Reused between shapes.
#[derive(Clone, Debug)]
pub(super) struct CrossingScratch {
    pub(super) hits: HitPacket,
    surfaces: SurfacePacket,
}

impl CrossingScratch {
    pub(super) const EMPTY: Self = Self { hits: HitPacket::EMPTY, surfaces: SurfacePacket::EMPTY };
}

/// Computes the crossings of rays in some lanes with a shape that has no equals. The rays are known to hit it, near the `t` in the scratch.
/// Adds the crossings to `crossed`, and returns the undecided lanes.
#[inline(always)]
pub(super) fn cross<S: Simd>(
    simd: S,
    geometry: &Geometry,
    rays: (&RayPacket, &Numbers),
    shape: (ShapeQuery<'_>, u32),
    scratch: &mut CrossingScratch,
    crossed: &mut Vec<CrossedPacket>,
) -> u32 {
    simd.vectorize(
        #[inline(always)]
        || find(simd, geometry, rays, shape, scratch, crossed),
    )
}

#[inline(always)]
fn find<S: Simd>(
    simd: S,
    geometry: &Geometry,
    (rays, limits): (&RayPacket, &Numbers),
    (ShapeQuery { id, shape }, hit): (ShapeQuery<'_>, u32),
    CrossingScratch { hits, surfaces }: &mut CrossingScratch,
    crossed: &mut Vec<CrossedPacket>,
) -> u32 {
    hits.ids = ShapeIds::splat(id);
    surfaces.clear();
    let mut undecided = refine_one(simd, RefineInput { geometry, rays, hits }, id, hit, surfaces);
    let (mut entering, mut leaving) = (0, 0);
    let mut far_ts = Numbers::splat(0.0);
    for half in 0..2 {
        let active = hit & !undecided & half_lanes(half);
        if active == 0 {
            continue;
        }
        let direction = rays.directions.load(simd, half);
        let inwards = dot(direction, surfaces.normals.load(simd, half)).simd_lt(splat(simd, 0.0));
        let enters = active & bits(inwards, half) & !hits.far;
        entering |= enters;
        if enters == 0 {
            continue;
        }
        // The exit is measured from the refined entry point.
        let from_there = Rays { origin: surfaces.points.load(simd, half), direction };
        let Some(out) = exit(simd, &from_there, shape) else { continue };
        let t = surfaces.ts.load(simd, half) + out.root.t();
        let before = t.simd_lt(limits.load(simd, half)) & out.hit;
        far_ts.store(half, t);
        undecided |= enters & bits(!out.hit, half);
        leaving |= enters & bits(before, half);
    }
    let lanes = hit & !undecided;
    if lanes != 0 {
        let (entering, leaving) = (entering & lanes, leaving & lanes);
        crossed.push(CrossedPacket {
            ts: surfaces.ts,
            entering,
            leaving,
            far_ts,
            ..CrossedPacket::once(id, lanes)
        });
    }
    undecided
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::trace::intersect::{CastRay, SurfacePoint};
    use crate::trace::math::scaled;
    use crate::trace::rays::PreparedRay;
    use crate::trace::scene::{PreparedShape, SurfaceMaterial};
    use crate::trace::shapes::Sphere;

    /// Generates coordinates that often coincide, so that rays graze surfaces, start on them and end on them.
    fn coordinate() -> impl Strategy<Value = f64> {
        let nudge = prop_oneof![Just(0.0), -1e-15..1e-15, -1e-9..1e-9, -1e-4..1e-4];
        prop_oneof![3 => (-4..=4).prop_map(f64::from), 2 => -4.0..4.0, 1 => (-4..=4, nudge).prop_map(|(whole, off)| f64::from(whole) + off)]
    }

    fn point() -> impl Strategy<Value = DVec3> {
        (coordinate(), coordinate(), coordinate()).prop_map(DVec3::from)
    }

    fn ball(center: DVec3, radius: f64) -> PreparedScene {
        let mut geometry = Geometry::default();
        let _ = geometry.push(PreparedShape::Sphere(Sphere { center, radius }));
        PreparedScene::new(geometry, vec![SurfaceMaterial::default()])
    }

    /// Returns a ray that leaves a surface towards a light, and the limit at the light.
    fn leave_to(surface: &SurfacePoint, outward: bool, light: DVec3) -> Option<(PreparedRay, ShadowLimit)> {
        let (_, scale) = scaled(light - surface.point)?;
        Some((surface.leave(outward, light - surface.point)?, ShadowLimit::new(scale.recip(), light)))
    }

    /// Returns the number of times that the ray crosses the ball: the fast count, if certain, and the exact one.
    fn crossings(scene: &PreparedScene, ray: &PreparedRay, limit: &ShadowLimit) -> (Option<u32>, usize) {
        let (geometry, id, intersector) = (scene.geometry(), ShapeId(0), &mut Intersector::default());
        let ray = &RayView::alone(ray);
        let mut crossings = Vec::new();
        if let Some(crossed) = Crossed::new(geometry, id, (ray, limit), CrossingDetail::FirstHit, intersector)
        {
            crossed.cross(scene, (ray, limit), &mut crossings, intersector);
        }
        (intersector.certain_crossings(geometry, id, ray, limit), crossings.len())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn certain_counts_are_exact(center in point(), radius in 0..3_usize, from in point(), light in point()) {
            let radius = [1.0, 2.0, 0.3][radius];
            let scene = ball(center, radius);
            // Besides the ray itself, two rays that start at its hit on the ball, one to either side.
            let mut rays: Vec<(PreparedRay, ShadowLimit)> = Vec::new();
            if let Some(ray) = PreparedRay::new(from, light - from) {
                let length = (light - from).abs().max_element() / ray.direction().abs().max_element();
                if let Some(surface) = CastRay::new(from, light - from).and_then(|ray| scene.cast(&ray)) {
                    rays.extend([true, false].into_iter().filter_map(|outward| leave_to(&surface, outward, light)));
                }
                rays.extend([(ray, ShadowLimit::new(length, light)), (ray, ShadowLimit::NONE)]);
            }
            for (ray, limit) in rays {
                let (certain, counted) = crossings(&scene, &ray, &limit);
                prop_assert!(certain.is_none_or(|certain| certain as usize == counted), "{certain:?}, {counted}: {ray:?} {limit:?}");
            }
        }
    }

    /// Checks that the fast count is certain in clear cases. Without this, the test above could pass with no certain counts at all.
    #[test]
    fn counts_are_certain_in_clear_cases() {
        let scene = ball(DVec3::ZERO, 1.0);
        let limit = |t: f64| ShadowLimit::new(t, DVec3::new(-5.0 + t, 0.3, 0.2));
        let ray = PreparedRay::new(DVec3::new(-5.0, 0.3, 0.2), DVec3::X).unwrap();
        for (t, count) in [(2.0, 0), (5.0, 1), (7.0, 2), (f64::INFINITY, 2)] {
            assert_eq!(crossings(&scene, &ray, &limit(t)), (Some(count), count as usize));
        }
        let inside = PreparedRay::new(DVec3::new(0.1, 0.3, 0.2), DVec3::X).unwrap();
        assert_eq!(crossings(&scene, &inside, &ShadowLimit::NONE), (Some(1), 1));
        let missing = PreparedRay::new(DVec3::new(-5.0, 1.3, 0.2), DVec3::X).unwrap();
        assert_eq!(crossings(&scene, &missing, &ShadowLimit::NONE), (Some(0), 0));
    }
}
