//! What accuracy costs in time: how far pictures are from each other, and what settings that make them better take.
//!
//! [`measure()`] renders frames of a scene in many ways, each of which turns one [`Knob`] or leaves out one effect, and tells for each
//! its error and its price. Errors are those to a reference, [`Converged`], which knows how good it is itself.
//!
//! Pictures are compared by what is shown, output values from 0 to 255 before they are rounded to bytes: light that is clamped in both
//! makes no difference, and a thousandth of a step does.

mod converged;
mod deadline;
mod demand;
mod estimate;
mod film_error;
mod fit;
mod flip;
mod frame_samples;
mod front;
mod knob;
mod measure;
mod output_values;
mod relative_error;
mod report;
mod resample;
mod similarity;
mod spread;
mod stop;

pub use converged::Converged;
pub use deadline::{Calibration, Deadline, FrameSurvey, survey_order};
pub use demand::Demand;
pub use estimate::{Estimate, estimate};
pub use film_error::FilmError;
pub use fit::PowerLaw;
pub use flip::{Flip, flip};
pub use frame_samples::FrameSamples;
pub use front::Resolution;
pub use knob::{Knob, Subject, Variant};
pub use measure::{Observer, Request, Thoroughness, measure};
pub use output_values::OutputValues;
pub use relative_error::relative_mse;
pub use report::{Reference, Report, Row, Share};
pub use similarity::structural_similarity;
pub use spread::Spread;
