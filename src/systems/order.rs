//! Gives positions in document order to entities that have none yet.

use hecs::{Entity, World};

use crate::components::{Light, Order, Shape};

/// Gives positions to visible entities and lights that have none yet, after all that are taken: first to `spawned`, in that
/// order, then to the rest by their ids, which in a fresh world is the order in which they were spawned.
pub(super) fn order_newcomers(world: &mut World, spawned: &[Entity]) {
    type Newcomer<'a> = hecs::Without<(Entity, hecs::Or<&'a Shape, &'a Light>), &'a Order>;
    let mut newcomers: Vec<Entity> =
        world.query_mut::<Newcomer<'_>>().into_iter().map(|(entity, _)| entity).collect();
    newcomers.sort_unstable_by_key(|entity| entity.id());
    if newcomers.is_empty() {
        return;
    }
    let taken = world.query_mut::<&Order>().into_iter().map(|order| order.0).max();
    let mut next = taken.map_or(0, |last| last.saturating_add(1));
    for entity in spawned.iter().chain(&newcomers) {
        if world.satisfies::<hecs::Without<hecs::Or<&Shape, &Light>, &Order>>(*entity) {
            // The entity exists: it satisfied the query just now.
            let _ = world.insert_one(*entity, Order(next));
            next = next.saturating_add(1);
        }
    }
}
