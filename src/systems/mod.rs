//! The systems that run for each frame, in this order:
//!
//! ```text
//! stepped systems up to this moment -> clouds -> animate -> scripts -> pure systems -> propagate -> prepare -> plan -> trace
//! ```
//!
//! - Custom systems are pure or stepped: [`Engine::add_system`](crate::Engine::add_system) and
//!   [`Engine::add_stepped_system`](crate::Engine::add_stepped_system). Tracks and scripts run before each step and again after the steps,
//!   so a step cannot permanently change a value that a track or a script drives.
//! - Clouds get the particles of this moment from their [sources](crate::components::CloudSource).
//! - [`animate()`] writes the values of motions at this moment.
//! - Scripts write their values after all tracks.
//! - [`propagate()`] derives world transforms from transforms, parents first.
//! - [`Plan`] lists the effects that the moment needs, with reasons.
//! - [`Fault`]s report the entities that are not drawn as specified.
//! - The preparation is the only bridge from the world to the kernel: it copies shapes, materials, lights and the camera into arrays, in
//!   document order, and updates only the data that has changed.
//! - The tracer, `trace`, queries the prepared world for closest hits and shadow rays, and writes the film.
//!
//! The frame loop, `frame`, advances the world to each instant of a frame and runs the tracer there.
//!
//! hecs does not track changes, so systems declare their writes: see [`Changes`].

mod aim;
mod animate;
mod batches;
mod changes;
mod clouds;
mod context;
mod disabled_effects;
mod effect;
mod faults;
mod fingerprint;
mod frame;
mod image_faults;
mod interrupted;
mod order;
mod plan;
mod prepare;
mod propagate;
mod property;
mod property_access;
mod render_request;
mod report;
mod schedule;
mod scripts;
mod snapshot;
mod trace;
mod value_error;
mod world_transform;

pub use animate::animate;
pub use changes::Changes;
pub use context::Context;
pub use effect::{Effect, EffectSet};
pub use faults::{Consequence, Fallback, Fault, FaultCause, UndeclaredChange};
pub(crate) use frame::{FrameInstants, NextInstants, PreparedInstant, Simulation};
pub(crate) use image_faults::image_faults;
pub(crate) use interrupted::{CloudFailure, Interrupted, ScriptFailure};
pub(crate) use order::{Unplaced, order_newcomers};
pub use plan::{Need, Plan};
#[cfg(feature = "live")]
pub(crate) use prepare::scene_camera;
pub use prepare::{ActiveCamera, EffectiveSettings, Preparation, RenderSettings, Viewpoint, active_camera};
pub use propagate::propagate;
pub use property_access::value;
pub use render_request::{OnPause, RenderRequest};
pub use report::{FrameReport, OneColor};
pub(crate) use schedule::Schedule;
pub use schedule::Step;
pub(crate) use scripts::Scripts;
pub use snapshot::UnknownComponent;
pub(crate) use snapshot::{Registry, WorldSnapshot};
pub(crate) use trace::{plan, render, trace_ray, trace_sample};
