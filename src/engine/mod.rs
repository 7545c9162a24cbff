//! The engine, which combines the world, the systems and the kernel.

mod cast;
#[expect(clippy::module_inception, reason = "what the folder is about")]
mod engine;
mod probe;
mod reload;
mod render;
mod report;

pub use cast::{Hit, IntoRay, Ray, SecondaryRay};
pub use engine::{Engine, EngineError};
#[doc(hidden)]
pub use probe::Probe;
pub use render::Draft;
pub use report::FrameReport;
