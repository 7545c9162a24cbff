//! Conversion of script values from and to Rhai's.

use rhai::{Dynamic, FnPtr, ImmutableString};

use super::Data;
use super::result::number;

impl Data {
    pub(super) fn of(value: &Dynamic) -> Self {
        if let Ok(whole) = value.as_int() {
            return Self::Whole(whole);
        }
        if let Ok(number) = value.as_float() {
            return Self::Number(number);
        }
        if let Ok(flag) = value.as_bool() {
            return Self::Flag(flag);
        }
        if let Ok(text) = value.as_immutable_string_ref() {
            return Self::Text(text.to_string());
        }
        if let Ok(list) = value.as_array_ref() {
            return Self::List(list.iter().map(Self::of).collect());
        }
        if let Ok(map) = value.as_map_ref() {
            return Self::Map(map.iter().map(|(name, value)| (name.to_string(), Self::of(value))).collect());
        }
        if value.is_unit() { Self::Nothing } else { Self::Other(kind(value)) }
    }

    pub(super) fn into_dynamic(self) -> Dynamic {
        match self {
            Self::Nothing | Self::Other(_) => Dynamic::UNIT,
            Self::Flag(flag) => Dynamic::from_bool(flag),
            Self::Number(number) => Dynamic::from_float(number),
            Self::Whole(whole) => Dynamic::from_int(whole),
            Self::Text(text) => ImmutableString::from(text).into(),
            Self::List(list) => Dynamic::from_array(list.into_iter().map(Self::into_dynamic).collect()),
            Self::Map(map) => Dynamic::from_map(
                map.into_iter().map(|(name, value)| (name.into(), value.into_dynamic())).collect(),
            ),
        }
    }

    /// Returns the total length in bytes of all strings in the value, without map keys.
    pub(super) fn text_length(&self) -> usize {
        match self {
            Self::Text(text) => text.len(),
            Self::List(list) => list.iter().map(Self::text_length).sum(),
            Self::Map(map) => map.iter().map(|(_, value)| value.text_length()).sum(),
            _ => 0,
        }
    }
}

/// Returns the name of a value's type as used in messages.
pub(super) fn kind(value: &Dynamic) -> &'static str {
    if number(value).is_some() {
        "a number"
    } else if value.is_string() {
        "a text"
    } else if value.is_array() {
        "a list"
    } else if value.is_map() {
        "a map"
    } else if value.is_bool() {
        "true or false"
    } else if value.is_unit() {
        "nothing"
    } else if value.is::<FnPtr>() {
        "a function"
    } else if value.is_char() {
        "a character"
    } else {
        "a range"
    }
}
