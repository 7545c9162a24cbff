//! The closest hit of a ray, and the surface there.

use std::cmp::Ordering;
use std::sync::atomic::Ordering::Relaxed;

use rayon::prelude::*;

use super::escalations::Escalations;
use super::hit::{ClosestHit, Hit, SurfacePoint};
use super::intersector::Intersector;
use super::scratch::Scratch;
use crate::trace::rays::{Limit, Ray, ShapeId, Tie, Ties};
use crate::trace::scene::PreparedScene;
use crate::trace::shapes::RefinedHit;

/// Evaluates an expression with `$shapes` bound to a scene's shapes, to be asked as its precision says.
macro_rules! with_intersector {
    ($scene:expr, $shapes:ident => $work:expr) => {
        match $scene.precision {
            $crate::trace::Precision::Guaranteed => {
                let $shapes = $scene.geometry();
                $work
            }
            $crate::trace::Precision::TextbookF64 => {
                let $shapes = &$crate::trace::query::Textbook::<f64>::new($scene.geometry());
                $work
            }
            $crate::trace::Precision::TextbookF32 => {
                let $shapes = &$crate::trace::query::Textbook::<f32>::new($scene.geometry());
                $work
            }
        }
    };
}

impl ClosestHit {
    /// Takes another shape into account, and says from which `t` on nothing is of interest any more.
    #[inline(always)]
    pub(crate) fn meet(
        best: &mut Option<Self>,
        id: ShapeId,
        shapes: &impl Intersector,
        ray: &Ray,
        escalations: &mut Escalations,
    ) -> f64 {
        if let Some(hit) = shapes.intersect(id, ray, escalations) {
            Self::consider(best, hit, shapes, ray, escalations);
        }
        best.as_ref().map_or(f64::INFINITY, |best| best.hit.root.latest())
    }

    /// Takes another hit of the ray into account.
    #[inline(always)]
    pub(crate) fn consider(
        best: &mut Option<Self>,
        hit: Hit,
        shapes: &impl Intersector,
        ray: &Ray,
        escalations: &mut Escalations,
    ) {
        let Some(closest) = best else {
            *best = Some(Self { hit, ties: Vec::new() });
            return;
        };
        match shapes.compare(ray, &hit, &closest.hit, escalations) {
            Ordering::Less => {
                closest.hit = hit;
                closest.ties.clear();
            }
            Ordering::Equal => {
                let (first, second) =
                    if hit.id < closest.hit.id { (hit, closest.hit) } else { (closest.hit, hit) };
                closest.hit = first;
                closest.ties.push(second);
            }
            Ordering::Greater => {}
        }
    }
}

impl PreparedScene {
    /// The shapes that a surface is on, besides the one that is seen, in document order.
    #[must_use]
    pub fn tied(&self, surface: &SurfacePoint) -> Vec<ShapeId> {
        let asked = surface.ties.ids().chain([surface.asked]);
        let mut tied: Vec<ShapeId> = Vec::new();
        for id in asked {
            match self.equal_shapes.group(id) {
                Some(group) => tied.extend(group.ids()),
                None => tied.push(id),
            }
        }
        tied.retain(|id| *id != surface.hit.id);
        tied.sort_unstable();
        tied
    }

    /// The nearest surface that the ray meets; of several at the same place the first in document order.
    #[must_use]
    pub(crate) fn closest(
        &self,
        shapes: &impl Intersector,
        ray: &Ray,
        scratch: &mut Scratch<'_>,
    ) -> Option<ClosestHit> {
        let Scratch { stack, escalations, cancelled, .. } = scratch;
        let mut best: Option<ClosestHit> = None;
        let mut limit = f64::INFINITY;
        for id in &self.beside {
            if cancelled.load(Relaxed) {
                return None;
            }
            limit = ClosestHit::meet(&mut best, *id, shapes, ray, escalations);
        }
        self.tree.visit_nearest(ray, limit, stack, cancelled, |id| {
            ClosestHit::meet(&mut best, id, shapes, ray, escalations)
        });
        best
    }

    /// The point that the ray found, with its normal. Of several surfaces at the same place it is the first in document order,
    /// save that a clear one that the ray leaves gives way to the first opaque one: what a glass stands on is seen through it.
    #[must_use]
    #[inline]
    pub(crate) fn surface(
        &self,
        shapes: &impl Intersector,
        ray: &Ray,
        closest: &ClosestHit,
        escalations: &mut Escalations,
    ) -> SurfacePoint {
        if closest.ties.is_empty() && self.equal_shapes.group(closest.hit.id).is_none() {
            return surface_at(shapes, ray, closest.hit, closest.hit.id, Ties::default(), escalations);
        }
        self.tied_surface(shapes, ray, closest, escalations)
    }

    #[cold]
    fn tied_surface(
        &self,
        shapes: &impl Intersector,
        ray: &Ray,
        closest: &ClosestHit,
        escalations: &mut Escalations,
    ) -> SurfacePoint {
        let mut met: Vec<Hit> = closest
            .ties
            .iter()
            .chain([&closest.hit])
            .map(|hit| Hit { id: self.first_equal(hit.id), ..*hit })
            .collect();
        met.sort_unstable_by_key(|hit| hit.id);
        met.dedup_by_key(|hit| hit.id);
        let seen_as = |hit: Hit, escalations: &mut Escalations| {
            let asked = self.first_equal(hit.id);
            let others = met.iter().filter(|other| other.id != asked).map(|tied| {
                let normal = shapes.refine(ray, tied, escalations).normal;
                Tie { id: tied.id, normal }
            });
            let ties = Ties::new(others.collect());
            surface_at(shapes, ray, hit, asked, ties, escalations)
        };
        let seen = seen_as(closest.hit, escalations);
        if seen.from_outside || self.material(closest.hit.id).refraction.is_none() {
            return seen;
        }
        let opaque = met.iter().filter_map(|hit| Some(Hit { id: self.first_opaque(hit.id)?, ..*hit }));
        opaque.min_by_key(|hit| hit.id).map_or(seen, |opaque| seen_as(opaque, escalations))
    }

    /// The first opaque one, in document order, of a shape and all that equal it.
    fn first_opaque(&self, asked: ShapeId) -> Option<ShapeId> {
        match self.equal_shapes.group(asked) {
            Some(group) => group.opaque(None),
            None => self.material(asked).refraction.is_none().then_some(asked),
        }
    }

    /// The nearest surface that the ray meets, by the renderer's own path.
    #[must_use]
    pub fn cast(&self, ray: &Ray) -> Option<SurfacePoint> {
        with_intersector!(self, shapes => self.cast_at(shapes, ray, &mut Scratch::default()))
    }

    /// The same for many rays, on the current rayon pool's threads.
    #[must_use]
    pub fn cast_all(&self, rays: &[Option<Ray>]) -> Vec<Option<SurfacePoint>> {
        with_intersector!(self, shapes => {
            let cast = |scratch: &mut Scratch<'_>, ray: &Option<Ray>| {
                self.cast_at(shapes, ray.as_ref()?, scratch)
            };
            rays.par_iter().map_init(Scratch::default, cast).collect()
        })
    }

    /// For asking after many rays, one by one.
    #[must_use]
    pub fn search(&self) -> Search<'_> {
        Search { scene: self, scratch: Scratch::default() }
    }

    fn cast_at(
        &self,
        shapes: &impl Intersector,
        ray: &Ray,
        scratch: &mut Scratch<'_>,
    ) -> Option<SurfacePoint> {
        let closest = self.closest(shapes, ray, scratch)?;
        Some(self.surface(shapes, ray, &closest, &mut scratch.escalations))
    }
}

/// The renderer's own questions, with what they need kept from ray to ray: nothing is allocated for each. Always asked with
/// [`Precision::Guaranteed`](crate::trace::Precision::Guaranteed).
#[derive(Debug)]
pub struct Search<'a> {
    scene: &'a PreparedScene,
    scratch: Scratch<'static>,
}

impl Search<'_> {
    /// What the ray meets first.
    #[must_use]
    #[inline]
    pub fn closest(&mut self, ray: &Ray) -> Option<ClosestHit> {
        self.scene.closest(&self.scene.geometry, ray, &mut self.scratch)
    }

    /// The point that the ray found, with its normal.
    #[must_use]
    #[inline]
    pub fn surface(&mut self, ray: &Ray, closest: &ClosestHit) -> SurfacePoint {
        self.scene.surface(&self.scene.geometry, ray, closest, &mut self.scratch.escalations)
    }

    /// Returns whether anything but `except` stands between the ray's origin and `limit`.
    #[must_use]
    #[inline]
    pub fn is_hidden(&mut self, ray: &Ray, limit: &Limit, except: Option<ShapeId>) -> bool {
        self.scene.occluder(&self.scene.geometry, ray, limit, except, &mut self.scratch).is_some()
    }
}

#[inline(always)]
fn surface_at(
    shapes: &impl Intersector,
    ray: &Ray,
    hit: Hit,
    asked: ShapeId,
    ties: Ties,
    escalations: &mut Escalations,
) -> SurfacePoint {
    let RefinedHit { t, point, normal } = shapes.refine(ray, &hit, escalations);
    // A far side is met from inside, however the last bits of a grazing ray fall.
    let from_outside = !hit.far && ray.direction().dot(normal) <= 0.0;
    SurfacePoint { hit, asked, ties, t, point, normal, from_outside }
}
