//! Validation of entities.

use std::sync::Arc;

use hashbrown::HashMap;

use super::materials::SLASH;
use super::{At, Named, Problems, check};
use crate::animation::limits::SMALLEST;
use crate::scene::document::{
    EntityDocument, RodDocument, RotationDocument, ScaleDocument, SceneDocument, ShapeDocument,
    SurfaceDocument, TransformDocument, Triple,
};
use crate::scene::files::Scope;
use crate::scene::quote::{Figure, linked, short};

pub(super) fn validate(document: &SceneDocument, scope: Scope<'_>, scene: &At<'_>, problems: &mut Problems) {
    let at = scene.field("entities");
    let names = names(&document.entities, &at, problems);
    for (index, entity) in document.entities.iter().enumerate() {
        let at = at.index(index);
        transform(&entity.transform, &at.field("transform"), problems);
        if let Some(light) = &entity.light {
            super::lights::validate(light, &at.field("light"), problems);
        }
        aim(entity, scope, &at, problems);
        look(entity, &at, problems);
        material(entity, scope, &at, problems);
        if let Some(parent) = entity.parent.as_deref()
            && scope.entity(parent).is_missing()
        {
            problems.add_unknown(&at.field("parent"), Named::Entity, parent, || scope.entity_names());
        }
    }
    cycles(&document.entities, &names, &at, problems);
}

/// Checks the point or the entity that an entity looks at.
fn aim(entity: &EntityDocument, scope: Scope<'_>, at: &At<'_>, problems: &mut Problems) {
    let EntityDocument { transform, target, look_at, .. } = entity;
    let field = match (target, look_at) {
        (None, None) => return,
        (Some(_), None) => "target",
        (None, Some(_)) => "look_at",
        (Some(target), Some(_)) => {
            let help = "keep `look_at` to look at an entity, or `target` at a point";
            let message = "the entity has both `look_at` and `target`";
            let at = at.field("target");
            problems.add(&at, message, "one too many", help);
            check::vector(**target, &at, problems);
            return;
        }
    };
    if transform.rotation != TransformDocument::default().rotation {
        let message = format!("the entity has both a rotation and `{field}`");
        let help = format!("keep one of the two: `{field}` turns the entity's own +z axis");
        problems.add(&at.field("transform").field("rotation"), message, "one too many", help);
    }
    let at = at.field(field);
    if let Some(target) = target.as_deref()
        && check::vector(*target, &at, problems)
        && *target == transform.translation
    {
        let help = "move one of the two: the entity's own +z axis points from its translation to the target";
        problems.add(&at, "the entity's target is where it stands", "the same as its translation", help);
    }
    if let Some(name) = look_at.as_deref() {
        if scope.entity(name).is_missing() {
            problems.add_unknown(&at, Named::Entity, name, || scope.entity_names());
        } else if entity.name.as_ref() == Some(name) {
            problems.add(&at, "an entity looks at itself", "its own name", "name another entity");
        }
    }
}

/// Reports a shape without a material, a material or a colour without a shape, and errors in the shape.
fn look(entity: &EntityDocument, at: &At<'_>, problems: &mut Problems) {
    let Some(shape) = &entity.shape else {
        unseen(entity, at, problems);
        let of_light = entity.light.as_ref().map(|_| "write the colour of a light in its `intensity`");
        for (is_written, field, noun, help) in [
            (entity.material.is_some(), "material", "material", None),
            (entity.color.is_some(), "color", "colour", of_light),
        ] {
            if is_written {
                let help = help.map_or_else(|| format!("add a `shape`, or remove the {noun}"), str::to_owned);
                let message = format!("a {noun} without a shape");
                problems.add(&at.field(field), message, "nothing has this surface", help);
            }
        }
        return;
    };
    self::shape(shape, &at.field("shape"), problems);
    if entity.material.is_none() && entity.color.is_none() {
        problems.add(
            &at.field("shape"),
            "a shape without a material",
            "nothing says what it looks like",
            "add `color: (255, 120, 60)`, or `material: \"name\"`, one of `materials`",
        );
    }
}

/// Reports the visibility of an entity without a shape.
fn unseen(entity: &EntityDocument, at: &At<'_>, problems: &mut Problems) {
    let EntityDocument { visible, casts_shadow, in_reflections, light, .. } = entity;
    for (value, field) in
        [(visible, "visible"), (casts_shadow, "casts_shadow"), (in_reflections, "in_reflections")]
    {
        if !value {
            let help = match light {
                Some(_) if field == "casts_shadow" => {
                    "write `casts_shadows: false` in the light, which then passes through everything"
                }
                Some(_) => "remove it: lights are not seen themselves",
                None => "write it in each part of the entity that has a shape: it does not pass on to parts",
            };
            problems.add(
                &at.field(field),
                format!("`{field}` without a shape"),
                "there is nothing to see",
                help,
            );
        }
    }
}

/// Reports errors in the entity's colour, and a material that does not exist or has errors.
fn material(entity: &EntityDocument, scope: Scope<'_>, entity_at: &At<'_>, problems: &mut Problems) {
    if let Some(color) = &entity.color {
        check::color(color.0, &entity_at.field("color"), problems);
    }
    let at = entity_at.field("material");
    match &entity.material {
        Some(SurfaceDocument::Named(name)) if scope.material(name).is_missing() => {
            problems.add_unknown(&at, Named::Material, name, || scope.material_names());
        }
        Some(SurfaceDocument::Inline(material)) => {
            super::materials::material(material, &at, problems);
            if material.color.is_some() && entity.color.is_some() {
                let message = "two colours of one surface";
                problems.add(
                    &entity_at.field("color"),
                    message,
                    "its material has one, too",
                    "remove one of the two",
                );
            }
        }
        Some(SurfaceDocument::Named(_)) | None => {}
    }
}

/// Returns the indices of entities by name. Reports invalid and duplicate names.
fn names<'a>(
    entities: &'a [Arc<EntityDocument>],
    at: &At<'_>,
    problems: &mut Problems,
) -> HashMap<&'a str, usize> {
    let mut names = HashMap::with_capacity(entities.len());
    for (index, entity) in entities.iter().enumerate() {
        let Some(name) = entity.name.as_deref() else {
            continue;
        };
        let entity_at = at.index(index);
        let at = entity_at.field("name");
        if self::name(name, &at, problems) && names.insert(name, index).is_some() {
            problems.add(
                &at,
                format!("two entities are called \"{}\"", short(name)),
                "again here",
                "give each its own name: others refer to entities by it",
            );
        }
    }
    names
}

/// Checks the name of an entity. Returns whether it is valid.
pub(super) fn name(name: &str, at: &At<'_>, problems: &mut Problems) -> bool {
    if name.is_empty() {
        problems.add(at, "an empty name", "names nothing", "write a name, or omit the field");
    } else if name == SceneDocument::CAMERA {
        problems.add(at, "the name \"camera\" is the camera's own", "taken", "choose another name");
    } else if name == SceneDocument::SCENE {
        problems.add(at, "the name \"scene\" is that of the whole scene", "taken", "choose another name");
    } else if name.contains('/') {
        problems.add(at, "a name with a `/` in it", SLASH, "write another sign, as `-`");
    } else {
        return true;
    }
    false
}

/// Reports each cycle of parents once, and entities that look at a part of themselves, so that what they look at turns with them.
fn cycles(
    entities: &[Arc<EntityDocument>],
    names: &HashMap<&str, usize>,
    at: &At<'_>,
    problems: &mut Problems,
) {
    let named = |name: Option<&String>| names.get(name?.as_str()).copied();
    let parent = |index: usize| named(entities[index].parent.as_deref());
    // The position of an entity depends on its parent, and its rotation on the position of the entity that it looks at.
    let needed = |index: usize| [parent(index), named(entities[index].look_at.as_deref()).and_then(parent)];
    let mut finished = vec![false; entities.len()];
    let mut positions: HashMap<usize, usize> = HashMap::new();
    for start in (0..entities.len()).filter(|index| needed(*index) != [None; 2]) {
        // Entities on the way, each with the number of its links that were followed.
        let mut way = vec![(start, 0)];
        positions.clear();
        while let Some((index, followed)) = way.last_mut() {
            let (index, link) = (*index, *followed);
            *followed += 1;
            if link == 0 && !finished[index] {
                positions.insert(index, way.len() - 1);
            }
            match needed(index).get(link) {
                _ if finished[index] => _ = way.pop(),
                None => {
                    finished[index] = true;
                    positions.remove(&index);
                    way.pop();
                }
                Some(Some(next)) => match positions.get(next) {
                    Some(first) => cycle(&way[*first..], entities, at, problems),
                    None => way.push((*next, 0)),
                },
                Some(None) => {}
            }
        }
    }
}

/// Reports a cycle of entities, given with the numbers of their links that were followed: 1 for the parent, 2 for the entity looked at.
fn cycle(ring: &[(usize, usize)], entities: &[Arc<EntityDocument>], at: &At<'_>, problems: &mut Problems) {
    let name = |index: usize| {
        let name = entities[index].name.as_deref();
        format!("\"{}\"", short(name.unwrap_or("?")))
    };
    if let Some((looking, _)) = ring.iter().rfind(|(_, followed)| *followed == 2) {
        let target = entities[*looking].look_at.as_deref().map_or("", String::as_str);
        problems.add(
            &at.index(*looking).field("look_at"),
            "an entity looks at another that turns with it",
            format!("the place of \"{}\" depends on where {} looks", short(target), name(*looking)),
            "let it look at an entity that is not a part of it",
        );
        return;
    }
    let mut path: Vec<String> = ring.iter().map(|(index, _)| name(*index)).collect();
    path.push(name(ring[0].0));
    let message =
        if ring.len() == 1 { "an entity is its own parent" } else { "entities are each other's parents" };
    problems.add(
        &at.index(ring[0].0).field("parent"),
        message,
        linked(&path, " -> "),
        "remove one of the parents",
    );
}

pub(super) fn transform(transform: &TransformDocument, at: &At<'_>, problems: &mut Problems) {
    check::vector(transform.translation, &at.field("translation"), problems);
    rotation(&transform.rotation, &at.field("rotation"), problems);
    scale(&transform.scale, &at.field("scale"), problems);
}

pub(super) fn rotation(rotation: &RotationDocument, at: &At<'_>, problems: &mut Problems) {
    match *rotation {
        RotationDocument::Euler(x, y, z) => {
            check::vector([x, y, z], at, problems);
        }
        RotationDocument::AxisAngle(axis, angle) => {
            check::direction(axis, "the axis of the rotation", &at.index(0), problems);
            check::number(angle, &at.index(1), problems);
        }
        RotationDocument::Quat(x, y, z, w) => {
            let mut good = true;
            for (index, part) in [x, y, z, w].into_iter().enumerate() {
                good &= check::number(part, &at.index(index), problems);
            }
            if good && [x, y, z, w].iter().all(|part| part.abs() < SMALLEST) {
                let label = if [x, y, z, w] == [0.0; 4] { "no rotation" } else { "too close to zero" };
                let help = "write Quat(0, 0, 0, 1) for no turn at all";
                problems.add(at, "the quaternion is zero", label, help);
            }
        }
    }
}

pub(super) fn scale(scale: &ScaleDocument, at: &At<'_>, problems: &mut Problems) {
    let mut factor = |value: f64, at: &At<'_>| {
        if !check::number(value, at, problems) {
            return;
        }
        if value == 0.0 {
            let help = "write a factor other than 0; 1 changes nothing";
            problems.add(at, "a scale of 0 leaves nothing", "zero", help);
        } else if value.abs() < SMALLEST {
            let message = format!("{} is too small for a scale", Figure(value));
            problems.add(at, message, "out of range", format!("write at least {SMALLEST:e}"));
        }
    };
    match *scale {
        ScaleDocument::Uniform(value) => factor(value, at),
        ScaleDocument::PerAxis(values) => {
            for (index, value) in values.into_iter().enumerate() {
                factor(value, &at.index(index));
            }
        }
    }
}

fn shape(shape: &ShapeDocument, at: &At<'_>, problems: &mut Problems) {
    match *shape {
        ShapeDocument::Sphere { radius } => {
            check::size(radius, "the radius", &at.field("radius"), problems);
        }
        ShapeDocument::Plane { normal } => {
            check::direction(normal, "the normal", &at.field("normal"), problems);
        }
        ShapeDocument::Box { size } => box_size(size, &at.field("size"), problems),
        ShapeDocument::Cylinder(ref rod) => self::rod(rod, "cylinder", at, problems),
        ShapeDocument::Capsule(ref rod) => self::rod(rod, "capsule", at, problems),
    }
}

/// Checks a cylinder or a capsule, which has either both ends of its axis or a height.
fn rod(rod: &RodDocument, what: &str, at: &At<'_>, problems: &mut Problems) {
    check::size(rod.radius, "the radius", &at.field("radius"), problems);
    if let Some(height) = rod.height {
        check::size(height, "the height", &at.field("height"), problems);
    }
    let ends = [("from", rod.from), ("to", rod.to)];
    for (name, end) in ends {
        if let Some(end) = end {
            check::vector(end, &at.field(name), problems);
        }
    }
    match (rod.from, rod.to, rod.height) {
        (Some(from), Some(to), None) if from == to => {
            let message = format!("the {what} ends where it begins");
            let help = "write two different points, or a Sphere";
            problems.add(&at.field("to"), message, "the same as `from`", help);
        }
        (None, None, Some(_)) | (Some(_), Some(_), None) => {}
        (_, _, Some(_)) => {
            let name = if rod.from.is_some() { "from" } else { "to" };
            let message = format!("the {what} has both `height` and `{name}`");
            let help =
                format!("keep `from` and `to`, or `height` for a {what} along the entity's own y axis");
            problems.add(&at.field("height"), message, "one too many", help);
        }
        (from, _, None) => {
            let message = match (from, rod.to) {
                (None, None) => format!("the {what} has no ends"),
                (None, _) => format!("the {what} has no `from`"),
                _ => format!("the {what} has no `to`"),
            };
            let help = "write `from: (0, 0, 0), to: (0, 2, 0)`, or `height: 2` along the entity's own y axis";
            problems.add(at, message, "its length is unknown", help);
        }
    }
}

pub(super) fn box_size(size: Triple, at: &At<'_>, problems: &mut Problems) {
    for (index, length) in size.into_iter().enumerate() {
        check::size(length, "every edge of a box", &at.index(index), problems);
    }
}
