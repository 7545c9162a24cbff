//! Kernels written for just one thing, with nothing else in mind: what the planned kernels are measured against.

use rayreel::trace::{Background, Camera, LightSource, PreparedScene};
use rayreel::{Film, Rgb};

/// The colour of a background that is the same everywhere.
fn flat(scene: &PreparedScene) -> Rgb {
    match scene.background {
        Background::Flat(color) => color,
        Background::Gradient { .. } => Rgb::ZERO,
    }
}

/// Ambient light alone.
pub(super) fn ambient(scene: &PreparedScene, camera: &Camera) -> Film {
    let (columns, rows) = camera.resolution();
    let background = flat(scene);
    let mut search = scene.search();
    let mut pixels = Vec::with_capacity(columns as usize * rows as usize);
    for j in 0..rows {
        for i in 0..columns {
            let closest = camera.ray(i, j).and_then(|ray| search.closest(&ray));
            pixels.push(match closest {
                Some(closest) => scene.material(closest.hit.id).ambient * scene.ambient,
                None => background,
            });
        }
    }
    Film::from_pixels(columns, rows, pixels.into_iter())
}

/// Ambient and diffuse light of points, with shadows.
pub(super) fn diffuse(scene: &PreparedScene, camera: &Camera) -> Film {
    let (columns, rows) = camera.resolution();
    let background = flat(scene);
    let mut search = scene.search();
    let mut pixels = Vec::with_capacity(columns as usize * rows as usize);
    for j in 0..rows {
        for i in 0..columns {
            let Some(ray) = camera.ray(i, j) else { continue };
            let Some(closest) = search.closest(&ray) else {
                pixels.push(background);
                continue;
            };
            let material = scene.material(closest.hit.id);
            let mut color = material.ambient * scene.ambient;
            if material.diffuse != Rgb::ZERO {
                let surface = search.surface(&ray, &closest);
                let normal = surface.facing_normal();
                for light in &scene.lights {
                    let LightSource::Point(place) = light.source else { continue };
                    let Some((ray, limit)) = surface.leave_to(place) else { continue };
                    let to_light = ray.direction();
                    let cosine = normal.dot(to_light) / to_light.dot(to_light).sqrt();
                    if cosine > 0.0 && !search.is_hidden(&ray, &limit, light.own_shape) {
                        color += material.diffuse * light.intensity * cosine as f32;
                    }
                }
            }
            pixels.push(color);
        }
    }
    Film::from_pixels(columns, rows, pixels.into_iter())
}
