//! The rays that a surface sends on: mirrored and refracted ones.

use glam::DVec3;

use super::context::RenderContext;
use super::dielectric::Boundary;
use super::medium_stack::{MediumStack, MediumStacks};
use super::scratch::LightScratch;
use crate::color::{Rgb, to_f32};
use crate::trace::effects::Effects;
use crate::trace::query::SurfacePoint;
use crate::trace::rays::Ray;
use crate::trace::scene::{Attenuation, PreparedScene, Refraction};

/// A ray of the tree of rays that makes a sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TreeRay {
    pub(crate) ray: Ray,
    pub(crate) state: PathState,
}

/// What a sample's rays carry from the camera to here.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathState {
    /// What share of the light along this ray reaches the pixel.
    pub(crate) throughput: Rgb,
    /// The clear solids it is inside of.
    pub(crate) medium: MediumStack,
    /// The place in the tree: 1 is the camera ray, and after p the mirrored ray is 2p, the refracted one 2p + 1.
    pub(crate) path: u64,
}

impl PathState {
    /// At the root of a tree.
    #[inline]
    pub(crate) const fn at_camera(medium: MediumStack) -> Self {
        Self { throughput: Rgb::ONE, medium, path: 1 }
    }

    /// What happens to light along the ray, over a length.
    pub(crate) fn passage(
        &self,
        effects: Effects,
        scene: &PreparedScene,
        media: &MediumStacks,
        length: f64,
    ) -> Attenuation {
        let absorption = if effects.in_media() { media.absorption(scene, self.medium) } else { Rgb::ZERO };
        if absorption == Rgb::ZERO && (!effects.extras || scene.fog.density == 0.0) {
            return Attenuation::CLEAR;
        }
        Attenuation::through(absorption, &scene.fog, length)
    }
}

/// The most rays that are traced for a sample, so that time and memory have a bound whatever a scene asks for. Those beyond see
/// the background untraced, as those beyond the last generation do.
pub(crate) const LARGEST_TREE: u32 = 4096;

/// What goes on from a surface.
#[derive(Debug, Default)]
pub(crate) struct SecondaryRays {
    pub(crate) reflected: Option<TreeRay>,
    pub(crate) refracted: Option<TreeRay>,
}

/// The continuations of a ray, which arrives in a direction, at a surface. Total internal reflection turns refracted light into mirrored light.
pub(crate) fn secondary_rays(
    context: &RenderContext<'_>,
    scratch: &mut LightScratch<'_>,
    (direction, arrived): (DVec3, &PathState),
    surface: &SurfacePoint,
) -> SecondaryRays {
    let RenderContext { scene, effects, .. } = *context;
    let material = scene.material(surface.hit.id);
    let mut reflected = material.reflected;
    let mut refraction = None;
    if effects.media()
        && let Some(medium) = &material.refraction
    {
        let LightScratch { media, search, .. } = scratch;
        let beyond = media.through(scene, arrived.medium, surface, &search.ties, direction);
        let (from, into) = (media.ior(scene, arrived.medium), media.ior(scene, beyond));
        let refracted = Refracted::at(medium, Boundary { from, into }, direction, surface);
        reflected += refracted.reflected;
        refraction = refracted.direction.map(|direction| (direction, refracted.transmitted, beyond));
    }

    let mut branches = SecondaryRays::default();
    if let Some(state) = reaching(arrived, reflected, arrived.medium, 0) {
        let direction = mirrored(direction, surface.normal);
        branches.reflected = surface.leave(surface.from_outside, direction).map(|ray| TreeRay { ray, state });
    }
    if effects.media()
        && let Some((direction, transmitted, beyond)) = refraction
        && let Some(state) = reaching(arrived, transmitted, beyond, 1)
    {
        branches.refracted =
            surface.leave(!surface.from_outside, direction).map(|ray| TreeRay { ray, state });
    }
    branches
}

/// What a ray carries that takes a share of the light on, in a medium, in place 0 or 1 below the one that it continues. `None` where it
/// would bring nothing.
#[inline]
pub(super) fn reaching(
    arrived: &PathState,
    share: f32,
    medium: MediumStack,
    place: u64,
) -> Option<PathState> {
    // Where k_r + k_t is above 1, light may double without end. A number times no light is no light; infinity
    // would be none.
    let throughput = (arrived.throughput * share).min(Rgb::splat(f32::MAX));
    let path = arrived.path.wrapping_mul(2).wrapping_add(place);
    (throughput != Rgb::ZERO).then_some(PathState { throughput, medium, path })
}

/// What a clear surface does with its share k_t of the light.
struct Refracted {
    /// Joins the mirrored light.
    reflected: f32,
    transmitted: f32,
    /// `None` under total internal reflection.
    direction: Option<DVec3>,
}

impl Refracted {
    fn at(medium: &Refraction, boundary: Boundary, direction: DVec3, surface: &SurfacePoint) -> Self {
        if boundary.from == boundary.into {
            return Self { reflected: 0.0, transmitted: medium.transmitted, direction: Some(direction) };
        }
        let unit = direction / direction.length();
        let normal = surface.facing_normal();
        let cosine = (-unit.dot(normal)).clamp(0.0, 1.0);
        let Some(bent) = boundary.transmitted_cosine(cosine) else {
            return Self { reflected: medium.transmitted, transmitted: 0.0, direction: None };
        };
        let share = if medium.fresnel { boundary.reflectance(cosine) } else { 0.0 };
        let ratio = boundary.from / boundary.into;
        Self {
            reflected: medium.transmitted * to_f32(share),
            transmitted: medium.transmitted * to_f32(1.0 - share),
            direction: Some(unit * ratio + normal * (ratio * cosine - bent)),
        }
    }
}

/// d - 2 (d.N) N.
fn mirrored(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - normal * (2.0 * direction.dot(normal))
}
