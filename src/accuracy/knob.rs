//! The knobs that trade accuracy for time, and the variants of a scene's settings that change one of them.

use std::fmt;

use crate::components::{Quality, Sampling};
use crate::engine::Engine;
use crate::systems::{Effect, Knobs, Plan};
use crate::trace::Precision;

/// A setting that trades accuracy for time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Knob {
    /// Samples per pixel, the same number for all.
    Samples,
    /// The error target of the picture, which decides the distribution of samples.
    MaxError,
    /// Samples per area light.
    LightSamples,
    /// Instants while the shutter is open.
    Instants,
    /// The maximum depth of rays.
    Depth,
    /// The contribution below which rays are not traced.
    Cutoff,
    /// The precision of ray-shape intersections.
    Precision,
    /// The film's columns and rows.
    Size,
}

impl Knob {
    /// All knobs.
    pub const ALL: [Self; 8] = [
        Self::Samples,
        Self::MaxError,
        Self::LightSamples,
        Self::Instants,
        Self::Depth,
        Self::Cutoff,
        Self::Precision,
        Self::Size,
    ];

    /// Returns the name in words, as "max error".
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Samples => "samples",
            Self::MaxError => "max error",
            Self::LightSamples => "light samples",
            Self::Instants => "instants",
            Self::Depth => "depth",
            Self::Cutoff => "cutoff",
            Self::Precision => "precision",
            Self::Size => "size",
        }
    }

    /// Returns whether errors fall as a power of the knob's value.
    #[must_use]
    pub fn converges(self) -> bool {
        matches!(self, Self::Samples | Self::LightSamples | Self::Instants)
    }
}

/// A set of settings to render a scene with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Variant {
    /// Settings that override the scene's own.
    pub knobs: Knobs,
    /// The precision of ray-shape intersections.
    pub precision: Precision,
    /// An effect to disable.
    pub without: Option<Effect>,
}

impl Variant {
    /// Applies the settings to an engine, in which the effects in `left_out` are disabled as well.
    pub(super) fn apply(&self, engine: &mut Engine, left_out: &[Effect]) {
        engine.set_knobs(self.knobs);
        engine.set_precision(self.precision);
        engine.set_left_out(left_out.iter().copied().chain(self.without));
    }
}

/// The difference of a variant from the scene's own settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Subject {
    /// No difference: the scene's own settings.
    Own,
    /// A knob with another value.
    Knob(Knob, f64),
    /// Another precision.
    Precision(Precision),
    /// Another size of the film, in columns and rows. Pictures are resampled for comparison.
    Size(u32, u32),
    /// A disabled effect.
    Without(Effect),
}

impl Subject {
    /// Returns the knob that is changed, if it is one.
    #[must_use]
    pub fn knob(&self) -> Option<Knob> {
        match self {
            Self::Knob(knob, _) => Some(*knob),
            Self::Precision(_) => Some(Knob::Precision),
            Self::Size(..) => Some(Knob::Size),
            Self::Own | Self::Without(_) => None,
        }
    }
}

impl fmt::Display for Subject {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Own => formatter.write_str("the scene's own"),
            Self::Knob(knob, value) => write!(formatter, "{} {value}", knob.name()),
            Self::Precision(Precision::Guaranteed) => formatter.write_str("guaranteed"),
            Self::Precision(Precision::TextbookF64) => formatter.write_str("textbook f64"),
            Self::Precision(Precision::TextbookF32) => formatter.write_str("textbook f32"),
            Self::Size(width, height) => write!(formatter, "size {width}x{height}"),
            Self::Without(effect) => write!(formatter, "without {effect}"),
        }
    }
}

/// The settings of a scene that knobs override.
#[derive(Clone, Copy, Debug)]
pub(super) struct OwnSettings {
    pub(super) sampling: Sampling,
    pub(super) quality: Quality,
}

/// The limits of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Reach {
    /// The largest sample count per pixel, if it is the same for all pixels.
    pub(super) samples: u32,
    /// The largest sample count per pixel, if it differs between pixels.
    pub(super) most: u32,
    /// The largest sample count per light.
    pub(super) light_samples: u32,
    /// The largest depth.
    pub(super) depth: u32,
}

/// Returns the variants worth comparing for the effects of a plan. The scene's own settings are the first. `sizes` are other sizes of the
/// film to include.
pub(super) fn sweep(
    plan: &Plan,
    own: OwnSettings,
    reach: Reach,
    sizes: &[(u32, u32)],
) -> Vec<(Subject, Variant)> {
    let mut rows = vec![(Subject::Own, Variant::default())];
    for knob in Knob::ALL.into_iter().filter(|knob| is_called_for(*knob, plan)) {
        let turned = values(knob, own, reach).into_iter().map(|value| {
            let mut knobs = turned(knob, value);
            if knob == Knob::MaxError {
                // Not more samples than a reference picture.
                knobs.samples = Some(reach.most);
            }
            (Subject::Knob(knob, value), Variant { knobs, ..Variant::default() })
        });
        rows.extend(turned);
    }
    rows.extend(
        [Precision::TextbookF64, Precision::TextbookF32]
            .map(|precision| (Subject::Precision(precision), Variant { precision, ..Variant::default() })),
    );
    rows.extend(sizes.iter().map(|(width, height)| {
        let knobs = Knobs { size: Some((*width, *height)), ..Knobs::default() };
        (Subject::Size(*width, *height), Variant { knobs, ..Variant::default() })
    }));
    let without = plan.needed().filter(|effect| *effect != Effect::Ambient || plan.needed().count() > 1);
    rows.extend(
        without.map(|effect| {
            (Subject::Without(effect), Variant { without: Some(effect), ..Variant::default() })
        }),
    );
    rows
}

/// Returns whether a knob affects pictures that need these effects.
fn is_called_for(knob: Knob, plan: &Plan) -> bool {
    match knob {
        Knob::Samples | Knob::MaxError | Knob::Precision | Knob::Size => true,
        Knob::LightSamples => plan.needs(Effect::AreaLights),
        Knob::Instants => plan.needs(Effect::MotionBlur),
        Knob::Depth | Knob::Cutoff => plan.needs(Effect::Reflection) || plan.needs(Effect::Refraction),
    }
}

/// Returns the values of a knob, ascending, without the scene's own value.
fn values(knob: Knob, OwnSettings { sampling, quality }: OwnSettings, reach: Reach) -> Vec<f64> {
    let powers =
        |most: u32| (0..32).map(|exponent| 1_u32 << exponent).take_while(move |power| *power <= most);
    let (mut values, own): (Vec<f64>, f64) = match knob {
        Knob::Samples if sampling.max_error > 0.0 => (powers(reach.samples).map(f64::from).collect(), 0.0),
        Knob::Samples => (powers(reach.samples).map(f64::from).collect(), sampling.samples.into()),
        Knob::MaxError => (vec![0.25, 0.5, 1.0, 2.0, 4.0], sampling.max_error.into()),
        Knob::LightSamples => (powers(reach.light_samples).map(f64::from).collect(), 0.0),
        Knob::Instants => (
            powers(sampling.samples.min(Sampling::LARGEST_INSTANTS)).map(f64::from).collect(),
            sampling.instants.into(),
        ),
        Knob::Depth => {
            let depths = [1, 2, 3, 4, 5, 6, 8, 12, 16, 24, 32].into_iter();
            (depths.take_while(|depth| *depth <= reach.depth).map(f64::from).collect(), quality.depth.into())
        }
        Knob::Cutoff => (vec![0.0, 0.25, 1.0, 4.0, 16.0], quality.cutoff.into()),
        // Their values are not numbers.
        Knob::Precision | Knob::Size => (Vec::new(), 0.0),
    };
    values.retain(|value| *value != own);
    values
}

/// Returns knobs with one of them set to a value of a sweep.
pub(super) fn turned(knob: Knob, value: f64) -> Knobs {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole numbers of a sweep")]
    let count = value as u32;
    #[expect(clippy::cast_possible_truncation, reason = "few digits")]
    let number = value as f32;
    let knobs = Knobs::default();
    match knob {
        Knob::Samples => Knobs { samples: Some(count), max_error: Some(0.0), ..knobs },
        Knob::MaxError => Knobs { max_error: Some(number), ..knobs },
        Knob::LightSamples => Knobs { light_samples: Some(count), ..knobs },
        Knob::Instants => Knobs { instants: Some(count), ..knobs },
        Knob::Depth => Knobs { depth: Some(count), ..knobs },
        Knob::Cutoff => Knobs { cutoff: Some(number), ..knobs },
        Knob::Precision | Knob::Size => knobs,
    }
}
