//! The clouds among the drawn entities.

use hecs::{Entity, World};

use super::material::{Surfaced, surface_material};
use super::shape::ray_visibility;
use crate::components::{Cloud, Material, Shape, Visibility, WorldTransform};
use crate::trace::{MaterialPalette, RayVisibility, ShapeId, SurfaceMaterial};

/// A cloud with all that its shapes were prepared from. Its columns are shared with the world.
#[derive(Clone, Debug)]
pub(super) struct DrawnCloud {
    pub(super) entity: Entity,
    /// The slot of the first drawn particle, and the number of drawn particles, whose slots follow each other.
    pub(super) first: ShapeId,
    pub(super) drawn: usize,
    /// The particles that are not drawn, by index.
    pub(super) left_out: Vec<u32>,
    pub(super) cloud: Cloud,
    shape: Shape,
    transform: WorldTransform,
    /// `None` if no ray sees it.
    visibility: Option<RayVisibility>,
    pub(super) materials: MaterialPalette,
}

/// The components of a cloud.
pub(super) type CloudParts<'a> = (Surfaced<'a>, &'a Cloud, Option<&'a Visibility>);

impl DrawnCloud {
    /// Creates a cloud none of whose particles is drawn yet.
    pub(super) fn new(entity: Entity, first: ShapeId, (surface, cloud, visibility): CloudParts<'_>) -> Self {
        Self {
            entity,
            first,
            drawn: 0,
            left_out: Vec::new(),
            cloud: cloud.clone(),
            shape: *surface.0,
            transform: *surface.1,
            visibility: ray_visibility(visibility),
            materials: MaterialPalette::new(materials(surface, cloud)),
        }
    }

    /// Returns whether the world has the cloud with the same shapes still.
    pub(super) fn has_same_shapes(&self, world: &World) -> bool {
        let mut query = world.query_one::<CloudParts<'_>>(self.entity);
        query.get().is_ok_and(|(surface, cloud, visibility)| {
            let is_same = (surface.0, surface.1) == (&self.shape, &self.transform);
            is_same && ray_visibility(visibility) == self.visibility && cloud.shares_shapes(&self.cloud)
        })
    }

    /// Takes the colours over from the world. Returns whether they differ.
    pub(super) fn repaint(&mut self, world: &World) -> bool {
        let mut query = world.query_one::<CloudParts<'_>>(self.entity);
        let Ok((surface, cloud, _)) = query.get() else { return false };
        let materials = materials(surface, cloud);
        let differs = !cloud.shares_colors(&self.cloud) || materials != self.materials.materials();
        self.cloud = cloud.clone();
        if differs {
            self.materials = MaterialPalette::new(materials);
        }
        differs
    }

    /// Returns the drawn particles by slot: the slot and the material of each.
    pub(super) fn surfaces(&self) -> impl Iterator<Item = (ShapeId, SurfaceMaterial)> {
        let slots = (self.first.0..).map(ShapeId).take(self.drawn);
        slots.filter_map(|slot| Some((slot, self.material(self.particle(slot)?)?)))
    }

    fn material(&self, particle: usize) -> Option<SurfaceMaterial> {
        self.materials.materials().get(color_index(&self.cloud, particle)).cloned()
    }

    /// Returns the index of the particle in a slot, if it is one of this cloud.
    pub(super) fn particle(&self, slot: ShapeId) -> Option<usize> {
        let mut particle =
            slot.index().checked_sub(self.first.index()).filter(|index| *index < self.drawn)?;
        // Every particle that is left out before it moves it on by one.
        for left_out in &self.left_out {
            if *left_out as usize > particle {
                break;
            }
            particle += 1;
        }
        Some(particle)
    }
}

/// Returns the index of a particle's material.
pub(super) fn color_index(cloud: &Cloud, particle: usize) -> usize {
    cloud.colors.as_ref().map_or(0, |colors| {
        let index = colors.indices.get(particle).copied().unwrap_or(0);
        usize::from(index).min(colors.palette.len().saturating_sub(1))
    })
}

/// Returns the materials of a cloud: one for each colour, or one alone.
fn materials(surface: Surfaced<'_>, cloud: &Cloud) -> Vec<SurfaceMaterial> {
    let (shape, transform, material, specular, reflective, refractive, pattern, emission) = surface;
    let painted = |material: &Material| {
        surface_material((shape, transform, material, specular, reflective, refractive, pattern, emission))
    };
    match &cloud.colors {
        Some(colors) if !colors.palette.is_empty() => {
            colors.palette.iter().map(|color| painted(&Material { color: *color, ..*material })).collect()
        }
        _ => vec![painted(material)],
    }
}
