//! Turns entities to the points and entities that they look at.
//!
//! The world transform of an entity depends on its parent's, and on the position of the entity that it looks at, which depends on the
//! transform of that entity's parent, but not on its rotation: entities may look at each other. World transforms are computed in the
//! order of these dependencies. An entity that looks at a part of itself, or depends on such an entity, has no defined rotation: it keeps
//! the rotation of its transform.

use std::collections::{HashMap, HashSet};

use glam::{DMat3, DVec3};
use hecs::{Entity, World};

use super::world_transform;
use crate::components::{Camera, LookAt, Parent, Target, Transform, WorldTransform};

/// The target of an entity.
#[derive(Clone, Copy, Debug)]
enum AimedAt {
    /// The entity's position in the world.
    Entity(Entity),
    /// A point in the space of the parent.
    Point(DVec3),
}

/// The dependencies of world transforms.
struct Dependencies {
    aims: HashMap<Entity, AimedAt>,
    parents: HashMap<Entity, Entity>,
    /// The entities with an aim or a parent.
    entities: Vec<Entity>,
}

/// Turns the entities that look at something, and moves the entities below them. Their world transforms must be those of their own
/// rotations. Returns the entities whose world transforms were written.
pub(super) fn aim(world: &mut World) -> Vec<Entity> {
    let Some(mut dependencies) = Dependencies::of(world) else { return Vec::new() };
    let circular = dependencies.sorted().circular;
    dependencies.aims.retain(|entity, _| !circular.contains(entity));
    // Entities that still depend on themselves have cyclic parents.
    let order = dependencies.sorted().order;
    let mut written = Vec::new();
    let mut turned: HashSet<Entity> = HashSet::new();
    for entity in order {
        let parent = dependencies.parents.get(&entity);
        let aim = dependencies.aims.get(&entity).copied();
        if aim.is_none() && parent.is_none_or(|parent| !turned.contains(parent)) {
            continue;
        }
        let Ok(local) = world.get::<&Transform>(entity).map(|transform| *transform) else { continue };
        let outer = parent.map(|parent| world_transform_of(world, *parent).unwrap_or_default());
        let position = |entity: Entity| match dependencies.parents.get(&entity) {
            // The stored transform of an entity below a turned one may not be written yet.
            Some(parent) if turned.contains(parent) => {
                let own = world.get::<&Transform>(entity).ok()?.translation;
                Some(world_transform_of(world, *parent)?.affine.transform_point3(own))
            }
            _ => Some(world_transform_of(world, entity)?.affine.translation),
        };
        let local = match aim {
            Some(AimedAt::Entity(target)) => match position(target).zip(position(entity)) {
                Some((target, own)) => facing(local, outer, |to_parent| to_parent * (target - own)),
                None => local,
            },
            Some(AimedAt::Point(point)) => facing(local, outer, |_| point - local.translation),
            None => local,
        };
        if let Ok(stored) = world.query_one_mut::<&mut WorldTransform>(entity) {
            *stored = match outer {
                Some(outer) => world_transform::child(&outer, &local),
                None => world_transform::root(&local),
            };
            written.push(entity);
        }
        turned.insert(entity);
    }
    written
}

/// Returns the entities that look at a point which turns with them.
pub(super) fn circular_aims(world: &World) -> Vec<Entity> {
    let Some(dependencies) = Dependencies::of(world) else { return Vec::new() };
    let circular = dependencies.sorted().circular;
    let is_aimed = |entity: &Entity| dependencies.aims.contains_key(entity);
    dependencies
        .entities
        .iter()
        .filter(|entity| is_aimed(entity) && circular.contains(entity))
        .copied()
        .collect()
}

fn world_transform_of(world: &World, entity: Entity) -> Option<WorldTransform> {
    world.get::<&WorldTransform>(entity).ok().map(|transform| *transform)
}

/// Returns the transform of an entity, turned to a direction in the space of its parent. `direction` computes it from the map of
/// directions to that space, given the parent's world transform. Without a direction, it is turned to the world's +z.
fn facing(local: Transform, outer: Option<WorldTransform>, direction: impl Fn(DMat3) -> DVec3) -> Transform {
    let to_parent = outer.map_or(DMat3::IDENTITY, |outer| outer.affine.matrix3.inverse());
    let turned = local.facing(direction(to_parent)).or_else(|| local.facing(to_parent * DVec3::Z));
    turned.unwrap_or(local)
}

/// Entities in the order of their dependencies.
#[derive(Default)]
struct Sorted {
    order: Vec<Entity>,
    /// The entities that depend on themselves, or on such an entity.
    circular: HashSet<Entity>,
}

impl Dependencies {
    /// Returns the dependencies of all entities in a world. `None` if no entity looks at anything. Cameras do so without turning their
    /// transform.
    fn of(world: &World) -> Option<Self> {
        type Aiming<'a> = hecs::Without<(Entity, hecs::Or<&'a LookAt, &'a Target>), &'a Camera>;
        let mut query = world.query::<Aiming<'_>>();
        let aims: HashMap<Entity, AimedAt> = query
            .iter()
            .map(|(entity, aim)| {
                let aim = match aim {
                    hecs::Or::Left(LookAt(target)) | hecs::Or::Both(LookAt(target), _) => {
                        AimedAt::Entity(*target)
                    }
                    hecs::Or::Right(Target(point)) => AimedAt::Point(*point),
                };
                (entity, aim)
            })
            .collect();
        if aims.is_empty() {
            return None;
        }
        let mut children = world.query::<(Entity, &Parent)>();
        let parents: HashMap<Entity, Entity> =
            children.iter().map(|(entity, parent)| (entity, parent.0)).collect();
        let is_root = |entity: &Entity| !parents.contains_key(entity);
        let roots = query.iter().map(|(entity, _)| entity).filter(is_root);
        let entities = children.iter().map(|(entity, _)| entity).chain(roots).collect();
        Some(Self { aims, parents, entities })
    }

    /// Returns the entities on whose world transforms the world transform of an entity depends.
    fn needed(&self, entity: Entity) -> impl Iterator<Item = Entity> {
        let target = match self.aims.get(&entity) {
            Some(AimedAt::Entity(target)) => self.parents.get(target),
            _ => None,
        };
        self.parents.get(&entity).into_iter().chain(target).copied()
    }

    /// Sorts the entities with an aim or a parent, by depth-first search.
    fn sorted(&self) -> Sorted {
        let mut sorted = Sorted::default();
        let (mut open, mut finished) = (HashSet::new(), HashSet::new());
        for start in &self.entities {
            let mut stack = vec![*start];
            while let Some(entity) = stack.last().copied() {
                if finished.contains(&entity) {
                    stack.pop();
                    continue;
                }
                if open.insert(entity) {
                    let is_new = |needed: &Entity| !finished.contains(needed) && !open.contains(needed);
                    stack.extend(self.needed(entity).filter(is_new));
                    continue;
                }
                stack.pop();
                // Entities that are needed and not finished are open: they depend on this one.
                let is_circular =
                    |needed: Entity| !finished.contains(&needed) || sorted.circular.contains(&needed);
                if self.needed(entity).any(is_circular) {
                    sorted.circular.insert(entity);
                } else {
                    sorted.order.push(entity);
                }
                finished.insert(entity);
            }
        }
        sorted
    }
}
