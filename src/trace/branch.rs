//! The rays that a surface sends on: mirrored and refracted ones.

use glam::DVec3;

use super::contribution::Brightest;
use super::effects::Effects;
use super::media::{Inside, Nesting};
use super::moment::Moment;
use super::shade::to_f32;
use super::surroundings::Passage;
use super::{Boundary, PreparedScene, Ray, Refraction, Surface};
use crate::color::Rgb;

/// A ray of the tree of rays that makes a sample.
#[derive(Clone, Debug)]
pub(super) struct TreeRay {
    pub(super) ray: Ray,
    pub(super) state: PathState,
}

/// What a sample's rays carry from the camera to here.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathState {
    /// What share of the light along this ray reaches the pixel.
    pub(super) throughput: Rgb,
    /// Up to how much of the pixel's light may be left out beyond.
    pub(super) budget: f32,
    /// The clear solids it is inside of.
    pub(super) inside: Inside,
    /// The place in the tree: 1 is the camera ray, and after p the mirrored ray is 2p, the refracted one 2p + 1.
    pub(super) path: u64,
}

impl PathState {
    /// At the root of a tree.
    #[inline]
    pub(super) fn at_camera(scene: &PreparedScene, inside: Inside) -> Self {
        Self { throughput: Rgb::ONE, budget: scene.cutoff, inside, path: 1 }
    }

    /// What happens to light along the ray, over a length.
    pub(super) fn passage<E: Effects>(
        &self,
        scene: &PreparedScene,
        nesting: &Nesting,
        length: f64,
    ) -> Passage {
        let absorption = if E::NESTING { nesting.absorption(scene, self.inside) } else { Rgb::ZERO };
        if absorption == Rgb::ZERO && (!E::EXTRAS || scene.fog.density == 0.0) {
            return Passage::CLEAR;
        }
        Passage::through(absorption, &scene.fog, length)
    }
}

/// The most rays that are traced for a sample, so that time and memory have a bound whatever a scene asks for. Those beyond see
/// the background untraced, as those beyond the last generation do.
pub(super) const LARGEST_TREE: u32 = 4096;

/// What goes on from a surface.
#[derive(Debug, Default)]
pub(super) struct Branches {
    pub(super) reflected: Option<TreeRay>,
    pub(super) refracted: Option<TreeRay>,
    /// How many were left out, as they could not show.
    pub(super) cut: u64,
}

/// The continuations of a ray at a surface. Total internal reflection turns refracted light into mirrored light.
/// `generations` are left for them, 0 if they see the background untraced.
pub(super) fn branches<E: Effects>(
    moment: &Moment<'_>,
    nesting: &mut Nesting,
    (ray, arrived): (&Ray, &PathState),
    surface: &Surface,
    generations: u32,
) -> Branches {
    let Moment { scene, brightest, .. } = moment;
    let material = scene.material(surface.hit.slot);
    let mut reflected = material.reflected;
    let mut refraction = None;
    if E::MEDIA
        && let Some(medium) = &material.refraction
    {
        let beyond = nesting.through(scene, arrived.inside, surface, ray.direction());
        let (from, into) = (nesting.ior(scene, arrived.inside), nesting.ior(scene, beyond));
        let refracted = Refracted::at(medium, Boundary { from, into }, ray, surface);
        reflected += refracted.reflected;
        refraction = refracted.direction.map(|direction| (direction, refracted.transmitted, beyond));
    }

    let mut branches = Branches::default();
    let (of_reflected, of_refracted) = {
        let transmitted = refraction.as_ref().map_or(0.0, |(_, transmitted, _)| *transmitted);
        // Where k_r + k_t is above 1, light may double without end. A number times no light is no light; infinity
        // would be none.
        let throughput =
            [reflected, transmitted].map(|share| (arrived.throughput * share).min(Rgb::splat(f32::MAX)));
        let budgets = shared::<E>(brightest, throughput, generations, arrived.budget, &mut branches.cut);
        ((throughput[0], budgets[0]), (throughput[1], budgets[1]))
    };
    if let (throughput, Some(budget)) = of_reflected {
        let direction = mirrored(ray.direction(), surface.normal);
        branches.reflected = Ray::leaving(surface, surface.from_outside, direction).map(|ray| TreeRay {
            ray,
            state: PathState {
                throughput,
                budget,
                inside: arrived.inside,
                path: arrived.path.wrapping_mul(2),
            },
        });
    }
    if E::MEDIA
        && let ((throughput, Some(budget)), Some((direction, _, inside))) = (of_refracted, refraction)
    {
        branches.refracted = Ray::leaving(surface, !surface.from_outside, direction).map(|ray| TreeRay {
            ray,
            state: PathState {
                throughput,
                budget,
                inside,
                path: arrived.path.wrapping_mul(2).wrapping_add(1),
            },
        });
    }
    branches
}

/// The error budgets of two continuations; `None` for one that is not followed. They share as the roots of their sizes: in
/// proportion to the sizes, no ray would ever come nearer to its budget than the one it continues, and in equal parts those
/// that bring most would soon have none. What the lesser one does not need, because it is left out, the other one gets.
fn shared<E: Effects>(
    brightest: &Brightest,
    throughput: [Rgb; 2],
    generations: u32,
    budget: f32,
    cut: &mut u64,
) -> [Option<f32>; 2] {
    let mut alone = |throughput: Rgb, budget: f32| {
        let negligible = brightest.is_negligible(throughput, generations, budget);
        *cut += u64::from(negligible);
        (!negligible).then_some(budget)
    };
    let exists = throughput.map(|throughput| throughput != Rgb::ZERO);
    if !E::MEDIA || !exists[1] {
        return [if exists[0] { alone(throughput[0], budget) } else { None }, None];
    }
    if !exists[0] {
        return [None, alone(throughput[1], budget)];
    }
    let sizes = throughput.map(Rgb::max_element);
    let (less, more) = if sizes[0] < sizes[1] { (0, 1) } else { (1, 0) };
    let roots = sizes.map(f32::sqrt);
    let share = budget * (roots[less] / (roots[less] + roots[more]));
    let mut budgets = [None; 2];
    budgets[less] = alone(throughput[less], share);
    let spent = if budgets[less].is_some() { share } else { sizes[less] * brightest.with_left(generations) };
    budgets[more] = alone(throughput[more], budget - spent);
    budgets
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
    fn at(medium: &Refraction, boundary: Boundary, arrived: &Ray, surface: &Surface) -> Self {
        let direction = arrived.direction();
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
