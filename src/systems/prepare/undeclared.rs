//! Finds changes of the world that systems did not declare, so that the kernel's data are out of date.
//!
//! The world is never updated here: builds with and without the check give the same images.

use hecs::{Component, Entity, EntityBuilder, EntityRef, World};

use super::Preparation;
use super::material::{Surfaced, surface_material};
use super::shape::{prepared_shape, ray_visibility};
use crate::components::{Parent, Transform, Visibility, WorldTransform};
use crate::systems::{Changes, Consequence, Fault, FaultCause, UndeclaredChange, propagate};

impl Preparation {
    /// Reports the entities that are as they were before a change.
    pub(super) fn undeclared_changes(&self, world: &World, faults: &mut Vec<Fault>) {
        let expected = propagated(world);
        let has_moved = |entity: Entity, stored: &WorldTransform| {
            let moved = expected.get::<&WorldTransform>(entity);
            // Transforms that are not finite equal nothing.
            moved.is_ok_and(|moved| moved.affine.is_finite() && moved.affine != stored.affine)
        };
        let mut placed = world.query::<(Entity, &WorldTransform)>();
        let moved = placed.iter().filter(|(entity, stored)| has_moved(*entity, stored));
        let moved: Vec<Entity> = moved.map(|(entity, _)| entity).collect();
        let changed = self.entities.iter().filter(|entity| !moved.contains(entity));
        let changed = changed.filter_map(|entity| Some((*entity, self.undeclared_change(world, *entity)?)));
        let moved = moved.iter().map(|entity| (*entity, UndeclaredChange::Transform));
        faults.extend(moved.chain(changed).map(|(entity, change)| Fault {
            entity,
            consequence: Consequence::OutOfDate,
            cause: FaultCause::UndeclaredChange(change),
        }));
    }

    /// Returns the undeclared change of an entity that is drawn and has not moved.
    fn undeclared_change(&self, world: &World, entity: Entity) -> Option<UndeclaredChange> {
        let slot = self.slots.get(entity)?;
        let mut query = world.query_one::<Surfaced<'_>>(entity);
        let Ok(surface) = query.get() else { return Some(UndeclaredChange::Removal) };
        let shape = prepared_shape(surface.0, surface.1);
        if !shape.is_ok_and(|shape| self.scene.geometry().holds(slot, &shape)) {
            return Some(UndeclaredChange::Shape);
        }
        let visibility = ray_visibility(world.get::<&Visibility>(entity).ok().as_deref());
        if visibility != Some(self.scene.geometry().visibility(slot)) {
            return Some(UndeclaredChange::Visibility);
        }
        let (stored, material) = (self.scene.material(slot), surface_material(surface));
        // A pattern that is not a number equals nothing, but is written the same.
        let differs = *stored != material && format!("{stored:?}") != format!("{material:?}");
        differs.then_some(UndeclaredChange::Material)
    }
}

/// Returns a copy of the world's transforms, propagated.
fn propagated(world: &World) -> World {
    fn add<T: Component + Copy>(entity: EntityRef<'_>, builder: &mut EntityBuilder) {
        if let Some(component) = entity.get::<&T>() {
            builder.add(*component);
        }
    }
    let (mut copy, mut builder) = (World::new(), EntityBuilder::new());
    for entity in world {
        add::<Transform>(entity, &mut builder);
        add::<Parent>(entity, &mut builder);
        add::<WorldTransform>(entity, &mut builder);
        copy.spawn_at(entity.entity(), builder.build());
    }
    propagate(&mut copy, &Changes::all());
    copy
}
