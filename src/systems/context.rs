//! The input of a system.

use hecs::{DynamicBundle, Entity, World};

use super::Changes;
use crate::time::Time;

/// The world at a moment, for a system to write to.
pub struct Context<'a> {
    /// All entities.
    pub world: &'a mut World,
    /// The moment of the frame for pure systems, the start of the step for stepped systems.
    pub time: Time,
    /// The record in which the system declares its writes.
    pub changes: &'a mut Changes,
    pub(super) step: Option<f64>,
    pub(super) spawned: Vec<Entity>,
}

impl Context<'_> {
    /// Returns the length of the step in seconds; 0 for a pure system.
    #[must_use]
    pub fn step_seconds(&self) -> f64 {
        self.step.unwrap_or(0.0)
    }

    /// Spawns an entity after all others in document order, and declares it. Entities that are spawned directly into the world are ordered
    /// by id after the system has run.
    pub fn spawn(&mut self, components: impl DynamicBundle) -> Entity {
        let entity = self.world.spawn(components);
        self.spawned.push(entity);
        self.changes.mark_all();
        entity
    }
}
