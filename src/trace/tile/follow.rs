//! A single ray: what it meets, the light there, and the rays that go on.

use super::buffers::{QueuedRay, Tile, TileBuffers};
use crate::color::Rgb;
use crate::trace::branch::{Branches, PathState, branches};
use crate::trace::direct::{Asker, Lit, from_light};
use crate::trace::effects::Effects;
use crate::trace::geometry::Leaves;
use crate::trace::media::Inside;
use crate::trace::moment::Moment;
use crate::trace::shade::{ambient, held};
use crate::trace::shadow::visibility;
use crate::trace::{Ray, Surface, SurfaceMaterial};

/// What is the same for all rays of a tile's sample.
pub(super) struct Follower<'a, L> {
    pub(super) moment: &'a Moment<'a>,
    pub(super) leaves: &'a L,
    pub(super) tile: Tile,
    pub(super) sample: u32,
}

impl<L: Leaves> Follower<'_, L> {
    /// Follows a pixel's camera ray; without one, the camera is not in a finite place.
    #[inline(always)]
    pub(super) fn start<E: Effects>(&self, ray: Option<Ray>, pixel: u32, buffers: &mut TileBuffers<'_>) {
        let Some(ray) = ray else {
            buffers.pixels[pixel as usize] = self.moment.nowhere();
            return;
        };
        buffers.rays_traced.camera += 1;
        let nesting = &mut buffers.scratch.nesting;
        let inside = if E::NESTING { self.moment.inside(ray.origin(), nesting) } else { Inside::NONE };
        let mut state = PathState::at_camera(inside);
        self.follow::<E>(&ray, &mut state, pixel, buffers);
    }

    /// As [`Follower::start`], not inlined: its code is long, and only where pixels have a single sample is a call worth saving.
    #[inline(never)]
    pub(super) fn start_apart<E: Effects>(
        &self,
        ray: Option<Ray>,
        pixel: u32,
        buffers: &mut TileBuffers<'_>,
    ) {
        self.start::<E>(ray, pixel, buffers);
    }

    /// Adds what the ray brings to its pixel, and queues what goes on.
    #[inline(always)]
    pub(super) fn follow<E: Effects>(
        &self,
        ray: &Ray,
        state: &mut PathState,
        pixel: u32,
        buffers: &mut TileBuffers<'_>,
    ) {
        let scene = self.moment.scene;
        let Some(closest) = scene.closest(self.leaves, ray, &mut buffers.scratch) else {
            let background = scene.background.towards(ray.direction());
            self.arrive::<E>(state, background, f64::INFINITY, pixel, buffers);
            return;
        };
        let material = scene.material(closest.hit.slot);
        if !self.needs_point::<E>(state, material) {
            let light = held(ambient(scene, material.ambient));
            deposit::<E>(&mut buffers.pixels[pixel as usize], state.throughput, light);
            return;
        }
        let surface = scene.surface(self.leaves, ray, &closest, &mut buffers.scratch.guards);
        let light = self.light::<E>(ray, state, &surface, pixel, buffers);
        let length = if E::NESTING || E::EXTRAS { surface.distance(ray) } else { 0.0 };
        self.arrive::<E>(state, light, length, pixel, buffers);
        if E::MIRRORS && scene.material(surface.hit.slot).continues() {
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
        if !E::NESTING && !E::EXTRAS {
            deposit::<E>(pixel, state.throughput, light);
            return;
        }
        let passage = state.passage::<E>(self.moment.scene, &buffers.scratch.nesting, length);
        deposit::<E>(pixel, state.throughput, passage.of(light));
        state.throughput *= passage.transmitted;
    }

    /// Is more asked of what a ray meets than what it is made of?
    #[inline]
    fn needs_point<E: Effects>(&self, state: &PathState, material: &SurfaceMaterial) -> bool {
        let lit = E::LIGHTS && !self.moment.lights.is_empty() && material.scatters();
        let continues =
            (E::MIRRORS && material.reflected > 0.0) || (E::MEDIA && material.refraction.is_some());
        let in_medium = E::NESTING && state.inside != Inside::NONE;
        let rare = E::EXTRAS && (self.moment.scene.fog.density > 0.0 || material.checker.is_some());
        lit || continues || in_medium || rare
    }

    /// The light that a surface point sends back along the ray: ambient and, light by light, diffuse and specular.
    #[inline(always)]
    fn light<E: Effects>(
        &self,
        ray: &Ray,
        state: &PathState,
        surface: &Surface,
        pixel: u32,
        buffers: &mut TileBuffers<'_>,
    ) -> Rgb {
        let scene = self.moment.scene;
        // Among surfaces in the same place it may be another one that is seen than the first that was met.
        let material = scene.material(surface.hit.slot);
        let (color, diffuse) =
            if E::EXTRAS { material.colors_at(surface) } else { (material.ambient, material.diffuse) };
        let mut light = ambient(scene, color);
        if !E::LIGHTS {
            return held(light);
        }
        // Only lights with a size ask for it.
        let pixel = if E::EXTRAS { self.tile.pixel(pixel) } else { (0, 0) };
        let asker = Asker { seed: self.moment.sampling.seed, pixel, sample: self.sample };
        let normal = surface.facing_normal();
        let lit = Lit { ray, state, surface, material, diffuse, asker, normal };
        let TileBuffers { scratch, rays_traced, last_occluders, .. } = buffers;
        for ((index, source), last_occluder) in self.moment.lights.iter().zip(last_occluders) {
            // A light may have thousands of samples.
            if E::EXTRAS && source.samples > 1 && scratch.is_cancelled() {
                break;
            }
            let added = from_light::<E>((*index, source), &lit, |shadow_ray| {
                rays_traced.shadow += 1;
                let seen = (surface, state.inside);
                let light = (source.own_shape, &mut *last_occluder);
                visibility::<E>(scene, self.leaves, shadow_ray, light, seen, scratch)
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
        surface: &Surface,
        pixel: u32,
        buffers: &mut TileBuffers<'_>,
    ) {
        let TileBuffers { next, scratch, .. } = buffers;
        let Branches { reflected, refracted } =
            branches::<E>(self.moment, &mut scratch.nesting, arrived, surface);
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
pub(super) fn give_up(moment: &Moment<'_>, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { beyond, pixels, trees_ended, .. } = buffers;
    for QueuedRay { tree, pixel, .. } in beyond.iter() {
        let background = moment.scene.background.towards(tree.ray.direction());
        pixels[*pixel as usize] += tree.state.throughput * background;
    }
    trees_ended.depth += beyond.len() as u64;
    beyond.clear();
}
