//! The names of entities, with their lines in the scene's files.

use std::collections::HashMap;

use serde_json::{Value, json};

use rayreel::components::{CloudMember, Name, Order};
use rayreel::drawing::label;
use rayreel::scene::{SourceLine, Sources};
use rayreel::systems::Preparation;
use rayreel::trace::ShapeId;
use rayreel::{Entity, Hit, World};

/// Returns the label of a hit: that of the entity, with the number of the particle, as `gas/1234`, or those of a bond, as `gas/12-57`.
pub(super) fn hit_label(world: &World, hit: &Hit) -> String {
    match hit.member {
        Some(member) => format!("{}/{member}", label(world, hit.entity)),
        None => label(world, hit.entity),
    }
}

fn order(world: &World, entity: Entity) -> Option<u64> {
    world.get::<&Order>(entity).ok().map(|order| order.0)
}

/// Entities with the lines on which they start.
pub(super) struct EntityLines<'a> {
    world: &'a World,
    lines: HashMap<Entity, SourceLine<'a>>,
}

impl<'a> EntityLines<'a> {
    /// Looks up the lines of entities.
    pub(super) fn of(world: &'a World, sources: &'a Sources, entities: &[Entity]) -> Self {
        let index = |entity: &Entity| Some((*entity, usize::try_from(order(world, *entity)?).ok()?));
        let (entities, indices): (Vec<_>, Vec<_>) = entities.iter().filter_map(index).unzip();
        let lines = entities.into_iter().zip(sources.entities(&indices)).collect();
        Self { world, lines }
    }

    /// Formats the name and line of an entity, as `"globe" (scenes/first_light.ron:25)`.
    pub(super) fn text(&self, entity: Entity) -> String {
        self.described(entity, "", None)
    }

    /// Formats the name and line of the entity in a slot. A particle has its number, a bond those of its particles, and
    /// both the file and frame of their cloud, as `"gas/1234" (gas.ron:8, gas.xyz, frame 17)`.
    pub(super) fn slot_text(&self, prepared: &Preparation, slot: ShapeId) -> String {
        let entity = prepared.entity(slot);
        match prepared.cloud_member(slot) {
            Some((member, origin)) => self.described(entity, &format!("/{member}"), origin),
            None => self.text(entity),
        }
    }

    /// Formats the name of an entity with an ending, and its line and further place.
    fn described(&self, entity: Entity, ending: &str, origin: Option<&str>) -> String {
        let name = match self.world.get::<&Name>(entity) {
            // Quoted as in the scene file: a name may contain any character.
            Ok(name) => format!("{:?}", format!("{}{ending}", name.0)),
            Err(_) => format!("{}{ending}", label(self.world, entity)),
        };
        let line = self.lines.get(&entity).map(ToString::to_string);
        let places: Vec<String> = line.into_iter().chain(origin.map(str::to_owned)).collect();
        if places.is_empty() { name } else { format!("{name} ({})", places.join(", ")) }
    }

    /// Returns the same as [`json`](Self::json) for the entity in a slot, and for a particle or a bond its numbers and where its cloud is from.
    pub(super) fn slot_json(&self, prepared: &Preparation, slot: ShapeId) -> Value {
        let mut object = self.json(prepared.entity(slot));
        if let Some((member, origin)) = prepared.cloud_member(slot) {
            match member {
                CloudMember::Particle(number) => object["particle"] = number.into(),
                CloudMember::Bond(pair) => object["bond"] = pair.to_vec().into(),
            }
            object["data"] = origin.into();
        }
        object
    }

    /// Returns the name (or null), the index in document order, the file and the line of an entity.
    pub(super) fn json(&self, entity: Entity) -> Value {
        json!({
            "name": self.world.get::<&Name>(entity).ok().map(|name| name.0.clone()),
            "order": order(self.world, entity),
            "file": self.lines.get(&entity).map(|place| place.file),
            "line": self.lines.get(&entity).map(|place| place.line),
        })
    }
}
