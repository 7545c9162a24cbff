//! Animated values.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::Property;
use crate::animation::{Orbit, Path, Track, Turns, Value};
use crate::color::Rgb;

/// The motions that drive the values of this entity, in the order in which they are applied.
#[derive(Clone, Debug, Default)]
pub struct Animated(pub Vec<Channel>);

/// A value of an entity and its motion.
#[derive(Clone, Debug)]
pub struct Channel {
    /// The value.
    pub property: Property,
    /// The motion of the value. It has no effect unless it is of the property's [`kind`](Property::kind).
    pub motion: Motion,
    /// The first two neighbouring rotation keys that are written more than half a turn apart; the rotation between them takes the shorter
    /// way.
    pub short_turn: Option<ShortTurn>,
}

/// Two neighbouring rotation keys whose angles, as written, differ by more than half a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShortTurn {
    /// The times of the keys in seconds.
    pub times: [f64; 2],
    /// The angles in degrees.
    pub angles: [f64; 2],
}

impl Channel {
    /// Creates a channel for a property and its motion.
    #[must_use]
    pub fn new(property: Property, motion: impl Into<Motion>) -> Self {
        Self { property, motion: motion.into(), short_turn: None }
    }
}

/// A value as a function of time. Cloning is cheap: entities with a common material share its motions.
#[derive(Clone, Debug)]
pub enum Motion {
    /// Keyed numbers.
    Number(Arc<Track<f64>>),
    /// Keyed vectors.
    Vector(Arc<Track<DVec3>>),
    /// Keyed rotations.
    Rotation(Arc<Track<DQuat>>),
    /// Keyed RGB values.
    Color(Arc<Track<Rgb>>),
    /// Points on a path through waypoints.
    Path(Arc<Path>),
    /// Points on a circle.
    Orbit(Arc<Orbit>),
    /// Rotations about an axis by any number of turns.
    Turns(Arc<Turns>),
    /// A value computed by a script.
    Script(ScriptId),
}

/// The index of a script in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ScriptId(pub usize);

impl Motion {
    /// Returns the value at `seconds`. `None` for a script, which depends on more than the time.
    #[must_use]
    pub fn at(&self, seconds: f64) -> Option<Value> {
        Some(match self {
            Self::Number(track) => Value::Number(track.at(seconds)),
            Self::Vector(track) => Value::Vector(track.at(seconds)),
            Self::Rotation(track) => Value::Rotation(track.at(seconds)),
            Self::Color(track) => Value::Color(track.at(seconds)),
            Self::Path(path) => Value::Vector(path.at(seconds)),
            Self::Orbit(orbit) => Value::Vector(orbit.at(seconds)),
            Self::Turns(turns) => Value::Rotation(turns.at(seconds)),
            Self::Script(_) => return None,
        })
    }
}

impl From<Track<f64>> for Motion {
    fn from(track: Track<f64>) -> Self {
        Self::Number(Arc::new(track))
    }
}

impl From<Track<DVec3>> for Motion {
    fn from(track: Track<DVec3>) -> Self {
        Self::Vector(Arc::new(track))
    }
}

impl From<Track<DQuat>> for Motion {
    fn from(track: Track<DQuat>) -> Self {
        Self::Rotation(Arc::new(track))
    }
}

impl From<Track<Rgb>> for Motion {
    fn from(track: Track<Rgb>) -> Self {
        Self::Color(Arc::new(track))
    }
}

impl From<Path> for Motion {
    fn from(path: Path) -> Self {
        Self::Path(Arc::new(path))
    }
}

impl From<Orbit> for Motion {
    fn from(orbit: Orbit) -> Self {
        Self::Orbit(Arc::new(orbit))
    }
}

impl From<Turns> for Motion {
    fn from(turns: Turns) -> Self {
        Self::Turns(Arc::new(turns))
    }
}
