//! Stage 6: the rays that this wave's surfaces send on.

use super::buffers::{QueuedRay, TileBuffers};
use crate::trace::branch::{Branches, LARGEST_TREE, branches};
use crate::trace::effects::Effects;
use crate::trace::moment::Moment;

/// Makes the next wave out of this one's mirrors and clear surfaces. `generations` are left for it.
pub(super) fn run<E: Effects>(moment: &Moment<'_>, generations: u32, buffers: &mut TileBuffers) {
    let TileBuffers { rays, found, next, beyond, tree_sizes, scratch, rays_traced, trees_ended, .. } =
        buffers;
    next.clear();
    for point in found.iter() {
        if !moment.scene.material(point.surface.hit.slot).continues() {
            continue;
        }
        let QueuedRay { tree, pixel } = &rays[point.ray];
        let Branches { reflected, refracted, cut } =
            branches::<E>(moment, &mut scratch.nesting, tree, &point.surface, generations);
        trees_ended.cutoff += cut;
        let size = &mut tree_sizes[*pixel as usize];
        for (tree, traced) in
            [(reflected, &mut rays_traced.reflection), (refracted, &mut rays_traced.refraction)]
        {
            let Some(tree) = tree else { continue };
            let queued = QueuedRay { tree, pixel: *pixel };
            if generations > 0 && *size < LARGEST_TREE {
                *size += 1;
                *traced += 1;
                next.push(queued);
            } else {
                beyond.push(queued);
            }
        }
    }
    std::mem::swap(rays, next);
}

/// Rays that are not traced see the background.
pub(super) fn give_up(moment: &Moment<'_>, buffers: &mut TileBuffers) {
    let TileBuffers { beyond, pixels, trees_ended, .. } = buffers;
    for QueuedRay { tree, pixel } in beyond.iter() {
        let background = moment.scene.background.towards(tree.ray.direction());
        pixels[*pixel as usize] += tree.throughput * background;
    }
    trees_ended.depth += beyond.len() as u64;
    beyond.clear();
}
