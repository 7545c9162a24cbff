//! Which entities of a world are those of another scene.

use std::collections::HashMap;

use glam::DVec3;
use hecs::{Entity, Query, QueryBorrow, Satisfies, World};

use crate::components::{Material, Name, Order, Shape, Transform};

/// Which is which.
pub(super) struct Matching {
    /// The entities of the scene in document order, each with the one of the world that goes on as it.
    pub(super) pairs: Vec<(Entity, Option<Entity>)>,
    /// The entities of the world that the scene does not have.
    pub(super) gone: Vec<Entity>,
    /// Are the same entities drawn, in the same order?
    pub(super) same_drawn: bool,
}

type ThingQuery<'a> = (
    Entity,
    Option<&'a Order>,
    Option<&'a Name>,
    Option<&'a Transform>,
    Option<&'a Shape>,
    Satisfies<&'a Material>,
);

/// What is to be known of an entity.
struct Thing<'a> {
    entity: Entity,
    order: u64,
    drawn: bool,
    known_by: KnownBy<'a>,
}

enum KnownBy<'a> {
    Name(&'a str),
    Content(Option<&'a Transform>, Option<&'a Shape>),
}

/// What an entity is recognised by: the name, or else what it is and where. Materials do not count: they alone are animated in
/// entities without a name.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Mark<'a> {
    Name(&'a str),
    Content([u64; 10], [u64; 4]),
}

impl Matching {
    pub(super) fn of(world: &World, scene: &World) -> Self {
        let (mut world, mut scene) = (world.query::<ThingQuery<'_>>(), scene.query::<ThingQuery<'_>>());
        let (old, new) = rayon::join(|| in_document_order(&mut world), || in_document_order(&mut scene));
        let found = find(&old, &new);
        let pairs = new.iter().zip(&found).map(|(new, place)| (new.entity, place.map(|at| old[at].entity)));
        let drawn_before = old.iter().filter(|thing| thing.drawn).map(|thing| Some(thing.entity));
        let drawn_now = new.iter().zip(&found).filter(|(thing, _)| thing.drawn);
        Self {
            same_drawn: drawn_before.eq(drawn_now.map(|(_, place)| place.map(|at| old[at].entity))),
            pairs: pairs.collect(),
            gone: not_found(&old, &found).map(|at| old[at].entity).collect(),
        }
    }
}

fn in_document_order<'a>(all: &'a mut QueryBorrow<'_, ThingQuery<'_>>) -> Vec<Thing<'a>> {
    let thing =
        |(entity, order, name, transform, shape, material): <ThingQuery<'a> as Query>::Item<'a>| Thing {
            entity,
            order: order.map_or(u64::MAX, |order| order.0),
            drawn: shape.is_some() && material,
            known_by: match name {
                Some(name) => KnownBy::Name(&name.0),
                None => KnownBy::Content(transform, shape),
            },
        };
    let mut things: Vec<Thing<'a>> = all.iter().map(thing).collect();
    things.sort_by_key(|thing| (thing.order, thing.entity.id()));
    things
}

/// For each of `new` its place in `old`: by name; without one by content, then by position among those that are left.
fn find(old: &[Thing<'_>], new: &[Thing<'_>]) -> Vec<Option<usize>> {
    let alike = |(old, new): &(&Thing<'_>, &Thing<'_>)| old.mark() == new.mark();
    let head = old.iter().zip(new).take_while(alike).count();
    let backwards = old[head..].iter().rev().zip(new[head..].iter().rev());
    let tail = backwards.take_while(alike).count();
    let (old_end, new_end) = (old.len() - tail, new.len() - tail);

    let mut places: HashMap<Mark<'_>, Vec<usize>> = HashMap::new();
    for at in (head..old_end).rev() {
        places.entry(old[at].mark()).or_default().push(at);
    }
    let mut found: Vec<Option<usize>> = (0..head).map(Some).collect();
    found.extend(new[head..new_end].iter().map(|thing| places.get_mut(&thing.mark())?.pop()));
    found.extend((old_end..old.len()).map(Some));

    let left: Vec<usize> = not_found(old, &found).filter(|at| !old[*at].is_named()).collect();
    let lost = found.iter_mut().zip(new).filter(|(place, thing)| place.is_none() && !thing.is_named());
    for ((place, _), at) in lost.zip(left) {
        *place = Some(at);
    }
    found
}

/// The places that are not among those found.
fn not_found(old: &[Thing<'_>], found: &[Option<usize>]) -> impl Iterator<Item = usize> + use<> {
    let mut is_found = vec![false; old.len()];
    for at in found.iter().flatten() {
        is_found[*at] = true;
    }
    is_found.into_iter().enumerate().filter_map(|(at, is_found)| (!is_found).then_some(at))
}

impl<'a> Thing<'a> {
    fn is_named(&self) -> bool {
        matches!(self.known_by, KnownBy::Name(_))
    }

    fn mark(&self) -> Mark<'a> {
        match self.known_by {
            KnownBy::Name(name) => Mark::Name(name),
            KnownBy::Content(transform, shape) => {
                Mark::Content(transform.map_or([0; 10], placed), shape.map_or([0; 4], shaped))
            }
        }
    }
}

/// The bits of a transform.
pub(super) fn placed(transform: &Transform) -> [u64; 10] {
    let ([x, y, z], [i, j, k, w]) = (transform.translation.to_array(), transform.rotation.to_array());
    let [a, b, c] = transform.scale.to_array();
    [x, y, z, i, j, k, w, a, b, c].map(f64::to_bits)
}

/// The bits of a shape.
pub(super) fn shaped(shape: &Shape) -> [u64; 4] {
    let (kind, DVec3 { x, y, z }) = match *shape {
        Shape::Sphere { radius } => (1, DVec3::splat(radius)),
        Shape::Plane { normal } => (2, normal),
        Shape::Box { size } => (3, size),
    };
    [kind, x.to_bits(), y.to_bits(), z.to_bits()]
}
