//! Turns a world into that of another scene, with as little as possible changed.

use hecs::{Entity, World};

use super::matching::{Matching, placed, shaped};
use crate::components::{
    Ambient, Animated, Background, Camera, Checker, FilmSettings, Fog, Follow, Light, LookAt, Material, Name,
    Order, Parent, Quality, Reflective, Refractive, Sampling, Shape, Shots, Specular, Transform,
};
use crate::systems::Changes;

/// All components of a scene, if an entity has them, but those that are derived from others.
type Written<'a> = (
    (Option<&'a mut Name>, Option<&'a mut Order>, Option<&'a mut Animated>),
    (Option<&'a mut Transform>, Option<&'a mut Parent>),
    Option<&'a mut Shape>,
    (
        Option<&'a mut Material>,
        Option<&'a mut Specular>,
        Option<&'a mut Reflective>,
        Option<&'a mut Refractive>,
        Option<&'a mut Checker>,
    ),
    (
        Option<&'a mut Light>,
        Option<&'a mut Camera>,
        Option<&'a mut Follow>,
        Option<&'a mut LookAt>,
        Option<&'a mut Shots>,
    ),
    (
        Option<&'a mut FilmSettings>,
        Option<&'a mut Ambient>,
        Option<&'a mut Background>,
        Option<&'a mut Fog>,
        Option<&'a mut Quality>,
        Option<&'a mut Sampling>,
    ),
);

/// Gives `world` the entities and components of `scene`, and says what really changed. It does not matter what has been done to the
/// world: every component is what the scene says, but for world transforms, which are to be derived again where that is recorded.
/// Entities with the same name, or without one and with the same content or position, stay who they are.
pub(super) fn patch(world: &mut World, mut scene: World) -> Changes {
    let Matching { pairs, gone, same_drawn } = Matching::of(world, &scene);
    let mut changes = Changes::default();
    if !same_drawn {
        changes.anything();
    }
    for entity in gone {
        // The entity exists: it was found just now.
        let _ = world.despawn(entity);
    }
    let pairs = with_newcomers(world, &pairs);
    let own = Translation::of(&pairs);
    translate_links(&mut scene, &own);
    for (entity, own) in pairs {
        if !has_same_parts(world, own, &scene, entity)
            && let Ok(parts) = scene.take(entity)
        {
            world.spawn_at(own, parts);
            changes.transform(own);
            changes.shape(own);
            changes.material(own);
        }
    }
    let mut view = world.view_mut::<Written<'_>>();
    for (entity, new) in scene.query_mut::<(Entity, Written<'_>)>() {
        let own = own.get(entity);
        if let Some(old) = view.get_mut(own) {
            write(old, new, own, &mut changes);
        }
    }
    // What many entities had is given back while the next picture is made.
    rayon::spawn(move || drop(scene));
    changes
}

/// With empty entities for those that the world does not have yet.
fn with_newcomers(world: &mut World, pairs: &[(Entity, Option<Entity>)]) -> Vec<(Entity, Entity)> {
    pairs.iter().map(|(entity, own)| (*entity, own.unwrap_or_else(|| world.spawn(())))).collect()
}

/// The world's entities by those of the scene. Ids of a fresh world are dense, so that a list does.
struct Translation(Vec<Entity>);

impl Translation {
    fn of(pairs: &[(Entity, Entity)]) -> Self {
        let length = pairs.iter().map(|(entity, _)| entity.id() as usize + 1).max().unwrap_or(0);
        let mut list = vec![Entity::DANGLING; length];
        for (entity, own) in pairs {
            list[entity.id() as usize] = *own;
        }
        Self(list)
    }

    fn get(&self, entity: Entity) -> Entity {
        self.0.get(entity.id() as usize).copied().unwrap_or(Entity::DANGLING)
    }
}

/// Lets all components that name entities name those of the world.
fn translate_links(scene: &mut World, own: &Translation) {
    for parent in scene.query_mut::<&mut Parent>() {
        parent.0 = own.get(parent.0);
    }
    for followed in scene.query_mut::<&mut Follow>() {
        followed.0 = own.get(followed.0);
    }
    for looked_at in scene.query_mut::<&mut LookAt>() {
        looked_at.0 = own.get(looked_at.0);
    }
    for shots in scene.query_mut::<&mut Shots>() {
        for shot in &mut shots.0 {
            shot.camera = own.get(shot.camera);
        }
    }
}

/// Have two entities components of the same types?
fn has_same_parts(world: &World, own: Entity, scene: &World, entity: Entity) -> bool {
    let (Ok(own), Ok(entity)) = (world.entity(own), scene.entity(entity)) else { return false };
    own.component_types().eq(entity.component_types())
}

/// Writes an entity that has components of the same types as before.
fn write(
    old: <Written<'_> as hecs::Query>::Item<'_>,
    new: <Written<'_> as hecs::Query>::Item<'_>,
    own: Entity,
    changes: &mut Changes,
) {
    let (old_identity, old_place, old_shape, old_surface, old_view, old_settings) = old;
    let (new_identity, new_place, new_shape, new_surface, new_view, new_settings) = new;
    put(old_identity.0, new_identity.0);
    put(old_identity.1, new_identity.1);
    // What motions write, they record.
    if let (Some(old), Some(new)) = (old_identity.2, new_identity.2) {
        std::mem::swap(old, new);
    }
    if put_bits(old_place.0, new_place.0, placed) | put(old_place.1, new_place.1) {
        changes.transform(own);
    }
    if put_bits(old_shape, new_shape, shaped) {
        changes.shape(own);
    }
    if put(old_surface.0, new_surface.0)
        | put(old_surface.1, new_surface.1)
        | put(old_surface.2, new_surface.2)
        | put(old_surface.3, new_surface.3)
        | put(old_surface.4, new_surface.4)
    {
        changes.material(own);
    }
    // These are read for every frame.
    put(old_view.0, new_view.0);
    put(old_view.1, new_view.1);
    put(old_view.2, new_view.2);
    put(old_view.3, new_view.3);
    put(old_view.4, new_view.4);
    put(old_settings.0, new_settings.0);
    put(old_settings.1, new_settings.1);
    put(old_settings.2, new_settings.2);
    put(old_settings.3, new_settings.3);
    put(old_settings.4, new_settings.4);
    put(old_settings.5, new_settings.5);
}

/// Puts the new value in place, to the last bit. Is it different?
fn put<T: PartialEq>(old: Option<&mut T>, new: Option<&mut T>) -> bool {
    let (Some(old), Some(new)) = (old, new) else { return false };
    let differs = *old != *new;
    std::mem::swap(old, new);
    differs
}

/// As [`put`], but zeros of another sign are different: world transforms show them.
fn put_bits<T, const N: usize>(
    old: Option<&mut T>,
    new: Option<&mut T>,
    bits: impl Fn(&T) -> [u64; N],
) -> bool {
    let (Some(old), Some(new)) = (old, new) else { return false };
    let differs = bits(old) != bits(new);
    std::mem::swap(old, new);
    differs
}
