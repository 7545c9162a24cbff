//! The cost of accuracy: errors of pictures, and the time that better settings take.
//!
//! [`measure()`] renders frames of a scene with many settings. Each of them changes one [`Parameter`] or disables one effect; the result holds
//! its error and its cost. Errors are relative to a reference, [`ReferenceImage`], which has an estimate of its own error.
//!
//! Pictures are compared by their output values, from 0 to 255, before these are rounded to bytes. Light that is clamped in both pictures
//! makes no difference; a thousandth of an 8-bit level does.

mod deadline;
mod demand;
mod estimate;
mod film_error;
mod fit;
mod flip;
mod frame_samples;
mod front;
mod measure;
mod measured_frame;
mod median_range;
mod output_values;
mod parameter;
mod reference_image;
mod relative_error;
mod report;
mod resample;
mod similarity;

pub use deadline::{Deadline, FrameSurvey, survey_order};
pub use estimate::{Estimate, estimate};
pub use film_error::FilmError;
pub use fit::PowerLaw;
pub use flip::{Flip, flip};
pub use frame_samples::FrameSamples;
pub use front::Resolution;
pub use measure::{Observer, Preset, Request, measure};
pub use measured_frame::MeasuredFrame;
pub use median_range::MedianRange;
pub use output_values::OutputValues;
pub use parameter::{Parameter, Subject};
pub use reference_image::ReferenceImage;
pub use relative_error::relative_mse;
pub use report::{ReferenceInfo, Report, Row, Share};
pub use similarity::structural_similarity;
