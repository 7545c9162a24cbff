//! The entities of a world that continue as those of another scene.

use hecs::Entity;

/// A map from the entities of the scene. Their ids are dense, as its world is fresh, so that a list suffices.
pub(super) struct Counterparts(Vec<Entity>);

impl Counterparts {
    /// Creates a map with capacity for this many.
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

    /// Returns the counterpart of an entity; [`Entity::DANGLING`] for one that is not in the scene.
    pub(super) fn of(&self, entity: Entity) -> Entity {
        self.0.get(entity.id() as usize).copied().unwrap_or(Entity::DANGLING)
    }
}
