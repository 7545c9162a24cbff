//! Records the values that serde requests while a text is parsed. For a rejected text, the pending requests describe the expected value.
//!
//! Serde requests one value after the other from the parser, each with a type and nested in another request. [`Watched`] wraps both of
//! them, forwards every call, and records the requests that have not been fulfilled yet.

use std::cell::RefCell;
use std::fmt;

use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, Expected, MapAccess, SeqAccess, VariantAccess, Visitor,
};
use serde::forward_to_deserialize_any;

/// A request by serde for a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::scene) enum Expectation {
    Number,
    Flag,
    Text,
    /// A list in square brackets.
    List,
    /// A map in braces.
    Map,
    /// The name before a colon.
    FieldName,
    /// Named values in parentheses.
    Fields {
        name: &'static str,
        fields: &'static [&'static str],
    },
    /// Values in parentheses, as described by the type that reads them.
    Values {
        reader: String,
        count: usize,
    },
    /// One of several words, some of them with content in parentheses.
    Choice {
        name: &'static str,
        words: &'static [&'static str],
    },
    /// The content in parentheses after a word.
    VariantContent {
        of: &'static str,
        word: String,
        content: VariantContent,
    },
    /// A value with several notations, as described by the type that reads it.
    Any {
        reader: String,
    },
}

/// The content in parentheses after a word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::scene) enum VariantContent {
    One,
    Several(usize),
    Fields(&'static [&'static str]),
}

/// The requests made while a text is parsed.
#[derive(Debug, Default)]
pub(super) struct Trail {
    /// The pending requests, each nested in the previous one.
    open: RefCell<Vec<Expectation>>,
    /// The request fulfilled last.
    fulfilled: RefCell<Option<Expectation>>,
    /// The last word read for a choice.
    word: RefCell<String>,
}

impl Trail {
    /// Wraps a parser to record the requests made to it.
    pub(super) fn watch<T>(&self, parser: T) -> Watched<'_, T> {
        Watched { inner: parser, trail: self }
    }

    /// Returns the pending requests, innermost last.
    pub(super) fn open(&self) -> Vec<Expectation> {
        self.open.borrow().clone()
    }

    /// Returns the request fulfilled last.
    pub(super) fn fulfilled(&self) -> Option<Expectation> {
        self.fulfilled.borrow().clone()
    }

    /// Makes a request, which stays pending if it fails.
    fn expect<T, E>(&self, kind: Expectation, fulfil: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
        self.request(kind);
        let value = fulfil()?;
        self.fulfil();
        Ok(value)
    }

    // Not inlined into the hundreds of instances of `expect`.
    #[inline(never)]
    fn request(&self, kind: Expectation) {
        self.open.borrow_mut().push(kind);
    }

    #[inline(never)]
    fn fulfil(&self) {
        *self.fulfilled.borrow_mut() = self.open.borrow_mut().pop();
    }
}

/// A recording wrapper around any object that serde and the parser pass to each other.
pub(super) struct Watched<'t, T> {
    inner: T,
    trail: &'t Trail,
}

macro_rules! expect_for {
    ($($method:ident: $kind:expr;)*) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
            self.trail.expect($kind, || self.inner.$method(self.trail.watch(visitor)))
        }
    )*};
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for Watched<'_, D> {
    type Error = D::Error;

    expect_for! {
        deserialize_bool: Expectation::Flag;
        deserialize_f64: Expectation::Number;
        deserialize_str: Expectation::Text;
        deserialize_string: Expectation::Text;
        deserialize_seq: Expectation::List;
        deserialize_map: Expectation::Map;
    }

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        let reader = words_of(&visitor);
        self.trail
            .expect(Expectation::Any { reader }, || self.inner.deserialize_any(self.trail.watch(visitor)))
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.inner.deserialize_option(self.trail.watch(visitor))
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.inner.deserialize_ignored_any(visitor)
    }

    fn deserialize_identifier<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        // The word of a choice, otherwise the name of a field.
        let is_choice = matches!(self.trail.open.borrow().last(), Some(Expectation::Choice { .. }));
        let read = || self.inner.deserialize_identifier(Word { visitor, trail: self.trail });
        if is_choice { read() } else { self.trail.expect(Expectation::FieldName, read) }
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, count: usize, visitor: V) -> Result<V::Value, D::Error> {
        let kind = Expectation::Values { reader: words_of(&visitor), count };
        self.trail.expect(kind, || self.inner.deserialize_tuple(count, self.trail.watch(visitor)))
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        count: usize,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let kind = Expectation::Values { reader: words_of(&visitor), count };
        self.trail
            .expect(kind, || self.inner.deserialize_tuple_struct(name, count, self.trail.watch(visitor)))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let kind = Expectation::Fields { name, fields };
        self.trail.expect(kind, || self.inner.deserialize_struct(name, fields, self.trail.watch(visitor)))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let kind = Expectation::Choice { name, words: variants };
        self.trail.expect(kind, || self.inner.deserialize_enum(name, variants, self.trail.watch(visitor)))
    }

    forward_to_deserialize_any! {
        i8 i16 i32 i64 u8 u16 u32 u64 f32 char bytes byte_buf unit unit_struct newtype_struct
    }
}

fn words_of<'de>(visitor: &impl Visitor<'de>) -> String {
    (visitor as &dyn Expected).to_string()
}

macro_rules! hand_on {
    ($($method:ident($value:ty);)*) => {$(
        fn $method<E: Error>(self, value: $value) -> Result<V::Value, E> {
            self.inner.$method(value)
        }
    )*};
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Watched<'_, V> {
    type Value = V::Value;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.inner.expecting(formatter)
    }

    hand_on! {
        visit_bool(bool);
        visit_i64(i64);
        visit_u64(u64);
        visit_f64(f64);
        visit_str(&str);
        visit_borrowed_str(&'de str);
        visit_string(String);
    }

    fn visit_unit<E: Error>(self) -> Result<V::Value, E> {
        self.inner.visit_unit()
    }

    fn visit_none<E: Error>(self) -> Result<V::Value, E> {
        self.inner.visit_none()
    }

    fn visit_some<D: Deserializer<'de>>(self, parser: D) -> Result<V::Value, D::Error> {
        self.inner.visit_some(self.trail.watch(parser))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<V::Value, A::Error> {
        self.inner.visit_seq(self.trail.watch(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, entries: A) -> Result<V::Value, A::Error> {
        self.inner.visit_map(self.trail.watch(entries))
    }

    fn visit_enum<A: EnumAccess<'de>>(self, choice: A) -> Result<V::Value, A::Error> {
        self.inner.visit_enum(self.trail.watch(choice))
    }
}

/// A visitor that records the word of a choice.
struct Word<'t, V> {
    visitor: V,
    trail: &'t Trail,
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Word<'_, V> {
    type Value = V::Value;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.visitor.expecting(formatter)
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<V::Value, E> {
        self.trail.word.replace(word.to_owned());
        self.visitor.visit_str(word)
    }

    fn visit_borrowed_str<E: Error>(self, word: &'de str) -> Result<V::Value, E> {
        self.trail.word.replace(word.to_owned());
        self.visitor.visit_borrowed_str(word)
    }
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Watched<'_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, parser: D) -> Result<S::Value, D::Error> {
        self.inner.deserialize(self.trail.watch(parser))
    }
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for Watched<'_, A> {
    type Error = A::Error;

    fn next_element_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, A::Error> {
        self.inner.next_element_seed(self.trail.watch(seed))
    }
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Watched<'_, A> {
    type Error = A::Error;

    fn next_key_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, A::Error> {
        self.inner.next_key_seed(self.trail.watch(seed))
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, A::Error> {
        self.inner.next_value_seed(self.trail.watch(seed))
    }
}

impl<'t, 'de, A: EnumAccess<'de>> EnumAccess<'de> for Watched<'t, A> {
    type Error = A::Error;
    type Variant = Watched<'t, A::Variant>;

    fn variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<(S::Value, Self::Variant), A::Error> {
        let (word, content) = self.inner.variant_seed(self.trail.watch(seed))?;
        Ok((word, self.trail.watch(content)))
    }
}

impl<A> Watched<'_, A> {
    /// Returns the request for the content in parentheses after the last word.
    fn content(&self, content: VariantContent) -> Expectation {
        let of = match self.trail.open.borrow().last() {
            Some(Expectation::Choice { name, .. }) => name,
            _ => "",
        };
        Expectation::VariantContent { of, word: self.trail.word.borrow().clone(), content }
    }
}

impl<'de, A: VariantAccess<'de>> VariantAccess<'de> for Watched<'_, A> {
    type Error = A::Error;

    fn unit_variant(self) -> Result<(), A::Error> {
        self.inner.unit_variant()
    }

    fn newtype_variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value, A::Error> {
        let kind = self.content(VariantContent::One);
        self.trail.expect(kind, || self.inner.newtype_variant_seed(self.trail.watch(seed)))
    }

    fn tuple_variant<V: Visitor<'de>>(self, count: usize, visitor: V) -> Result<V::Value, A::Error> {
        let kind = self.content(VariantContent::Several(count));
        self.trail.expect(kind, || self.inner.tuple_variant(count, self.trail.watch(visitor)))
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        let kind = self.content(VariantContent::Fields(fields));
        self.trail.expect(kind, || self.inner.struct_variant(fields, self.trail.watch(visitor)))
    }
}
