//! How often a shadow ray crosses the surface of a sphere, as far as a first look says it for certain. Where a sphere is clear and
//! does not absorb, nothing else is asked of it.

use crate::trace::rays::{Limit, Ray, RayView, ShapeId};
use crate::trace::scene::{Geometry, Kind, Location};
use crate::trace::shapes::Sphere;

/// 2^-32: what is nearer to a light than so, compared with its distance, takes a second look.
const NEAR: f64 = f64::from_bits((1023 - 32) << 52);

/// Half a unit in the last place of 1.
const U: f64 = f64::EPSILON / 2.0;

/// How the line of a ray runs by a sphere.
enum Line {
    Beside,
    /// Through it, entering and leaving there, with a bound of the error of both.
    Through {
        near: f64,
        far: f64,
        error: f64,
    },
}

impl Line {
    /// `None` where it is too close to the sphere's outline. The roots are those of [`Sphere::intersect`], and all bounds
    /// several times as wide.
    #[inline]
    fn by(sphere: &Sphere, ray: &Ray) -> Option<Self> {
        let (to_center, direction) = (sphere.center - ray.origin(), ray.direction());
        let b = to_center.dot(direction);
        let squared_radius = sphere.radius * sphere.radius;
        let projection = b * ray.inverse_square();
        let nearest = to_center - direction * projection;
        let q = squared_radius - nearest.dot(nearest);
        let q_error = 64.0 * U * (b * projection + squared_radius);
        if q < -q_error {
            return Some(Self::Beside);
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
    /// How many times the ray crosses the surface of a sphere before the limit. `None` where a glance does not tell, and for all
    /// other shapes.
    #[inline]
    pub(crate) fn crossings_at_a_glance(&self, id: ShapeId, ray: &RayView<'_>, limit: &Limit) -> Option<u32> {
        let Location { kind: Kind::Sphere, index } = self.locations[id.index()] else {
            return None;
        };
        if ray.left_normal(id).is_some() {
            return None;
        }
        let departure = ray.departure().filter(|departure| departure.id == id);
        if departure.is_some_and(|departure| departure.outward) {
            return Some(0);
        }
        let Line::Through { near, far, error } = Line::by(&self.spheres[index as usize], ray)? else {
            return departure.is_none().then_some(0);
        };
        let (before, beyond) = (limit.t() * (1.0 - NEAR), limit.t() * (1.0 + NEAR));
        let between = |t: f64| {
            if t < -error || t - error > beyond {
                Some(0)
            } else {
                (t > error && t + error < before).then_some(1)
            }
        };
        // The near side of a sphere that the ray leaves inwards is where it starts.
        let near = if departure.is_some() { 0 } else { between(near)? };
        Some(near + between(far)?)
    }
}
