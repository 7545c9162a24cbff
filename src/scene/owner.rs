//! The elements of a scene's text that entities of the world represent.

use std::fmt;

use hecs::{Entity, World};

use super::source_text::SourceLine;
use super::sources::Sources;
use crate::components::{Camera, Name, Order};

/// The element of a scene that an entity of the world represents, for warnings about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Owner {
    /// An entity, with its name and its index in document order, if it has them.
    Entity(Option<String>, Option<usize>),
    /// A camera, by its name.
    Camera(String),
    /// The settings of the scene.
    Scene,
}

impl Owner {
    /// Returns the element that `entity` represents.
    #[must_use]
    pub fn of(world: &World, entity: Entity) -> Self {
        let name = world.get::<&Name>(entity).ok().map(|name| name.0.clone());
        let order = world.get::<&Order>(entity).ok().and_then(|order| usize::try_from(order.0).ok());
        match (name, order) {
            (Some(name), None) if world.satisfies::<&Camera>(entity) => Self::Camera(name),
            (Some(_), None) => Self::Scene,
            (name, order) => Self::Entity(name, order),
        }
    }

    /// Returns the line on which the element starts.
    #[must_use]
    pub fn line<'a>(&self, sources: &'a Sources) -> Option<SourceLine<'a>> {
        match self {
            Self::Entity(_, order) => sources.entities(&[(*order)?]).next(),
            Self::Camera(name) => Some(sources.camera(name)),
            Self::Scene => None,
        }
    }
}

impl fmt::Display for Owner {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // Quoted as in the scene file: a name may contain any character.
            Self::Entity(Some(name), _) => write!(formatter, "{name:?}"),
            Self::Entity(None, Some(order)) => write!(formatter, "entity #{order}"),
            Self::Entity(None, None) => formatter.write_str("an entity"),
            Self::Camera(name) if name == "camera" => formatter.write_str("the camera"),
            Self::Camera(name) => write!(formatter, "camera {name:?}"),
            Self::Scene => formatter.write_str("the scene"),
        }
    }
}
