//! Matches the entities of a world with the entities of another scene.

use std::collections::HashMap;
use std::ops::Range;

use glam::DVec3;
use hecs::{Archetype, ArchetypeColumn, Entity, World};
use rayon::prelude::*;

use crate::components::{Material, Name, Order, Shape, Transform};

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

/// The correspondence between two worlds.
pub(super) struct Matching {
    /// The entities of the world that have a counterpart in the scene.
    pub(super) own: Counterparts,
    /// The entities of the scene without a counterpart in the world, in document order.
    pub(super) new: Vec<Entity>,
    /// The entities of the scene whose counterparts have components of other types.
    pub(super) of_other_types: Vec<Entity>,
    /// The entities of the world without a counterpart in the scene.
    pub(super) gone: Vec<Entity>,
    /// True if the drawn entities are the same, in the same order.
    pub(super) same_drawn: bool,
}

/// The entities of a world that have components of the same types.
struct EntityTable<'a> {
    entities: Vec<Entity>,
    orders: Option<&'a [Order]>,
    names: Option<&'a [Name]>,
    transforms: Option<&'a [Transform]>,
    shapes: Option<&'a [Shape]>,
    drawn: bool,
}

/// The borrowed component columns of a table.
struct Columns<'a> {
    archetype: &'a Archetype,
    orders: Option<ArchetypeColumn<'a, Order>>,
    names: Option<ArchetypeColumn<'a, Name>>,
    transforms: Option<ArchetypeColumn<'a, Transform>>,
    shapes: Option<ArchetypeColumn<'a, Shape>>,
}

/// All entities of a world in document order.
struct Things<'a> {
    tables: &'a [EntityTable<'a>],
    locations: Vec<ComponentLocation>,
}

/// The location of an entity's components.
#[derive(Clone, Copy)]
struct ComponentLocation {
    order: u64,
    table: u32,
    row: u32,
}

/// The key by which an entity is matched: its name or, without a name, its transform and shape. Materials are not part of the key: in
/// entities without a name, they alone can be animated.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum MatchKey<'a> {
    Name(&'a str),
    Content([u64; 10], [u64; 8]),
}

impl Matching {
    pub(super) fn of(world: &World, scene: &World) -> Self {
        let (old_columns, new_columns) = (columns(world), columns(scene));
        let types = same_types(&old_columns, &new_columns);
        let (old, new) = (tables(world, &old_columns), tables(scene, &new_columns));
        if let Some(own) = stored_alike(&old, &new, &types) {
            return Self {
                own,
                new: Vec::new(),
                of_other_types: Vec::new(),
                gone: Vec::new(),
                same_drawn: true,
            };
        }
        let (old, new) = rayon::join(|| Things::in_document_order(&old), || Things::in_document_order(&new));
        Self::pair(&old, &new, &types)
    }

    fn pair(old: &Things<'_>, new: &Things<'_>, types: &[Option<usize>]) -> Self {
        let found = Matches::of(old, new);
        let mut matching = Self {
            own: Counterparts::of_many(new.len()),
            new: Vec::new(),
            of_other_types: Vec::new(),
            gone: found.missed().map(|at| old.entity(at)).collect(),
            same_drawn: true,
        };
        let mut drawn_before = (0..old.len()).filter(|at| old.table(*at).drawn);
        for at in 0..new.len() {
            let (entity, counterpart) = (new.entity(at), found.counterpart(at));
            if new.table(at).drawn {
                matching.same_drawn &= counterpart.is_some() && drawn_before.next() == counterpart;
            }
            match counterpart {
                None => matching.new.push(entity),
                Some(counterpart) => {
                    matching.own.insert(entity, old.entity(counterpart));
                    if types[new.locations[at].table as usize]
                        != Some(old.locations[counterpart].table as usize)
                    {
                        matching.of_other_types.push(entity);
                    }
                }
            }
        }
        matching.same_drawn &= drawn_before.next().is_none();
        matching
    }
}

impl<'a> Columns<'a> {
    fn of(archetype: &'a Archetype) -> Self {
        Self {
            archetype,
            orders: archetype.get::<&Order>(),
            names: archetype.get::<&Name>(),
            transforms: archetype.get::<&Transform>(),
            shapes: archetype.get::<&Shape>(),
        }
    }
}

fn columns(world: &World) -> Vec<Columns<'_>> {
    world.archetypes().map(Columns::of).collect()
}

/// Lists the world's archetypes in storage order.
fn tables<'a>(world: &World, columns: &'a [Columns<'_>]) -> Vec<EntityTable<'a>> {
    let mut entities = world.query::<Entity>();
    let mut entities = entities.iter();
    let table = |columns: &'a Columns<'_>| EntityTable {
        entities: entities.by_ref().take(columns.archetype.len() as usize).collect(),
        orders: columns.orders.as_deref(),
        names: columns.names.as_deref(),
        transforms: columns.transforms.as_deref(),
        shapes: columns.shapes.as_deref(),
        drawn: columns.shapes.is_some() && columns.archetype.has::<Material>(),
    };
    columns.iter().map(table).collect()
}

/// Returns, for each of the `new` archetypes, the index of the `old` archetype with the same component types.
fn same_types(old: &[Columns<'_>], new: &[Columns<'_>]) -> Vec<Option<usize>> {
    let same = |old: &Columns<'_>, new: &Columns<'_>| {
        old.archetype.component_types().eq(new.archetype.component_types())
    };
    new.iter().map(|new| old.iter().position(|old| same(old, new))).collect()
}

/// Matches the entities of the world with the scene's in storage order. Returns `None` unless each pair has the same mark, the same
/// document order and components of the same types, as after edits that change values only.
fn stored_alike(
    old: &[EntityTable<'_>],
    new: &[EntityTable<'_>],
    types: &[Option<usize>],
) -> Option<Counterparts> {
    let count =
        |tables: &[EntityTable<'_>]| -> usize { tables.iter().map(|table| table.entities.len()).sum() };
    if count(old) != count(new) {
        return None;
    }
    let mut own = Counterparts::of_many(count(new));
    for (new, types) in new.iter().zip(types).filter(|(new, _)| !new.entities.is_empty()) {
        let old = &old[(*types)?];
        let alike = |row: usize| old.order(row) == new.order(row) && old.mark(row) == new.mark(row);
        let rows = new.entities.len();
        if old.entities.len() != rows || !(0..rows).into_par_iter().all(alike) {
            return None;
        }
        for (new, old) in new.entities.iter().zip(&old.entities) {
            own.insert(*new, *old);
        }
    }
    Some(own)
}

impl<'a> EntityTable<'a> {
    fn order(&self, row: usize) -> u64 {
        self.orders.map_or(u64::MAX, |orders| orders[row].0)
    }

    fn mark(&self, row: usize) -> MatchKey<'a> {
        match self.names {
            Some(names) => MatchKey::Name(&names[row].0),
            None => MatchKey::Content(
                self.transforms.map_or([0; 10], |transforms| transform_bits(&transforms[row])),
                self.shapes.map_or([0; 8], |shapes| shape_bits(&shapes[row])),
            ),
        }
    }
}

impl<'a> Things<'a> {
    fn in_document_order(tables: &'a [EntityTable<'a>]) -> Self {
        let mut locations = Vec::with_capacity(tables.iter().map(|table| table.entities.len()).sum());
        for (table, index) in tables.iter().zip(0..) {
            let rows = (0..table.entities.len()).zip(0..);
            locations.extend(rows.map(|(at, row)| ComponentLocation {
                order: table.order(at),
                table: index,
                row,
            }));
        }
        let id = |location: &ComponentLocation| {
            tables[location.table as usize].entities[location.row as usize].id()
        };
        locations.sort_by(|a, b| a.order.cmp(&b.order).then_with(|| id(a).cmp(&id(b))));
        Self { tables, locations }
    }

    fn len(&self) -> usize {
        self.locations.len()
    }

    fn table(&self, at: usize) -> &EntityTable<'a> {
        &self.tables[self.locations[at].table as usize]
    }

    fn entity(&self, at: usize) -> Entity {
        self.table(at).entities[self.locations[at].row as usize]
    }

    fn is_named(&self, at: usize) -> bool {
        self.table(at).names.is_some()
    }

    fn mark(&self, at: usize) -> MatchKey<'a> {
        self.table(at).mark(self.locations[at].row as usize)
    }
}

/// The matches between an old and a new list of entities. The lists agree before and after the middle ranges `old` and `new`.
struct Matches {
    middle: Vec<Option<usize>>,
    old: Range<usize>,
    new: Range<usize>,
}

impl Matches {
    /// Matches entities with names by name. Matches entities without names by content, and the remaining ones by position.
    fn of(old: &Things<'_>, new: &Things<'_>) -> Self {
        let shorter = old.len().min(new.len());
        let differ = |at: usize| old.mark(at) != new.mark(at);
        let head = (0..shorter).into_par_iter().position_first(differ).unwrap_or(shorter);
        let alike = |back: &usize| old.mark(old.len() - back) == new.mark(new.len() - back);
        let tail = (1..=shorter - head).take_while(alike).count();
        let mut found = Self { middle: Vec::new(), old: head..old.len() - tail, new: head..new.len() - tail };

        let mut by_mark: HashMap<MatchKey<'_>, Vec<usize>> = HashMap::new();
        for at in found.old.clone().rev() {
            by_mark.entry(old.mark(at)).or_default().push(at);
        }
        found.middle = found.new.clone().map(|at| by_mark.get_mut(&new.mark(at))?.pop()).collect();

        let left: Vec<usize> = found.missed().filter(|at| !old.is_named(*at)).collect();
        let counterparts = found.middle.iter_mut().zip(found.new.clone());
        let lost = counterparts.filter(|(counterpart, at)| counterpart.is_none() && !new.is_named(*at));
        for ((counterpart, _), at) in lost.zip(left) {
            *counterpart = Some(at);
        }
        found
    }

    fn counterpart(&self, at: usize) -> Option<usize> {
        match at {
            _ if at < self.new.start => Some(at),
            _ if at < self.new.end => self.middle[at - self.new.start],
            _ => Some(at - self.new.end + self.old.end),
        }
    }

    /// Returns the indices in the old list that have no match.
    fn missed(&self) -> impl Iterator<Item = usize> + use<> {
        let mut is_found = vec![false; self.old.len()];
        for at in self.middle.iter().flatten() {
            is_found[at - self.old.start] = true;
        }
        self.old.clone().zip(is_found).filter_map(|(at, is_found)| (!is_found).then_some(at))
    }
}

/// Returns the bits of all numbers of a transform.
pub(super) fn transform_bits(transform: &Transform) -> [u64; 10] {
    let ([x, y, z], [i, j, k, w]) = (transform.translation.to_array(), transform.rotation.to_array());
    let [a, b, c] = transform.scale.to_array();
    [x, y, z, i, j, k, w, a, b, c].map(f64::to_bits)
}

/// Returns the kind of a shape and the bits of its numbers.
pub(super) fn shape_bits(shape: &Shape) -> [u64; 8] {
    let (kind, number, one, other) = match *shape {
        Shape::Sphere { radius } => (1, radius, DVec3::ZERO, DVec3::ZERO),
        Shape::Plane { normal } => (2, 0.0, normal, DVec3::ZERO),
        Shape::Box { size } => (3, 0.0, size, DVec3::ZERO),
        Shape::Cylinder { radius, from, to } => (4, radius, from, to),
        Shape::Capsule { radius, from, to } => (5, radius, from, to),
    };
    let [x, y, z, i, j, k] = [one.x, one.y, one.z, other.x, other.y, other.z].map(f64::to_bits);
    [kind, number.to_bits(), x, y, z, i, j, k]
}
