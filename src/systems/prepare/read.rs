//! Reads many entities in parallel.

use std::ops::Range;

use hecs::{Entity, View, World};
use rayon::prelude::*;

use super::clouds::{CloudParts, DrawnCloud, DrawnRun, color_index, rod_color_index};
use super::faults::surface_fault;
use super::material::{Surfaced, surface_material};
use super::shape::{bond_shape, particle_shape, prepared_shape, ray_visibility};
use crate::components::{Cloud, Material, Order, Shape, Visibility, WorldTransform};
use crate::trace::{Geometry, MaterialTable, PreparedShape, RayVisibility, ShapeId, SurfaceMaterial};

/// The number of entities or particles that a thread reads at a time.
const BATCH: usize = 4096;

/// The number of batches that are read before their results are merged, small enough for the results to stay in cache.
const BATCHES: usize = 32;

/// The components that define a surface, and the rays that see it.
type Seen<'a> = (Surfaced<'a>, Option<&'a Visibility>);

/// The entities, particles or bonds that a thread reads at a time.
enum ReadShare<'a> {
    Entities(&'a [(Order, Entity)]),
    /// Some particles of a cloud.
    Particles(Entity, Range<usize>),
    /// Some bonds of a cloud, after all of its particles.
    Bonds(Entity, Range<usize>),
}

/// The particles of a cloud, or the rods of its bonds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Copies {
    Particles,
    Rods,
}

/// The kernel data of some entities, particles or bonds. Merging empties it and keeps its memory.
#[derive(Debug, Default)]
struct Batch {
    geometry: Geometry,
    /// Materials, each with the number of consecutive shapes that have it.
    materials: Vec<(SurfaceMaterial, u32)>,
    drawn: Vec<Entity>,
    unsound: Vec<Entity>,
    /// The cloud, and the particles or rods of the batch, of which `left_out` are not drawn.
    copies: Option<(Entity, Copies, Range<usize>)>,
    left_out: Vec<u32>,
}

/// The entities that are drawn.
#[derive(Debug, Default)]
pub(super) struct VisibleShapes {
    /// All drawn entities, in document order.
    pub(super) entities: Vec<Entity>,
    /// All clouds, in document order.
    pub(super) clouds: Vec<DrawnCloud>,
    /// Drawn entities whose surfaces have out-of-range numbers.
    pub(super) unsound: Vec<Entity>,
}

/// Reads the shapes and materials of all entities that are drawn, in document order.
pub(super) fn read_all(
    world: &mut World,
    geometry: &mut Geometry,
    materials: &mut MaterialTable,
) -> VisibleShapes {
    type Drawn<'a> = hecs::With<(Entity, &'a Order), (&'a Shape, &'a WorldTransform, &'a Material)>;
    let entities = world.query_mut::<hecs::Without<Drawn<'_>, &Cloud>>().into_iter();
    let ordered = in_order(entities.map(|(entity, order)| (*order, entity)));
    let clouds = world.query_mut::<(Drawn<'_>, &Cloud)>().into_iter();
    let counts = clouds.map(|((entity, order), cloud)| CloudSize {
        key: (*order, entity),
        particles: cloud.positions.len(),
        bonds: cloud.bond_count(),
        rods_per_bond: cloud.rods_per_bond(),
    });
    let mut counts: Vec<CloudSize> = counts.collect();
    counts.sort_unstable_by_key(|CloudSize { key: (order, entity), .. }| (*order, entity.id()));
    let shares = shares(&ordered, &counts);
    let view = world.view_mut::<(Seen<'_>, Option<&Cloud>)>();
    let mut all = VisibleShapes::default();
    let particles = counts.iter().map(|size| size.particles).sum();
    geometry.reserve_spheres(particles);
    let rods: usize = counts.iter().map(|size| size.bonds * size.rods_per_bond).sum();
    all.entities.reserve_exact(ordered.len() + particles + rods);
    // Reading one group of batches overlaps with merging the group before it.
    let (mut before, mut batches) = (Vec::new(), Vec::new());
    for shares in shares.chunks(BATCHES).chain([&shares[..0]]) {
        let read = || {
            batches.resize_with(shares.len(), Batch::default);
            shares.par_iter().zip(&mut batches).for_each(|(share, batch)| batch.read(&view, share));
        };
        rayon::join(read, || {
            before.iter_mut().for_each(|batch| all.append(batch, &view, geometry, materials));
        });
        std::mem::swap(&mut before, &mut batches);
    }
    all
}

fn in_order(entities: impl Iterator<Item = (Order, Entity)>) -> Vec<(Order, Entity)> {
    let mut ordered: Vec<(Order, Entity)> = entities.collect();
    ordered.sort_unstable_by_key(|(order, entity)| (*order, entity.id()));
    ordered
}

/// The numbers of the particles and bonds of a cloud.
struct CloudSize {
    key: (Order, Entity),
    particles: usize,
    bonds: usize,
    rods_per_bond: usize,
}

/// Divides entities and clouds, both in document order, into shares in document order. Every cloud has a share, even an empty one.
fn shares<'a>(mut entities: &'a [(Order, Entity)], clouds: &[CloudSize]) -> Vec<ReadShare<'a>> {
    let mut shares = Vec::new();
    let batches = |count: usize| {
        let starts = (0..count).step_by(BATCH);
        starts.map(move |start| start..(start + BATCH).min(count))
    };
    for CloudSize { key: cloud, particles, bonds, .. } in clouds {
        let key = |(order, entity): &(Order, Entity)| (*order, entity.id());
        let (before, after) = entities.split_at(entities.partition_point(|entity| key(entity) < key(cloud)));
        shares.extend(before.chunks(BATCH).map(ReadShare::Entities));
        entities = after;
        shares.extend((*particles == 0).then_some(ReadShare::Particles(cloud.1, 0..0)));
        shares.extend(batches(*particles).map(|range| ReadShare::Particles(cloud.1, range)));
        shares.extend(batches(*bonds).map(|range| ReadShare::Bonds(cloud.1, range)));
    }
    shares.extend(entities.chunks(BATCH).map(ReadShare::Entities));
    shares
}

impl VisibleShapes {
    /// Merges the data of a batch and empties the batch.
    fn append(
        &mut self,
        batch: &mut Batch,
        view: &View<'_, (Seen<'_>, Option<&Cloud>)>,
        geometry: &mut Geometry,
        materials: &mut MaterialTable,
    ) {
        let first = ShapeId(u32::try_from(geometry.len()).unwrap_or(u32::MAX));
        geometry.append(&mut batch.geometry);
        for (material, shapes) in batch.materials.drain(..) {
            materials.push_all(material, shapes);
        }
        if let Some((entity, copies, range)) = batch.copies.take()
            && let Some(((surface, visibility), Some(cloud))) = view.get(entity)
        {
            let parts: CloudParts<'_> = (surface, cloud, visibility);
            if range.start == 0 && copies == Copies::Particles {
                self.clouds.push(DrawnCloud::new(entity, first, parts));
            }
            if let Some(drawn) = self.clouds.last_mut() {
                if range.start == 0 && copies == Copies::Rods {
                    drawn.rods = DrawnRun::starting_at(first);
                }
                let (run, color_index): (_, fn(&Cloud, usize) -> usize) = match copies {
                    Copies::Particles => (&mut drawn.particles, color_index),
                    Copies::Rods => (&mut drawn.rods, rod_color_index),
                };
                let mut left_out = batch.left_out.iter().map(|copy| *copy as usize).peekable();
                for copy in range {
                    if left_out.next_if_eq(&copy).is_none() {
                        materials.push_of(&mut drawn.materials, color_index(cloud, copy));
                        run.drawn += 1;
                    }
                }
                run.left_out.append(&mut batch.left_out);
            }
        }
        self.entities.append(&mut batch.drawn);
        self.unsound.append(&mut batch.unsound);
    }
}

impl Batch {
    fn read(&mut self, view: &View<'_, (Seen<'_>, Option<&Cloud>)>, share: &ReadShare<'_>) {
        match share {
            ReadShare::Entities(entities) => self.read_entities(view, entities),
            ReadShare::Particles(entity, range) => self.read_particles(view, *entity, range.clone()),
            ReadShare::Bonds(entity, range) => self.read_bonds(view, *entity, range.clone()),
        }
    }

    fn read_entities(&mut self, view: &View<'_, (Seen<'_>, Option<&Cloud>)>, entities: &[(Order, Entity)]) {
        for (_, entity) in entities {
            let Some(((surface, visibility), _)) = view.get(*entity) else { continue };
            let Some(visibility) = ray_visibility(visibility) else { continue };
            let Ok(shape) = prepared_shape(surface.0, surface.1) else { continue };
            let id = self.geometry.push(shape);
            self.geometry.set_visibility(id, visibility);
            self.drawn.push(*entity);
            let material = surface_material(surface);
            match self.materials.last_mut() {
                Some((last, shapes)) if *last == material => *shapes += 1,
                _ => self.materials.push((material, 1)),
            }
            if surface_fault(*entity, surface).is_some() {
                self.unsound.push(*entity);
            }
        }
    }

    fn read_particles(
        &mut self,
        view: &View<'_, (Seen<'_>, Option<&Cloud>)>,
        entity: Entity,
        range: Range<usize>,
    ) {
        let Some(((surface, visibility), Some(cloud))) = view.get(entity) else { return };
        if range.start == 0 && surface_fault(entity, surface).is_some() {
            self.unsound.push(entity);
        }
        self.copies = Some((entity, Copies::Particles, range.clone()));
        let visibility = ray_visibility(visibility);
        for particle in range {
            let shape = shape_of(particle, surface, cloud).zip(visibility);
            self.push_copy(entity, particle, shape);
        }
    }

    fn read_bonds(
        &mut self,
        view: &View<'_, (Seen<'_>, Option<&Cloud>)>,
        entity: Entity,
        range: Range<usize>,
    ) {
        let Some(((surface, visibility), Some(cloud))) = view.get(entity) else { return };
        let Some(bonds) = &cloud.bonds else { return };
        let rods = cloud.rods_per_bond();
        self.copies = Some((entity, Copies::Rods, range.start * rods..range.end * rods));
        let visibility = ray_visibility(visibility);
        for bond in range {
            let pair = bonds.pairs[bond].map(|particle| particle as usize);
            let is_drawn = pair.iter().all(|particle| shape_of(*particle, surface, cloud).is_some());
            let ends = || pair.map(|particle| cloud.positions[particle]);
            let half = |half| bond_shape(surface.1, bonds.radius, ends(), half).ok();
            // Both halves, or none.
            let shapes = match (is_drawn, rods) {
                (false, _) => [None; 2],
                (true, 1) => [half(None), None],
                (true, _) => half(Some(0))
                    .zip(half(Some(1)))
                    .map_or([None; 2], |(one, other)| [Some(one), Some(other)]),
            };
            for (rod, shape) in (bond * rods..).zip(shapes).take(rods) {
                self.push_copy(entity, rod, shape.zip(visibility));
            }
        }
    }

    /// Adds a particle or a rod, which is left out without a shape.
    fn push_copy(&mut self, entity: Entity, copy: usize, shape: Option<(PreparedShape, RayVisibility)>) {
        match shape {
            Some((shape, visibility)) => {
                let id = self.geometry.push(shape);
                self.geometry.set_visibility(id, visibility);
                self.drawn.push(entity);
            }
            None => self.left_out.push(u32::try_from(copy).unwrap_or(u32::MAX)),
        }
    }
}

/// Returns the shape of a particle, if it can be drawn.
fn shape_of(particle: usize, surface: Surfaced<'_>, cloud: &Cloud) -> Option<PreparedShape> {
    let scale = match &cloud.scales {
        Some(scales) => *scales.get(particle)?,
        None => 1.0,
    };
    particle_shape(surface.0, surface.1, *cloud.positions.get(particle)?, scale).ok()
}

/// Reads the shapes of those entities that have all components of a drawn entity and are no clouds, and passes each to `put`, with `None` if it is not
/// drawn. Stops and returns `None` if `put` does.
pub(super) fn read_shapes(
    world: &mut World,
    entities: &[Entity],
    mut put: impl FnMut(Entity, Option<(PreparedShape, RayVisibility)>) -> Option<()>,
) -> Option<()> {
    // Clouds are compared as a whole: see `DrawnCloud::has_same_shapes`.
    type Shaped<'a> = hecs::Without<
        hecs::With<(&'a Shape, &'a WorldTransform, Option<&'a Visibility>), &'a Material>,
        &'a Cloud,
    >;
    let view = world.view_mut::<Shaped<'_>>();
    let read = |entity: &Entity| {
        let (shape, transform, visibility) = view.get(*entity)?;
        let visibility = ray_visibility(visibility);
        Some((*entity, prepared_shape(shape, transform).ok().zip(visibility)))
    };
    let mut shapes = Vec::new();
    for entities in entities.chunks(BATCH) {
        entities.par_iter().with_min_len(BATCH / BATCHES).map(read).collect_into_vec(&mut shapes);
        for (entity, shape) in shapes.drain(..).flatten() {
            put(entity, shape)?;
        }
    }
    Some(())
}
