//! Faults of a world at a moment.
//!
//! Invalid scene files are rejected when they are loaded. Worlds built in code, and later changes by tracks, scripts and systems, are not
//! rejected: entities that cannot be drawn are omitted from the image, and out-of-range values are clamped. A fault reports such an entity.

use std::fmt;

use hecs::Entity;

use crate::components::{RangeError, ShortTurn};

/// A reason why an entity does not appear as specified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// The entity.
    pub entity: Entity,
    /// The consequence.
    pub consequence: Consequence,
    /// The cause.
    pub cause: FaultCause,
}

/// The consequence of a [`Fault`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Consequence {
    /// The entity's shape is not drawn.
    NotDrawn,
    /// The entity's light gives no light.
    NoLight,
    /// The image shows only the background.
    NothingSeen,
    /// The camera keeps moving after its target has come to rest.
    FixedTarget,
    /// The rotation between two keys takes the shorter way instead of the angle as written.
    ShortTurn,
    /// The image is mirrored or collapsed.
    Distorted,
    /// A replacement is used for an invalid number or part.
    Fallback(Fallback),
}

/// The replacement for an invalid number or part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fallback {
    /// This number.
    Number(f64),
    /// No replacement: the part is ignored.
    Nothing,
    /// The world's +z as the view direction of a camera, or as the direction to which another entity points.
    AlongZ,
}

/// The cause of a [`Fault`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultCause {
    /// The entity has a [`Shape`](crate::components::Shape) and no [`Material`](crate::components::Material).
    NoMaterial,
    /// The entity was spawned without being declared, see [`Changes::mark_all`](super::Changes::mark_all).
    Undeclared,
    /// A number in the named part is not finite.
    NotFinite(&'static str),
    /// The entity's own transform is finite, but its product with the transforms of its parents is not.
    Overflow,
    /// A factor of the entity's own scale is 0.
    NoScale,
    /// The transform flattens the entity in some direction, through the scales of its parents or through rounding.
    Flat,
    /// A coordinate in the world is 1e150 or more in magnitude, or a size in the world is not between 1e-150 and 1e150.
    BeyondMeasure,
    /// The named vector, which must have a direction, has none.
    NoDirection(&'static str),
    /// An edge of a box is so short, and the box so far from the origin, that both ends round to the same number.
    Lost {
        /// The length of the edge in the world.
        edge: f64,
        /// The coordinate of the edge's centre.
        coordinate: f64,
    },
    /// A number is out of its range.
    OutOfRange {
        /// The name of the number.
        what: &'static str,
        /// The number, and its valid range.
        error: RangeError,
    },
    /// The entity at the end of the named link ("follows", for example) does not exist or has no position.
    Missing(&'static str),
    /// The entity looks at an entity whose position depends on where it looks.
    CircularAim,
    /// Two neighbouring rotation keys are written more than half a turn apart.
    ShortTurn(ShortTurn),
    /// The path of a camera's target ends before the path of its position.
    TargetEnds {
        /// The end of the target's path in seconds.
        target: f64,
        /// The end of the position's path in seconds.
        position: f64,
    },
}

impl Fault {
    /// Returns the remedy.
    #[must_use]
    pub fn remedy(&self) -> String {
        match self.cause {
            FaultCause::NoMaterial => "give it a material".to_owned(),
            FaultCause::Undeclared => "call `changes.mark_all()` where it is spawned".to_owned(),
            FaultCause::NotFinite(_) => {
                "look for a division by zero or an overflow in what sets it: a track, a script or a system"
                    .to_owned()
            }
            FaultCause::Overflow => "let its parents move and scale it less".to_owned(),
            FaultCause::NoScale => "write factors other than 0".to_owned(),
            FaultCause::Flat => {
                "look for a scale of 0, or for scales of very different sizes, among its parents".to_owned()
            }
            FaultCause::BeyondMeasure => "keep coordinates and sizes between 1e-150 and 1e150".to_owned(),
            FaultCause::NoDirection(_) => "give it any length but zero, as (0, 1, 0)".to_owned(),
            FaultCause::Lost { coordinate, .. } => format!(
                "make it longer than {}, or bring it nearer to the origin",
                brief(coordinate.abs().next_up() - coordinate.abs())
            ),
            FaultCause::OutOfRange { error, .. } => format!("keep it {}", error.requirement()),
            FaultCause::Missing(_) => "refer to an entity that exists".to_owned(),
            FaultCause::CircularAim => "let it look at an entity that does not turn with it".to_owned(),
            FaultCause::TargetEnds { .. } => {
                "end both paths at the same time: the view turns fast where a camera passes a resting target"
                    .to_owned()
            }
            FaultCause::ShortTurn(ShortTurn { angles: [from, to], .. }) => {
                let steps = ((to - from).abs() / 180.0).floor() + 1.0;
                let angle = |step: f64| brief(from + (to - from) * step / steps);
                let between = match steps {
                    2.0 => format!("a key at {}", angle(1.0)),
                    3.0 => format!("keys at {} and {}", angle(1.0), angle(2.0)),
                    _ => format!("keys at {}, {} and so on", angle(1.0), angle(2.0)),
                };
                format!(
                    "add {between} degrees between them: neighbouring keys may be up to 180 degrees apart; or write whole turns as Turns(axis: .., turns: .., duration: ..)"
                )
            }
        }
    }
}

impl fmt::Display for Fault {
    /// Writes the consequence and the cause, as a predicate to follow the entity's name.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.consequence {
            Consequence::NotDrawn => write!(formatter, "is not drawn: {}", self.cause),
            Consequence::NoLight => write!(formatter, "gives no light: {}", self.cause),
            Consequence::NothingSeen => write!(formatter, "sees nothing: {}", self.cause),
            Consequence::FixedTarget => write!(formatter, "moves on past a fixed target: {}", self.cause),
            Consequence::ShortTurn => write!(formatter, "turns the short way: {}", self.cause),
            Consequence::Distorted => write!(formatter, "shows a distorted picture: {}", self.cause),
            Consequence::Fallback(instead) => {
                write!(formatter, "is not as it says: {}, and ", self.cause)?;
                match instead {
                    Fallback::Number(number) => write!(formatter, "counts as {}", brief(number)),
                    Fallback::Nothing => write!(formatter, "is omitted"),
                    Fallback::AlongZ => write!(formatter, "looks along +z"),
                }
            }
        }
    }
}

impl fmt::Display for FaultCause {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoMaterial => write!(formatter, "it has a shape but no material"),
            Self::Undeclared => write!(formatter, "it was spawned without being declared"),
            Self::NotFinite(what) => write!(formatter, "its {what} is not finite"),
            Self::Overflow => {
                write!(formatter, "its transform and those of its parents together are not finite")
            }
            Self::NoScale => write!(formatter, "its scale has a factor of 0"),
            Self::Flat => write!(formatter, "its transform flattens it in some direction"),
            Self::BeyondMeasure => write!(formatter, "it is too large, too small or too far away"),
            Self::OutOfRange { what, error } => write!(formatter, "its {what} is {}", brief(error.value)),
            Self::NoDirection(what) => write!(formatter, "its {what} has no direction"),
            Self::Lost { edge, coordinate } => write!(
                formatter,
                "its edge of {} is lost at {}, where numbers are {} apart",
                brief(*edge),
                brief(*coordinate),
                brief(coordinate.abs().next_up() - coordinate.abs())
            ),
            Self::ShortTurn(ShortTurn { times, angles }) => write!(
                formatter,
                "its rotation keys at {} s and {} s are {} degrees apart",
                brief(times[0]),
                brief(times[1]),
                brief((angles[1] - angles[0]).abs())
            ),
            Self::TargetEnds { target, position } => write!(
                formatter,
                "its target path ends at {} s, its position path at {} s",
                brief(*target),
                brief(*position)
            ),
            Self::CircularAim => write!(formatter, "it looks at an entity that turns with it"),
            Self::Missing(what) => write!(formatter, "the entity that it {what} does not exist"),
        }
    }
}

/// Formats a number, with an exponent if it is very large or very small.
fn brief(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !size.is_finite() || (1e-4..1e7).contains(&size) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}
