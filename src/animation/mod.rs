//! Values over time, as pure functions: keys, easing, interpolation.
//!
//! A [`Track`] returns the value at a given second and keeps no state between calls. Which component a track drives is said in
//! [`components::Channel`](crate::components::Channel); when it is evaluated is the business of
//! [`systems::animate`](crate::systems::animate).
//!
//! ```text
//! seconds -> Playback: the keys' time -> Track: the segment and the fraction u of it
//!     -> straight: Easing's progress, Interpolate::between
//!     -> smooth:   slopes from neighbouring keys, Interpolate::curve
//! ```
//!
//! Points may also move along a [`Path`] through waypoints or in an [`Orbit`]:
//!
//! ```text
//! seconds -> Pace: the share of the way -> Path: the curve's point at that length
//!                                       -> Orbit: the point at that angle
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
mod value;

pub use easing::{Ease, Easing};
pub use interpolate::Interpolate;
pub use orbit::Orbit;
pub use pace::Pace;
pub use path::Path;
pub use playback::{Playback, Repeat};
pub use rotation::{Rotation, slerp};
pub use track::{Key, Track};
#[doc(hidden)]
pub use value::Notation;
pub use value::{Kind, Value};
