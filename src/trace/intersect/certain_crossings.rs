//! Fast count of the crossings of a shadow ray with a sphere's surface, for the cases in which error bounds make it certain. A transparent
//! sphere without absorption then needs no other query.

use crate::trace::rays::{PreparedRay, RayView, ShadowLimit, ShapeId};
use crate::trace::scene::{Geometry, ShapeRef};
use crate::trace::shapes::Sphere;

/// 2^-32: crossings closer to a light than this, relative to its distance, are uncertain.
const NEAR: f64 = f64::from_bits((1023 - 32) << 52);

/// Half a unit in the last place of 1.
const U: f64 = f64::EPSILON / 2.0;

/// The position of a ray's line relative to a sphere.
enum Line {
    Missing,
    /// Enters the sphere at `near` and leaves it at `far`, both with an error of at most `error`.
    Through {
        near: f64,
        far: f64,
        error: f64,
    },
}

impl Line {
    /// Returns `None` if the line passes too close to the sphere's outline. The roots are computed as in [`Sphere::intersect`], and all bounds
    /// are several times as wide.
    #[inline]
    fn by(sphere: &Sphere, ray: &PreparedRay) -> Option<Self> {
        let (to_center, direction) = (sphere.center - ray.origin(), ray.direction());
        let b = to_center.dot(direction);
        let squared_radius = sphere.radius * sphere.radius;
        let projection = b * ray.inverse_square();
        let nearest = to_center - direction * projection;
        let q = squared_radius - nearest.dot(nearest);
        let q_error = 64.0 * U * (b * projection + squared_radius);
        if q < -q_error {
            return Some(Self::Missing);
        }
        (q > 1024.0 * q_error).then(|| {
            let root = (direction.dot(direction) * q).sqrt();
            let error = 256.0 * U * (to_center.dot(to_center) + squared_radius) / root;
            let [near, far] = [b - root, b + root].map(|root| root * ray.inverse_square());
            Self::Through { near, far, error }
        })
    }
}

impl Geometry {
    /// Returns the number of times that the ray crosses the surface of a sphere before the limit. `None` if the number is uncertain, and for
    /// all other shapes.
    #[inline]
    pub(crate) fn certain_crossings(
        &self,
        id: ShapeId,
        ray: &RayView<'_>,
        limit: &ShadowLimit,
    ) -> Option<u32> {
        let ShapeRef::Sphere(sphere) = self.shape(id) else { return None };
        if ray.left_normal(id).is_some() {
            return None;
        }
        let exclusion = ray.exclusion().filter(|exclusion| exclusion.id == id);
        if exclusion.is_some_and(|exclusion| exclusion.outward) {
            return Some(0);
        }
        let Line::Through { near, far, error } = Line::by(sphere, ray)? else {
            return exclusion.is_none().then_some(0);
        };
        let (before, beyond) = (limit.t() * (1.0 - NEAR), limit.t() * (1.0 + NEAR));
        let between = |t: f64| {
            if t < -error || t - error > beyond {
                Some(0)
            } else {
                (t > error && t + error < before).then_some(1)
            }
        };
        // A ray that leaves a sphere inwards starts on its near side.
        let near = if exclusion.is_some() { 0 } else { between(near)? };
        Some(near + between(far)?)
    }
}
