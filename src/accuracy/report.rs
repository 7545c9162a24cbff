//! The results of a measurement of a scene's accuracy and cost.

use std::time::Duration;

use super::fit::PowerLaw;
use super::front::{CostClass, FrontPoint, Resolution, front};
use super::median_range::MedianRange;
use super::parameter::{Parameter, Subject};
use super::{FilmError, ReferenceImage};
use crate::systems::RenderSettings;
use crate::trace::{EstimatedError, Film, RayCounts};

/// The cost of accuracy in a scene.
#[derive(Clone, Debug)]
pub struct Report {
    /// The frames that were rendered.
    pub frames: Vec<u32>,
    /// The film's width and height in pixels.
    pub size: (u32, u32),
    /// The reference for all rows.
    pub reference: ReferenceInfo,
    /// The measured variants. The scene's own settings are the first.
    pub rows: Vec<Row>,
    /// The smallest significant differences of errors and of times.
    pub resolution: Resolution,
    /// The orders of convergence of parameters.
    pub orders: Vec<(Parameter, PowerLaw)>,
    /// The number of times that each variant was rendered to measure its cost: fewer than requested if the measurement was cancelled.
    pub rounds: u32,
    /// Samples per pixel of the scene's own settings; 0 if the number differs between pixels.
    pub own_samples: u32,
}

/// The reference that rows are compared with.
#[derive(Clone, Debug)]
pub struct ReferenceInfo {
    /// Samples per pixel, of all reference pictures together.
    pub samples: u32,
    /// The number of reference pictures.
    pub pictures: u32,
    /// The largest of the frames' [uncertainties](ReferenceImage::rms), in output values.
    pub rms: f64,
    /// The largest of the frames' [channel uncertainties](ReferenceImage::max), in output values.
    pub max: f64,
    /// The time taken to render it.
    pub time: Duration,
    /// The first frame's film.
    pub film: Film,
}

/// A measured variant, with its error and cost.
#[derive(Clone, Debug)]
pub struct Row {
    /// The difference from the scene's own settings.
    pub subject: Subject,
    /// The settings that it is rendered with.
    pub settings: RenderSettings,
    /// The error against the reference: the largest error and fraction of any frame, and the RMS error over all frames.
    pub error: FilmError,
    /// The mean structural similarity to the reference.
    pub similarity: f64,
    /// The error caused by this parameter or effect alone. For samples, it is relative to the converged picture with the scene's other settings;
    /// for other parameters, to the same samples with the best value of the parameter; for effects, to the same samples with the effect.
    pub alone: FilmError,
    /// Mean seconds per frame: `relative` times the median time of the scene's own settings, so that it does not depend on the machine's
    /// speed during the measurement.
    pub seconds: MedianRange,
    /// The time as a multiple of the time of the scene's own settings, measured right before and after.
    pub relative: MedianRange,
    /// Mean ray counts per frame.
    pub rays: RayCounts,
    /// Mean number of instructions per frame, if they are counted.
    pub instructions: Option<f64>,
    /// The renderer's own estimate of the error, if there was an error target: the largest of all frames.
    pub estimated: Option<EstimatedError>,
    /// The maximum sample count per pixel, if it kept the picture from its error target.
    pub capped: Option<u32>,
    /// The index of the first row that traces the same rays to the same picture, if any. Its time is also the time of this row.
    pub same_as: Option<usize>,
    /// True if no other setting is both better and cheaper at this [resolution](Report::resolution). Settings that trace the same rays as
    /// another, are [capped](Self::capped), or disable an effect, are not on the front.
    pub on_front: bool,
    /// The film of the first frame, if it was requested.
    pub film: Option<Film>,
}

/// The fraction of the time that an effect takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// The fraction, from 0 to 1; below 0 if pictures without the effect take longer.
    pub median: f64,
    /// Half the distance between the extremes.
    pub deviation: f64,
    /// True if the measured fraction was below 0 within the scatter of times, and was set to 0.
    pub is_clamped: bool,
}

impl Row {
    /// Returns the fraction of the time that is saved compared with the scene's own settings.
    #[must_use]
    pub fn share(&self) -> Share {
        let MedianRange { median, low, high } = self.relative;
        let is_clamped = median > 1.0 && low <= 1.0;
        let median = if is_clamped { 0.0 } else { 1.0 - median };
        Share { median, deviation: 0.5 * (high - low), is_clamped }
    }

    fn kind(&self) -> CostClass {
        (self.settings.precision, self.settings.instants, self.settings.size)
    }

    /// Returns whether another row traces the same rays in the same way to the same picture.
    pub(super) fn is_same_as(&self, other: &Self) -> bool {
        let is_a_setting = |row: &Self| !matches!(row.subject, Subject::Without(_));
        is_a_setting(self)
            && is_a_setting(other)
            && self.kind() == other.kind()
            && (self.rays, self.error, self.similarity) == (other.rays, other.error, other.similarity)
    }
}

impl ReferenceInfo {
    /// Combines the references of all frames.
    pub(super) fn of(frames: &[ReferenceImage], samples: u32, pictures: u32, time: Duration) -> Self {
        let most = |of: fn(&ReferenceImage) -> f64| frames.iter().map(of).fold(0.0, f64::max);
        let film = frames.first().map_or_else(|| Film::new(0, 0), |frame| frame.film.clone());
        Self { samples, pictures, rms: most(|frame| frame.rms), max: most(|frame| frame.max), time, film }
    }
}

impl Report {
    /// Returns the row of the scene's own settings.
    #[must_use]
    pub fn own(&self) -> &Row {
        &self.rows[0]
    }

    /// Returns the rows that change a parameter, ascending, or disable an effect.
    pub fn of_parameter(&self, parameter: Parameter) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(move |row| row.subject.parameter() == Some(parameter))
    }

    /// Returns the range of a row's true RMS error. The measured error includes the error of the reference, and the remaining uncertainty
    /// extends the range on both sides.
    #[must_use]
    pub fn rms_range(&self, row: &Row) -> (f64, f64) {
        // The reference's uncertainty is two standard errors.
        let (measured, reference, open) =
            (row.error.rms, 0.5 * self.reference.rms, 0.5 * self.resolution.rms);
        let least = (measured * measured - reference * reference).max(0.0).sqrt();
        ((least - open).max(0.0), measured + open)
    }

    /// Finds the Pareto front and fits the orders of convergence.
    pub(super) fn conclude(&mut self) {
        let candidates: Vec<(usize, FrontPoint)> = self
            .rows
            .iter()
            .enumerate()
            .filter(|(_, row)| {
                !matches!(row.subject, Subject::Without(_)) && row.same_as.is_none() && row.capped.is_none()
            })
            .map(|(index, row)| {
                let candidate = FrontPoint {
                    // Smaller errors cannot be distinguished.
                    error: row.error.rms.max(self.reference.rms),
                    time: row.relative.median,
                    rays: row.rays,
                    kind: row.estimated.is_none().then_some(row.kind()),
                };
                (index, candidate)
            })
            .collect();
        let values = 3.0 * f64::from(self.size.0) * f64::from(self.size.1) * self.frames.len() as f64;
        let times: Vec<MedianRange> =
            candidates.iter().map(|(index, _)| self.rows[*index].relative).collect();
        self.resolution = Resolution::of(self.reference.max, values, &times);
        let candidates_alone: Vec<FrontPoint> = candidates.iter().map(|(_, candidate)| *candidate).collect();
        for ((index, _), on_front) in candidates.iter().zip(front(&candidates_alone, self.resolution)) {
            self.rows[*index].on_front = on_front;
        }
        let trusted = 2.0 * self.reference.rms;
        self.orders = Parameter::ALL
            .into_iter()
            .filter(|parameter| parameter.converges())
            .filter_map(|parameter| {
                let own =
                    self.rows.first().filter(|_| parameter == Parameter::Samples && self.own_samples > 1);
                let own = own.map(|row| (f64::from(self.own_samples), row.alone.rms));
                let pairs = self.of_parameter(parameter).filter_map(|row| match row.subject {
                    // A single sample is in the pixel's centre, which is a different rule.
                    Subject::Parameter(Parameter::Samples, value) if value < 2.0 => None,
                    Subject::Parameter(_, value) if row.alone.rms > trusted => Some((value, row.alone.rms)),
                    _ => None,
                });
                let pairs = pairs.chain(own.filter(|(_, error)| *error > trusted));
                Some((parameter, PowerLaw::fit(&pairs.collect::<Vec<_>>())?))
            })
            .collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_below_0_within_the_range_are_0() {
        let row = |low, median, high| Row {
            subject: Subject::Own,
            settings: RenderSettings::default(),
            error: FilmError::default(),
            similarity: 1.0,
            alone: FilmError::default(),
            seconds: MedianRange::default(),
            relative: MedianRange { median, low, high },
            rays: RayCounts::default(),
            instructions: None,
            estimated: None,
            capped: None,
            same_as: None,
            on_front: false,
            film: None,
        };
        let share = |low, median, high| row(low, median, high).share();
        assert_eq!(share(0.5, 0.75, 1.0), Share { median: 0.25, deviation: 0.25, is_clamped: false });
        assert_eq!(share(0.75, 1.25, 1.25), Share { median: 0.0, deviation: 0.25, is_clamped: true });
        // This exceeds the scatter.
        assert_eq!(share(1.25, 1.5, 1.75), Share { median: -0.5, deviation: 0.25, is_clamped: false });
        assert_eq!(share(1.0, 1.0, 1.0), Share { median: 0.0, deviation: 0.0, is_clamped: false });
    }
}
