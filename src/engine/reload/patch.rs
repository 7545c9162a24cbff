//! Turns a world into that of another scene, with as little as possible changed.

use hecs::{Component, Entity, World};

use super::counterparts::Counterparts;
use super::matching::{Matching, placed, shaped};
use crate::components::{
    Ambient, Animated, Background, Camera, Checker, FilmSettings, Fog, Follow, Light, LookAt, Material,
    Order, Parent, Quality, Reflective, Refractive, Sampling, Shots, Specular,
};
use crate::systems::Changes;

/// Gives `world` the entities and components of `scene`, and says what really changed. It does not matter what has been done to the
/// world: every component is what the scene says, but for world transforms, which are to be derived again where that is recorded.
/// Entities with the same name, or without one and with the same content or position, stay who they are.
pub(super) fn patch(world: &mut World, mut scene: World) -> Changes {
    world.flush();
    let Matching { mut own, new, of_other_types, gone, same_drawn } = Matching::of(world, &scene);
    let mut changes = Changes::default();
    if !same_drawn {
        changes.anything();
    }
    for entity in &new {
        own.insert(*entity, world.reserve_entity());
    }
    world.flush();
    translate_links(&mut scene, &own);
    // Each id would be looked for among the free ones, and there may be many.
    let free: Vec<Entity> = world.freelist().collect();
    world.set_freelist(&[]);
    for entity in new.into_iter().chain(of_other_types) {
        if let Ok(parts) = scene.take(entity) {
            let own = own.of(entity);
            world.spawn_at(own, parts);
            changes.transform(own);
            changes.shape(own);
            changes.material(own);
        }
    }
    world.set_freelist(&free);
    write(Worlds { world, scene: &scene, own: &own }, &mut changes);
    for entity in gone {
        // The entity exists: it was found just now.
        let _ = world.despawn(entity);
    }
    // What many entities had is given back while the next picture is made.
    rayon::spawn(move || drop((scene, own)));
    changes
}

/// Lets all components that name entities name those of the world.
fn translate_links(scene: &mut World, own: &Counterparts) {
    for parent in scene.query_mut::<&mut Parent>() {
        parent.0 = own.of(parent.0);
    }
    for followed in scene.query_mut::<&mut Follow>() {
        followed.0 = own.of(followed.0);
    }
    for looked_at in scene.query_mut::<&mut LookAt>() {
        looked_at.0 = own.of(looked_at.0);
    }
    for shots in scene.query_mut::<&mut Shots>() {
        for shot in &mut shots.0 {
            shot.camera = own.of(shot.camera);
        }
    }
}

/// Writes the entities that have components of the same types as before. Names are the same.
fn write(worlds: Worlds<'_>, changes: &mut Changes) {
    let ((moved, resized), painted) = rayon::join(
        || {
            let moved = worlds.put_bits(placed).into_iter().chain(worlds.put_all::<Parent>());
            (moved, worlds.put_bits(shaped))
        },
        || {
            let painted = worlds.put_all::<Material>().into_iter();
            let painted = painted.chain(worlds.put_all::<Specular>()).chain(worlds.put_all::<Reflective>());
            let painted = painted.chain(worlds.put_all::<Refractive>()).chain(worlds.put_all::<Checker>());
            worlds.put_all::<Order>();
            // What motions write, they record.
            worlds.put(|old: &mut Animated, new| {
                std::mem::swap(old, new);
                false
            });
            // These are read for every frame.
            worlds.put_all::<Light>();
            worlds.put_all::<Camera>();
            worlds.put_all::<Follow>();
            worlds.put_all::<LookAt>();
            worlds.put_all::<Shots>();
            worlds.put_all::<FilmSettings>();
            worlds.put_all::<Ambient>();
            worlds.put_all::<Background>();
            worlds.put_all::<Fog>();
            worlds.put_all::<Quality>();
            worlds.put_all::<Sampling>();
            painted
        },
    );
    moved.for_each(|entity| changes.transform(entity));
    resized.into_iter().for_each(|entity| changes.shape(entity));
    painted.for_each(|entity| changes.material(entity));
}

/// Two worlds, the components of which are put from one to the other type by type.
#[derive(Clone, Copy)]
struct Worlds<'a> {
    world: &'a World,
    scene: &'a World,
    own: &'a Counterparts,
}

impl Worlds<'_> {
    /// The entities of the world for which `put` says that something else is there now.
    fn put<T: Component>(self, put: impl Fn(&mut T, &mut T) -> bool) -> Vec<Entity> {
        let (mut old, mut new) = (self.world.query::<&mut T>(), self.scene.query::<(Entity, &mut T)>());
        let mut old = old.view();
        let mut changed = Vec::new();
        for (entity, new) in &mut new {
            let own = self.own.of(entity);
            if old.get_mut(own).is_some_and(|old| put(old, new)) {
                changed.push(own);
            }
        }
        changed
    }

    /// Puts the new values in place, to the last bit.
    fn put_all<T: Component + PartialEq>(self) -> Vec<Entity> {
        self.put(|old: &mut T, new| {
            let differs = *old != *new;
            std::mem::swap(old, new);
            differs
        })
    }

    /// As [`put_all`](Self::put_all), but zeros of another sign are different: world transforms show them.
    fn put_bits<T: Component, const N: usize>(self, bits: impl Fn(&T) -> [u64; N]) -> Vec<Entity> {
        self.put(|old: &mut T, new| {
            let differs = bits(old) != bits(new);
            if differs {
                std::mem::swap(old, new);
            }
            differs
        })
    }
}
