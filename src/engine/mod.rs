//! The engine, which combines the world, the systems and the kernel.

mod cast;
#[expect(clippy::module_inception, reason = "what the folder is about")]
mod engine;
mod reload;

pub use crate::systems::{FrameReport, RenderRequest};
pub use cast::{Hit, IntoRay, Ray, SecondaryRay};
pub(crate) use engine::unless_cancelled;
pub use engine::{Engine, EngineError};
