//! Where shadow rays cross the surfaces of clear shapes.

use super::escalations::Escalations;
use super::hit::Hit;
use super::intersector::Intersector;
use crate::trace::rays::{Limit, RayView, ShapeId};
use crate::trace::scene::PreparedScene;
use crate::trace::shapes::RefinedHit;

/// A clear shape in the way of a shadow ray.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Crossed {
    /// Its surface is crossed so many times, and nobody has asked where.
    Times(ShapeId, u32),
    /// First met here, before the light.
    At(Hit),
}

/// Where a shadow ray crosses a clear shape's surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub(crate) t: f64,
    pub(crate) id: ShapeId,
    pub(crate) entering: bool,
}

/// How closely a clear shape is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Look {
    /// No more than how often it is crossed, where that is certain at a glance.
    Glance,
    /// Where it is crossed.
    Whole,
}

impl Crossed {
    /// A clear shape, if it is in the way.
    #[inline]
    pub(crate) fn new(
        shapes: &impl Intersector,
        id: ShapeId,
        (ray, limit): (&RayView<'_>, &Limit),
        look: Look,
        escalations: &mut Escalations,
    ) -> Option<Self> {
        let certain = if look == Look::Glance { shapes.certain_crossings(id, ray, limit) } else { None };
        match certain {
            Some(0) => None,
            Some(times) => Some(Self::Times(id, times)),
            None => {
                let hit = shapes.intersect(id, ray, escalations)?;
                shapes.is_before(&hit, ray, limit, escalations).then_some(Self::At(hit))
            }
        }
    }

    /// The same of another shape that equals it.
    pub(crate) fn by(self, id: ShapeId) -> Self {
        match self {
            Self::Times(_, times) => Self::Times(id, times),
            Self::At(hit) => Self::At(Hit { id, ..hit }),
        }
    }

    pub(crate) fn id(&self) -> ShapeId {
        match self {
            Self::Times(id, _) => *id,
            Self::At(hit) => hit.id,
        }
    }

    /// Adds where the ray crosses its surface.
    pub(crate) fn cross(
        &self,
        scene: &PreparedScene,
        shapes: &impl Intersector,
        (ray, limit): (&RayView<'_>, &Limit),
        crossings: &mut Vec<Crossing>,
        escalations: &mut Escalations,
    ) {
        let hit = match self {
            Self::At(hit) => Some(*hit),
            // Asked of the one that the ray knows.
            Self::Times(id, _) => {
                shapes.intersect(scene.first_equal(*id), ray, escalations).map(|hit| Hit { id: *id, ..hit })
            }
        };
        let Some(hit) = hit else { return };
        let RefinedHit { t, point, normal } = shapes.refine(ray, &hit, escalations);
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
    use crate::trace::rays::Ray;
    use crate::trace::scene::{Geometry, PreparedShape, SurfaceMaterial};
    use crate::trace::shapes::Sphere;

    /// Often where others are, so that rays graze, start on surfaces and end on them.
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

    /// A ray that leaves a surface towards a light, and where that is on it.
    fn leave_to(surface: &SurfacePoint, outward: bool, light: DVec3) -> Option<(Ray, Limit)> {
        let (_, scale) = scaled(light - surface.point)?;
        Some((surface.leave(outward, light - surface.point)?, Limit::new(scale.recip(), light)))
    }

    /// How often the ray crosses the ball, if it is certain at a glance; and in fact.
    fn crossings(scene: &PreparedScene, ray: &Ray, limit: &Limit) -> (Option<u32>, usize) {
        let (shapes, id, escalations) = (scene.geometry(), ShapeId(0), &mut Escalations::default());
        let ray = &RayView::alone(ray);
        let mut crossings = Vec::new();
        if let Some(met) = Crossed::new(shapes, id, (ray, limit), Look::Whole, escalations) {
            met.cross(scene, shapes, (ray, limit), &mut crossings, escalations);
        }
        (shapes.certain_crossings(id, ray, limit), crossings.len())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn what_a_glance_says_is_so(center in point(), radius in 0..3_usize, from in point(), light in point()) {
            let radius = [1.0, 2.0, 0.3][radius];
            let scene = ball(center, radius);
            // Along with the ray itself, one that starts on the ball where it meets it, to either side.
            let mut rays: Vec<(Ray, Limit)> = Vec::new();
            if let Some(ray) = Ray::new(from, light - from) {
                let length = (light - from).abs().max_element() / ray.direction().abs().max_element();
                if let Some(surface) = CastRay::new(from, light - from).and_then(|ray| scene.cast(&ray)) {
                    rays.extend([true, false].into_iter().filter_map(|outward| leave_to(&surface, outward, light)));
                }
                rays.extend([(ray, Limit::new(length, light)), (ray, Limit::NONE)]);
            }
            for (ray, limit) in rays {
                let (certain, counted) = crossings(&scene, &ray, &limit);
                prop_assert!(certain.is_none_or(|certain| certain as usize == counted), "{certain:?}, {counted}: {ray:?} {limit:?}");
            }
        }
    }

    /// Where it is not close, a glance is enough: a test of the test above, which could not fail otherwise.
    #[test]
    fn a_glance_is_mostly_enough() {
        let scene = ball(DVec3::ZERO, 1.0);
        let limit = |t: f64| Limit::new(t, DVec3::new(-5.0 + t, 0.3, 0.2));
        let ray = Ray::new(DVec3::new(-5.0, 0.3, 0.2), DVec3::X).unwrap();
        for (t, count) in [(2.0, 0), (5.0, 1), (7.0, 2), (f64::INFINITY, 2)] {
            assert_eq!(crossings(&scene, &ray, &limit(t)), (Some(count), count as usize));
        }
        let inside = Ray::new(DVec3::new(0.1, 0.3, 0.2), DVec3::X).unwrap();
        assert_eq!(crossings(&scene, &inside, &Limit::NONE), (Some(1), 1));
        let beside = Ray::new(DVec3::new(-5.0, 1.3, 0.2), DVec3::X).unwrap();
        assert_eq!(crossings(&scene, &beside, &Limit::NONE), (Some(0), 0));
    }
}
