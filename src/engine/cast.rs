//! Casting of single rays with the renderer's intersection code.

use glam::DVec3;
use hecs::Entity;

use crate::components::CloudMember;
use crate::systems::Preparation;
use crate::trace;

/// A ray from any point: `origin + t direction`, t >= 0. The direction may have any nonzero length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The start point.
    pub origin: DVec3,
    /// The direction.
    pub direction: DVec3,
}

/// The closest hit of a ray.
#[derive(Clone, Debug)]
pub struct Hit {
    /// The entity whose shape is hit.
    pub entity: Entity,
    /// The particle or the bond that is hit, if the entity is a [`Cloud`](crate::components::Cloud).
    pub member: Option<CloudMember>,
    /// The ray parameter for the direction as given: the point is origin + t direction. `None` if no `f64` can represent it, because the
    /// direction is so short that the distance is more than 1.8e308 times its length; [`Hit::distance`] is correct in that case too.
    pub t: Option<f64>,
    /// The distance from the ray's origin, in scene units.
    pub distance: f64,
    /// The point on the surface.
    pub point: DVec3,
    /// The unit normal on the side that the ray came from.
    pub normal: DVec3,
    surface: trace::CastHit,
}

impl Hit {
    /// Creates a hit from the kernel's ray and hit. `exponent` is the power of two by which the direction was scaled for the kernel.
    pub(super) fn new(
        prepared: &Preparation,
        ray: &trace::CastRay,
        exponent: i32,
        surface: trace::CastHit,
    ) -> Self {
        // A hit at the origin has t = 0 for any scaling. Adding zero makes negative zeros positive.
        let t = if surface.t.rounded() == 0.0 { 0.0 } else { libm::ldexp(surface.t.rounded(), exponent) };
        let slot = surface.hit.id;
        Self {
            entity: prepared.entity(slot),
            member: prepared.cloud_member(slot).map(|(member, _)| member),
            t: t.is_finite().then_some(t),
            distance: surface.distance(ray) + 0.0,
            point: surface.point,
            normal: surface.facing_normal() + DVec3::ZERO,
            surface,
        }
    }

    /// Returns a ray that leaves this surface. It stores the surfaces that it starts on and does not hit them again through rounding, so
    /// that no offset is needed. `None` if the direction is zero or not finite.
    #[must_use]
    pub fn leave_towards(&self, direction: DVec3) -> Option<SecondaryRay> {
        let ray = self.surface.leave_towards(direction)?;
        let exponent = exponent(&ray, direction);
        Some(SecondaryRay { ray, exponent })
    }
}

/// A secondary ray, which leaves a surface that another ray hit.
#[derive(Clone, Debug)]
pub struct SecondaryRay {
    ray: trace::CastRay,
    exponent: i32,
}

/// Returns the exponent of the power of two by which the kernel's direction is longer than the given one.
fn exponent(ray: &trace::CastRay, direction: DVec3) -> i32 {
    let exponent = |vector: DVec3| libm::ilogb(vector.abs().max_element());
    exponent(ray.direction()) - exponent(direction)
}

/// A ray that [`Engine::cast`](super::Engine::cast) can trace.
pub trait IntoRay {
    /// Returns the kernel's ray, and the exponent of the power of two by which its direction is longer than the given one. `None` if a
    /// number is not finite or the direction is zero.
    #[doc(hidden)]
    fn into_ray(self) -> Option<(trace::CastRay, i32)>;
}

impl IntoRay for Ray {
    fn into_ray(self) -> Option<(trace::CastRay, i32)> {
        let ray = trace::CastRay::new(self.origin, self.direction)?;
        let exponent = exponent(&ray, self.direction);
        Some((ray, exponent))
    }
}

impl IntoRay for SecondaryRay {
    fn into_ray(self) -> Option<(trace::CastRay, i32)> {
        Some((self.ray, self.exponent))
    }
}

impl IntoRay for Option<SecondaryRay> {
    fn into_ray(self) -> Option<(trace::CastRay, i32)> {
        self?.into_ray()
    }
}
