//! Gives newcomers what they lack.

use hecs::{Entity, World};

use super::world_transform;
use crate::components::{Light, Order, Shape, Transform, WorldTransform};

/// Gives positions to visible entities and lights that have none yet, after all that are taken: first to `spawned`, in that
/// order, then to the rest by their ids, which in a fresh world is the order in which they were spawned. Those without a world
/// transform get one, too: whatever an entity is given, all of its components are moved for, so that it is given all at once.
pub(crate) fn order_newcomers(world: &mut World, spawned: &[Entity]) {
    type Visible<'a> = hecs::Or<&'a Shape, &'a Light>;
    type Newcomer<'a> = hecs::Without<(Entity, Visible<'a>), &'a Order>;
    type Spatial<'a> = (Option<&'a Transform>, hecs::Satisfies<&'a WorldTransform>);
    let mut newcomers: Vec<Entity> =
        world.query_mut::<Newcomer<'_>>().into_iter().map(|(entity, _)| entity).collect();
    newcomers.sort_unstable_by_key(|entity| entity.id());
    if newcomers.is_empty() {
        return;
    }
    let taken = world.query_mut::<&Order>().into_iter().map(|order| order.0).max();
    let mut next = taken.map_or(0, |last| last.saturating_add(1));
    for entity in spawned.iter().chain(&newcomers) {
        let newcomer = world.query_one_mut::<hecs::Without<(Spatial<'_>, Visible<'_>), &Order>>(*entity);
        let Ok(((transform, complete), _)) = newcomer else { continue };
        let transform = transform.copied().unwrap_or(Transform::IDENTITY);
        // The entity exists: it satisfied the query just now.
        let _ = if complete {
            world.insert_one(*entity, Order(next))
        } else {
            world.insert(*entity, (Order(next), transform, world_transform::root(&transform)))
        };
        next = next.saturating_add(1);
    }
}
