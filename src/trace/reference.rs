//! The slow path: every ray asks every shape. It is the oracle that the fast path is held against, bit for bit, the
//! definition of the picture in the fewest words, and, as it keeps the whole tree of a pixel's rays, its explanation.

use super::film::PixelSum;
use super::geometry::Leaves;
use super::shade::{ambient, incidence, mirrored};
use super::{Camera, Closest, Film, Guards, PreparedScene, Ray, Sampling, Slot, Surface};
use crate::color::Rgb;

/// All rays of one sample of a pixel, breadth first.
#[derive(Clone, Debug, PartialEq)]
pub struct RayTree {
    /// The camera ray is the first; every ray comes after the one it continues.
    pub rays: Vec<TracedRay>,
}

/// One of them.
#[derive(Clone, Debug, PartialEq)]
pub struct TracedRay {
    /// Index of the ray that this one continues; `None` for a camera ray.
    pub parent: Option<usize>,
    /// The ray.
    pub ray: Ray,
    /// What share of the light along it reaches the pixel, before the mean over samples is taken.
    pub throughput: Rgb,
    /// What it finds.
    pub end: RayEnd,
}

/// What a ray finds.
#[derive(Clone, Debug, PartialEq)]
pub enum RayEnd {
    /// Nothing: it sees the background.
    Background,
    /// Nobody looks: it is beyond the last generation, and sees the background.
    BeyondDepth,
    /// A surface.
    Surface(Box<LitSurface>),
}

/// A surface point and the light on it.
#[derive(Clone, Debug, PartialEq)]
pub struct LitSurface {
    /// The point.
    pub surface: Surface,
    /// Ambient light sent back along the ray.
    pub ambient: Rgb,
    /// For every light of the scene, in document order, what comes of it.
    pub lights: Vec<LightReach>,
}

/// What comes of a light at a surface point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightReach {
    /// It can add nothing: it is off, or behind the surface, or shines elsewhere, or the surface scatters none of it. No
    /// shadow ray is sent.
    NotAsked,
    /// Something stands in its way; the first in document order of all that do.
    Hidden(Slot),
    /// It is sent back along the ray with this colour.
    Reaches(Rgb),
}

impl RayTree {
    /// The sample's colour: throughput times light, ray after ray.
    #[must_use]
    pub fn color(&self, scene: &PreparedScene) -> Rgb {
        self.rays.iter().fold(Rgb::ZERO, |sum, traced| sum + traced.throughput * traced.end.light(scene))
    }
}

impl RayEnd {
    /// The light that comes back from here.
    #[must_use]
    pub fn light(&self, scene: &PreparedScene) -> Rgb {
        match self {
            Self::Background | Self::BeyondDepth => scene.background,
            Self::Surface(lit) => lit.lights.iter().fold(lit.ambient, |sum, reach| match reach {
                LightReach::Reaches(color) => sum + *color,
                LightReach::NotAsked | LightReach::Hidden(_) => sum,
            }),
        }
    }
}

/// Makes the picture, pixel after pixel, and in a pixel sample after sample.
#[must_use]
pub fn render(scene: &PreparedScene, camera: &Camera, sampling: Sampling) -> Film {
    let (columns, rows) = camera.resolution();
    let mut film = Film::new(columns, rows);
    for j in 0..rows {
        for i in 0..columns {
            let mut sum = PixelSum::default();
            for sample in 0..sampling.samples {
                let ray = camera.sample_ray(sampling, i, j, sample);
                sum.add(ray.map_or(scene.background, |ray| ray_tree(scene, ray).color(scene)));
            }
            film.store(i, j, &[sum.mean(sampling.samples)]);
        }
    }
    film
}

/// Follows a camera ray from mirror to mirror.
#[must_use]
pub fn ray_tree(scene: &PreparedScene, camera_ray: Ray) -> RayTree {
    let mut rays = Vec::new();
    let mut next = Some((None, camera_ray, Rgb::ONE));
    let mut generation = 0;
    while let Some((parent, ray, throughput)) = next.take() {
        generation += 1;
        let end = if generation > scene.depth {
            RayEnd::BeyondDepth
        } else if let Some(closest) = closest(scene, &ray) {
            let surface = scene.surface(scene.geometry(), &ray, &closest, &mut Guards::default());
            let throughput = throughput * scene.material(surface.hit.slot).reflected;
            if throughput != Rgb::ZERO {
                next = mirrored(&ray, &surface).map(|ray| (Some(rays.len()), ray, throughput));
            }
            RayEnd::Surface(Box::new(lit(scene, &ray, surface)))
        } else {
            RayEnd::Background
        };
        rays.push(TracedRay { parent, ray, throughput, end });
    }
    RayTree { rays }
}

fn lit(scene: &PreparedScene, arrived: &Ray, surface: Surface) -> LitSurface {
    let material = scene.material(surface.hit.slot);
    let reach = |light| {
        let Some(incidence) = incidence(scene, arrived, &surface, light) else {
            return LightReach::NotAsked;
        };
        let hidden = || hidden_by(scene, &incidence.ray, incidence.limit, light.own_shape);
        match light.casts_shadows.then(hidden).flatten() {
            Some(slot) => LightReach::Hidden(slot),
            None => LightReach::Reaches(incidence.color),
        }
    };
    let lights = scene.lights.iter().map(reach).collect();
    LitSurface { ambient: ambient(scene, material), lights, surface }
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

/// What but `except` stands between the ray's origin and `limit`, the first in document order.
#[must_use]
pub fn hidden_by(scene: &PreparedScene, ray: &Ray, limit: f64, except: Option<Slot>) -> Option<Slot> {
    let geometry = scene.geometry();
    geometry.slots().find(|slot| {
        Some(*slot) != except && geometry.stands_before(*slot, ray, limit, &mut Guards::default())
    })
}
