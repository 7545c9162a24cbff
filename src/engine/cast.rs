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
    /// The ray's parameter, for the direction as it was given: the point is origin + t direction.
    pub t: f64,
    /// From the ray's origin, in scene units.
    pub distance: f64,
    /// On the surface.
    pub point: DVec3,
    /// The unit normal, on the side that the ray came from.
    pub normal: DVec3,
    surface: trace::Surface,
}

impl Hit {
    /// `scale` is how many times shorter the direction was before the kernel took it over.
    pub(super) fn new(entity: Entity, ray: &trace::Ray, scale: f64, surface: trace::Surface) -> Self {
        Self {
            entity,
            // However short the direction was, no way is none. Adding zero makes negative zeros positive.
            t: if surface.t.rounded() == 0.0 { 0.0 } else { surface.t.rounded() * scale },
            distance: surface.distance(ray) + 0.0,
            point: surface.point,
            normal: surface.facing_normal() + DVec3::ZERO,
            surface,
        }
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
    /// The kernel's ray, and how many times longer its direction is than the one that was given, a power of two. `None` if a
    /// number is not finite or the direction is zero.
    fn into_ray(self) -> Option<(trace::Ray, f64)>;
}

impl IntoRay for Ray {
    fn into_ray(self) -> Option<(trace::Ray, f64)> {
        let ray = trace::Ray::new(self.origin, self.direction)?;
        let scale = ray.direction().abs().max_element() / self.direction.abs().max_element();
        Some((ray, scale))
    }
}

impl IntoRay for trace::Ray {
    fn into_ray(self) -> Option<(trace::Ray, f64)> {
        Some((self, 1.0))
    }
}

impl IntoRay for Option<trace::Ray> {
    fn into_ray(self) -> Option<(trace::Ray, f64)> {
        self?.into_ray()
    }
}
