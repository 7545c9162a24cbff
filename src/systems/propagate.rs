//! World transforms, parents before children.

use std::collections::HashMap;

use hecs::{Entity, World};

use super::Changes;
use crate::components::{Light, Parent, Shape, Transform, WorldTransform};

/// Brings [`WorldTransform`] up to date, and returns the entities for which it changed. When everything may have changed,
/// the list is not needed and stays empty.
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
    let mut moved = Vec::new();
    for entity in changes.transforms() {
        let parts = world.query_one_mut::<hecs::Without<(&Transform, &mut WorldTransform), &Parent>>(*entity);
        if let Ok((transform, world_transform)) = parts {
            *world_transform = WorldTransform::from_root(transform);
            moved.push(*entity);
        }
    }
    if !changes.transforms().is_empty() {
        moved.extend(propagate_children(world));
    }
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

/// Sets the world transforms of all entities that have a parent, and returns those for which it changed.
fn propagate_children(world: &mut World) -> Vec<Entity> {
    let children: Vec<(Entity, Parent)> = world
        .query_mut::<(Entity, &Parent)>()
        .into_iter()
        .map(|(entity, parent)| (entity, *parent))
        .collect();
    let parents: HashMap<Entity, Entity> =
        children.iter().map(|(entity, parent)| (*entity, parent.0)).collect();
    let mut known: HashMap<Entity, WorldTransform> = HashMap::with_capacity(children.len());
    let mut moved = Vec::new();
    for (entity, _) in children {
        // Upwards to an ancestor that is known or has no parent, then down again.
        let mut chain = Vec::new();
        let mut current = entity;
        while !known.contains_key(&current)
            && let Some(parent) = parents.get(&current)
            && chain.len() <= parents.len()
        {
            chain.push(current);
            current = *parent;
        }
        let root = || {
            world.get::<&WorldTransform>(current).map_or_else(|_| WorldTransform::default(), |found| *found)
        };
        let mut above = known.get(&current).copied().unwrap_or_else(root);
        while let Some(child) = chain.pop() {
            if known.contains_key(&child) {
                continue;
            }
            let Ok((transform, world_transform)) =
                world.query_one_mut::<(&Transform, &mut WorldTransform)>(child)
            else {
                continue;
            };
            above = above.child(transform);
            if *world_transform != above {
                *world_transform = above;
                moved.push(child);
            }
            known.insert(child, above);
        }
    }
    moved
}
