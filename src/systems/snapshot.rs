//! Copies of a world, for going back in time.

use std::any::{TypeId, type_name};

use hecs::{BuiltEntityClone, Component, Entity, EntityBuilderClone, EntityRef, World};

use super::Unplaced;
use crate::color::Rgb;
use crate::components::{self, Control, with_components};

/// The component types that a snapshot copies.
#[derive(Clone, Debug)]
pub(crate) struct Registry {
    entries: Vec<Entry>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    type_id: TypeId,
    name: &'static str,
    copy: fn(EntityRef<'_>, &mut EntityBuilderClone),
}

/// The error for a world with a component whose type a snapshot cannot copy.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "{entity} has a component of a type that was not registered, so that time could not be turned back: call \
     `engine.register::<T>()` for every component type of your own; registered are {registered}"
)]
pub struct UnknownComponent {
    /// The entity, with its components of registered types.
    entity: String,
    /// The registered types that are not of this crate.
    registered: String,
}

debug_as_message!(UnknownComponent);

impl Default for Registry {
    /// Returns a registry of all component types of this crate.
    fn default() -> Self {
        let mut registry = Self { entries: Vec::new() };
        macro_rules! register {
            ($($component:ident: $_:ident,)*) => {
                $(registry.register::<components::$component>();)*
            };
        }
        with_components!(register);
        registry.register::<Unplaced>();
        registry.register::<Control>();
        registry.register::<Control<bool>>();
        registry.register::<Control<Rgb>>();
        registry
    }
}

impl Registry {
    /// Adds a component type.
    pub(crate) fn register<T: Component + Clone>(&mut self) {
        fn copy<T: Component + Clone>(entity: EntityRef<'_>, builder: &mut EntityBuilderClone) {
            if let Some(component) = entity.get::<&T>() {
                builder.add(T::clone(&component));
            }
        }
        let type_id = TypeId::of::<T>();
        if self.entries.iter().all(|entry| entry.type_id != type_id) {
            self.entries.push(Entry { type_id, name: type_name::<T>(), copy: copy::<T> });
        }
    }

    fn check(&self, world: &World) -> Result<(), UnknownComponent> {
        let known = |type_id: TypeId| self.entries.iter().any(|entry| entry.type_id == type_id);
        let mut occupied = world.archetypes().filter(|archetype| !archetype.is_empty());
        let Some(unknown) = occupied.find(|archetype| !archetype.component_types().all(known)) else {
            return Ok(());
        };
        let short = |entry: &Entry| entry.name.rsplit("::").next().unwrap_or(entry.name).to_owned();
        let has = |entry: &&Entry| unknown.component_types().any(|type_id| type_id == entry.type_id);
        let components: Vec<String> = self.entries.iter().filter(has).map(short).collect();
        let entity = unknown.ids().first().map_or_else(String::new, |id| format!(" {id}"));
        let own = |entry: &&Entry| !entry.name.starts_with(concat!(env!("CARGO_CRATE_NAME"), "::"));
        let registered: Vec<String> = self.entries.iter().filter(own).map(short).collect();
        let listed = |names: Vec<String>, none: &str| match names.is_empty() {
            true => none.to_owned(),
            false => names.join(", "),
        };
        Err(UnknownComponent {
            entity: format!("entity{entity} (with {})", listed(components, "no other component")),
            registered: listed(registered, "none so far"),
        })
    }
}

/// A copy of all entities, with their ids.
pub(crate) struct WorldSnapshot {
    /// The entities with their components, ascending by id.
    entities: Vec<(Entity, BuiltEntityClone)>,
}

impl WorldSnapshot {
    /// Copies a world.
    ///
    /// # Errors
    ///
    /// If it holds a component whose type is not registered.
    pub(crate) fn take(world: &World, registry: &Registry) -> Result<Self, UnknownComponent> {
        registry.check(world)?;
        let mut entities: Vec<(Entity, BuiltEntityClone)> = world
            .iter()
            .map(|entity| {
                let mut builder = EntityBuilderClone::new();
                for entry in &registry.entries {
                    (entry.copy)(entity, &mut builder);
                }
                (entity.entity(), builder.build())
            })
            .collect();
        entities.sort_unstable_by_key(|(entity, _)| entity.id());
        Ok(Self { entities })
    }

    /// Restores the copied world. Entities keep their ids, and new ids are allocated in the same order again.
    pub(crate) fn restore(&self, world: &mut World) {
        *world = World::new();
        for (entity, components) in &self.entities {
            world.spawn_at(*entity, components);
        }
    }
}
