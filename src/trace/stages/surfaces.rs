//! Refinement: the surface points that hits stand for, where light, a medium or a mirror asks for them.

use super::buffers::{FoundSurface, TileBuffers};
use crate::color::Rgb;
use crate::trace::effects::Effects;
use crate::trace::light::{MediumStack, PathState, RenderContext, ambient};
use crate::trace::query::{Intersector, SurfacePoint};
use crate::trace::scene::SurfaceMaterial;

/// Finds the surface points of the wave's hits, and the light there that no light source gives: the background, and ambient
/// light.
pub(super) fn surfaces(
    context: &RenderContext<'_>,
    shapes: &impl Intersector,
    buffers: &mut TileBuffers<'_>,
) {
    let scene = context.scene;
    buffers.entered.surfaces += 1;
    let TileBuffers { wave, hits, surfaces, radiance, lengths, scratch, .. } = buffers;
    surfaces.clear();
    radiance.clear();
    lengths.clear();
    for ((index, queued), hit) in (0..).zip(wave.iter()).zip(hits.iter()) {
        // Many shapes may be met at one point.
        if scratch.search.is_cancelled() {
            return;
        }
        let (ray, state) = (&queued.tree.ray, &queued.tree.state);
        let Some(closest) = hit else {
            radiance.push(scene.background.towards(ray.direction()));
            lengths.push(f64::INFINITY);
            continue;
        };
        let material = scene.material(closest.hit.id);
        if !needs_point(context, state, material) {
            radiance.push(ambient(scene, material.ambient));
            lengths.push(0.0);
            continue;
        }
        let point = scene.surface(shapes, ray, closest, &mut scratch.search);
        // Among surfaces in the same place it may be another one that is seen than the first that was met.
        let material = scene.material(point.hit.id);
        let (color, diffuse) = colors(context.effects, material, &point);
        radiance.push(ambient(scene, color));
        lengths.push(if context.effects.in_media() || context.effects.extras {
            point.distance(ray)
        } else {
            0.0
        });
        surfaces.push(FoundSurface { ray: index, point, diffuse });
    }
}

/// Says whether more is asked of what a ray meets than what it is made of.
#[inline]
fn needs_point(context: &RenderContext<'_>, state: &PathState, material: &SurfaceMaterial) -> bool {
    let lit = context.effects.lights() && !context.lights.is_empty() && material.scatters();
    let continues = (context.effects.mirrors() && material.reflected > 0.0)
        || (context.effects.media() && material.refraction.is_some());
    let in_medium = context.effects.in_media() && state.medium != MediumStack::NONE;
    let rare = context.effects.extras && (context.scene.fog.density > 0.0 || material.checker.is_some());
    lit || continues || in_medium || rare
}

/// Returns the ambient and the diffuse colour at a point.
#[inline]
fn colors(effects: Effects, material: &SurfaceMaterial, point: &SurfacePoint) -> (Rgb, Rgb) {
    if effects.extras {
        material.colors_at(point.point, point.normal)
    } else {
        (material.ambient, material.diffuse)
    }
}
