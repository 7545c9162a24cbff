//! Patches a world to equal the world of another scene, with as few changes as possible.

use hecs::{Component, Entity, World};
use rayon::prelude::*;

use super::matching::{Counterparts, Matching, shape_bits, transform_bits};
use crate::components::{
    self, Emission, FocusOn, Follow, LookAt, Material, Overlay, Parent, Pattern, Reflective, Refractive,
    Shape, Shots, Specular, Target, Transform, Visibility, with_components,
};
use crate::systems::Changes;

/// Gives `world` the entities and components of `scene`, and returns the changes. The previous state of the world does not matter: every
/// component gets the value in the scene, except for world transforms, which the returned changes cause to be derived again. Entities with
/// the same name, or without a name and with the same content or position, keep their identity.
pub(super) fn patch(world: &mut World, mut scene: World) -> Changes {
    world.flush();
    let Matching { mut own, new, of_other_types, gone, same_drawn } = Matching::of(world, &scene);
    let mut changes = Changes::default();
    if !same_drawn {
        changes.mark_all();
    }
    for entity in &new {
        own.insert(*entity, world.reserve_entity());
    }
    world.flush();
    translate_links(&mut scene, &own);
    // `spawn_at` searches the free list for each id, and the list may be long.
    let free: Vec<Entity> = world.freelist().collect();
    world.set_freelist(&[]);
    for entity in new.into_iter().chain(of_other_types) {
        if let Ok(parts) = scene.take(entity) {
            let own = own.of(entity);
            world.spawn_at(own, parts);
            changes.mark_transform(own);
            changes.mark_shape(own);
            changes.mark_material(own);
        }
    }
    world.set_freelist(&free);
    write(Worlds { world, scene: &scene, own: &own }, &mut changes);
    for entity in gone {
        // The entity exists: it was found just now.
        let _ = world.despawn(entity);
    }
    // Dropping the components of many entities takes time; it overlaps with the next frame.
    rayon::spawn(move || drop((scene, own)));
    changes
}

/// Replaces all references to entities of the scene with references to their counterparts in the world.
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
    for focused in scene.query_mut::<&mut FocusOn>() {
        focused.0 = own.of(focused.0);
    }
    for overlay in scene.query_mut::<&mut Overlay>() {
        for cloud in overlay.0.iter_mut().filter_map(|item| item.content.cloud_mut()) {
            *cloud = own.of(*cloud);
        }
    }
    for shots in scene.query_mut::<&mut Shots>() {
        for shot in &mut shots.0 {
            shot.camera = own.of(shot.camera);
        }
    }
}

/// Writes the components of the entities whose component types are the same as before.
fn write(worlds: Worlds<'_>, changes: &mut Changes) {
    macro_rules! writers {
        ($($component:ident: $written:ident,)*) => {
            &[$(|worlds| worlds.$written::<components::$component>(),)*]
        };
    }
    let writers: &[fn(Worlds<'_>) -> ComponentChanges] = with_components!(writers);
    let written: Vec<ComponentChanges> = writers.par_iter().map(|write| write(worlds)).collect();
    for ComponentChanges { entities, declare } in written {
        entities.into_iter().for_each(|entity| declare(changes, entity));
    }
}

/// The entities of the world whose components of one type have changed, and the function that declares the change.
struct ComponentChanges {
    entities: Vec<Entity>,
    declare: fn(&mut Changes, Entity),
}

impl ComponentChanges {
    /// No changes.
    const NONE: Self = Self { entities: Vec::new(), declare: |_, _| {} };
}

/// Two worlds between which components are swapped, one type at a time.
#[derive(Clone, Copy)]
struct Worlds<'a> {
    world: &'a World,
    scene: &'a World,
    own: &'a Counterparts,
}

/// The methods are named after the words of [`with_components`].
impl Worlds<'_> {
    fn transform<T: Put>(self) -> ComponentChanges {
        ComponentChanges { entities: self.put(T::put), declare: Changes::mark_transform }
    }

    fn shape<T: Put>(self) -> ComponentChanges {
        ComponentChanges { entities: self.put(T::put), declare: Changes::mark_shape }
    }

    fn material<T: Put>(self) -> ComponentChanges {
        ComponentChanges { entities: self.put(T::put), declare: Changes::mark_material }
    }

    fn rewritten<T: Component>(self) -> ComponentChanges {
        self.put(|old: &mut T, new| {
            std::mem::swap(old, new);
            false
        });
        ComponentChanges::NONE
    }

    #[expect(clippy::extra_unused_type_parameters, reason = "it is called as the other words are")]
    fn kept<T: Component>(self) -> ComponentChanges {
        ComponentChanges::NONE
    }

    /// Swaps in the components of the scene. Returns the entities of the world for which `put` reports a change.
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
}

/// A component from which data is prepared that is kept from moment to moment.
trait Put: Component + PartialEq + Sized {
    /// Swaps in the new value. Returns whether it differs from the old one.
    fn put(&mut self, new: &mut Self) -> bool {
        let differs = *self != *new;
        std::mem::swap(self, new);
        differs
    }
}

impl Put for Parent {}
impl Put for LookAt {}
impl Put for Visibility {}
impl Put for Material {}
impl Put for Specular {}
impl Put for Reflective {}
impl Put for Refractive {}
impl Put for Pattern {}
impl Put for Emission {}

/// Compares bits, since zeros of different signs give different world transforms.
impl Put for Transform {
    fn put(&mut self, new: &mut Self) -> bool {
        put_bits(self, new, transform_bits)
    }
}

/// Compares bits, like the implementation for transforms.
impl Put for Target {
    fn put(&mut self, new: &mut Self) -> bool {
        put_bits(self, new, |target| target.0.to_array().map(f64::to_bits))
    }
}

/// Compares bits, like the implementation for transforms.
impl Put for Shape {
    fn put(&mut self, new: &mut Self) -> bool {
        put_bits(self, new, shape_bits)
    }
}

fn put_bits<T, const N: usize>(old: &mut T, new: &mut T, bits: impl Fn(&T) -> [u64; N]) -> bool {
    let differs = bits(old) != bits(new);
    if differs {
        std::mem::swap(old, new);
    }
    differs
}
