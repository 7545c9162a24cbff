//! A single ray: what it meets, the light there, and the rays that go on.

use super::buffers::{QueuedRay, Tile, TileBuffers};
use crate::color::Rgb;
use crate::trace::effects::Effects;
use crate::trace::light::{
    LitPoint, MediumStack, PathState, RenderContext, SampleId, SecondaryRays, ambient, from_light, held,
    secondary_rays, visibility,
};
use crate::trace::query::{Intersector, SurfacePoint};
use crate::trace::rays::Ray;
use crate::trace::scene::SurfaceMaterial;

/// What is the same for all rays of a tile's sample.
pub(crate) struct Follower<'a, L> {
    pub(crate) context: &'a RenderContext<'a>,
    pub(crate) shapes: &'a L,
    pub(crate) tile: Tile,
    pub(crate) sample: u32,
}

impl<L: Intersector> Follower<'_, L> {
    /// Follows a pixel's camera ray; without one, the camera is not in a finite place.
    #[inline(always)]
    pub(crate) fn start<E: Effects>(&self, ray: Option<Ray>, pixel: u32, buffers: &mut TileBuffers<'_>) {
        let Some(ray) = ray else {
            buffers.pixels[pixel as usize] = self.context.nowhere();
            return;
        };
        buffers.rays_traced.camera += 1;
        let media = &mut buffers.scratch.media;
        let medium = if E::IN_MEDIA { self.context.medium(ray.origin(), media) } else { MediumStack::NONE };
        let mut state = PathState::at_camera(medium);
        self.follow::<E>(&ray, &mut state, pixel, buffers);
    }

    /// As [`Follower::start`], not inlined: its code is long, and only where pixels have a single sample is a call worth saving.
    #[inline(never)]
    pub(crate) fn start_apart<E: Effects>(
        &self,
        ray: Option<Ray>,
        pixel: u32,
        buffers: &mut TileBuffers<'_>,
    ) {
        self.start::<E>(ray, pixel, buffers);
    }

    /// Adds what the ray brings to its pixel, and queues what goes on.
    #[inline(always)]
    pub(crate) fn follow<E: Effects>(
        &self,
        ray: &Ray,
        state: &mut PathState,
        pixel: u32,
        buffers: &mut TileBuffers<'_>,
    ) {
        let scene = self.context.scene;
        let Some(closest) = scene.closest(self.shapes, ray, &mut buffers.scratch.search) else {
            let background = scene.background.towards(ray.direction());
            self.arrive::<E>(state, background, f64::INFINITY, pixel, buffers);
            return;
        };
        let material = scene.material(closest.hit.id);
        if !self.needs_point::<E>(state, material) {
            let light = held(ambient(scene, material.ambient));
            deposit::<E>(&mut buffers.pixels[pixel as usize], state.throughput, light);
            return;
        }
        let surface = scene.surface(self.shapes, ray, &closest, &mut buffers.scratch.search.escalations);
        let light = self.light::<E>(ray, state, &surface, pixel, buffers);
        let length = if E::IN_MEDIA || E::EXTRAS { surface.distance(ray) } else { 0.0 };
        self.arrive::<E>(state, light, length, pixel, buffers);
        if E::MIRRORS && scene.material(surface.hit.id).continues() {
            self.send_on::<E>((ray, state), &surface, pixel, buffers);
        }
    }

    /// Adds light that comes in at the end of a ray to its pixel, and what happens to it on the way to the ray's throughput.
    #[inline(always)]
    fn arrive<E: Effects>(
        &self,
        state: &mut PathState,
        light: Rgb,
        length: f64,
        pixel: u32,
        buffers: &mut TileBuffers<'_>,
    ) {
        let pixel = &mut buffers.pixels[pixel as usize];
        if !E::IN_MEDIA && !E::EXTRAS {
            deposit::<E>(pixel, state.throughput, light);
            return;
        }
        let passage = state.passage::<E>(self.context.scene, &buffers.scratch.media, length);
        deposit::<E>(pixel, state.throughput, passage.of(light));
        state.throughput *= passage.transmitted;
    }

    /// Is more asked of what a ray meets than what it is made of?
    #[inline]
    fn needs_point<E: Effects>(&self, state: &PathState, material: &SurfaceMaterial) -> bool {
        let lit = E::LIGHTS && !self.context.lights.is_empty() && material.scatters();
        let continues =
            (E::MIRRORS && material.reflected > 0.0) || (E::MEDIA && material.refraction.is_some());
        let in_medium = E::IN_MEDIA && state.medium != MediumStack::NONE;
        let rare = E::EXTRAS && (self.context.scene.fog.density > 0.0 || material.checker.is_some());
        lit || continues || in_medium || rare
    }

    /// The light that a surface point sends back along the ray: ambient and, light by light, diffuse and specular.
    #[inline(always)]
    fn light<E: Effects>(
        &self,
        ray: &Ray,
        state: &PathState,
        surface: &SurfacePoint,
        pixel: u32,
        buffers: &mut TileBuffers<'_>,
    ) -> Rgb {
        let scene = self.context.scene;
        // Among surfaces in the same place it may be another one that is seen than the first that was met.
        let material = scene.material(surface.hit.id);
        let (color, diffuse) = if E::EXTRAS {
            material.colors_at(surface.point, surface.normal)
        } else {
            (material.ambient, material.diffuse)
        };
        let mut light = ambient(scene, color);
        if !E::LIGHTS {
            return held(light);
        }
        // Only lights with a size ask for it.
        let pixel = if E::EXTRAS { self.tile.pixel(pixel) } else { (0, 0) };
        let asker = SampleId { seed: self.context.sampling.seed, pixel, sample: self.sample };
        let normal = surface.facing_normal();
        let lit = LitPoint { ray, state, surface, material, diffuse, asker, normal };
        let TileBuffers { scratch, rays_traced, last_occluders, .. } = buffers;
        for ((index, source), last_occluder) in self.context.lights.iter().zip(last_occluders) {
            // A light may have thousands of samples.
            if E::EXTRAS && source.samples > 1 && scratch.search.is_cancelled() {
                break;
            }
            let added = from_light::<E>((*index, source), &lit, |shadow_ray| {
                rays_traced.shadow += 1;
                let seen = (surface, state.medium);
                let light = (source.own_shape, &mut *last_occluder);
                visibility::<E>(scene, self.shapes, shadow_ray, light, seen, scratch)
            });
            if let Some(added) = added {
                light += added;
            }
        }
        held(light)
    }

    /// Queues the rays that a surface sends on.
    fn send_on<E: Effects>(
        &self,
        arrived: (&Ray, &PathState),
        surface: &SurfacePoint,
        pixel: u32,
        buffers: &mut TileBuffers<'_>,
    ) {
        let TileBuffers { next, scratch, .. } = buffers;
        let SecondaryRays { reflected, refracted } =
            secondary_rays::<E>(self.context, &mut scratch.media, arrived, surface);
        for (tree, mirrored) in [(reflected, true), (refracted, false)] {
            next.extend(tree.map(|tree| QueuedRay { tree, pixel, mirrored, cut: false }));
        }
    }
}

/// Adds what a ray brings to its pixel. Where no rays go on, it is all that comes to the pixel, and undiminished.
#[inline(always)]
fn deposit<E: Effects>(pixel: &mut Rgb, throughput: Rgb, light: Rgb) {
    if E::MIRRORS {
        *pixel += throughput * light;
    } else {
        *pixel = light;
    }
}

/// Rays that are not traced see the background.
pub(crate) fn give_up(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { beyond, pixels, trees_ended, .. } = buffers;
    for QueuedRay { tree, pixel, .. } in beyond.iter() {
        let background = context.scene.background.towards(tree.ray.direction());
        pixels[*pixel as usize] += tree.state.throughput * background;
    }
    trees_ended.depth += beyond.len() as u64;
    beyond.clear();
}
