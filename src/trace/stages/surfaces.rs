//! Refinement of hits to surface points, where lighting, a medium or secondary rays need them.

use fearless_simd::{dispatch, prelude::*};

use super::buffers::TileBuffers;
use super::material_flags::MaterialFlags;
use super::tile::PACKETS;
use super::wavefront::Wavefront;
use crate::color::Rgb;
use crate::trace::intersect::{HitPacket, SurfacePacket, SurfacePoint, refine};
use crate::trace::math::{Colors, lanes};
use crate::trace::rays::RayPacket;
use crate::trace::scene::SurfaceMaterial;
use crate::trace::shading::{MediumStack, RenderContext, ambient, emission};

/// Computes the surface points of the wavefront's hits, and the radiance that does not come from light sources: background, ambient light
/// and emission.
pub(super) fn surfaces(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.stage_runs.surfaces += 1;
    let TileBuffers { wavefront, hits, surfaces, material_flags, radiance, scratch, .. } = buffers;
    let scene = wavefront.scene(context);
    let mut special = [0; PACKETS];
    dispatch!(context.scene.simd.level(), simd => {
        for packet in 0..wavefront.count {
            let found = (&mut material_flags[packet], &mut radiance[packet], &mut surfaces[packet]);
            special[packet] = find(simd, context, (wavefront, packet), &hits[packet], found);
        }
    });
    for packet in 0..wavefront.count {
        let rays = &wavefront.rays[packet];
        let (hits, surfaces) = (&mut hits[packet], &mut surfaces[packet]);
        for lane in lanes(special[packet]) {
            // Many shapes may be hit at one point.
            if scratch.search.is_cancelled() {
                return;
            }
            let Some(closest) = hits.get(lane) else { continue };
            let point = scene.surface(&rays.get(lane), &closest, &mut scratch.search);
            surfaces.set(lane, &point, hits);
            // Among coincident surfaces, the visible one can differ from the first one hit.
            let material = scene.material(point.hit.id);
            material_flags[packet].record(1 << lane, material);
            let flags = &mut material_flags[packet];
            radiance[packet].set(lane, unlit(context, material.ambient, material));
            flags.ambient.set(lane, material.ambient);
            flags.diffuse.set(lane, material.diffuse);
        }
        if context.effects.extras {
            for lane in lanes(material_flags[packet].patterned & surfaces.lanes) {
                let Some(SurfacePoint { hit, point, normal, .. }) = surfaces.get(lane, hits) else {
                    continue;
                };
                let material = scene.material(hit.id);
                let (color, diffuse) = material.colors_at(point, normal);
                let flags = &mut material_flags[packet];
                radiance[packet].set(lane, unlit(context, color, material));
                flags.ambient.set(lane, color);
                flags.diffuse.set(lane, diffuse);
            }
        }
    }
}

/// Computes the surface points of a packet. Returns the lanes whose points have to be computed one by one.
#[inline(always)]
fn find<S: Simd>(
    simd: S,
    context: &RenderContext<'_>,
    (wavefront, packet): (&Wavefront, usize),
    hits: &HitPacket,
    (material_flags, radiance, surfaces): (&mut MaterialFlags, &mut Colors, &mut SurfacePacket),
) -> u32 {
    let rays = &wavefront.rays[packet];
    surfaces.clear();
    material_flags.wanted = 0;
    let hit = hits.ids.lanes(simd) & rays.lanes;
    if hit != rays.lanes {
        background(context, rays, radiance);
    }
    if hit == 0 {
        return 0;
    }
    let scene = wavefront.scene(context);
    if let Some(id) = hits.ids.common(simd, hit) {
        let material = scene.material(id);
        let (color, diffuse) = (unlit(context, material.ambient, material), material.diffuse);
        material_flags.record(hit, material);
        material_flags.diffuse = Colors::splat(diffuse);
        if context.occludes_ambient {
            material_flags.ambient = Colors::splat(material.ambient);
        }
        if hit == rays.lanes {
            *radiance = Colors::splat(color);
        } else {
            lanes(hit).for_each(|lane| radiance.set(lane, color));
        }
        material_flags.wanted = if needs_point(context, material) { hit } else { 0 };
    } else {
        for lane in lanes(hit) {
            let Some(id) = hits.ids.get(lane) else { continue };
            let material = scene.material(id);
            material_flags.record(1 << lane, material);
            material_flags.diffuse.set(lane, material.diffuse);
            if context.occludes_ambient {
                material_flags.ambient.set(lane, material.ambient);
            }
            radiance.set(lane, unlit(context, material.ambient, material));
            material_flags.wanted |= u32::from(needs_point(context, material)) << lane;
        }
    }
    if context.effects.in_media() {
        let in_medium = |lane: &usize| wavefront.paths[packet].media[*lane] != MediumStack::NONE;
        material_flags.wanted |= lanes(hit).filter(in_medium).fold(0, |mask, lane| mask | 1 << lane);
    }
    if material_flags.wanted == 0 {
        0
    } else {
        refine(simd, scene, rays, hits, material_flags.wanted, surfaces)
    }
}

/// Returns the light of a surface that does not come from light sources: the ambient term of a colour, unless it is occluded, and the
/// emission.
#[inline(always)]
fn unlit(context: &RenderContext<'_>, color: Rgb, material: &SurfaceMaterial) -> Rgb {
    let emission = emission(context.effects, material);
    if context.occludes_ambient { emission } else { ambient(context.scene, color) + emission }
}

/// Sets the radiance of all rays of a packet to the background.
#[inline(always)]
fn background(context: &RenderContext<'_>, rays: &RayPacket, radiance: &mut Colors) {
    if let Some(color) = context.scene.constant_miss_radiance() {
        *radiance = Colors::splat(color);
    } else {
        for lane in lanes(rays.lanes) {
            radiance.set(lane, context.scene.miss_radiance(rays.directions.get(lane)));
        }
    }
}

/// Returns whether a hit on this material needs its surface point.
#[inline]
fn needs_point(context: &RenderContext<'_>, material: &SurfaceMaterial) -> bool {
    let lit = context.effects.lights() && !context.lights.is_empty() && material.scatters()
        || context.occludes_ambient && material.ambient != Rgb::ZERO;
    let continues = (context.effects.mirrors() && material.reflected > 0.0)
        || (context.effects.media() && material.refraction.is_some());
    let rare = context.effects.extras && (context.scene.fog.density > 0.0 || material.pattern.is_some());
    lit || continues || rare
}
