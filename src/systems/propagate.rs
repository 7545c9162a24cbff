//! Propagates world transforms, parents before children, and then turns the entities that look at something.

use std::collections::HashMap;

use hecs::{Entity, World};

use super::aim::aim;
use super::batches::{BATCH, in_batches};
use super::{Changes, world_transform};
use crate::components::{Light, Parent, Shape, Transform, WorldTransform};

/// Updates [`WorldTransform`]s, and returns the entities whose world transforms may have changed: those whose transforms were written, and
/// all that have a parent or look at something. If everything may have changed, the list is not needed and is empty.
///
/// An entity whose parent does not exist, or that is its own ancestor, counts as a root.
pub fn propagate(world: &mut World, changes: &Changes) -> Vec<Entity> {
    if changes.is_all() {
        complete(world);
        propagate_roots(world);
        propagate_children(world);
        aim(world);
        return Vec::new();
    }
    if changes.transforms().is_empty() {
        return Vec::new();
    }
    let mut moved = changes.transforms().to_vec();
    // Sequential access in storage order is faster than random access, unless few entities moved.
    if moved.len() > world.len() as usize / 4 {
        propagate_roots(world);
    } else {
        for entity in &moved {
            if let Ok((transform, world_transform)) = world.query_one_mut::<Root<'_>>(*entity) {
                *world_transform = world_transform::root(transform);
            }
        }
    }
    moved.extend(propagate_children(world));
    moved.extend(aim(world));
    moved
}

type Root<'a> = hecs::Without<(&'a Transform, &'a mut WorldTransform), &'a Parent>;

/// Sets the world transforms of all entities that have no parent.
fn propagate_roots(world: &mut World) {
    let (count, roots) = (world.len(), world.query_mut::<Root<'_>>().into_iter_batched(BATCH));
    in_batches(count, roots, |batch| {
        for (transform, world_transform) in batch {
            *world_transform = world_transform::root(transform);
        }
    });
}

/// Adds missing transforms and world transforms to the entities that need them.
fn complete(world: &mut World) {
    type NeedsTransform<'a> = hecs::Or<hecs::Or<&'a Shape, &'a Light>, hecs::Or<&'a Transform, &'a Parent>>;
    let incomplete = |world: &World| -> Vec<Entity> {
        let query = world.query::<(
            Entity,
            NeedsTransform<'_>,
            hecs::Satisfies<&Transform>,
            hecs::Satisfies<&WorldTransform>,
        )>();
        let mut query = query;
        query.iter().filter(|(_, _, own, derived)| !(*own && *derived)).map(|(entity, ..)| entity).collect()
    };
    for entity in incomplete(world) {
        let transform = world.get::<&Transform>(entity).map_or(Transform::IDENTITY, |transform| *transform);
        // The entity exists: the query above found it.
        let _ = world.insert(entity, (transform, world_transform::root(&transform)));
    }
}

/// Sets the world transforms of all entities that have a parent, and returns them.
fn propagate_children(world: &mut World) -> Vec<Entity> {
    let children: Vec<(Entity, Entity)> = world
        .query_mut::<(Entity, &Parent)>()
        .into_iter()
        .map(|(entity, parent)| (entity, parent.0))
        .collect();
    let parents: HashMap<Entity, Entity> = children.iter().copied().collect();
    let mut known: HashMap<Entity, WorldTransform> = HashMap::with_capacity(children.len());
    for (entity, _) in &children {
        // Walks up to an ancestor that is known or has no parent, then back down.
        let mut chain = Vec::new();
        let mut current = *entity;
        while !known.contains_key(&current)
            && let Some(parent) = parents.get(&current)
        {
            chain.push(current);
            if chain.len() > parents.len() {
                break_ring(world, &parents, current, &mut known);
                chain.retain(|member| !known.contains_key(member));
                current = chain.last().and_then(|last| parents.get(last)).copied().unwrap_or(current);
                break;
            }
            current = *parent;
        }
        let root = || {
            world.get::<&WorldTransform>(current).map_or_else(|_| WorldTransform::default(), |found| *found)
        };
        let mut above = known.get(&current).copied().unwrap_or_else(root);
        while let Some(child) = chain.pop() {
            if let Some(found) = known.get(&child) {
                above = *found;
            } else if let Ok(transform) = world.query_one_mut::<&Transform>(child) {
                above = world_transform::child(&above, transform);
                known.insert(child, above);
            }
        }
    }
    for (entity, _) in &children {
        if let (Some(found), Ok(stored)) =
            (known.get(entity), world.query_one_mut::<&mut WorldTransform>(*entity))
        {
            *stored = *found;
        }
    }
    children.into_iter().map(|(entity, _)| entity).collect()
}

/// Makes all entities in a cycle of parents roots.
fn break_ring(
    world: &World,
    parents: &HashMap<Entity, Entity>,
    member: Entity,
    known: &mut HashMap<Entity, WorldTransform>,
) {
    let mut current = member;
    while !known.contains_key(&current) {
        let local = world.get::<&Transform>(current).map_or(Transform::IDENTITY, |transform| *transform);
        known.insert(current, world_transform::root(&local));
        match parents.get(&current) {
            Some(parent) => current = *parent,
            None => return,
        }
    }
}
