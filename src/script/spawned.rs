//! Entities spawned by scripts, and the limits of their number and size.

use super::{Data, limits};

/// A spawned entity: a map that mirrors an entity of the file format.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spawned {
    /// The map passed to `spawn`.
    pub(crate) entity: Data,
    /// Byte offset of the call of `spawn` in the script's text.
    pub(crate) at: usize,
}

/// The remaining spawning budget of the scripts of a scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpawnBudget {
    /// Number of entities.
    pub(crate) entities: u64,
    /// Bytes of text in the entities.
    pub(crate) text: u64,
}

impl Default for SpawnBudget {
    fn default() -> Self {
        Self { entities: limits::ENTITIES, text: limits::SPAWNED_TEXT }
    }
}
