//! What happens each frame, in this order:
//!
//! ```text
//! animate -> scripts -> own systems -> propagate -> prepare   (-> trace)
//! ```
//!
//! - [`animate()`] writes the values of motions at this moment.
//! - Scripts write the values of programs, after all tracks.
//! - The schedule runs the systems added by the program that uses the library, pure or stepped; both run before each of its
//!   steps.
//! - [`propagate()`] turns transforms into world transforms, parents first.
//! - [`Plan`] lists the effects that the moment calls for, and why.
//! - [`Fault`]s report what is wrong with the moment, so that something is not drawn as specified.
//! - [`Preparation`] is the only bridge from the world to the kernel: it carries shapes, materials, lights and the camera over
//!   into arrays, in document order, and only what has changed.
//!
//! hecs keeps no record of changes, so systems declare their writes: see [`Changes`].

mod animate;
mod batches;
mod changes;
mod context;
mod effect;
mod faults;
mod halt;
mod left_out;
mod order;
mod parts;
mod plan;
mod prepare;
mod propagate;
mod property;
mod refusal;
mod schedule;
mod scripts;
mod snapshot;
mod world_transform;

pub use animate::animate;
pub use changes::Changes;
pub use context::Context;
pub use effect::Effect;
pub use faults::{Fault, FaultCause, FaultEffect, Instead};
pub(crate) use halt::Halt;
pub use halt::ScriptFailure;
pub use parts::value;
pub use plan::{Need, Plan};
#[doc(hidden)]
pub use prepare::Preparation;
pub use prepare::{Filming, film_settings, filming};
pub(crate) use prepare::{RayLimits, Shutter, Shutters};
pub use propagate::propagate;
pub(crate) use schedule::Schedule;
pub use schedule::Step;
pub(crate) use scripts::Scripts;
pub use snapshot::UnknownComponent;
pub(crate) use snapshot::{Registry, Snapshot};
