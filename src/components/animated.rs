//! Animated values.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::{Property, Transform};
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
    /// Keyed choices between yes and no, each of which holds until the next key.
    Flag(Arc<Track<bool>>),
    /// Points on a path through waypoints.
    Path(Arc<Path>),
    /// Points on a circle.
    Orbit(Arc<Orbit>),
    /// Rotations about an axis by any number of turns.
    Turns(Arc<Turns>),
    /// The direction of motion on a way, as a vector.
    Direction(Way),
    /// The rotation that points +z in the direction of motion on a way, with y up as far as possible; none while there is no direction.
    Facing(Way),
    /// A value computed by a script.
    Script(ScriptId),
}

/// The index of a script in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ScriptId(pub usize);

/// A motion of a point with a direction at every moment.
#[derive(Clone, Debug)]
pub enum Way {
    /// A path through waypoints.
    Path(Arc<Path>),
    /// A circle.
    Orbit(Arc<Orbit>),
}

impl Way {
    /// Returns the way of a motion, if it has one.
    #[must_use]
    pub fn of(motion: &Motion) -> Option<Self> {
        match motion {
            Motion::Path(path) => Some(Self::Path(Arc::clone(path))),
            Motion::Orbit(orbit) => Some(Self::Orbit(Arc::clone(orbit))),
            _ => None,
        }
    }

    /// Returns the direction of motion at `seconds`, as a unit vector, also at rest; zero if there is none.
    #[must_use]
    pub fn direction(&self, seconds: f64) -> DVec3 {
        match self {
            Self::Path(path) => path.direction(seconds),
            Self::Orbit(orbit) => orbit.direction(seconds),
        }
    }
}

impl Motion {
    /// Returns the value at `seconds`. `None` for a script, which depends on more than the time.
    #[must_use]
    pub fn at(&self, seconds: f64) -> Option<Value> {
        Some(match self {
            Self::Number(track) => Value::Number(track.at(seconds)),
            Self::Vector(track) => Value::Vector(track.at(seconds)),
            Self::Rotation(track) => Value::Rotation(track.at(seconds)),
            Self::Color(track) => Value::Color(track.at(seconds)),
            Self::Flag(track) => Value::Flag(track.at(seconds)),
            Self::Path(path) => Value::Vector(path.at(seconds)),
            Self::Orbit(orbit) => Value::Vector(orbit.at(seconds)),
            Self::Turns(turns) => Value::Rotation(turns.at(seconds)),
            Self::Direction(way) => Value::Vector(way.direction(seconds)),
            Self::Facing(way) => {
                let turned = Transform::IDENTITY.facing(way.direction(seconds)).unwrap_or_default();
                Value::Rotation(turned.rotation)
            }
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

impl From<Track<bool>> for Motion {
    fn from(track: Track<bool>) -> Self {
        Self::Flag(Arc::new(track))
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
