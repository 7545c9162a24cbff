//! Values with more than one notation. Each type has its own visitor, so that error messages describe the valid notations.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Error, IntoDeserializer, MapAccess, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

use crate::color::hex_channels;
use crate::scene::quote::{Figure, short};
use crate::scene::suggest;

/// Three numbers.
pub(crate) type Triple = [f64; 3];

/// A colour, written as `(255, 120, 60)` or `"#ff783c"`. Channels are in 0..=255 after validation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ColorDocument(pub(crate) Triple);

impl<'de> Deserialize<'de> for ColorDocument {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ColorVisitor;

        impl<'de> Visitor<'de> for ColorVisitor {
            type Value = ColorDocument;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter
                    .write_str("a colour: three numbers from 0 to 255, as (255, 120, 60), or \"#ff783c\"")
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<ColorDocument, E> {
                hex_channels(text).map(ColorDocument).ok_or_else(|| {
                    E::custom(format!(
                        "`{}` is not a colour\nwrite six hexadecimal digits after a #, as in \"#ff783c\", or (255, 120, 60)",
                        short(text)
                    ))
                })
            }

            fn visit_seq<A: SeqAccess<'de>>(self, sequence: A) -> Result<ColorDocument, A::Error> {
                triple(sequence, &self).map(ColorDocument)
            }
        }

        deserializer.deserialize_any(ColorVisitor)
    }
}

/// A background: a colour, or a gradient written as `(bottom: (255, 255, 255), top: "#80b3ff")`, perhaps with a `horizon`, or as
/// `(stops: [(0, (255, 255, 255)), (1, "#80b3ff")])`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum BackgroundDocument {
    Flat(ColorDocument),
    Gradient {
        bottom: ColorDocument,
        horizon: Option<ColorDocument>,
        top: ColorDocument,
    },
    /// Heights and colours.
    Stops(Vec<(f64, ColorDocument)>),
}

impl Default for BackgroundDocument {
    fn default() -> Self {
        Self::Flat(ColorDocument([0.0; 3]))
    }
}

impl BackgroundDocument {
    /// The names of the fields of a gradient.
    pub(crate) const FIELDS: &'static [&'static str] = &["bottom", "horizon", "top", "stops"];
}

impl<'de> Deserialize<'de> for BackgroundDocument {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(BackgroundVisitor)
    }
}

struct BackgroundVisitor;

#[derive(Deserialize)]
#[serde(field_identifier, rename_all = "lowercase")]
enum BackgroundField {
    Bottom,
    Horizon,
    Top,
    Stops,
    Other(String),
}

impl<'de> Visitor<'de> for BackgroundVisitor {
    type Value = BackgroundDocument;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(
            "a background: a colour, as (255, 120, 60) or \"#ff783c\", or two, as (bottom: (255, 255, 255), top: (128, 179, 255))",
        )
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<BackgroundDocument, E> {
        ColorDocument::deserialize(text.into_deserializer()).map(BackgroundDocument::Flat)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, sequence: A) -> Result<BackgroundDocument, A::Error> {
        triple(sequence, &self).map(|channels| BackgroundDocument::Flat(ColorDocument(channels)))
    }

    /// Reports errors with its own messages, because serde would attribute them to the scene.
    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<BackgroundDocument, A::Error> {
        let (mut bottom, mut horizon, mut top, mut stops) = (None, None, None, None);
        let twice = |name: &str| {
            let message = format!("field `{name}` of `background` is written twice");
            A::Error::custom(message + "\nremove one of the two")
        };
        while let Some(field) = map.next_key()? {
            let (name, place) = match field {
                BackgroundField::Bottom => ("bottom", &mut bottom),
                BackgroundField::Horizon => ("horizon", &mut horizon),
                BackgroundField::Top => ("top", &mut top),
                BackgroundField::Stops if stops.is_some() => return Err(twice("stops")),
                BackgroundField::Stops => {
                    stops = Some(map.next_value::<Option<Vec<(f64, ColorDocument)>>>()?);
                    continue;
                }
                BackgroundField::Other(name) => {
                    let remedy = suggest::remedy(&name, BackgroundDocument::FIELDS, "fields");
                    let message = format!("unknown field `{}` of `background`\n{remedy}", short(&name));
                    return Err(A::Error::custom(message));
                }
            };
            if place.is_some() {
                return Err(twice(name));
            }
            *place = Some(map.next_value::<Option<ColorDocument>>()?);
        }
        let missing = |name: &str| {
            let message = format!("missing field `{name}` of `background`");
            A::Error::custom(message + "\nwrite both `bottom` and `top`, or `stops`, or a single colour")
        };
        let [bottom, horizon, top] = [bottom, horizon, top].map(Option::flatten);
        if let Some(stops) = stops.flatten() {
            let ends = [("bottom", bottom), ("horizon", horizon), ("top", top)];
            if let Some((name, _)) = ends.iter().find(|(_, color)| color.is_some()) {
                let message = format!("a background of both `stops` and `{name}`");
                return Err(A::Error::custom(
                    message
                        + "\nremove the stops, or the others: `bottom` is a stop at -1, `horizon` at 0 and `top` at 1",
                ));
            }
            return Ok(BackgroundDocument::Stops(stops));
        }
        let bottom = bottom.ok_or_else(|| missing("bottom"))?;
        let top = top.ok_or_else(|| missing("top"))?;
        Ok(BackgroundDocument::Gradient { bottom, horizon, top })
    }
}

/// A scale factor for all axes, or one per axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ScaleDocument {
    /// `2`
    Uniform(f64),
    /// `(1, 2, 1)`
    PerAxis(Triple),
}

impl<'de> Deserialize<'de> for ScaleDocument {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let written =
            deserializer.deserialize_any(OneOrThree("a scale: a factor, as 2, or three, as (1, 2, 1)"))?;
        Ok(match written {
            OffsetDocument::Number(factor) => Self::Uniform(factor),
            OffsetDocument::Triple(factors) => Self::PerAxis(factors),
        })
    }
}

/// The difference between two values: one number or three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum OffsetDocument {
    Number(f64),
    Triple(Triple),
}

impl<'de> Deserialize<'de> for OffsetDocument {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(OneOrThree("a difference: a number, as -0.5, or three, as (1, 0, 0)"))
    }
}

/// A visitor of one number or three. The text describes the expected value.
struct OneOrThree(&'static str);

impl<'de> Visitor<'de> for OneOrThree {
    type Value = OffsetDocument;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.0)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<OffsetDocument, E> {
        Ok(OffsetDocument::Number(value))
    }

    #[expect(
        clippy::cast_precision_loss,
        reason = "integers beyond 2^53 round, as any number in a file does"
    )]
    fn visit_i64<E: Error>(self, value: i64) -> Result<OffsetDocument, E> {
        Ok(OffsetDocument::Number(value as f64))
    }

    #[expect(
        clippy::cast_precision_loss,
        reason = "integers beyond 2^53 round, as any number in a file does"
    )]
    fn visit_u64<E: Error>(self, value: u64) -> Result<OffsetDocument, E> {
        Ok(OffsetDocument::Number(value as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, sequence: A) -> Result<OffsetDocument, A::Error> {
        triple(sequence, &self).map(OffsetDocument::Triple)
    }
}

/// An integer of 0 or more, also accepted in notations such as `640.0` or `1e3`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct WholeDocument(u64);

/// Deserializes a field as a [`WholeDocument`].
pub(crate) fn whole<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
    WholeDocument::deserialize(deserializer).map(|whole| whole.0)
}

/// Deserializes a field as three [`WholeDocument`]s.
pub(crate) fn three_whole<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[u64; 3], D::Error> {
    <[WholeDocument; 3]>::deserialize(deserializer).map(|numbers| numbers.map(|whole| whole.0))
}

/// 2^53, from which on an `f64` no longer represents every integer.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// Converts a float to an integer. `None` if it has a fraction, is negative, or is at least 2^53.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is one that the type holds")]
fn whole_of(value: f64) -> Option<u64> {
    ((0.0..EXACT).contains(&value) && value.fract() == 0.0).then_some(value as u64)
}

impl<'de> Deserialize<'de> for WholeDocument {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct WholeVisitor;

        impl Visitor<'_> for WholeVisitor {
            type Value = WholeDocument;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a whole number: 0 or more, without a fraction, as 16")
            }

            fn visit_u64<E: Error>(self, value: u64) -> Result<WholeDocument, E> {
                Ok(WholeDocument(value))
            }

            fn visit_i64<E: Error>(self, value: i64) -> Result<WholeDocument, E> {
                let whole = u64::try_from(value).ok().map(WholeDocument);
                whole.ok_or_else(|| E::invalid_type(Unexpected::Signed(value), &self))
            }

            fn visit_f64<E: Error>(self, value: f64) -> Result<WholeDocument, E> {
                match whole_of(value) {
                    Some(whole) => Ok(WholeDocument(whole)),
                    // Floats this large have no fraction.
                    None if value >= EXACT => Err(E::custom(format!(
                        "this whole number is too large\nwrite at most {}, with all its digits",
                        u64::MAX
                    ))),
                    None => Err(E::invalid_type(Unexpected::Float(value), &self)),
                }
            }
        }

        deserializer.deserialize_any(WholeVisitor)
    }
}

/// Frames per second, written as `24` or `(30000, 1001)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RateDocument {
    pub(crate) numerator: u64,
    pub(crate) denominator: u64,
}

impl Default for RateDocument {
    fn default() -> Self {
        Self { numerator: 24, denominator: 1 }
    }
}

/// Returns the default of flags that are usually set.
pub(super) fn yes() -> bool {
    true
}

impl<'de> Deserialize<'de> for RateDocument {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct RateVisitor;

        impl<'de> Visitor<'de> for RateVisitor {
            type Value = RateDocument;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str(
                    "frames per second: a whole number, as 24, or a ratio of two, as (30000, 1001)",
                )
            }

            fn visit_u64<E: Error>(self, value: u64) -> Result<RateDocument, E> {
                Ok(RateDocument { numerator: value, denominator: 1 })
            }

            fn visit_f64<E: Error>(self, value: f64) -> Result<RateDocument, E> {
                match whole_of(value) {
                    Some(whole) => self.visit_u64(whole),
                    None if value.fract() != 0.0 && value > 0.0 && value.is_finite() => {
                        Err(E::custom(format!(
                            "{} frames per second is not exact\nwrite a ratio of whole numbers, as (30000, 1001) for 29.97",
                            Figure(value)
                        )))
                    }
                    None => Err(E::invalid_type(Unexpected::Float(value), &self)),
                }
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<RateDocument, A::Error> {
                let short = |length: usize| A::Error::invalid_length(length, &self);
                let WholeDocument(numerator) = sequence.next_element()?.ok_or_else(|| short(0))?;
                let WholeDocument(denominator) = sequence.next_element()?.ok_or_else(|| short(1))?;
                Ok(RateDocument { numerator, denominator })
            }
        }

        deserializer.deserialize_any(RateVisitor)
    }
}

fn triple<'de, A: SeqAccess<'de>>(mut sequence: A, expected: &impl Visitor<'de>) -> Result<Triple, A::Error> {
    let mut values = [0.0; 3];
    for (length, value) in values.iter_mut().enumerate() {
        *value = sequence.next_element()?.ok_or_else(|| A::Error::invalid_length(length, expected))?;
    }
    Ok(values)
}

/// A map as a list of entries in file order. Duplicate keys are kept for validation to report.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entries<T>(pub(crate) Vec<(String, T)>);

impl<T> Default for Entries<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Entries<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct EntriesVisitor<T>(PhantomData<T>);

        impl<'de, T: Deserialize<'de>> Visitor<'de> for EntriesVisitor<T> {
            type Value = Entries<T>;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a map, as { \"name\": ( .. ), }")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Entries<T>, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Entries(entries))
            }
        }

        deserializer.deserialize_map(EntriesVisitor(PhantomData))
    }
}
