//! Worlds in words, so that two can be compared without regard to entity ids.

use std::collections::HashMap;
use std::fmt::{Debug, Write};

use rayreel::components::{
    Ambient, Animated, Background, Camera, Checker, FilmSettings, Fog, Follow, Light, LookAt, Material, Name,
    Order, Parent, Quality, Reflective, Refractive, Sampling, Shape, Shots, Specular, Transform,
    WorldTransform,
};
use rayreel::{Entity, Film, World};

/// Every component of every entity in document order; what has no place there follows by name. Numbers are written so that no
/// two different ones look alike. World transforms are right only once the world has been brought to a moment.
pub(crate) fn described(world: &World, with_world_transforms: bool) -> Vec<String> {
    let mut query = world.query::<(Entity, Option<&Order>, Option<&Name>)>();
    let mut entities: Vec<(u64, String, Entity)> = query
        .iter()
        .map(|(entity, order, name)| {
            let name = name.map_or_else(String::new, |name| name.0.clone());
            (order.map_or(u64::MAX, |order| order.0), name, entity)
        })
        .collect();
    entities.sort();
    let places: HashMap<Entity, usize> = entities.iter().map(|(.., entity)| *entity).zip(0..).collect();
    let words = entities.iter().map(|(.., entity)| Words { world, entity: *entity, places: &places });
    words.map(|words| words.all(with_world_transforms)).collect()
}

struct Words<'a> {
    world: &'a World,
    entity: Entity,
    places: &'a HashMap<Entity, usize>,
}

impl Words<'_> {
    fn all(&self, with_world_transforms: bool) -> String {
        let mut text = format!("{} components", self.world.entity(self.entity).unwrap().len());
        text += &self.one::<Name>();
        text += &self.one::<Order>();
        text += &self.one::<Transform>();
        text += &self.one::<Shape>();
        text += &self.one::<Material>();
        text += &self.one::<Specular>();
        text += &self.one::<Reflective>();
        text += &self.one::<Refractive>();
        text += &self.one::<Checker>();
        text += &self.one::<Light>();
        text += &self.one::<Camera>();
        text += &self.one::<FilmSettings>();
        text += &self.one::<Ambient>();
        text += &self.one::<Background>();
        text += &self.one::<Fog>();
        text += &self.one::<Quality>();
        text += &self.one::<Sampling>();
        text += &self.one::<Animated>();
        text += &self.linked(|parent: &Parent| vec![parent.0]);
        text += &self.linked(|followed: &Follow| vec![followed.0]);
        text += &self.linked(|looked_at: &LookAt| vec![looked_at.0]);
        text += &self.linked(|shots: &Shots| shots.0.iter().map(|shot| shot.camera).collect());
        if let Ok(shots) = self.world.get::<&Shots>(self.entity) {
            write!(text, "\n  {:?}", shots.0.iter().map(|shot| shot.start).collect::<Vec<_>>()).unwrap();
        }
        if with_world_transforms {
            text += &self.one::<WorldTransform>();
        }
        text
    }

    fn one<T: hecs::Component + Debug>(&self) -> String {
        self.world.get::<&T>(self.entity).map_or_else(|_| String::new(), |part| format!("\n  {:?}", *part))
    }

    fn linked<T: hecs::Component>(&self, links: impl Fn(&T) -> Vec<Entity>) -> String {
        self.world.get::<&T>(self.entity).map_or_else(
            |_| String::new(),
            |part| {
                let kind = std::any::type_name::<T>();
                let places: Vec<_> = links(&part).iter().map(|entity| self.places.get(entity)).collect();
                format!("\n  {kind} {places:?}")
            },
        )
    }
}

/// The bits of a film.
pub(crate) fn bits(film: &Film) -> Vec<[u32; 3]> {
    film.pixels().iter().map(|pixel| pixel.to_array().map(f32::to_bits)).collect()
}
