//! Secondary rays spawned at a surface: mirrored and refracted rays.

use std::ptr;

use glam::DVec3;

use super::context::RenderContext;
use super::dielectric::{Boundary, incidence, mirrored};
use super::handover::handed_over;
use super::medium_stack::{MediumStack, MediumStacks};
use super::scratch::LightScratch;
use crate::color::{Rgb, to_f32};
use crate::trace::effects::Effects;
use crate::trace::intersect::SurfacePoint;
use crate::trace::rays::PreparedRay;
use crate::trace::scene::{Attenuation, PassageTerms, PreparedScene, Refraction};

/// A ray in the ray tree of a sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TreeRay {
    pub(crate) ray: PreparedRay,
    pub(crate) state: PathState,
}

/// The state of a path from the camera to a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathState {
    /// Share of the light along the ray that reaches the pixel.
    pub(crate) throughput: Rgb,
    /// Transparent solids that contain the ray.
    pub(crate) medium: MediumStack,
    /// Index in the ray tree: 1 is the camera ray; ray p spawns the mirrored ray 2p and the refracted ray 2p + 1.
    pub(crate) path: u64,
}

impl PathState {
    /// Returns the state of a camera ray.
    #[inline]
    pub(crate) const fn at_camera(medium: MediumStack) -> Self {
        Self { throughput: Rgb::ONE, medium, path: 1 }
    }

    /// Computes the attenuation along the ray, over a length, which is infinite if the ray hits nothing, and its terms.
    pub(crate) fn passage(
        &self,
        effects: Effects,
        scene: &PreparedScene,
        media: &MediumStacks,
        (ray, length): (&PreparedRay, f64),
    ) -> (Attenuation, PassageTerms) {
        let absorption = if effects.in_media() { media.absorption(scene, self.medium) } else { Rgb::ZERO };
        let in_fog = effects.extras && scene.fog.density != 0.0;
        let optical_depth =
            if in_fog { scene.fog.optical_depth(ray.origin(), ray.direction(), length) } else { 0.0 };
        let terms = PassageTerms { absorption, fog: scene.fog.color, optical_depth };
        (Attenuation::through(&terms, length), terms)
    }
}

/// Maximum number of rays traced per sample, which bounds time and memory for any scene. Rays beyond it are not traced and see the
/// background, like rays beyond the last bounce.
pub(crate) const LARGEST_TREE: u32 = 4096;

/// The rays spawned at a surface.
#[derive(Debug, Default)]
pub(crate) struct SecondaryRays {
    pub(crate) reflected: Option<TreeRay>,
    pub(crate) refracted: Option<TreeRay>,
}

/// The shares of the light of its secondary rays that a surface sends back along the ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SecondaryTerms {
    /// The mirror coefficient, k_r.
    pub mirror: f32,
    /// The share of the reflected ray's light: k_r, and the part of k_t that is reflected.
    pub reflected: f32,
    /// The colour of a metal, by which reflected light and highlights are multiplied.
    pub tint: Option<Rgb>,
    /// The terms of refraction, if the surface is transparent.
    pub refraction: Option<RefractionTerms>,
}

/// The terms of refraction at a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefractionTerms {
    /// The transmission coefficient, k_t.
    pub coefficient: f32,
    /// Refractive index of the medium from which the ray arrives.
    pub from: f64,
    /// Refractive index of the medium behind the surface.
    pub into: f64,
    /// The reflectance F: 1 under total internal reflection, 0 without Fresnel's equations.
    pub reflectance: f32,
    /// The share of the refracted ray's light, k_t (1 - F).
    pub share: f32,
}

impl RefractionTerms {
    /// Returns true under total internal reflection.
    #[must_use]
    pub fn is_total(&self) -> bool {
        self.reflectance == 1.0 && self.share == 0.0
    }
}

/// Spawns the secondary rays of a ray that arrives at a surface of the scene `seen`, as the ray sees it. Total internal reflection adds the
/// refracted light to the mirrored light.
pub(crate) fn secondary_rays(
    context: &RenderContext<'_>,
    scratch: &mut LightScratch<'_>,
    arrived: (&PreparedScene, &PreparedRay, &PathState),
    surface: &SurfacePoint,
) -> SecondaryRays {
    secondary_rays_and_terms(context, scratch, arrived, surface).0
}

/// Spawns the [`secondary_rays`] of a surface, with the terms of their shares of the light.
#[inline(always)]
pub(crate) fn secondary_rays_and_terms(
    context: &RenderContext<'_>,
    scratch: &mut LightScratch<'_>,
    (seen, ray, arrived): (&PreparedScene, &PreparedRay, &PathState),
    surface: &SurfacePoint,
) -> (SecondaryRays, SecondaryTerms) {
    let RenderContext { scene, effects, .. } = *context;
    let direction = ray.direction();
    let material = scene.material(surface.hit.id);
    let mut reflected = material.reflected;
    let mut refraction = None;
    let mut terms = SecondaryTerms { mirror: reflected, tint: material.tint, ..SecondaryTerms::default() };
    if effects.media()
        && let Some(medium) = &material.refraction
    {
        let LightScratch { media, search, .. } = scratch;
        let beyond = media.through(seen, arrived.medium, surface, &search.ties, direction);
        let (from, into) = (media.ior(scene, arrived.medium), media.ior(scene, beyond));
        let refracted = Refracted::at(medium, Boundary { from, into }, direction, surface);
        reflected += refracted.reflected;
        terms.refraction = Some(RefractionTerms {
            coefficient: medium.transmitted,
            from,
            into,
            reflectance: refracted.reflectance,
            share: refracted.transmitted,
        });
        refraction = refracted.direction.map(|direction| (direction, refracted.transmitted, beyond));
    }

    let (surface, medium) =
        &handed_over(context, (seen, context.secondary), (ray, surface), arrived.medium, scratch);
    if let Some((.., beyond)) = &mut refraction
        && !ptr::eq(seen, context.secondary)
    {
        let LightScratch { media, search, .. } = scratch;
        *beyond = media.through(context.secondary, *medium, surface, &search.ties, direction);
    }

    terms.reflected = reflected;
    let mut branches = SecondaryRays::default();
    let tint = material.tint.unwrap_or(Rgb::ONE);
    if let Some(state) = reaching(arrived, reflected, tint, *medium, 0) {
        let direction = mirrored::<f64>(direction.into(), surface.normal.into()).into();
        branches.reflected = surface.leave(surface.from_outside, direction).map(|ray| TreeRay { ray, state });
    }
    if effects.media()
        && let Some((direction, transmitted, beyond)) = refraction
        && let Some(state) = reaching(arrived, transmitted, Rgb::ONE, beyond, 1)
    {
        branches.refracted =
            surface.leave(!surface.from_outside, direction).map(|ray| TreeRay { ray, state });
    }
    (branches, terms)
}

/// Returns the state of a secondary ray that carries a share of the light, in a tint, in a medium, as child `place`, 0 or 1, of the ray
/// that it continues. `None` if its throughput is zero.
#[inline]
pub(super) fn reaching(
    arrived: &PathState,
    share: f32,
    tint: Rgb,
    medium: MediumStack,
    place: u64,
) -> Option<PathState> {
    // If k_r + k_t is above 1, light may double without end. It is clamped to finite numbers, because a finite number times zero is zero,
    // but infinity times zero is NaN.
    let throughput = (arrived.throughput * share).min(Rgb::splat(f32::MAX)) * tint;
    let path = arrived.path.wrapping_mul(2).wrapping_add(place);
    (throughput != Rgb::ZERO).then_some(PathState { throughput, medium, path })
}

/// The division of a surface's share k_t of the light into mirrored and refracted light.
struct Refracted {
    reflectance: f32,
    /// Share that is added to the mirrored light.
    reflected: f32,
    transmitted: f32,
    /// `None` under total internal reflection.
    direction: Option<DVec3>,
}

impl Refracted {
    fn at(medium: &Refraction, boundary: Boundary, direction: DVec3, surface: &SurfacePoint) -> Self {
        // Equal indices neither bend nor mirror light; the direction stays exact.
        if boundary.from == boundary.into {
            let (transmitted, direction) = (medium.transmitted, Some(direction));
            return Self { reflectance: 0.0, reflected: 0.0, transmitted, direction };
        }
        let unit = direction / direction.length();
        let normal = surface.facing_normal();
        let cosine = incidence(unit.into(), normal.into());
        let (transmitted, passes) = boundary.refraction(cosine);
        if !passes {
            let reflected = medium.transmitted;
            return Self { reflectance: 1.0, reflected, transmitted: 0.0, direction: None };
        }
        let share = if medium.fresnel { boundary.partial_reflectance(cosine, transmitted) } else { 0.0 };
        Self {
            reflectance: to_f32(share),
            reflected: medium.transmitted * to_f32(share),
            transmitted: medium.transmitted * to_f32(1.0 - share),
            direction: Some(boundary.refracted(unit.into(), normal.into(), cosine, transmitted).into()),
        }
    }
}
