//! The name of an animated property.

use std::fmt;

use serde::de::{EnumAccess, Error, VariantAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::components::Property;

/// A property, written as its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ChannelDocument(pub(crate) Property);

impl ChannelDocument {
    const NAMES: &'static [&'static str] = &{
        let mut names = [""; Property::ALL.len()];
        let mut index = 0;
        while index < names.len() {
            names[index] = Property::ALL[index].name();
            index += 1;
        }
        names
    };
}

impl<'de> Deserialize<'de> for ChannelDocument {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ChannelVisitor;

        struct PropertyName(Property);

        impl<'de> Deserialize<'de> for PropertyName {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_identifier(ChannelVisitor).map(Self)
            }
        }

        impl<'de> Visitor<'de> for ChannelVisitor {
            type Value = Property;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a channel, as Translation")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<Property, E> {
                Property::named(name).ok_or_else(|| E::unknown_variant(name, ChannelDocument::NAMES))
            }

            fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<Property, A::Error> {
                let (PropertyName(property), rest) = data.variant()?;
                rest.unit_variant()?;
                Ok(property)
            }
        }

        deserializer.deserialize_enum("Channel", Self::NAMES, ChannelVisitor).map(Self)
    }
}
