//! Reads many entities in parallel.

use hecs::{Entity, View, World};
use rayon::prelude::*;

use super::faults::surface_fault;
use super::material::{Surfaced, surface_material};
use super::shape::{prepared_shape, ray_visibility};
use crate::components::{Material, Order, Shape, Visibility, WorldTransform};
use crate::trace::{Geometry, MaterialTable, PreparedShape, RayVisibility, SurfaceMaterial};

/// The number of entities that a thread reads at a time.
const BATCH: usize = 4096;

/// The number of batches that are read before their results are merged, small enough for the results to stay in cache.
const BATCHES: usize = 32;

/// The components that define a surface, and the rays that see it.
type Seen<'a> = (Surfaced<'a>, Option<&'a Visibility>);

/// The kernel data of some entities. Merging empties it and keeps its memory.
#[derive(Debug, Default)]
struct Batch {
    geometry: Geometry,
    /// Materials, each with the number of consecutive shapes that have it.
    materials: Vec<(SurfaceMaterial, u32)>,
    drawn: Vec<Entity>,
    unsound: Vec<Entity>,
}

/// The entities that are drawn.
#[derive(Debug, Default)]
pub(super) struct VisibleShapes {
    /// All drawn entities, in document order.
    pub(super) entities: Vec<Entity>,
    /// Drawn entities whose surfaces have out-of-range numbers.
    pub(super) unsound: Vec<Entity>,
}

/// Reads the shapes and materials of all entities that are drawn, in document order.
pub(super) fn read_all(
    world: &mut World,
    geometry: &mut Geometry,
    materials: &mut MaterialTable,
) -> VisibleShapes {
    let mut ordered: Vec<(Order, Entity)> = world
        .query_mut::<hecs::With<(Entity, &Order), (&Shape, &WorldTransform, &Material)>>()
        .into_iter()
        .map(|(entity, order)| (*order, entity))
        .collect();
    ordered.sort_unstable_by_key(|(order, entity)| (*order, entity.id()));
    let view = world.view_mut::<Seen<'_>>();
    let mut all = VisibleShapes::default();
    // Reading one group of batches overlaps with merging the group before it.
    let (mut before, mut batches) = (Vec::new(), Vec::new());
    for entities in ordered.chunks(BATCH * BATCHES).chain([&ordered[..0]]) {
        let read = || {
            batches.resize_with(entities.len().div_ceil(BATCH), Batch::default);
            let shares = entities.par_chunks(BATCH).zip(&mut batches);
            shares.for_each(|(entities, batch)| batch.read(&view, entities));
        };
        rayon::join(read, || before.iter_mut().for_each(|batch| all.append(batch, geometry, materials)));
        std::mem::swap(&mut before, &mut batches);
    }
    all
}

impl VisibleShapes {
    /// Merges the data of a batch and empties the batch.
    fn append(&mut self, batch: &mut Batch, geometry: &mut Geometry, materials: &mut MaterialTable) {
        geometry.append(&mut batch.geometry);
        for (material, shapes) in batch.materials.drain(..) {
            materials.push_all(material, shapes);
        }
        self.entities.append(&mut batch.drawn);
        self.unsound.append(&mut batch.unsound);
    }
}

impl Batch {
    fn read(&mut self, view: &View<'_, Seen<'_>>, entities: &[(Order, Entity)]) {
        for (_, entity) in entities {
            let Some((surface, visibility)) = view.get(*entity) else { continue };
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
}

/// Reads the shapes of those entities that have all components of a drawn entity, and passes each to `put`, with `None` if it is not
/// drawn. Stops and returns `None` if `put` does.
pub(super) fn read_shapes(
    world: &mut World,
    entities: &[Entity],
    mut put: impl FnMut(Entity, Option<(PreparedShape, RayVisibility)>) -> Option<()>,
) -> Option<()> {
    type Shaped<'a> = hecs::With<(&'a Shape, &'a WorldTransform, Option<&'a Visibility>), &'a Material>;
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
