//! The parameters that trade accuracy for time, and the variants of a scene's settings that change one of them.

use std::fmt;

use crate::components::Sampling;
use crate::systems::{Effect, EffectiveSettings, Plan, RenderSettings};
use crate::trace::Precision;

/// A setting that trades accuracy for time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Parameter {
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
    /// The effects, disabled one by one.
    Effects,
}

impl Parameter {
    /// All parameters.
    pub const ALL: [Self; 9] = [
        Self::Samples,
        Self::MaxError,
        Self::LightSamples,
        Self::Instants,
        Self::Depth,
        Self::Cutoff,
        Self::Precision,
        Self::Size,
        Self::Effects,
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
            Self::Effects => "effects",
        }
    }

    /// Returns whether this parameter affects pictures that need these effects.
    #[must_use]
    pub fn affects(self, plan: &Plan) -> bool {
        match self {
            Self::Samples | Self::MaxError | Self::Precision | Self::Size | Self::Effects => true,
            Self::LightSamples => plan.needs(Effect::AreaLights) || plan.needs(Effect::AmbientOcclusion),
            Self::Instants => plan.needs(Effect::MotionBlur),
            Self::Depth | Self::Cutoff => plan.needs(Effect::Reflection) || plan.needs(Effect::Refraction),
        }
    }

    /// Returns whether errors fall as a power of the parameter's value.
    #[must_use]
    pub fn converges(self) -> bool {
        matches!(self, Self::Samples | Self::LightSamples | Self::Instants)
    }
}

/// The difference of a row's settings from the scene's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Subject {
    /// No difference: the scene's own settings.
    Own,
    /// A parameter with another value.
    Parameter(Parameter, f64),
    /// Another precision.
    Precision(Precision),
    /// Another size of the film, in columns and rows. Pictures are resampled for comparison.
    Size(u32, u32),
    /// A disabled effect.
    Without(Effect),
}

impl Subject {
    /// Returns the parameter that is changed, if it is one.
    #[must_use]
    pub fn parameter(&self) -> Option<Parameter> {
        match self {
            Self::Parameter(parameter, _) => Some(*parameter),
            Self::Precision(_) => Some(Parameter::Precision),
            Self::Size(..) => Some(Parameter::Size),
            Self::Without(_) => Some(Parameter::Effects),
            Self::Own => None,
        }
    }
}

impl fmt::Display for Subject {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Own => formatter.write_str("the scene's own"),
            Self::Parameter(parameter, value) => write!(formatter, "{} {value}", parameter.name()),
            Self::Precision(Precision::Robust) => formatter.write_str("guaranteed"),
            Self::Precision(Precision::NaiveF64) => formatter.write_str("textbook f64"),
            Self::Precision(Precision::NaiveF32) => formatter.write_str("textbook f32"),
            Self::Size(width, height) => write!(formatter, "size {width}x{height}"),
            Self::Without(effect) => write!(formatter, "without {effect}"),
        }
    }
}

/// The limits of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SweepRange {
    /// The largest sample count per pixel, if it is the same for all pixels.
    pub(super) samples: u32,
    /// The largest sample count per pixel, if it differs between pixels.
    pub(super) most: u32,
    /// The largest sample count per light.
    pub(super) light_samples: u32,
    /// The largest depth.
    pub(super) depth: u32,
}

/// Returns the variants of `parameters` that affect pictures with the effects of a plan, after the scene's own settings. `sizes` are other
/// sizes of the film to include.
pub(super) fn sweep(
    plan: &Plan,
    own: EffectiveSettings,
    range: SweepRange,
    parameters: &[Parameter],
    sizes: &[(u32, u32)],
) -> Vec<(Subject, RenderSettings)> {
    let own_settings = RenderSettings::default();
    let is_varied = |parameter: &Parameter| parameters.contains(parameter) && parameter.affects(plan);
    let mut rows = vec![(Subject::Own, own_settings)];
    for parameter in Parameter::ALL.into_iter().filter(is_varied) {
        let turned = values(parameter, own, range).into_iter().map(|value| {
            let mut settings = turned(parameter, value);
            if parameter == Parameter::MaxError {
                // Not more samples than a reference picture.
                settings.samples = Some(range.most);
            }
            (Subject::Parameter(parameter, value), settings)
        });
        rows.extend(turned);
    }
    if is_varied(&Parameter::Precision) {
        rows.extend([Precision::NaiveF64, Precision::NaiveF32].map(|precision| {
            (Subject::Precision(precision), RenderSettings { precision: Some(precision), ..own_settings })
        }));
    }
    rows.extend(sizes.iter().map(|(width, height)| {
        let settings = RenderSettings { size: Some((*width, *height)), ..own_settings };
        (Subject::Size(*width, *height), settings)
    }));
    if is_varied(&Parameter::Effects) {
        let without = plan.needed().filter(|effect| *effect != Effect::Ambient || plan.needed().count() > 1);
        rows.extend(without.map(|effect| {
            (Subject::Without(effect), RenderSettings { without: [effect].into(), ..own_settings })
        }));
    }
    rows
}

/// Returns the values of a parameter, ascending, without the scene's own value.
fn values(
    parameter: Parameter,
    EffectiveSettings { sampling, quality, .. }: EffectiveSettings,
    range: SweepRange,
) -> Vec<f64> {
    let powers =
        |most: u32| (0..32).map(|exponent| 1_u32 << exponent).take_while(move |power| *power <= most);
    let (mut values, own): (Vec<f64>, f64) = match parameter {
        Parameter::Samples if sampling.is_adaptive() => (powers(range.samples).map(f64::from).collect(), 0.0),
        Parameter::Samples => (powers(range.samples).map(f64::from).collect(), sampling.samples.into()),
        Parameter::MaxError => (vec![0.25, 0.5, 1.0, 2.0, 4.0], sampling.max_error.into()),
        Parameter::LightSamples => (powers(range.light_samples).map(f64::from).collect(), 0.0),
        Parameter::Instants => (
            powers(sampling.samples.min(Sampling::LARGEST_INSTANTS)).map(f64::from).collect(),
            sampling.instants.into(),
        ),
        Parameter::Depth => {
            let depths = [1, 2, 3, 4, 5, 6, 8, 12, 16, 24, 32].into_iter();
            (depths.take_while(|depth| *depth <= range.depth).map(f64::from).collect(), quality.depth.into())
        }
        Parameter::Cutoff => (vec![0.0, 0.25, 1.0, 4.0, 16.0], quality.cutoff.into()),
        // Their values are not numbers.
        Parameter::Precision | Parameter::Size | Parameter::Effects => (Vec::new(), 0.0),
    };
    values.retain(|value| *value != own);
    values
}

/// Returns settings with one parameter set to a value of a sweep.
pub(super) fn turned(parameter: Parameter, value: f64) -> RenderSettings {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole numbers of a sweep")]
    let count = value as u32;
    #[expect(clippy::cast_possible_truncation, reason = "few digits")]
    let number = value as f32;
    let settings = RenderSettings::default();
    match parameter {
        Parameter::Samples => RenderSettings { samples: Some(count), max_error: Some(0.0), ..settings },
        Parameter::MaxError => RenderSettings { max_error: Some(number), ..settings },
        Parameter::LightSamples => RenderSettings { light_samples: Some(count), ..settings },
        Parameter::Instants => RenderSettings { instants: Some(count), ..settings },
        Parameter::Depth => RenderSettings { depth: Some(count), ..settings },
        Parameter::Cutoff => RenderSettings { cutoff: Some(number), ..settings },
        Parameter::Precision | Parameter::Size | Parameter::Effects => settings,
    }
}
