//! What accuracy costs in time: how far pictures are from each other, and what settings that make them better take.
//!
//! [`measure()`] renders frames of a scene in many ways, each of which turns one [`Knob`] or leaves out one effect, and tells for each
//! its error and its price. Errors are those to a reference, [`Converged`], which knows how good it is itself.
//!
//! Pictures are compared by what is shown, output values from 0 to 255 before they are rounded to bytes: light that is clamped in both
//! makes no difference, and a thousandth of a step does.

mod converged;
mod few_samples;
mod film_error;
mod fit;
mod knob;
mod ladder;
mod measure;
mod output_values;
mod report;
mod similarity;
mod spread;

pub use converged::Converged;
pub use few_samples::FewSamples;
pub use film_error::FilmError;
pub use fit::PowerLaw;
pub use knob::{Knob, Subject, Variant};
pub use ladder::{Deadline, FrameSamples, Ladder};
pub use measure::{Progress, Request, Step, Thoroughness, measure, time_left};
pub use report::{Reference, Report, Row};
pub use similarity::structural_similarity;
pub use spread::Spread;
