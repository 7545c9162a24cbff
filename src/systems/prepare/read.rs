//! Reads many entities in parallel.

use std::ops::Range;

use hecs::{Entity, View, World};
use rayon::prelude::*;

use super::clouds::{CloudParts, DrawnCloud, color_index};
use super::faults::surface_fault;
use super::material::{Surfaced, surface_material};
use super::shape::{particle_shape, prepared_shape, ray_visibility};
use crate::components::{Cloud, Material, Order, Shape, Visibility, WorldTransform};
use crate::trace::{Geometry, MaterialTable, PreparedShape, RayVisibility, ShapeId, SurfaceMaterial};

/// The number of entities or particles that a thread reads at a time.
const BATCH: usize = 4096;

/// The number of batches that are read before their results are merged, small enough for the results to stay in cache.
const BATCHES: usize = 32;

/// The components that define a surface, and the rays that see it.
type Seen<'a> = (Surfaced<'a>, Option<&'a Visibility>);

/// The entities or particles that a thread reads at a time.
enum ReadShare<'a> {
    Entities(&'a [(Order, Entity)]),
    /// Some particles of a cloud.
    Particles(Entity, Range<usize>),
}

/// The kernel data of some entities or particles. Merging empties it and keeps its memory.
#[derive(Debug, Default)]
struct Batch {
    geometry: Geometry,
    /// Materials, each with the number of consecutive shapes that have it.
    materials: Vec<(SurfaceMaterial, u32)>,
    drawn: Vec<Entity>,
    unsound: Vec<Entity>,
    /// The cloud and the particles of the batch, of which `left_out` are not drawn.
    particles: Option<(Entity, Range<usize>)>,
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
    let counts = clouds.map(|((entity, order), cloud)| ((*order, entity), cloud.positions.len()));
    let mut counts: Vec<((Order, Entity), usize)> = counts.collect();
    counts.sort_unstable_by_key(|((order, entity), _)| (*order, entity.id()));
    let shares = shares(&ordered, &counts);
    let view = world.view_mut::<(Seen<'_>, Option<&Cloud>)>();
    let mut all = VisibleShapes::default();
    let particles = counts.iter().map(|(_, count)| count).sum();
    geometry.reserve_spheres(particles);
    all.entities.reserve_exact(ordered.len() + particles);
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

/// Divides entities and clouds, both in document order, into shares in document order. Every cloud has a share, even an empty one.
fn shares<'a>(
    mut entities: &'a [(Order, Entity)],
    clouds: &[((Order, Entity), usize)],
) -> Vec<ReadShare<'a>> {
    let mut shares = Vec::new();
    for (cloud, count) in clouds {
        let key = |(order, entity): &(Order, Entity)| (*order, entity.id());
        let (before, after) = entities.split_at(entities.partition_point(|entity| key(entity) < key(cloud)));
        shares.extend(before.chunks(BATCH).map(ReadShare::Entities));
        entities = after;
        let starts = (0..(*count).max(1)).step_by(BATCH);
        shares.extend(starts.map(|start| ReadShare::Particles(cloud.1, start..(start + BATCH).min(*count))));
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
        if let Some((entity, range)) = batch.particles.take()
            && let Some(((surface, visibility), Some(cloud))) = view.get(entity)
        {
            let parts: CloudParts<'_> = (surface, cloud, visibility);
            if range.start == 0 {
                self.clouds.push(DrawnCloud::new(entity, first, parts));
            }
            if let Some(drawn) = self.clouds.last_mut() {
                let mut left_out = batch.left_out.iter().map(|particle| *particle as usize).peekable();
                for particle in range {
                    if left_out.next_if_eq(&particle).is_none() {
                        materials.push_of(&mut drawn.materials, color_index(cloud, particle));
                        drawn.drawn += 1;
                    }
                }
                drawn.left_out.append(&mut batch.left_out);
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
        self.particles = Some((entity, range.clone()));
        let visibility = ray_visibility(visibility);
        for particle in range {
            let scale =
                cloud.scales.as_ref().map_or(1.0, |scales| scales.get(particle).copied().unwrap_or(f64::NAN));
            let shape = particle_shape(surface.0, surface.1, cloud.positions[particle], scale);
            match (shape, visibility) {
                (Ok(shape), Some(visibility)) => {
                    let id = self.geometry.push(shape);
                    self.geometry.set_visibility(id, visibility);
                    self.drawn.push(entity);
                }
                _ => self.left_out.push(u32::try_from(particle).unwrap_or(u32::MAX)),
            }
        }
    }
}

/// Reads the shapes of those entities that have all components of a drawn entity, and passes each to `put`, with `None` if it is not
/// drawn. Stops and returns `None` if `put` does.
pub(super) fn read_shapes(
    world: &mut World,
    entities: &[Entity],
    mut put: impl FnMut(Entity, Option<(PreparedShape, RayVisibility)>) -> Option<()>,
) -> Option<()> {
    // Clouds are compared as a whole.
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
