//! The list of a scene's parts, and the values of one of them.

use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;

use hecs::{Entity, World};
use serde::{Deserialize, Serialize};

use super::pixel_info::place_of;
use crate::components::{Cloud, Light, LightKind, Name, Order, Parent, Shape};
use crate::drawing::label;
use crate::scene::{AnimatedChannel, ChangedPart, ScenePart, Sources, WrittenValue};

/// Maximum number of rows below a heading or a parent. A filter finds the others.
const MOST_ROWS: usize = 200;

/// The headings, which are open by default.
const LIGHTS: &str = "lights";
const MATERIALS: &str = "materials";
const ENTITIES: &str = "entities";

/// The part of the list that a page shows.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutlineRequest {
    /// A text that the names or the kinds of all listed parts contain, in any case.
    pub filter: String,
    /// The keys of the headings and the parents whose rows are listed; `None` for the headings.
    pub open: Option<Vec<String>>,
    /// A part that is listed even if it is beyond the number of rows.
    pub selected: Option<ScenePart>,
    /// True if what holds the selected part is opened.
    #[serde(default)]
    pub reveals: bool,
}

/// A row of the list.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OutlineRow {
    /// The part; `None` for a heading, and for the number of rows that are left out.
    pub part: Option<ScenePart>,
    /// The name by which the row is opened and closed; different for all rows.
    pub key: String,
    /// The name, or the words of a heading.
    pub name: String,
    /// The kind of entity, such as `sphere`.
    pub kind: &'static str,
    /// The level, from 1.
    pub level: usize,
    /// Number of rows below.
    pub count: usize,
    /// True if the rows below are listed.
    pub is_open: bool,
}

/// The values of a part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartInfo {
    /// The part, with its kind, such as `material clay`.
    pub title: String,
    /// Position of the part, as `ball.ron:12`.
    pub place: Option<String>,
    /// The values of the part, then those of the material of an entity.
    pub sections: Vec<PartSection>,
    /// The reason why there are no values.
    pub note: Option<&'static str>,
}

/// The values of a part, or of the material of an entity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartSection {
    /// The kind and the name.
    pub title: String,
    /// The written values, then the defaults of other fields.
    pub values: Vec<WrittenValue>,
    /// Those that tracks or scripts set over time.
    pub animated: Vec<AnimatedField>,
    /// The paths of those that differ from their initial values, with these; only of a program's controls.
    pub initial: BTreeMap<String, String>,
}

/// A value that a track or a script sets over time.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct AnimatedField {
    /// The path of the value.
    pub path: String,
    /// The path that the list of the track's keys has, if there is one.
    pub track: String,
    /// True if a script sets it.
    pub is_script: bool,
    /// Position of the track, or of the script's file, as `ball.ron:12`.
    pub place: String,
}

/// An entity in the list.
struct EntityRow {
    entity: Entity,
    name: String,
    kind: &'static str,
}

/// The rows that are listed.
struct OutlineRows<'a> {
    request: &'a OutlineRequest,
    filter: String,
    /// The selected entity and its ancestors.
    revealed: Vec<Entity>,
    children: HashMap<Entity, Vec<EntityRow>>,
    rows: Vec<OutlineRow>,
}

/// Lists the parts of a scene: cameras, settings, lights, materials, and the other entities below their parents. With a filter, all parts are
/// listed below the headings.
pub(super) fn outline(world: &World, sources: &Sources, request: &OutlineRequest) -> Vec<OutlineRow> {
    let mut lights = Vec::new();
    let mut roots = Vec::new();
    let mut children: HashMap<Entity, Vec<EntityRow>> = HashMap::new();
    let mut query = world.query::<(Entity, &Order)>();
    let mut entities: Vec<(u64, Entity)> = query.iter().map(|(entity, order)| (order.0, entity)).collect();
    entities.sort_unstable();
    for (_, entity) in entities {
        let (kind, is_light) = kind_of(world, entity);
        let row = EntityRow { entity, name: label(world, entity), kind };
        let parent = world.get::<&Parent>(entity).ok().map(|parent| parent.0);
        match parent.filter(|parent| request.filter.is_empty() && world.satisfies::<&Order>(*parent)) {
            _ if is_light => lights.push(row),
            Some(parent) => children.entry(parent).or_default().push(row),
            None => roots.push(row),
        }
    }
    let selected = match &request.selected {
        Some(ScenePart::Entity(name)) => entity_named(world, name),
        _ => None,
    };
    let parent = |entity: &Entity| world.get::<&Parent>(*entity).ok().map(|parent| parent.0);
    let revealed = std::iter::successors(selected, parent).take(MOST_ROWS).collect();
    let filter = request.filter.to_lowercase();
    let mut outline = OutlineRows { request, filter, revealed, children, rows: Vec::new() };
    let (materials, others): (Vec<_>, Vec<_>) =
        sources.parts().into_iter().partition(|part| matches!(part, ScenePart::Material(_)));
    outline.add_parts(others, 1);
    outline.add_heading(LIGHTS, "Lights", |outline| outline.add_entities(lights, 2));
    outline.add_heading(MATERIALS, "Materials", |outline| outline.add_parts(materials, 2));
    outline.add_heading(ENTITIES, "Entities", |outline| outline.add_entities(roots, 2));
    outline.rows
}

impl OutlineRows<'_> {
    fn matches(&self, name: &str, kind: &str) -> bool {
        name.to_lowercase().contains(&self.filter) || kind.contains(&self.filter)
    }

    fn is_open(&self, key: &str) -> bool {
        let is_heading = [LIGHTS, MATERIALS, ENTITIES].contains(&key);
        self.request.open.as_ref().map_or(is_heading, |open| open.iter().any(|open| open == key))
    }

    /// Adds a heading with the rows that `add` adds below it, if there are any.
    fn add_heading(&mut self, key: &str, name: &str, add: impl FnOnce(&mut Self) -> usize) {
        let at = self.rows.len();
        let count = add(self);
        let of_selected =
            self.rows[at..].iter().any(|row| row.part.is_some() && row.part == self.request.selected);
        let is_open = !self.filter.is_empty() || self.is_open(key) || of_selected && self.request.reveals;
        if !is_open {
            self.rows.truncate(at);
        }
        if count > 0 {
            let (key, name) = (key.to_owned(), name.to_owned());
            self.rows.insert(at, OutlineRow { part: None, key, name, kind: "", level: 1, count, is_open });
        }
    }

    /// Adds parts that are not entities. Returns their number.
    fn add_parts(&mut self, parts: Vec<ScenePart>, level: usize) -> usize {
        let rows = parts.into_iter().map(|part| {
            let (kind, name) = described(&part);
            // Those below a heading are of its kind.
            (part, name, if level > 1 { "" } else { kind })
        });
        let found: Vec<_> = rows.filter(|(_, name, kind)| self.matches(name, kind)).collect();
        let count = found.len();
        let mut left_out = 0;
        for (index, (part, name, kind)) in found.into_iter().enumerate() {
            if index >= MOST_ROWS && Some(&part) != self.request.selected.as_ref() {
                left_out += 1;
                continue;
            }
            let key = key_of(&part);
            self.rows.push(OutlineRow { part: Some(part), key, name, kind, level, count: 0, is_open: false });
        }
        self.add_left_out(left_out, level);
        count
    }

    /// Adds entities and, below those that are open, their children. Returns the number of the entities.
    fn add_entities(&mut self, entities: Vec<EntityRow>, level: usize) -> usize {
        let found: Vec<EntityRow> =
            entities.into_iter().filter(|row| self.matches(&row.name, row.kind)).collect();
        let count = found.len();
        let mut left_out = 0;
        for (index, EntityRow { entity, name, kind }) in found.into_iter().enumerate() {
            let is_revealed = self.revealed.contains(&entity);
            if index >= MOST_ROWS && !is_revealed {
                left_out += 1;
                continue;
            }
            let below = self.children.remove(&entity).unwrap_or_default();
            let part = ScenePart::Entity(name.clone());
            let key = key_of(&part);
            let holds_selected =
                self.request.reveals && is_revealed && self.revealed.first() != Some(&entity);
            let is_open = !below.is_empty() && (self.is_open(&key) || holds_selected);
            let count = below.len();
            self.rows.push(OutlineRow { part: Some(part), key, name, kind, level, count, is_open });
            if is_open {
                self.add_entities(below, level + 1);
            }
        }
        self.add_left_out(left_out, level);
        count
    }

    fn add_left_out(&mut self, count: usize, level: usize) {
        if count > 0 {
            let (key, name) =
                (format!("more {}", self.rows.len()), format!("and {count} more: filter to find them"));
            self.rows.push(OutlineRow { part: None, key, name, kind: "", level, count: 0, is_open: false });
        }
    }
}

impl PartInfo {
    /// Describes a part; `None` if the scene has no such part.
    pub(super) fn of(world: &World, sources: &Sources, part: &ScenePart, files: &[PathBuf]) -> Option<Self> {
        let mut info = Self { title: String::new(), place: None, sections: Vec::new(), note: None };
        let mut add = |title: String, path: &[String], animated: Vec<AnimatedChannel>| {
            // Only named parts are looked for in included files.
            let files = if path.len() == 1 { &files[..files.len().min(1)] } else { files };
            let mut values = WrittenValue::all(path, files);
            if !sources.is_extension() {
                values.extend(WrittenValue::defaults(path, files));
            }
            let animated = values.iter().filter_map(|value| AnimatedField::of(value, &animated)).collect();
            let initial = BTreeMap::new();
            info.sections.push(PartSection { title, values, animated, initial });
        };
        let (title, place) = match part {
            ScenePart::Entity(name) => {
                let entity = entity_named(world, name)?;
                let order =
                    world.get::<&Order>(entity).ok().and_then(|order| usize::try_from(order.0).ok())?;
                let own = label(world, entity);
                let title = format!("entity {own}");
                let animated = sources.animated_channels("target", &own);
                if let Some(path) = sources.entity_path(order) {
                    add(title.clone(), &path, animated);
                    if let Some(material) = sources.material(order) {
                        let path = ["materials".to_owned(), material.clone()];
                        let animated = sources.animated_channels("material", &material);
                        add(format!("material {material}"), &path, animated);
                    }
                } else if sources.is_spawned(order) {
                    info.note = Some("A script makes it: its values are changed there.");
                } else {
                    info.note = Some("Its values are changed in its own file.");
                }
                (title, place_of(world, sources, entity))
            }
            _ => {
                let (field, target) = match part {
                    ScenePart::Material(name) => ("material", name.as_str()),
                    ScenePart::Camera(name) | ScenePart::Entity(name) => ("target", name.as_str()),
                    ScenePart::Setting(_) => ("target", "scene"),
                };
                let (kind, name) = described(part);
                let title = format!("{kind} {name}").trim_start().to_owned();
                let (path, place) = match (sources.written_part(part), part) {
                    (Some((path, line)), _) => (path, Some(line.to_string())),
                    (None, ScenePart::Setting(name)) => (vec![name.clone()], None),
                    _ => return None,
                };
                add(title.clone(), &path, sources.animated_channels(field, target));
                (title, place)
            }
        };
        info.sections.retain(|section| !section.values.is_empty());
        if info.sections.is_empty() && info.note.is_none() {
            info.note = Some("It has no values that can be changed here.");
        }
        Some(Self { title, place, ..info })
    }
}

impl AnimatedField {
    /// Returns `None` if none of the channels sets the value.
    fn of(value: &WrittenValue, channels: &[AnimatedChannel]) -> Option<Self> {
        // Of several, the last one has the last word.
        let AnimatedChannel { track, is_script, place, .. } =
            channels.iter().rev().find(|channel| sets(&channel.name, &value.path))?.clone();
        Some(Self { path: value.path.clone(), track, is_script, place })
    }
}

/// Returns a changed part; `None` for an entity that the world does not have.
pub(super) fn part_of(world: &World, changed: ChangedPart) -> Option<ScenePart> {
    match changed {
        ChangedPart::Named(part) => Some(part),
        ChangedPart::Entity(order) => {
            let entity = entity_named(world, &format!("#{order}"))?;
            Some(ScenePart::Entity(label(world, entity)))
        }
    }
}

/// Returns the kind of a part, which is empty if the name says it, and the name as it is shown.
fn described(part: &ScenePart) -> (&'static str, String) {
    match part {
        ScenePart::Camera(name) if name == "camera" => ("", name.clone()),
        ScenePart::Camera(name) => ("camera", name.clone()),
        ScenePart::Setting(name) => ("", name.replace('_', " ")),
        ScenePart::Material(name) => ("material", name.clone()),
        ScenePart::Entity(name) => ("entity", name.clone()),
    }
}

/// Returns the name by which a part's row is opened and closed.
fn key_of(part: &ScenePart) -> String {
    match part {
        ScenePart::Setting(name) => format!("setting {name}"),
        ScenePart::Camera(name) => format!("camera {name}"),
        ScenePart::Material(name) => format!("material {name}"),
        ScenePart::Entity(name) => format!("entity {name}"),
    }
}

/// Returns the entity with a label, also if a particle of it is named.
pub(super) fn entity_named(world: &World, name: &str) -> Option<Entity> {
    let named = |name: &str| -> Option<Entity> {
        if let Some(order) = name.strip_prefix('#') {
            let order = Order(order.parse().ok()?);
            return world
                .query::<(Entity, &Order)>()
                .iter()
                .find(|(_, own)| **own == order)
                .map(|(found, _)| found);
        }
        let mut query = world.query::<hecs::With<(Entity, &Name), &Order>>();
        query.iter().find(|(_, own)| own.0 == name).map(|(found, _)| found)
    };
    named(name).or_else(|| named(name.rsplit_once('/')?.0))
}

/// Returns the kind of an entity, and whether it is a light without a shape.
fn kind_of(world: &World, entity: Entity) -> (&'static str, bool) {
    if let Ok(shape) = world.get::<&Shape>(entity) {
        let kind = match *shape {
            Shape::Sphere { .. } => "sphere",
            Shape::Plane { .. } => "plane",
            Shape::Box { .. } => "box",
            Shape::Cylinder { .. } => "cylinder",
            Shape::Capsule { .. } => "capsule",
        };
        return (kind, false);
    }
    if let Ok(light) = world.get::<&Light>(entity) {
        let kind = match light.kind {
            LightKind::Point => "point light",
            LightKind::Spot { .. } => "spot light",
            LightKind::Directional { .. } => "directional light",
            LightKind::Area { .. } => "area light",
        };
        return (kind, true);
    }
    (if world.satisfies::<&Cloud>(entity) { "particles" } else { "group" }, false)
}

/// Returns whether a channel, such as `FogDensity`, sets the value at a path, such as `fog.density`.
fn sets(channel: &str, path: &str) -> bool {
    let channel = channel.to_lowercase();
    let path = path.replace('_', "");
    let steps: Vec<&str> = path.split('.').collect();
    let last = steps.last().copied().unwrap_or_default();
    let Some(part) = channel.strip_suffix(last) else { return false };
    let is_inside = |step: &str| steps[..steps.len() - 1].contains(&step);
    match part {
        "stripe" | "brick" | "noise" => is_inside("pattern"),
        "" => !(is_inside("pattern") || is_inside("light") && is_inside("shape")) || last == "mortar",
        part => is_inside(part),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_set_the_values_of_their_fields() {
        for (channel, path) in [
            ("Translation", "entities.ball.transform.translation"),
            ("Kd", "materials.clay.k_d"),
            ("AmbientColor", "materials.clay.ambient_color"),
            ("PatternColor", "materials.clay.pattern.color"),
            ("StripeRatio", "materials.clay.pattern.ratio"),
            ("Mortar", "materials.clay.pattern.mortar"),
            ("LightRadius", "entities.lamp.light.shape.radius"),
            ("Radius", "entities.ball.shape.radius"),
            ("HorizontalFov", "camera.horizontal_fov"),
            ("Aperture", "camera.lens.aperture"),
            ("SunGlowSize", "sun.glow_size"),
            ("FogDensity", "fog.density"),
            ("Ambient", "ambient"),
            ("BackgroundTop", "background.top"),
        ] {
            assert!(sets(channel, path), "{channel} {path}");
        }
        for (channel, path) in [
            ("Color", "materials.clay.pattern.color"),
            ("Radius", "entities.lamp.light.shape.radius"),
            ("Fov", "camera.horizontal_fov"),
            ("FogDensity", "fog.color"),
            ("SunSize", "stars.size"),
            ("SunGlow", "sun.glow_size"),
            ("Color", "materials.clay.ambient_color"),
        ] {
            assert!(!sets(channel, path), "{channel} {path}");
        }
    }
}
