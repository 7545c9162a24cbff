//! Stage 3: from hits to points that lie on their surfaces, where more than ambient light is asked of them. Rays that met
//! nothing see the background.

use super::buffers::{Found, TileBuffers};
use crate::color::Rgb;
use crate::trace::effects::Effects;
use crate::trace::geometry::Leaves;
use crate::trace::media::Inside;
use crate::trace::moment::Moment;
use crate::trace::shade::ambient;
use crate::trace::surroundings::Passage;

pub(super) fn run<E: Effects>(moment: &Moment<'_>, leaves: &impl Leaves, buffers: &mut TileBuffers) {
    let TileBuffers { rays, hits, light, passages, found, scratch, .. } = buffers;
    let scene = moment.scene;
    let lit = E::LIGHTS && scene.lights.iter().any(|light| light.intensity != Rgb::ZERO);
    let hazy = E::RARE && scene.fog.density > 0.0;
    let has_passages = E::NESTING || E::RARE;
    found.clear();
    light.clear();
    passages.clear();
    for (index, (queued, hit)) in rays.iter().zip(hits.iter()).enumerate() {
        let tree = &queued.tree;
        let Some(closest) = hit else {
            light.push(scene.background.towards(tree.ray.direction()));
            if has_passages {
                passages.push(tree.passage::<E>(scene, &scratch.nesting, f64::INFINITY));
            }
            continue;
        };
        let material = scene.material(closest.hit.slot);
        let in_medium = E::NESTING && tree.inside != Inside::NONE;
        let continues =
            (E::MIRRORS && material.reflected > 0.0) || (E::MEDIA && material.refraction.is_some());
        let checkered = E::RARE && material.checker.is_some();
        if (lit && material.scatters()) || continues || in_medium || hazy || checkered {
            let surface = scene.surface(leaves, &tree.ray, closest, &mut scratch.guards);
            // Among surfaces in the same place it may be another one that is seen.
            let material = scene.material(surface.hit.slot);
            let (color, diffuse) =
                if E::RARE { material.colors_at(&surface) } else { (material.ambient, material.diffuse) };
            light.push(ambient(scene, color));
            if has_passages {
                let length = surface.distance(&tree.ray);
                passages.push(tree.passage::<E>(scene, &scratch.nesting, length));
            }
            found.push(Found { ray: index, surface, diffuse });
        } else {
            light.push(ambient(scene, material.ambient));
            if has_passages {
                passages.push(Passage::CLEAR);
            }
        }
    }
}
