//! Values over time, as pure functions: keys, easing, interpolation.
//!
//! A [`Track`] answers "what is the value at this second" and remembers nothing between questions. Which component a
//! track drives is said in [`components::Channel`](crate::components::Channel); when it is asked is the business of
//! [`systems::animate`](crate::systems::animate).

mod easing;
mod interpolate;
mod rotation;
mod track;

pub use easing::Easing;
pub use interpolate::Interpolate;
pub use rotation::{Rotation, slerp};
pub use track::{Key, Track};
