//! Animated values and their tracks.

use std::fmt;

use serde::de::{Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::{ChannelDocument, ColorDocument, OffsetDocument, RotationDocument, ScaleDocument, Triple, whole};
use crate::animation::Notation;

/// One animated value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct AnimationDocument {
    pub(crate) target: Option<String>,
    pub(crate) material: Option<String>,
    pub(crate) channel: ChannelDocument,
    pub(crate) track: TracksDocument,
    pub(crate) repeat: RepeatDocument,
    pub(crate) offset: f64,
    pub(crate) speed: f64,
    /// The index of the compiled script, if the track is a script.
    pub(crate) script: Option<usize>,
}

/// A track with the value type of its channel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum TracksDocument {
    Number(TrackDocument<f64>),
    Vector(TrackDocument<Triple>),
    Scale(TrackDocument<ScaleDocument>),
    Rotation(TrackDocument<RotationDocument>),
    Color(TrackDocument<ColorDocument>),
    Flag(TrackDocument<bool>),
}

/// A value over time.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Track")]
pub(crate) enum TrackDocument<T> {
    Keys(Vec<KeyDocument<T>>),
    Path {
        points: Vec<Triple>,
        #[serde(default)]
        closed: bool,
        #[serde(default)]
        start: f64,
        duration: Option<f64>,
        speed: Option<f64>,
        #[serde(default)]
        ease: EasingDocument,
    },
    Orbit {
        center: Triple,
        radius: f64,
        #[serde(default = "upwards")]
        axis: Triple,
        #[serde(default)]
        height: f64,
        #[serde(default)]
        from: f64,
        #[serde(default = "once")]
        turns: f64,
        #[serde(default)]
        start: f64,
        duration: f64,
        #[serde(default)]
        ease: EasingDocument,
    },
    Turns {
        #[serde(default = "upwards")]
        axis: Triple,
        #[serde(default = "once")]
        turns: f64,
        #[serde(default)]
        from: f64,
        #[serde(default)]
        start: f64,
        duration: f64,
        #[serde(default)]
        ease: EasingDocument,
    },
    Along,
    Script(String),
    ScriptFile(String),
}

fn upwards() -> Triple {
    [0.0, 1.0, 0.0]
}

fn once() -> f64 {
    1.0
}

impl<T> TrackDocument<T> {
    /// Returns the script of a scripted track; `None` for other tracks.
    pub(crate) fn script(&self) -> Option<ScriptDocument> {
        match self {
            Self::Keys(_) | Self::Path { .. } | Self::Orbit { .. } | Self::Turns { .. } | Self::Along => None,
            Self::Script(text) => Some(ScriptDocument::Script(text.clone())),
            Self::ScriptFile(name) => Some(ScriptDocument::File(name.clone())),
        }
    }
}

impl TracksDocument {
    /// Returns whether it is the direction of a way.
    pub(crate) fn is_along(&self) -> bool {
        match self {
            Self::Number(track) => matches!(track, TrackDocument::Along),
            Self::Vector(track) => matches!(track, TrackDocument::Along),
            Self::Scale(track) => matches!(track, TrackDocument::Along),
            Self::Rotation(track) => matches!(track, TrackDocument::Along),
            Self::Color(track) => matches!(track, TrackDocument::Along),
            Self::Flag(track) => matches!(track, TrackDocument::Along),
        }
    }

    /// Returns whether it is a way, which has a direction.
    pub(crate) fn is_way(&self) -> bool {
        matches!(self, Self::Vector(TrackDocument::Path { .. } | TrackDocument::Orbit { .. }))
    }

    /// Returns the script of a scripted track; `None` for other tracks.
    pub(crate) fn script(&self) -> Option<ScriptDocument> {
        match self {
            Self::Number(track) => track.script(),
            Self::Vector(track) => track.script(),
            Self::Scale(track) => track.script(),
            Self::Rotation(track) => track.script(),
            Self::Color(track) => track.script(),
            Self::Flag(track) => track.script(),
        }
    }
}

/// A script, written in the scene file or in a file of its own.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename = "Script")]
pub(crate) enum ScriptDocument {
    Script(String),
    File(String),
}

/// A key, written as `(time, value)` or `(time, value, easing)`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct KeyDocument<T> {
    pub(crate) time: f64,
    pub(crate) value: T,
    pub(crate) easing: EasingDocument,
}

/// The easing from one key to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename = "Easing")]
pub(crate) enum EasingDocument {
    Hold,
    #[default]
    Linear,
    EaseIn,
    EaseOut,
    EaseInOut,
    InSine,
    OutSine,
    InOutSine,
    InQuad,
    OutQuad,
    InOutQuad,
    InCubic,
    OutCubic,
    InOutCubic,
    InQuart,
    OutQuart,
    InOutQuart,
    InQuint,
    OutQuint,
    InOutQuint,
    InExpo,
    OutExpo,
    InOutExpo,
    InCirc,
    OutCirc,
    InOutCirc,
    InBack,
    OutBack,
    InOutBack,
    InElastic,
    OutElastic,
    InOutElastic,
    InBounce,
    OutBounce,
    InOutBounce,
    Steps(#[serde(deserialize_with = "whole")] u64),
    Bezier(f64, f64, f64, f64),
    Cubic,
    CatmullRom,
    Monotone,
    Handles(OffsetDocument, OffsetDocument),
}

/// The behaviour of a track beyond its keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename = "Repeat")]
pub(crate) enum RepeatDocument {
    #[default]
    Clamp,
    Loop,
    PingPong,
}

impl AnimationDocument {
    pub(crate) const FIELDS: &'static [&'static str] =
        &["target", "material", "channel", "track", "repeat", "offset", "speed"];
}

/// Implemented by hand because the type of `track` depends on `channel`.
impl<'de> Deserialize<'de> for AnimationDocument {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_struct("Animation", Self::FIELDS, AnimationVisitor)
    }
}

struct AnimationVisitor;

#[derive(Deserialize)]
#[serde(field_identifier, rename_all = "lowercase")]
enum AnimationField {
    Target,
    Material,
    Channel,
    Track,
    Repeat,
    Offset,
    Speed,
}

impl<'de> Visitor<'de> for AnimationVisitor {
    type Value = AnimationDocument;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an animation, as (target: \"name\", channel: Translation, track: Keys([ .. ]))")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<AnimationDocument, A::Error> {
        let (mut target, mut material, mut channel, mut track) = (None, None, None, None);
        let (mut repeat, mut offset, mut speed) = (None, None, None);
        while let Some(field) = map.next_key()? {
            let twice = match field {
                AnimationField::Target => target.is_some().then_some("target"),
                AnimationField::Material => material.is_some().then_some("material"),
                AnimationField::Channel => channel.is_some().then_some("channel"),
                AnimationField::Track => track.is_some().then_some("track"),
                AnimationField::Repeat => repeat.is_some().then_some("repeat"),
                AnimationField::Offset => offset.is_some().then_some("offset"),
                AnimationField::Speed => speed.is_some().then_some("speed"),
            };
            if let Some(name) = twice {
                return Err(A::Error::duplicate_field(name));
            }
            match field {
                AnimationField::Target => target = map.next_value::<Option<String>>()?,
                AnimationField::Material => material = map.next_value::<Option<String>>()?,
                AnimationField::Channel => channel = Some(map.next_value::<ChannelDocument>()?),
                AnimationField::Track => {
                    let Some(channel) = channel else {
                        return Err(A::Error::custom(
                            "`track` stands before `channel`\nwrite `channel` first: it says what kind of values the keys have",
                        ));
                    };
                    track = Some(tracks(channel, &mut map)?);
                }
                AnimationField::Repeat => repeat = Some(map.next_value::<RepeatDocument>()?),
                AnimationField::Offset => offset = Some(map.next_value::<f64>()?),
                AnimationField::Speed => speed = Some(map.next_value::<f64>()?),
            }
        }
        let channel = channel.ok_or_else(|| A::Error::missing_field("channel"))?;
        let track = track.ok_or_else(|| A::Error::missing_field("track"))?;
        let (repeat, offset) = (repeat.unwrap_or_default(), offset.unwrap_or(0.0));
        let speed = speed.unwrap_or(1.0);
        Ok(AnimationDocument { target, material, channel, track, repeat, offset, speed, script: None })
    }
}

fn tracks<'de, A: MapAccess<'de>>(channel: ChannelDocument, map: &mut A) -> Result<TracksDocument, A::Error> {
    match channel.0.notation() {
        Notation::Number | Notation::Degrees => map.next_value().map(TracksDocument::Number),
        Notation::Vector | Notation::Light => map.next_value().map(TracksDocument::Vector),
        Notation::Scale => map.next_value().map(TracksDocument::Scale),
        Notation::Rotation => map.next_value().map(TracksDocument::Rotation),
        Notation::Color => map.next_value().map(TracksDocument::Color),
        Notation::Flag => map.next_value().map(TracksDocument::Flag),
    }
}

/// Implemented by hand because the easing is optional.
impl<'de, T: Deserialize<'de>> Deserialize<'de> for KeyDocument<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct KeyVisitor<T>(std::marker::PhantomData<T>);

        impl<'de, T: Deserialize<'de>> Visitor<'de> for KeyVisitor<T> {
            type Value = KeyDocument<T>;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a key: (time, value) or (time, value, easing)")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<KeyDocument<T>, A::Error> {
                let time = sequence.next_element()?.ok_or_else(|| A::Error::invalid_length(0, &self))?;
                let value = sequence.next_element()?.ok_or_else(|| A::Error::invalid_length(1, &self))?;
                let easing = sequence.next_element()?.unwrap_or_default();
                if sequence.next_element::<IgnoredAny>()?.is_some() {
                    return Err(A::Error::invalid_length(4, &self));
                }
                Ok(KeyDocument { time, value, easing })
            }
        }

        deserializer.deserialize_tuple(3, KeyVisitor(std::marker::PhantomData))
    }
}
