//! World, systems and kernel put together.

mod cast;
mod report;
mod run;

pub use cast::{Hit, IntoRay, Ray};
pub use report::FrameReport;
pub use run::{Engine, EngineError};
