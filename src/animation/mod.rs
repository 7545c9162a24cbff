//! Values over time as pure functions: keys, easing, interpolation.
//!
//! A [`Track`] returns the value at a given second and keeps no state between calls. [`components::Channel`](crate::components::Channel)
//! names the component that a track drives; [`systems::animate`](crate::systems::animate) evaluates the tracks.
//!
//! ```text
//! seconds -> Playback: the keys' time -> Track: the segment and the fraction u of it
//!     -> straight: Easing's progress, Interpolate::between
//!     -> smooth:   slopes from neighbouring keys, Interpolate::curve
//! ```
//!
//! Points may also move along a [`Path`] through waypoints or in an [`Orbit`], and rotations make [`Turns`]:
//!
//! ```text
//! seconds -> Pace: the fraction covered -> Path: the curve's point at that length
//!                                       -> Orbit: the point at that angle
//!                                       -> Turns: the rotation by that angle
//! ```
//!
//! Only basic operations and libm's functions are used, so that values have the same bits on every platform.

mod angle;
mod arc_length;
mod cubic_bezier;
mod easing;
mod hermite;
mod interpolate;
pub mod limits;
mod orbit;
mod pace;
mod path;
mod playback;
mod rotation;
mod track;
mod turns;
mod value;

pub use easing::{Ease, Easing};
pub use interpolate::Interpolate;
pub use orbit::Orbit;
pub use pace::Pace;
pub use path::Path;
pub use playback::{Playback, Repeat};
pub use rotation::{Rotation, slerp};
pub use track::{Key, Track};
pub use turns::Turns;
pub use value::{Notation, Value, ValueKind};
