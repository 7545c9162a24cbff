//! Stage 4: light by light the shadow rays and what they let through.

use super::buffers::{Tile, TileBuffers};
use crate::color::Rgb;
use crate::trace::direct::{Lit, from_light};
use crate::trace::effects::Effects;
use crate::trace::geometry::Leaves;
use crate::trace::moment::Moment;
use crate::trace::sampler::PixelSamples;
use crate::trace::shadow::visibility;

pub(super) fn run<E: Effects>(
    moment: &Moment<'_>,
    leaves: &impl Leaves,
    (tile, sample): (Tile, u32),
    buffers: &mut TileBuffers,
) {
    let TileBuffers { rays, found, light, scratch, rays_traced, .. } = buffers;
    let scene = moment.scene;
    for (index, source) in scene.lights.iter().enumerate() {
        if source.intensity == Rgb::ZERO {
            continue;
        }
        for point in found.iter() {
            let queued = &rays[point.ray];
            let (i, j) = tile.pixel(queued.pixel);
            let lit = Lit {
                arrived: &queued.tree,
                surface: &point.surface,
                diffuse: point.diffuse,
                pixel: PixelSamples::new(moment.sampling.seed, i, j),
                sample,
            };
            light[point.ray] += from_light::<E>(scene, (index, source), &lit, |incidence| {
                rays_traced.shadow += 1;
                let seen = (lit.surface, lit.arrived.inside);
                visibility::<E>(scene, leaves, incidence, source.own_shape, seen, scratch)
            });
        }
    }
}
