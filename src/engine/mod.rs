//! World, systems and kernel put together.

mod cast;
mod counterparts;
mod draft;
mod frame;
mod matching;
mod patch;
mod probe;
mod reload;
mod report;
mod run;

pub use cast::{Hit, IntoRay, Ray, SecondaryRay};
pub use draft::Draft;
pub use probe::Probe;
pub use report::FrameReport;
pub use run::{Engine, EngineError};
