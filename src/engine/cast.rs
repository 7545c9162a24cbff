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
    /// The ray's parameter, for the direction as it was given: the point is origin + t direction. `None` where no `f64` can hold
    /// it, because the direction is so short that the way takes more than 1.8e308 of it; [`Hit::distance`] is right then too.
    pub t: Option<f64>,
    /// From the ray's origin, in scene units.
    pub distance: f64,
    /// On the surface.
    pub point: DVec3,
    /// The unit normal, on the side that the ray came from.
    pub normal: DVec3,
    surface: trace::SurfacePoint,
}

impl Hit {
    /// `exponent` says by which power of two the direction was scaled before the kernel took it over.
    pub(super) fn new(entity: Entity, ray: &trace::Ray, exponent: i32, surface: trace::SurfacePoint) -> Self {
        // However short the direction was, no way is none. Adding zero makes negative zeros positive.
        let t = if surface.t.rounded() == 0.0 { 0.0 } else { libm::ldexp(surface.t.rounded(), exponent) };
        Self {
            entity,
            t: t.is_finite().then_some(t),
            distance: surface.distance(ray) + 0.0,
            point: surface.point,
            normal: surface.facing_normal() + DVec3::ZERO,
            surface,
        }
    }

    /// A ray that leaves this surface. It knows which surfaces it starts on and never meets them by rounding; there is no
    /// offset to choose. `None` if the direction is zero or not finite.
    #[must_use]
    pub fn leave_towards(&self, direction: DVec3) -> Option<SecondaryRay> {
        let ray = self.surface.leave_towards(direction)?;
        let exponent = exponent(&ray, direction);
        Some(SecondaryRay { ray, exponent })
    }
}

/// A ray that leaves a surface which another ray has found.
#[derive(Clone, Debug)]
pub struct SecondaryRay {
    ray: trace::Ray,
    exponent: i32,
}

/// By which power of two the kernel's direction is longer than the one that was given.
fn exponent(ray: &trace::Ray, direction: DVec3) -> i32 {
    let exponent = |vector: DVec3| libm::ilogb(vector.abs().max_element());
    exponent(ray.direction()) - exponent(direction)
}

/// A ray that [`Engine::cast`](super::Engine::cast) can follow.
pub trait IntoRay {
    /// The kernel's ray, and by which power of two its direction is longer than the one that was given. `None` if a number is not
    /// finite or the direction is zero.
    fn into_ray(self) -> Option<(trace::Ray, i32)>;
}

impl IntoRay for Ray {
    fn into_ray(self) -> Option<(trace::Ray, i32)> {
        let ray = trace::Ray::new(self.origin, self.direction)?;
        let exponent = exponent(&ray, self.direction);
        Some((ray, exponent))
    }
}

impl IntoRay for SecondaryRay {
    fn into_ray(self) -> Option<(trace::Ray, i32)> {
        Some((self.ray, self.exponent))
    }
}

impl IntoRay for Option<SecondaryRay> {
    fn into_ray(self) -> Option<(trace::Ray, i32)> {
        self?.into_ray()
    }
}
