//! Descriptions of worlds as text, which are compared without regard to entity ids.

use std::collections::HashMap;
use std::fmt::Debug;

use rayreel::components::{
    Ambient, AmbientOcclusion, Animated, Background, Camera, Emission, FilmSettings, FocusOn, Fog, Follow,
    Light, LookAt, Material, Name, Order, Parent, Pattern, Quality, Reflective, Refractive, Sampling, Shape,
    Shots, Space, Specular, Stars, Sun, Target, Transform, Visibility, WorldTransform,
};
use rayreel::{Entity, Film, World};

/// Returns every component of every entity in document order; entities without an order follow by name. Different numbers have different
/// texts. World transforms are valid only after the world has been advanced to a time.
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
        let shots = self.world.get::<&Shots>(self.entity);
        let starts = shots.map(|shots| shots.0.iter().map(|shot| shot.start).collect::<Vec<_>>());
        let parts = [
            self.one::<Name>(),
            self.one::<Order>(),
            self.one::<Transform>(),
            self.one::<Target>(),
            self.one::<Shape>(),
            self.one::<Visibility>(),
            self.one::<Material>(),
            self.one::<Specular>(),
            self.one::<Reflective>(),
            self.one::<Refractive>(),
            self.one::<Pattern>(),
            self.one::<Emission>(),
            self.one::<Light>(),
            self.one::<Camera>(),
            self.one::<FilmSettings>(),
            self.one::<Ambient>(),
            self.one::<AmbientOcclusion>(),
            self.one::<Background>(),
            self.one::<Sun>(),
            self.one::<Stars>(),
            self.one::<Fog>(),
            self.one::<Quality>(),
            self.one::<Sampling>(),
            self.one::<Space>(),
            self.one::<Animated>(),
            self.linked(|parent: &Parent| vec![parent.0]),
            self.linked(|followed: &Follow| vec![followed.0]),
            self.linked(|looked_at: &LookAt| vec![looked_at.0]),
            self.linked(|focused: &FocusOn| vec![focused.0]),
            self.linked(|shots: &Shots| shots.0.iter().map(|shot| shot.camera).collect()),
            self.one::<WorldTransform>()
                .map(|words| if with_world_transforms { words } else { String::new() }),
        ];
        let text: Vec<String> = parts.into_iter().flatten().collect();
        assert_eq!(self.world.entity(self.entity).unwrap().len(), text.len(), "there are other components");
        format!("{}\n  {starts:?}", text.concat())
    }

    fn one<T: hecs::Component + Debug>(&self) -> Option<String> {
        self.world.get::<&T>(self.entity).map(|part| format!("\n  {:?}", *part)).ok()
    }

    fn linked<T: hecs::Component>(&self, links: impl Fn(&T) -> Vec<Entity>) -> Option<String> {
        let part = self.world.get::<&T>(self.entity).ok()?;
        let places: Vec<_> = links(&part).iter().map(|entity| self.places.get(entity)).collect();
        Some(format!("\n  {} {places:?}", std::any::type_name::<T>()))
    }
}

/// Returns the bits of a film's pixels.
pub(crate) fn bits(film: &Film) -> Vec<[u32; 3]> {
    film.pixels().iter().map(|pixel| pixel.to_array().map(f32::to_bits)).collect()
}
