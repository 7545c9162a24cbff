//! Assigns document order to new entities.

use hecs::{Entity, World};

use super::world_transform;
use crate::components::{Light, LightKind, Order, Shape, Transform, WorldTransform};

/// Marks a light with a position that was given no transform, and is therefore at the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unplaced;

/// Assigns an [`Order`] to visible entities and lights that have none, after all existing ones: first to `spawned`, in that order, then to
/// the others by id, which in a fresh world is the order in which they were spawned. A missing world transform is added in the same
/// insertion, since every insertion moves all components of an entity.
pub(crate) fn order_newcomers(world: &mut World, spawned: &[Entity]) {
    type Visible<'a> = hecs::Or<&'a Shape, &'a Light>;
    type Newcomer<'a> = hecs::Without<(Entity, Visible<'a>), &'a Order>;
    type MaybePlaced<'a> = (Option<&'a Transform>, hecs::Satisfies<&'a WorldTransform>);
    let mut newcomers: Vec<Entity> =
        world.query_mut::<Newcomer<'_>>().into_iter().map(|(entity, _)| entity).collect();
    newcomers.sort_unstable_by_key(|entity| entity.id());
    if newcomers.is_empty() {
        return;
    }
    let taken = world.query_mut::<&Order>().into_iter().map(|order| order.0).max();
    let mut next = taken.map_or(0, |last| last.saturating_add(1));
    for entity in spawned.iter().chain(&newcomers) {
        let newcomer = world.query_one_mut::<hecs::Without<(MaybePlaced<'_>, Visible<'_>), &Order>>(*entity);
        let Ok(((transform, complete), _)) = newcomer else { continue };
        let (is_placed, transform) = (transform.is_some(), transform.copied().unwrap_or(Transform::IDENTITY));
        let light = world.get::<&Light>(*entity).map(|light| light.kind);
        if !is_placed && light.is_ok_and(|kind| !matches!(kind, LightKind::Directional { .. })) {
            let _ = world.insert_one(*entity, Unplaced);
        }
        // The entity exists: it satisfied the query above.
        let _ = if complete {
            world.insert_one(*entity, Order(next))
        } else {
            world.insert(*entity, (Order(next), transform, world_transform::root(&transform)))
        };
        next = next.saturating_add(1);
    }
}
