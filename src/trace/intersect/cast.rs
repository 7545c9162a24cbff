//! Queries with single rays that own their lists of coincident shapes, through the renderer's own code path.

use std::ops::Deref;

use glam::DVec3;
use rayon::prelude::*;

use super::hit::SurfacePoint;
use super::naive::Naive;
use super::scratch::Scratch;
use crate::trace::rays::{PreparedRay, ShapeId, TieLists};
use crate::trace::scene::PreparedScene;

/// A ray that owns the list of the surfaces it leaves.
#[derive(Clone, Debug)]
pub struct CastRay {
    ray: PreparedRay,
    ties: TieLists,
}

/// The surface point found by a [`CastRay`].
#[derive(Clone, Debug)]
pub struct CastHit {
    surface: SurfacePoint,
    ties: TieLists,
}

impl CastRay {
    /// Creates a ray with any origin. `None` if a number is not finite or the direction is zero.
    #[must_use]
    pub fn new(origin: DVec3, direction: DVec3) -> Option<Self> {
        Some(Self { ray: PreparedRay::new(origin, direction)?, ties: TieLists::default() })
    }
}

impl CastHit {
    /// Returns a ray that leaves this surface. Rounding never makes it hit the surface on which it starts. `None` if the direction is zero or
    /// not finite.
    #[must_use]
    pub fn leave_towards(&self, direction: DVec3) -> Option<CastRay> {
        let ray = self.surface.leave(direction.dot(self.normal) >= 0.0, direction)?;
        Some(CastRay { ray, ties: self.ties.clone() })
    }
}

impl Deref for CastRay {
    type Target = PreparedRay;

    fn deref(&self) -> &PreparedRay {
        &self.ray
    }
}

impl Deref for CastHit {
    type Target = SurfacePoint;

    fn deref(&self) -> &SurfacePoint {
        &self.surface
    }
}

impl PreparedScene {
    /// Returns the closest hit of the ray, by the renderer's own code path.
    #[must_use]
    pub fn cast(&self, ray: &CastRay) -> Option<CastHit> {
        self.cast_at(ray, &mut Scratch::uncancelled(Naive::of(self).as_ref()))
    }

    /// Casts many rays, on the current rayon pool's threads.
    #[must_use]
    pub fn cast_all(&self, rays: &[Option<CastRay>]) -> Vec<Option<CastHit>> {
        let naive = Naive::of(self);
        let cast = |scratch: &mut Scratch<'_>, ray: &Option<CastRay>| self.cast_at(ray.as_ref()?, scratch);
        rays.par_iter().map_init(|| Scratch::uncancelled(naive.as_ref()), cast).collect()
    }

    fn cast_at(&self, CastRay { ray, ties }: &CastRay, scratch: &mut Scratch<'_>) -> Option<CastHit> {
        scratch.tied_hits.clear();
        scratch.ties.clone_from(ties);
        let closest = self.closest(ray, scratch)?;
        let mut surface = self.surface(ray, &closest, scratch);
        // Rays that leave the hit do not need the list of the surfaces that this ray left.
        scratch.ties.keep(std::iter::once(&mut surface.ties));
        Some(CastHit { surface, ties: scratch.ties.clone() })
    }

    /// Returns the shapes that coincide with the visible one at a surface point, in document order.
    #[must_use]
    pub(crate) fn tied(&self, surface: &SurfacePoint, ties: &TieLists) -> Vec<ShapeId> {
        let first_equals = ties.of(surface.ties).iter().map(|tie| tie.id).chain([surface.first_equal]);
        let mut tied: Vec<ShapeId> = Vec::new();
        for id in first_equals {
            match self.equal_shapes.group(id) {
                Some(group) => tied.extend(group.ids()),
                None => tied.push(id),
            }
        }
        tied.retain(|id| *id != surface.hit.id);
        tied.sort_unstable_by_key(|id| self.order().rank(*id));
        tied
    }
}
