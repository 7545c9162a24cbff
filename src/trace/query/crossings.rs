//! Crossings of shadow rays with the surfaces of transparent shapes.

use super::hit::ShapeHit;
use super::intersector::Intersector;
use crate::trace::rays::{RayView, ShadowLimit, ShapeId};
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
pub(crate) enum Look {
    /// The number of crossings if the fast count is certain, otherwise the first hit.
    Glance,
    /// The first hit.
    Whole,
}

impl Crossed {
    /// Queries a transparent shape. `None` if the ray does not hit it before the limit.
    #[inline]
    pub(crate) fn new(
        geometry: &Geometry,
        id: ShapeId,
        (ray, limit): (&RayView<'_>, &ShadowLimit),
        look: Look,
        intersector: &mut Intersector<'_>,
    ) -> Option<Self> {
        let certain =
            if look == Look::Glance { intersector.certain_crossings(geometry, id, ray, limit) } else { None };
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

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::trace::math::scaled;
    use crate::trace::query::{CastRay, SurfacePoint};
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
        if let Some(met) = Crossed::new(geometry, id, (ray, limit), Look::Whole, intersector) {
            met.cross(scene, (ray, limit), &mut crossings, intersector);
        }
        (intersector.certain_crossings(geometry, id, ray, limit), crossings.len())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn what_a_glance_says_is_so(center in point(), radius in 0..3_usize, from in point(), light in point()) {
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
    fn a_glance_is_mostly_enough() {
        let scene = ball(DVec3::ZERO, 1.0);
        let limit = |t: f64| ShadowLimit::new(t, DVec3::new(-5.0 + t, 0.3, 0.2));
        let ray = PreparedRay::new(DVec3::new(-5.0, 0.3, 0.2), DVec3::X).unwrap();
        for (t, count) in [(2.0, 0), (5.0, 1), (7.0, 2), (f64::INFINITY, 2)] {
            assert_eq!(crossings(&scene, &ray, &limit(t)), (Some(count), count as usize));
        }
        let inside = PreparedRay::new(DVec3::new(0.1, 0.3, 0.2), DVec3::X).unwrap();
        assert_eq!(crossings(&scene, &inside, &ShadowLimit::NONE), (Some(1), 1));
        let unbounded = PreparedRay::new(DVec3::new(-5.0, 1.3, 0.2), DVec3::X).unwrap();
        assert_eq!(crossings(&scene, &unbounded, &ShadowLimit::NONE), (Some(0), 0));
    }
}
