//! World, systems and kernel put together.

mod cast;
mod draft;
mod frame;
mod matching;
mod patch;
mod probe;
mod reload;
mod report;
mod run;
mod translation;

pub use cast::{Hit, IntoRay, Ray};
pub use probe::Probe;
pub use report::FrameReport;
pub use run::{Engine, EngineError};
