//! A map from the entities of a scene to their counterparts in the world.

use hecs::Entity;

/// A map from entities of the scene to entities of the world. The scene's world is newly created, so its ids are dense and a list suffices.
pub(super) struct Counterparts(Vec<Entity>);

impl Counterparts {
    /// Creates an empty map with capacity for `count` entities.
    pub(super) fn of_many(count: usize) -> Self {
        Self(Vec::with_capacity(count))
    }

    pub(super) fn insert(&mut self, entity: Entity, own: Entity) {
        let at = entity.id() as usize;
        if at >= self.0.len() {
            self.0.resize(at + 1, Entity::DANGLING);
        }
        self.0[at] = own;
    }

    /// Returns the counterpart of an entity, or [`Entity::DANGLING`] if the entity is not in the scene.
    pub(super) fn of(&self, entity: Entity) -> Entity {
        self.0.get(entity.id() as usize).copied().unwrap_or(Entity::DANGLING)
    }
}
