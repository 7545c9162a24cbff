//! Faults of a world at a moment.
//!
//! Invalid scene files are rejected when they are loaded. Worlds built in code, and later changes by tracks, scripts and systems, are not
//! rejected: entities that cannot be drawn are omitted from the image, and out-of-range values are clamped. A fault reports such an entity.

use std::fmt;

use glam::DVec3;
use hecs::Entity;

use super::OneColor;
use crate::components::{RangeError, ShortTurn};

/// A reason why an entity does not appear as specified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// The entity: the active camera for faults of the image, and [`Entity::DANGLING`] if there is none.
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
    /// Only some particles of the entity's cloud are drawn.
    Incomplete,
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
    /// The surface reflects more light than it receives.
    TooBright,
    /// The surface is black.
    Black,
    /// The image shows the view of a default camera.
    DefaultView,
    /// The light is at the origin.
    AtOrigin,
    /// The shape or the material is drawn as it was before a change.
    OutOfDate,
    /// A replacement is used for an invalid number or part.
    Fallback(Fallback),
    /// The whole image has one colour.
    OneColor(OneColor),
    /// The image shows the background in place of much of its reflected and refracted light.
    CutOff,
    /// The light reaches no surface that the camera can see.
    ReachesNothing,
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
    /// The world's +y as the up vector of a camera.
    AlongY,
}

/// The cause of a [`Fault`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultCause {
    /// The entity has a [`Shape`](crate::components::Shape) and no [`Material`](crate::components::Material).
    NoMaterial,
    /// The entity has a [`Light`](crate::components::Light) and no [`Transform`](crate::components::Transform).
    NoTransform,
    /// No entity has a [`Light`](crate::components::Light) or an [`Ambient`](crate::components::Ambient).
    NoLight,
    /// No entity has a [`Camera`](crate::components::Camera).
    NoCamera,
    /// The entity was spawned without being declared, see [`Changes::mark_all`](super::Changes::mark_all).
    Undeclared,
    /// A system has changed the named components of the entity, and has declared other changes but not this one. Found in builds with debug
    /// assertions only.
    UndeclaredChange(UndeclaredChange),
    /// A channel of the named colour, which surfaces reflect, is above 1.
    AboveWhite {
        /// The name of the colour.
        what: &'static str,
        /// The channel.
        value: f32,
    },
    /// Particles have a position that is not finite or out of range, or a scale that is not greater than 0.
    Particles {
        /// The number of these particles.
        left_out: usize,
        /// The number of all particles of the cloud.
        count: usize,
    },
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
    /// An edge of a box, or the length of a cylinder or a capsule, is so short, and the shape so far from the origin, that both ends round to
    /// the same number.
    Lost {
        /// The edge or the length.
        what: &'static str,
        /// Its length in the world.
        length: f64,
        /// The coordinate of its centre or of an end.
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
    /// No shape is drawn.
    NoShapes,
    /// The camera sees none of the shapes because of their [`Visibility`](crate::components::Visibility).
    HiddenShapes {
        /// The number of shapes.
        shapes: usize,
    },
    /// No shape is in view.
    OutOfView {
        /// The number of shapes.
        shapes: usize,
        /// The middle of the bounded ones.
        middle: Option<DVec3>,
    },
    /// The image needs neither ambient light nor the light of lights.
    Unlit {
        /// The reason why it needs no ambient light.
        ambient: &'static str,
        /// The reason why it needs no lights.
        lights: &'static str,
    },
    /// No light reaches the surfaces in view.
    NoLightArrives,
    /// The surfaces in view have equal radiance.
    EqualRadiance,
    /// Fog hides the surfaces in view.
    HiddenByFog,
    /// Rays that would contribute much are beyond the maximum depth.
    DepthReached {
        /// The maximum depth.
        depth: u32,
        /// The number of such rays per camera ray.
        share: f64,
    },
    /// No shape is inside the cone of a spot light.
    OutsideCone,
    /// An opaque surface separates a light from everything that the camera can see.
    Separated,
}

impl Consequence {
    /// The names of all consequences, as in `--allow` of the command.
    pub const NAMES: [&str; 16] = [
        "not-drawn",
        "no-light",
        "nothing-seen",
        "passed-target",
        "short-turn",
        "distorted",
        "replaced-value",
        "one-color",
        "cut-off",
        "idle-light",
        "too-bright",
        "black-surface",
        "default-view",
        "at-origin",
        "out-of-date",
        "incomplete",
    ];

    /// Returns the name of the consequence.
    #[must_use]
    pub fn name(self) -> &'static str {
        let index = match self {
            Self::NotDrawn => 0,
            Self::NoLight => 1,
            Self::NothingSeen => 2,
            Self::FixedTarget => 3,
            Self::ShortTurn => 4,
            Self::Distorted => 5,
            Self::Fallback(_) => 6,
            Self::OneColor(_) => 7,
            Self::CutOff => 8,
            Self::ReachesNothing => 9,
            Self::TooBright => 10,
            Self::Black => 11,
            Self::DefaultView => 12,
            Self::AtOrigin => 13,
            Self::OutOfDate => 14,
            Self::Incomplete => 15,
        };
        Self::NAMES[index]
    }
}

/// A change that a system made to an entity and did not declare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UndeclaredChange {
    /// A change of the [`Transform`](crate::components::Transform), of the entity or of one of its parents.
    Transform,
    /// A change of the [`Shape`](crate::components::Shape).
    Shape,
    /// A change of the [`Material`](crate::components::Material) or of another component of the surface.
    Material,
    /// A change of the [`Visibility`](crate::components::Visibility).
    Visibility,
    /// The entity was despawned, or its [`Shape`](crate::components::Shape) or [`Material`](crate::components::Material) was removed.
    Removal,
}

impl Fault {
    /// Returns whether this is a fault only if it occurs at all moments of interest: a film may begin with a black frame, and a spot light
    /// may pass over nothing.
    #[must_use]
    pub fn may_pass(&self) -> bool {
        matches!(self.consequence, Consequence::OneColor(_) | Consequence::ReachesNothing)
    }

    /// Returns the remedy.
    #[must_use]
    pub fn remedy(&self) -> String {
        match self.cause {
            FaultCause::NoMaterial => {
                "give it a material, in code as `Material::matte(color)`, or `Material::default()` for mirrors and glass"
                    .to_owned()
            }
            FaultCause::NoTransform => {
                "give it a position, as `Transform::at(-4.0, 6.0, -4.0)`".to_owned()
            }
            FaultCause::NoLight => {
                "spawn a light, as `(Light::point(Rgb::ONE), Transform::at(-4.0, 6.0, -4.0))`, or ambient light, as `(Ambient(Rgb::ONE),)`"
                    .to_owned()
            }
            FaultCause::NoCamera => {
                "spawn a camera, as `(Camera::looking_at(position, target),)`".to_owned()
            }
            FaultCause::Undeclared => {
                "spawn it with `context.spawn`, or call `context.changes.mark_all()` after the change".to_owned()
            }
            FaultCause::UndeclaredChange(change) => match change {
                UndeclaredChange::Transform => "call `context.changes.mark_transform(entity)` after the change",
                UndeclaredChange::Shape | UndeclaredChange::Visibility => {
                    "call `context.changes.mark_shape(entity)` after the change"
                }
                UndeclaredChange::Material => "call `context.changes.mark_material(entity)` after the change",
                UndeclaredChange::Removal => "call `context.changes.mark_all()` after the change",
            }
            .to_owned(),
            FaultCause::AboveWhite { .. } => {
                "keep its channels from 0 to 1: scene files write 0 to 255, code converts them with `color::srgb(255, 120, 60)`"
                    .to_owned()
            }
            FaultCause::NotFinite(_) => {
                "look for a division by zero or an overflow in what sets it: a track, a script or a system"
                    .to_owned()
            }
            FaultCause::Particles { .. } => {
                "correct their data, or leave them out by a `filter`, as \"r > 0\"".to_owned()
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
            FaultCause::NoShapes => "add an entity with a shape and a material".to_owned(),
            FaultCause::HiddenShapes { .. } => {
                "let the camera see a shape: remove `visible: false`, or animate Visible".to_owned()
            }
            FaultCause::OutOfView { middle: Some(middle), .. } => {
                let [x, y, z] = middle.to_array().map(rounded);
                format!("turn or move the camera: the middle of the shapes is at ({x}, {y}, {z})")
            }
            FaultCause::OutOfView { middle: None, .. } => "turn or move the camera".to_owned(),
            FaultCause::Unlit { .. } => {
                "give the materials a `k_d` and add a light, or a `k_a` and give the scene `ambient` light"
                    .to_owned()
            }
            FaultCause::NoLightArrives => {
                "`rayreel probe` says for a pixel why a light does not reach it".to_owned()
            }
            FaultCause::EqualRadiance => {
                "add a light: surfaces get brighter the more they face it".to_owned()
            }
            FaultCause::HiddenByFog => {
                "lower the density of the fog: exp(-density l) of the light is left after a length l"
                    .to_owned()
            }
            FaultCause::DepthReached { depth, .. } => {
                format!("allow more bounces, as `quality: (depth: {})`", depth.saturating_mul(2))
            }
            FaultCause::OutsideCone => {
                "turn it, so that its own +z axis points to a shape, or widen its angle".to_owned()
            }
            FaultCause::Separated => {
                "move it to the camera's side of that surface, or let it shine without shadows".to_owned()
            }
        }
    }
}

impl fmt::Display for Fault {
    /// Writes the consequence and the cause, as a predicate to follow the entity's name.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.consequence {
            Consequence::NotDrawn => write!(formatter, "is not drawn: {}", self.cause),
            Consequence::Incomplete => write!(formatter, "is drawn in part: {}", self.cause),
            Consequence::NoLight => write!(formatter, "gives no light: {}", self.cause),
            Consequence::NothingSeen => write!(formatter, "sees nothing: {}", self.cause),
            Consequence::FixedTarget => write!(formatter, "moves on past a fixed target: {}", self.cause),
            Consequence::ShortTurn => write!(formatter, "turns the short way: {}", self.cause),
            Consequence::Distorted => write!(formatter, "shows a distorted picture: {}", self.cause),
            Consequence::TooBright => {
                write!(formatter, "reflects more light than it receives: {}", self.cause)
            }
            Consequence::Black => write!(formatter, "is black: {}", self.cause),
            Consequence::DefaultView => write!(formatter, "is seen by a default camera: {}", self.cause),
            Consequence::AtOrigin => write!(formatter, "shines from the origin: {}", self.cause),
            Consequence::OutOfDate => write!(formatter, "is drawn as before: {}", self.cause),
            Consequence::Fallback(instead) => {
                write!(formatter, "is not as it says: {}, and ", self.cause)?;
                match instead {
                    Fallback::Number(number) => write!(formatter, "counts as {}", brief(number)),
                    Fallback::Nothing => write!(formatter, "is omitted"),
                    Fallback::AlongZ => write!(formatter, "looks along +z"),
                    Fallback::AlongY => write!(formatter, "has +y upwards"),
                }
            }
            Consequence::OneColor(OneColor::Black) => write!(formatter, "sees only black: {}", self.cause),
            Consequence::OneColor(OneColor::Other) => write!(formatter, "sees one colour: {}", self.cause),
            Consequence::CutOff => {
                write!(
                    formatter,
                    "sees the background in place of reflected or refracted light: {}",
                    self.cause
                )
            }
            Consequence::ReachesNothing => write!(formatter, "lights nothing in view: {}", self.cause),
        }
    }
}

impl fmt::Display for FaultCause {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoMaterial => write!(formatter, "it has a shape but no material"),
            Self::NoTransform => write!(formatter, "it has a light but no transform"),
            Self::NoLight => write!(formatter, "no entity has a light, and none has ambient light"),
            Self::NoCamera => write!(formatter, "no entity has a camera"),
            Self::Undeclared => write!(formatter, "it was spawned without being declared"),
            Self::UndeclaredChange(change) => {
                let change = match change {
                    UndeclaredChange::Transform => "its `Transform`, or that of a parent, was changed",
                    UndeclaredChange::Shape => "its `Shape` was changed",
                    UndeclaredChange::Visibility => "its `Visibility` was changed",
                    UndeclaredChange::Material => {
                        "its `Material`, or another component of its surface, was changed"
                    }
                    UndeclaredChange::Removal => {
                        "it was despawned, or its `Shape` or `Material` was removed,"
                    }
                };
                write!(formatter, "{change} without being declared")
            }
            Self::AboveWhite { what, value } => {
                write!(formatter, "its {what} has a channel of {}, and 1 is white", brief((*value).into()))
            }
            Self::Particles { left_out, count } => {
                write!(
                    formatter,
                    "{left_out} of its {count} particles have no finite position, or no scale above 0"
                )
            }
            Self::NotFinite(what) => write!(formatter, "its {what} is not finite"),
            Self::Overflow => {
                write!(formatter, "its transform and those of its parents together are not finite")
            }
            Self::NoScale => write!(formatter, "its scale has a factor of 0"),
            Self::Flat => write!(formatter, "its transform flattens it in some direction"),
            Self::BeyondMeasure => write!(formatter, "it is too large, too small or too far away"),
            Self::OutOfRange { what, error } => write!(formatter, "its {what} is {}", brief(error.value)),
            Self::NoDirection(what) => write!(formatter, "its {what} has no direction"),
            Self::Lost { what, length, coordinate } => write!(
                formatter,
                "its {what} of {} is lost at {}, where numbers are {} apart",
                brief(*length),
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
            Self::NoShapes => write!(formatter, "no shape is drawn"),
            Self::HiddenShapes { shapes: 1 } => write!(formatter, "the only shape is not visible"),
            Self::HiddenShapes { shapes } => write!(formatter, "none of the {shapes} shapes is visible"),
            Self::OutOfView { shapes: 1, .. } => write!(formatter, "the only shape is not in view"),
            Self::OutOfView { shapes, .. } => write!(formatter, "none of the {shapes} shapes is in view"),
            Self::Unlit { ambient, lights } if ambient == lights => write!(formatter, "{ambient}"),
            Self::Unlit { ambient, lights } => write!(formatter, "{ambient}, and {lights}"),
            Self::NoLightArrives => write!(formatter, "no light reaches the surfaces in view"),
            Self::EqualRadiance => write!(formatter, "the surfaces in view are equally bright"),
            Self::HiddenByFog => write!(formatter, "fog hides the surfaces in view"),
            Self::DepthReached { depth, share } => write!(
                formatter,
                "{} rays per 100 camera rays end at the depth of {depth} with at least half of their light",
                rounded(100.0 * share)
            ),
            Self::OutsideCone => write!(formatter, "no shape is inside its cone"),
            Self::Separated => {
                write!(formatter, "an opaque surface separates it from all that the camera sees")
            }
        }
    }
}

/// Formats a number, rounded to three digits.
fn rounded(value: f64) -> String {
    brief(format!("{value:.2e}").parse().unwrap_or(value))
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
