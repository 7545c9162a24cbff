//! World transforms, parents before children.

use std::collections::HashMap;

use hecs::{Entity, World};

use super::Changes;
use crate::components::{Light, Parent, Shape, Transform, WorldTransform};

/// Brings [`WorldTransform`] up to date, and returns the entities for which it may have changed: those that were written,
/// and all that have a parent. When everything may have changed, the list is not needed and stays empty.
///
/// An entity whose parent is gone, or that is its own ancestor, counts as a root.
pub fn propagate(world: &mut World, changes: &Changes) -> Vec<Entity> {
    if changes.is_everything() {
        complete(world);
        for (transform, world_transform) in world.query_mut::<(&Transform, &mut WorldTransform)>() {
            *world_transform = WorldTransform::from_root(transform);
        }
        propagate_children(world);
        return Vec::new();
    }
    if changes.transforms().is_empty() {
        return Vec::new();
    }
    let mut moved = changes.transforms().to_vec();
    for entity in &moved {
        let parts = world.query_one_mut::<hecs::Without<(&Transform, &mut WorldTransform), &Parent>>(*entity);
        if let Ok((transform, world_transform)) = parts {
            *world_transform = WorldTransform::from_root(transform);
        }
    }
    moved.extend(propagate_children(world));
    moved
}

/// Gives transforms to entities that need them and lack them.
fn complete(world: &mut World) {
    type Placed<'a> = hecs::Or<hecs::Or<&'a Shape, &'a Light>, hecs::Or<&'a Transform, &'a Parent>>;
    let incomplete = |world: &World| -> Vec<Entity> {
        let query = world
            .query::<(Entity, Placed<'_>, hecs::Satisfies<&Transform>, hecs::Satisfies<&WorldTransform>)>();
        let mut query = query;
        query.iter().filter(|(_, _, own, derived)| !(*own && *derived)).map(|(entity, ..)| entity).collect()
    };
    for entity in incomplete(world) {
        let transform = world.get::<&Transform>(entity).map_or(Transform::IDENTITY, |transform| *transform);
        // The entity exists: it was found just now.
        let _ = world.insert(entity, (transform, WorldTransform::from_root(&transform)));
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
        // Upwards to an ancestor that is known or has no parent, then down again.
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
                above = above.child(transform);
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

/// Makes roots of all entities in a ring of parents.
fn break_ring(
    world: &World,
    parents: &HashMap<Entity, Entity>,
    member: Entity,
    known: &mut HashMap<Entity, WorldTransform>,
) {
    let mut current = member;
    while !known.contains_key(&current) {
        let local = world.get::<&Transform>(current).map_or(Transform::IDENTITY, |transform| *transform);
        known.insert(current, WorldTransform::from_root(&local));
        match parents.get(&current) {
            Some(parent) => current = *parent,
            None => return,
        }
    }
}
