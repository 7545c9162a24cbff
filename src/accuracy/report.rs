//! What is known of a scene's accuracy and its price, once it has been measured.

use std::time::Duration;

use super::fit::PowerLaw;
use super::knob::{Knob, Subject, Variant};
use super::spread::Spread;
use super::{Converged, FilmError};
use crate::trace::{Film, RayCounts};

/// What accuracy costs in a scene.
#[derive(Clone, Debug)]
pub struct Report {
    /// The frames that were rendered.
    pub frames: Vec<u32>,
    /// The film's columns and rows.
    pub size: (u32, u32),
    /// What all ways to render are compared with.
    pub reference: Reference,
    /// The ways to render; the scene's own is the first.
    pub rows: Vec<Row>,
    /// How fast the errors of knobs fall.
    pub orders: Vec<(Knob, PowerLaw)>,
    /// How often each way was rendered.
    pub rounds: u32,
    /// Samples per pixel of the scene's own settings; 0 if pixels have different numbers.
    pub own_samples: u32,
}

/// What all ways to render are compared with.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Samples per pixel, of all its pictures together.
    pub samples: u32,
    /// The number of its pictures.
    pub pictures: u32,
    /// The largest of the frames' [uncertainties](Converged::rms), in output values.
    pub rms: f64,
    /// The same of [single channels](Converged::max).
    pub max: f64,
    /// The time that it took.
    pub time: Duration,
    /// The first frame's.
    pub film: Film,
}

/// A way to render, its error and its price.
#[derive(Clone, Debug)]
pub struct Row {
    /// What is turned or left out.
    pub subject: Subject,
    /// How it is rendered.
    pub variant: Variant,
    /// How far it is off the reference: the worst frame's largest error and share, and the root of the mean square over all frames.
    pub error: FilmError,
    /// How alike it is to the reference, on average.
    pub similarity: f64,
    /// How far it is off what its knob or effect alone makes of it: for samples the converged picture with the scene's other settings,
    /// for others the same samples with the knob at its best, or with the effect.
    pub alone: FilmError,
    /// Seconds a frame, on average.
    pub seconds: Spread,
    /// The time as a multiple of that of the scene's own settings, measured right before and after.
    pub relative: Spread,
    /// Rays a frame, on average.
    pub rays: RayCounts,
    /// Instructions a frame, on average, where they are counted.
    pub instructions: Option<f64>,
    /// Whether no other setting has both a smaller error and a lower price.
    pub on_front: bool,
    /// The first frame's, if it was to be kept.
    pub film: Option<Film>,
}

impl Reference {
    /// Joins the frames' references.
    pub(super) fn of(frames: &[Converged], samples: u32, pictures: u32, time: Duration) -> Self {
        let most = |of: fn(&Converged) -> f64| frames.iter().map(of).fold(0.0, f64::max);
        let film = frames.first().map_or_else(|| Film::new(0, 0), |frame| frame.film.clone());
        Self { samples, pictures, rms: most(|frame| frame.rms), max: most(|frame| frame.max), time, film }
    }
}

impl Report {
    /// Returns the scene's own settings.
    #[must_use]
    pub fn own(&self) -> &Row {
        &self.rows[0]
    }

    /// Returns the ways that turn a knob, ascending.
    pub fn of_knob(&self, knob: Knob) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(move |row| row.subject.knob() == Some(knob))
    }

    /// Returns the ways without an effect.
    pub fn without(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| matches!(row.subject, Subject::Without(_)))
    }

    /// Marks the ways that no other one is both better and cheaper than, and fits orders.
    pub(super) fn conclude(&mut self) {
        let prices: Vec<(f64, f64, bool)> = self
            .rows
            .iter()
            .map(|row| {
                // Below that they cannot be told apart.
                let error = row.error.rms.max(self.reference.rms);
                (error, row.relative.median, !matches!(row.subject, Subject::Without(_)))
            })
            .collect();
        for (index, row) in self.rows.iter_mut().enumerate() {
            let (error, price, counts) = prices[index];
            let beaten = prices.iter().any(|(other, cheaper, counts)| {
                *counts && *other <= error && *cheaper <= price && (*other < error || *cheaper < price)
            });
            row.on_front = counts && !beaten;
        }
        let trusted = 2.0 * self.reference.rms;
        self.orders = Knob::ALL
            .into_iter()
            .filter(|knob| knob.converges())
            .filter_map(|knob| {
                let own = self.rows.first().filter(|_| knob == Knob::Samples && self.own_samples > 1);
                let own = own.map(|row| (f64::from(self.own_samples), row.alone.rms));
                let pairs = self.of_knob(knob).filter_map(|row| match row.subject {
                    // A single sample is in the pixel's centre, which is another rule.
                    Subject::Knob(Knob::Samples, value) if value < 2.0 => None,
                    Subject::Knob(_, value) if row.alone.rms > trusted => Some((value, row.alone.rms)),
                    _ => None,
                });
                let pairs = pairs.chain(own.filter(|(_, error)| *error > trusted));
                Some((knob, PowerLaw::fit(&pairs.collect::<Vec<_>>())?))
            })
            .collect();
    }
}
