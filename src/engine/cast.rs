//! Single rays through the renderer's own path.

use glam::DVec3;
use hecs::Entity;

use crate::trace;

/// A ray that starts anywhere: `origin + t direction`, t >= 0. The direction may have any length but zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Which way it goes.
    pub direction: DVec3,
}

/// What a ray meets first.
#[derive(Clone, Debug)]
pub struct Hit {
    /// Whose shape.
    pub entity: Entity,
    /// From the ray's origin, in scene units.
    pub distance: f64,
    /// On the surface.
    pub point: DVec3,
    /// The unit normal, on the side that the ray came from.
    pub normal: DVec3,
    surface: trace::Surface,
}

impl Hit {
    pub(super) fn new(entity: Entity, distance: f64, surface: trace::Surface) -> Self {
        let normal = surface.facing_normal();
        Self { entity, distance, point: surface.point, normal, surface }
    }

    /// A ray that leaves this surface. It knows which surfaces it starts on and never meets them by rounding; there is no
    /// offset to choose. `None` if the direction is zero or not finite.
    #[must_use]
    pub fn leave_towards(&self, direction: DVec3) -> Option<trace::Ray> {
        self.surface.leave_towards(direction)
    }
}

/// A ray that [`Engine::cast`](super::Engine::cast) can follow.
pub trait IntoRay {
    /// The kernel's ray; `None` if a number is not finite or the direction is zero.
    fn into_ray(self) -> Option<trace::Ray>;
}

impl IntoRay for Ray {
    fn into_ray(self) -> Option<trace::Ray> {
        trace::Ray::new(self.origin, self.direction)
    }
}

impl IntoRay for trace::Ray {
    fn into_ray(self) -> Option<trace::Ray> {
        Some(self)
    }
}

impl IntoRay for Option<trace::Ray> {
    fn into_ray(self) -> Option<trace::Ray> {
        self
    }
}
