//! The cost of accuracy: errors of pictures, and the time that better settings take.
//!
//! [`measure()`] renders frames of a scene with many settings. Each of them changes one [`Knob`] or disables one effect; the result holds
//! its error and its cost. Errors are relative to a reference, [`Converged`], which has an estimate of its own error.
//!
//! Pictures are compared by their output values, from 0 to 255, before these are rounded to bytes. Light that is clamped in both pictures
//! makes no difference; a thousandth of an 8-bit step does.

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
