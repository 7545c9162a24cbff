//! The material of an entity, in its two notations.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::MaterialDocument;

/// The material of an entity: its name, written as `"clay"`, or its fields, written as `(color: (255, 120, 60))`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SurfaceDocument {
    Named(String),
    /// Boxed because it is large and few entities have one.
    Inline(Box<MaterialDocument>),
}

impl SurfaceDocument {
    /// The words with which [`expecting`](Visitor::expecting) begins.
    pub(crate) const NOUN: &'static str = "a material";

    /// Returns it with a prefix before its name.
    pub(crate) fn prefixed(&self, prefix: &str) -> Self {
        match self {
            Self::Named(name) => Self::Named(format!("{prefix}{name}")),
            Self::Inline(_) => self.clone(),
        }
    }
}

impl<'de> Deserialize<'de> for SurfaceDocument {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct SurfaceVisitor;

        impl<'de> Visitor<'de> for SurfaceVisitor {
            type Value = SurfaceDocument;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(
                    formatter,
                    "{}: its name in quotes, as \"clay\", or its fields, as (color: (255, 120, 60))",
                    SurfaceDocument::NOUN
                )
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<SurfaceDocument, E> {
                Ok(SurfaceDocument::Named(name.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, fields: A) -> Result<SurfaceDocument, A::Error> {
                Box::deserialize(MapAccessDeserializer::new(fields)).map(SurfaceDocument::Inline)
            }
        }

        deserializer.deserialize_any(SurfaceVisitor)
    }
}
