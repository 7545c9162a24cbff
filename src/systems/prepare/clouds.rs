//! The clouds among the drawn entities.

use hecs::{Entity, World};

use super::material::{Surfaced, surface_material};
use super::shape::{prepared_shape, ray_visibility};
use crate::color::Rgb;
use crate::components::{Cloud, CloudMember, Material, Shape, Visibility, WorldTransform};
use crate::systems::FaultCause;
use crate::trace::{MaterialPalette, RayVisibility, ShapeId, SurfaceMaterial};

/// A cloud with all that its shapes were prepared from. Its columns are shared with the world.
#[derive(Clone, Debug)]
pub(super) struct DrawnCloud {
    pub(super) entity: Entity,
    /// The particles, and the rods of the bonds after them.
    pub(super) particles: DrawnRun,
    pub(super) rods: DrawnRun,
    pub(super) cloud: Cloud,
    shape: Shape,
    transform: WorldTransform,
    /// `None` if no ray sees it.
    visibility: Option<RayVisibility>,
    pub(super) materials: MaterialPalette,
}

/// Particles or rods of a cloud, by index. The slots of those that are drawn follow each other.
#[derive(Clone, Debug)]
pub(super) struct DrawnRun {
    /// The slot of the first that is drawn.
    first: ShapeId,
    pub(super) drawn: usize,
    /// Those that are not drawn, in order.
    pub(super) left_out: Vec<u32>,
}

/// The components of a cloud.
pub(super) type CloudParts<'a> = (Surfaced<'a>, &'a Cloud, Option<&'a Visibility>);

impl DrawnCloud {
    /// Creates a cloud none of whose particles is drawn yet.
    pub(super) fn new(entity: Entity, first: ShapeId, (surface, cloud, visibility): CloudParts<'_>) -> Self {
        Self {
            entity,
            particles: DrawnRun::starting_at(first),
            rods: DrawnRun::starting_at(first),
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

    /// Returns the cause for which no particle can be drawn, if it lies in the shape or the transform.
    pub(super) fn fault(&self) -> Option<FaultCause> {
        prepared_shape(&self.shape, &self.transform).err()
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

    /// Returns the drawn particles and rods: the slot and the material of each.
    pub(super) fn surfaces(&self) -> impl Iterator<Item = (ShapeId, SurfaceMaterial)> {
        let slots = self.particles.slots().chain(self.rods.slots());
        slots.filter_map(|slot| {
            let material = match self.particles.at(slot) {
                Some(particle) => color_index(&self.cloud, particle),
                None => rod_color_index(&self.cloud, self.rods.at(slot)?),
            };
            Some((slot, self.materials.materials().get(material)?.clone()))
        })
    }

    /// Returns what is drawn in a slot, if it is of this cloud.
    pub(super) fn member(&self, slot: ShapeId) -> Option<CloudMember> {
        let cloud = &self.cloud;
        if let Some(particle) = self.particles.at(slot) {
            return Some(CloudMember::Particle(cloud.number(particle)));
        }
        let (pair, _) = cloud.rod(self.rods.at(slot)?)?;
        Some(CloudMember::Bond(pair.map(|particle| cloud.number(particle))))
    }

    /// Returns the colour of what is drawn in a slot; `None` if it is that of the entity's material.
    pub(super) fn color(&self, slot: ShapeId) -> Option<Rgb> {
        let particle = match self.particles.at(slot) {
            Some(particle) => particle,
            None => {
                let (pair, end) = self.cloud.rod(self.rods.at(slot)?)?;
                match end {
                    Some(end) => pair[end],
                    None => return self.cloud.bonds.as_ref()?.color,
                }
            }
        };
        self.cloud.colors.as_ref()?.palette.get(color_index(&self.cloud, particle)).copied()
    }
}

impl DrawnRun {
    /// Creates a run of which nothing is drawn yet.
    pub(super) fn starting_at(first: ShapeId) -> Self {
        Self { first, drawn: 0, left_out: Vec::new() }
    }

    /// Returns the slot of the first that is drawn.
    pub(super) fn first(&self) -> ShapeId {
        self.first
    }

    fn slots(&self) -> impl Iterator<Item = ShapeId> {
        (self.first.0..).map(ShapeId).take(self.drawn)
    }

    /// Returns the index of what is drawn in a slot, if it is one of these.
    fn at(&self, slot: ShapeId) -> Option<usize> {
        let drawn = slot.index().checked_sub(self.first.index()).filter(|index| *index < self.drawn)?;
        // The number of those that are left out before it, each of which moves it on by one.
        let (mut least, mut most) = (0, self.left_out.len());
        while least < most {
            let middle = least.midpoint(most);
            if self.left_out[middle] as usize - middle <= drawn {
                least = middle + 1;
            } else {
                most = middle;
            }
        }
        Some(drawn + least)
    }
}

/// Returns the index of a rod's material: that of the particle at its end, or that of all bonds, which is the last.
pub(super) fn rod_color_index(cloud: &Cloud, rod: usize) -> usize {
    match cloud.rod(rod) {
        Some((pair, Some(end))) => color_index(cloud, pair[end]),
        _ if cloud.bonds.as_ref().is_some_and(|bonds| bonds.color.is_some()) => {
            cloud.colors.as_ref().map_or(1, |colors| colors.palette.len().max(1))
        }
        _ => 0,
    }
}

/// Returns the index of a particle's material.
pub(super) fn color_index(cloud: &Cloud, particle: usize) -> usize {
    cloud.colors.as_ref().map_or(0, |colors| {
        let index = colors.indices.get(particle).copied().unwrap_or(0);
        usize::from(index).min(colors.palette.len().saturating_sub(1))
    })
}

/// Returns the materials of a cloud: one for each colour, or one alone, and then that of bonds with a colour of their own.
fn materials(surface: Surfaced<'_>, cloud: &Cloud) -> Vec<SurfaceMaterial> {
    let (shape, transform, material, specular, reflective, refractive, pattern, emission) = surface;
    let painted = |material: &Material| {
        surface_material((shape, transform, material, specular, reflective, refractive, pattern, emission))
    };
    let colored = |color: &Rgb| painted(&Material { color: *color, ..*material });
    let mut materials: Vec<SurfaceMaterial> = match &cloud.colors {
        Some(colors) if !colors.palette.is_empty() => colors.palette.iter().map(colored).collect(),
        _ => vec![painted(material)],
    };
    materials.extend(cloud.bonds.iter().filter_map(|bonds| bonds.color.as_ref()).map(colored));
    materials
}
