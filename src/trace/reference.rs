//! The slow path: every ray asks every shape. It is the oracle that the fast path is held against, bit for bit, and the
//! definition of the picture in the fewest words.

use super::geometry::Leaves;
use super::shade::{ambient, diffuse, mirrored, shadow_ray};
use super::{Camera, Closest, Film, Guards, PreparedScene, Ray, Slot};
use crate::color::Rgb;

/// Makes the picture, pixel after pixel.
#[must_use]
pub fn render(scene: &PreparedScene, camera: &Camera) -> Film {
    let (columns, rows) = camera.resolution();
    let mut film = Film::new(columns, rows);
    for j in 0..rows {
        for i in 0..columns {
            let color = camera.ray(i, j).map_or(scene.background, |ray| radiance(scene, ray));
            film.store(i, j, &[color]);
        }
    }
    film
}

/// The light that comes back along a camera ray: what each surface along the chain of mirrors sends, weighted by the
/// mirrors before it.
#[must_use]
pub fn radiance(scene: &PreparedScene, camera_ray: Ray) -> Rgb {
    let mut sum = Rgb::ZERO;
    let mut next = Some((camera_ray, Rgb::ONE));
    for _ in 0..scene.depth {
        let Some((ray, throughput)) = next.take() else {
            return sum;
        };
        let Some(closest) = closest(scene, &ray) else {
            return sum + throughput * scene.background;
        };
        let surface = scene.surface(scene.geometry(), &ray, &closest, &mut Guards::default());
        let material = scene.material(surface.hit.slot);

        let mut local = ambient(scene, material);
        for light in &scene.lights {
            if let Some(shadow) = shadow_ray(scene, &surface, light)
                && !is_hidden(scene, &shadow.ray, shadow.limit, light.own_shape)
            {
                local += diffuse(material, light, shadow.cosine);
            }
        }
        sum += throughput * local;

        let throughput = throughput * material.reflected;
        if throughput != Rgb::ZERO {
            next = mirrored(&ray, &surface).map(|ray| (ray, throughput));
        }
    }
    // Beyond the last generation a ray sees the background.
    match next {
        Some((_, throughput)) => sum + throughput * scene.background,
        None => sum,
    }
}

/// The nearest surface; of several at the same place the first in document order.
#[must_use]
pub fn closest(scene: &PreparedScene, ray: &Ray) -> Option<Closest> {
    let geometry = scene.geometry();
    let mut best = None;
    let mut guards = Guards::default();
    for slot in geometry.slots() {
        if let Some(hit) = geometry.first_hit(slot, ray, &mut guards) {
            Closest::consider(&mut best, hit, geometry, ray, &mut guards);
        }
    }
    best
}

/// Does anything but `except` stand between the ray's origin and `limit`?
#[must_use]
pub fn is_hidden(scene: &PreparedScene, ray: &Ray, limit: f64, except: Option<Slot>) -> bool {
    let geometry = scene.geometry();
    let hides = |slot| geometry.stands_before(slot, ray, limit, &mut Guards::default());
    geometry.slots().any(|slot| Some(slot) != except && hides(slot))
}
