//! Refraction at sixteen transparent surfaces: the operations of [`secondary_rays`](super::secondary_rays), in the same order.

use fearless_simd::{f32x16, prelude::*};
use glam::DVec3;

use super::dielectric::{Boundary, incidence};
use super::facing_normals::facing_normals;
use super::medium_stack::{MediumStack, MediumStacks};
use super::path_packet::PathPacket;
use super::terms::{length, over};
use crate::trace::intersect::{HitPacket, SurfacePacket};
use crate::trace::math::{LANES, Numbers, Vectors, bits, half_lanes, half_of, lanes, mask, moderate, splat};
use crate::trace::rays::{RayPacket, ShapeId};
use crate::trace::scene::{self, PreparedScene};

/// The refraction at transparent surfaces, lane by lane.
#[derive(Clone, Debug)]
pub(super) struct RefractionPacket {
    /// Share of the light that is refracted.
    pub(super) transmitted: [f32; LANES],
    /// Directions of the refracted rays, of any length except zero.
    pub(super) directions: Vectors,
    /// Transparent solids that contain the refracted rays.
    pub(super) beyond: [MediumStack; LANES],
    /// Lanes with refracted rays.
    pub(super) lanes: u32,
    /// Lanes left to the scalar function.
    pub(super) escalated: u32,
}

/// The media on both sides of surfaces, lane by lane.
struct Media {
    /// Refractive indices on the side of the arriving ray, `from`, and on the other side, `into`.
    from: Numbers,
    into: Numbers,
    /// k_t.
    transmitted: [f32; LANES],
    /// Lanes in which Fresnel's equations give the reflectance.
    fresnel: u32,
}

/// The media on both sides of a transparent surface.
#[derive(Clone, Copy)]
struct MediumBoundary {
    /// Transparent solids that contain a ray behind the surface.
    beyond: MediumStack,
    /// Refractive indices on the side of the arriving ray, `from`, and on the other side, `into`.
    from: f64,
    into: f64,
    refraction: scene::Refraction,
}

impl MediumBoundary {
    /// Returns the boundary at which a ray in medium `arrived` enters or leaves a shape. `None` if the shape is not transparent or has
    /// equal shapes.
    fn of(
        (scene, media): (&PreparedScene, &mut MediumStacks),
        (id, arrived, entering): (Option<ShapeId>, MediumStack, bool),
    ) -> Option<Self> {
        let id = id.filter(|id| scene.equal_shapes.group(*id).is_none())?;
        let refraction = scene.material(id).refraction?;
        let beyond = if entering { media.entered(arrived, id) } else { media.left(arrived, id) };
        let (from, into) = (media.ior(scene, arrived), media.ior(scene, beyond));
        Some(Self { beyond, from, into, refraction })
    }
}

impl RefractionPacket {
    /// Computes the refraction at the surfaces in lanes `transparent`, all of them transparent. Light that they mirror is added to `reflected`.
    #[inline(always)]
    pub(super) fn at<S: Simd>(
        simd: S,
        (scene, media): (&PreparedScene, &mut MediumStacks),
        (rays, paths): (&RayPacket, &PathPacket),
        (hits, surfaces): (&HitPacket, &SurfacePacket),
        transparent: u32,
        reflected: &mut [f32; LANES],
    ) -> Self {
        let mut refraction = Self {
            transmitted: [0.0; LANES],
            directions: Vectors::splat(DVec3::ONE),
            beyond: [MediumStack::NONE; LANES],
            lanes: 0,
            escalated: 0,
        };
        if transparent != 0 {
            let boundaries = refraction.gather((scene, media), paths, (hits, surfaces), transparent);
            let in_range = transparent & !refraction.escalated;
            refraction.refract(simd, rays, surfaces, &boundaries, in_range, reflected);
        }
        refraction
    }

    /// Collects the media on both sides of transparent surfaces.
    fn gather(
        &mut self,
        (scene, media): (&PreparedScene, &mut MediumStacks),
        paths: &PathPacket,
        (hits, surfaces): (&HitPacket, &SurfacePacket),
        transparent: u32,
    ) -> Media {
        let one = Numbers::splat(1.0);
        let mut found = Media { from: one, into: one, transmitted: [0.0; LANES], fresnel: 0 };
        let mut last = None;
        for lane in lanes(transparent) {
            let bit = 1 << lane;
            let crossing = (hits.ids.get(lane), paths.media[lane], surfaces.from_outside & bit != 0);
            // Neighbouring rays usually cross the same surface from the same side.
            let boundary = match last {
                Some((before, boundary)) if before == crossing => boundary,
                _ => MediumBoundary::of((scene, media), crossing),
            };
            last = Some((crossing, boundary));
            let Some(MediumBoundary { beyond, from, into, refraction }) = boundary else {
                self.escalated |= bit;
                continue;
            };
            self.beyond[lane] = beyond;
            found.from.set(lane, from);
            found.into.set(lane, into);
            found.transmitted[lane] = refraction.transmitted;
            found.fresnel |= if refraction.fresnel { bit } else { 0 };
        }
        found
    }

    /// Computes the refracted shares and directions by Snell's law and Fresnel's equations, as [`Boundary`](super::dielectric::Boundary)
    /// does.
    #[inline(always)]
    fn refract<S: Simd>(
        &mut self,
        simd: S,
        rays: &RayPacket,
        surfaces: &SurfacePacket,
        Media { from, into, transmitted, fresnel }: &Media,
        transparent: u32,
        reflected: &mut [f32; LANES],
    ) {
        let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
        let mut mirrored = Numbers::splat(0.0);
        for half in 0..2 {
            if half_of(transparent, half) == 0 {
                continue;
            }
            let (from, into) = (from.load(simd, half), into.load(simd, half));
            let direction = rays.directions.load(simd, half);
            let (unit, normal) = (over(direction, length(direction)), facing_normals(simd, surfaces, half));
            let (boundary, cosine) = (Boundary { from, into }, incidence(unit, normal));
            let (bent, passes) = boundary.refraction(cosine);
            let share = boundary.partial_reflectance(cosine, bent);
            let by_fresnel = mask(simd, *fresnel, half).select(share, zero);
            // Equal indices mirror nothing; total internal reflection mirrors everything.
            let same = from.simd_eq(into);
            mirrored.store(half, same.select(zero, passes.select(by_fresnel, one)));
            let refracted = boundary.refracted(unit, normal, cosine, bent);
            for axis in 0..3 {
                let along = same.select(direction[axis], refracted[axis]);
                self.directions.axis_mut(axis).store(half, along);
            }
            // Numbers of other sizes may make the products inexact.
            let in_range = same | (moderate(cosine) & moderate(from * from) & moderate(into * into));
            let here = transparent & half_lanes(half);
            self.escalated |= here & !bits(in_range, half);
            self.lanes |= here & bits(in_range & (same | passes), half);
        }
        let transmitted = f32x16::load_array_ref(simd, transmitted);
        let rest = [one - mirrored.load(simd, 0), one - mirrored.load(simd, 1)];
        let mirrored = transmitted * mirrored.rounded(simd);
        (f32x16::load_array_ref(simd, reflected) + mirrored).store_array(reflected);
        (transmitted * rest[0].narrow(rest[1])).store_array(&mut self.transmitted);
    }
}
