//! The writes to the world since the kernel's arrays were last updated.

use hecs::Entity;

/// A record of writes to the world.
///
/// A system that declares no writes may have written anything, so the whole world is read again. After a system that declares its writes
/// with the methods here, only these are read. Undeclared writes of such a system leave the image out of date; in builds with debug
/// assertions, [`Engine::faults`](crate::Engine::faults) and the reports of sequences list them, with the method that declares them.
#[derive(Clone, Debug, Default)]
pub struct Changes {
    all: bool,
    declared: bool,
    transforms: Vec<Entity>,
    shapes: Vec<Entity>,
    materials: Vec<Entity>,
}

impl Changes {
    /// Creates a record in which everything may have changed, including the set of entities.
    #[must_use]
    pub fn all() -> Self {
        Self { all: true, ..Self::default() }
    }

    /// Declares that anything may have been written: entities spawned or despawned, components added or removed, parents changed.
    pub fn mark_all(&mut self) {
        self.all = true;
        self.declared = true;
    }

    /// Declares a write to an entity's [`Transform`](crate::components::Transform), [`LookAt`](crate::components::LookAt) or
    /// [`Target`](crate::components::Target).
    pub fn mark_transform(&mut self, entity: Entity) {
        self.declared = true;
        self.transforms.push(entity);
    }

    /// Declares a write to an entity's [`Shape`](crate::components::Shape), [`Visibility`](crate::components::Visibility) or
    /// [`Cloud`](crate::components::Cloud). Clouds are compared with the previous ones, declared or not.
    pub fn mark_shape(&mut self, entity: Entity) {
        self.declared = true;
        self.shapes.push(entity);
    }

    /// Declares a write to an entity's [`Material`](crate::components::Material),
    /// [`Specular`](crate::components::Specular), [`Reflective`](crate::components::Reflective),
    /// [`Refractive`](crate::components::Refractive), [`Pattern`](crate::components::Pattern) or
    /// [`Emission`](crate::components::Emission).
    pub fn mark_material(&mut self, entity: Entity) {
        self.declared = true;
        self.materials.push(entity);
    }

    /// Declares that there are no other writes, except to lights, cameras and settings of the whole scene, which are read again for every
    /// frame.
    pub fn mark_settings(&mut self) {
        self.declared = true;
    }

    /// Returns whether the whole world must be read again.
    #[must_use]
    pub fn is_all(&self) -> bool {
        self.all
    }

    /// Returns the entities whose transforms were written. An entity may occur more than once.
    #[must_use]
    pub fn transforms(&self) -> &[Entity] {
        &self.transforms
    }

    /// Returns the entities whose shapes were written. An entity may occur more than once.
    #[must_use]
    pub fn shapes(&self) -> &[Entity] {
        &self.shapes
    }

    /// Returns the entities whose materials were written. An entity may occur more than once.
    #[must_use]
    pub fn materials(&self) -> &[Entity] {
        &self.materials
    }

    /// Runs a system and records its declarations. If it declares nothing, everything is assumed to be written.
    pub(super) fn watch(&mut self, system: impl FnOnce(&mut Self)) {
        let before = std::mem::replace(&mut self.declared, false);
        system(self);
        if !self.declared {
            self.all = true;
        }
        self.declared = before;
    }

    /// Removes entities that occur again, so that the record of many moments stays short.
    #[cfg(feature = "live")]
    pub(super) fn deduplicate(&mut self) {
        for entities in [&mut self.transforms, &mut self.shapes, &mut self.materials] {
            entities.sort_unstable();
            entities.dedup();
        }
    }

    /// Adds the writes of another record.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.all |= other.all;
        self.transforms.extend(&other.transforms);
        self.shapes.extend(&other.shapes);
        self.materials.extend(&other.materials);
    }
}
