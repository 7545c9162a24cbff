//! A fast parser for a plain subset of RON, as programs write it, for long lists of entities.
//!
//! RON has comments, escapes, several notations for numbers, and optional names of types. A text without any of these is plain:
//!
//! - Values are separated by spaces, tabs and ends of lines.
//! - Names consist of ASCII letters, digits and `_`. Strings have no escapes.
//! - Numbers are decimal: digits, with an optional fraction and exponent.
//! - Types are not named. Optional values are present or absent, without `Some` and `None`.
//!
//! The general [parser](super::general_parser) defines the meaning of plain texts, too: it reads every text accepted here as the same value. A text
//! that is rejected here must be passed to the general parser, which may accept it.

use std::fmt;

use serde::de::value::BorrowedStrDeserializer;
use serde::de::{
    Deserialize, DeserializeSeed, Deserializer, EnumAccess, Error, MapAccess, SeqAccess, VariantAccess,
    Visitor,
};

/// Reads the value that starts at a byte, and returns it with its end. Rejects a text that is not plain, or that holds another type of
/// value.
pub(super) fn read_plain<'de, T: Deserialize<'de>>(text: &'de str, start: usize) -> Result<(T, usize)> {
    let mut plain = Plain { text, at: start };
    T::deserialize(&mut plain).map(|value| (value, plain.at))
}

/// The error for a text that the general parser must read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NotPlain;

impl fmt::Display for NotPlain {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("the text is not plain")
    }
}

impl std::error::Error for NotPlain {}

impl Error for NotPlain {
    fn custom<T: fmt::Display>(_: T) -> Self {
        Self
    }
}

type Result<T, E = NotPlain> = std::result::Result<T, E>;

/// A plain text with a read position.
struct Plain<'de> {
    text: &'de str,
    at: usize,
}

impl<'de> Plain<'de> {
    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn skip_space(&mut self) {
        self.skip_while(|byte| matches!(byte, b' ' | b'\n' | b'\r' | b'\t'));
    }

    /// Skips the bytes that match, and returns their number.
    fn skip_while(&mut self, skip: impl Fn(u8) -> bool) -> usize {
        let start = self.at;
        while self.peek().is_some_and(&skip) {
            self.at += 1;
        }
        self.at - start
    }

    /// Skips the next byte if it is `byte`. Returns whether it was.
    fn skip(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, byte: u8) -> Result<()> {
        if self.skip(byte) { Ok(()) } else { Err(NotPlain) }
    }

    /// Returns the text from `start` to the current position.
    fn since(&self, start: usize) -> Result<&'de str> {
        self.text.get(start..self.at).ok_or(NotPlain)
    }

    fn word(&mut self) -> Result<&'de str> {
        let start = self.at;
        if !self.peek().is_some_and(|byte| byte.is_ascii_alphabetic()) {
            return Err(NotPlain);
        }
        self.skip_while(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
        self.since(start)
    }

    fn string(&mut self) -> Result<&'de str> {
        self.expect(b'"')?;
        let start = self.at;
        self.skip_while(|byte| byte >= b' ' && byte != b'"' && byte != b'\\');
        let string = self.since(start)?;
        self.expect(b'"')?;
        Ok(string)
    }

    /// Returns the text of a number, and whether it is an integer: without a fraction or an exponent.
    fn number(&mut self) -> Result<(&'de str, bool)> {
        let start = self.at;
        self.skip(b'-');
        self.digits()?;
        let mut whole = true;
        if self.skip(b'.') {
            whole = false;
            self.digits()?;
        }
        if self.skip(b'e') || self.skip(b'E') {
            whole = false;
            let _ = self.skip(b'-') || self.skip(b'+');
            self.digits()?;
        }
        match self.peek() {
            None | Some(b',' | b')' | b']' | b' ' | b'\n' | b'\r' | b'\t') => Ok((self.since(start)?, whole)),
            Some(_) => Err(NotPlain),
        }
    }

    /// Skips one or more digits.
    fn digits(&mut self) -> Result<()> {
        if self.skip_while(|byte| byte.is_ascii_digit()) > 0 { Ok(()) } else { Err(NotPlain) }
    }

    /// Reads comma-separated values in brackets. A trailing comma is allowed.
    fn enclosed<T>(
        &mut self,
        [open, close]: [u8; 2],
        read: impl FnOnce(&mut BracketItems<'_, 'de>) -> Result<T>,
    ) -> Result<T> {
        self.expect(open)?;
        let mut items = BracketItems { plain: self, close, is_first: true };
        let value = read(&mut items)?;
        if items.is_next()? { Err(NotPlain) } else { self.expect(close).map(|()| value) }
    }

    fn values<V: Visitor<'de>>(&mut self, visitor: V) -> Result<V::Value> {
        self.enclosed(*b"()", |items| visitor.visit_seq(items))
    }

    fn fields<V: Visitor<'de>>(&mut self, visitor: V) -> Result<V::Value> {
        self.enclosed(*b"()", |items| visitor.visit_map(items))
    }
}

/// The remaining values in brackets.
struct BracketItems<'a, 'de> {
    plain: &'a mut Plain<'de>,
    close: u8,
    is_first: bool,
}

impl BracketItems<'_, '_> {
    /// Advances to the next value. Returns `false` if there is none.
    fn is_next(&mut self) -> Result<bool> {
        let is_first = std::mem::replace(&mut self.is_first, false);
        self.plain.skip_space();
        if !is_first && self.plain.skip(b',') {
            self.plain.skip_space();
        } else if !is_first && self.plain.peek() != Some(self.close) {
            return Err(NotPlain);
        }
        Ok(self.plain.peek() != Some(self.close))
    }
}

impl<'de> SeqAccess<'de> for &mut BracketItems<'_, 'de> {
    type Error = NotPlain;

    fn next_element_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>> {
        if self.is_next()? { seed.deserialize(&mut *self.plain).map(Some) } else { Ok(None) }
    }
}

impl<'de> MapAccess<'de> for &mut BracketItems<'_, 'de> {
    type Error = NotPlain;

    fn next_key_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>> {
        if !self.is_next()? {
            return Ok(None);
        }
        let name = self.plain.word()?;
        self.plain.expect(b':')?;
        self.plain.skip_space();
        seed.deserialize(BorrowedStrDeserializer::new(name)).map(Some)
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value> {
        seed.deserialize(&mut *self.plain)
    }
}

/// An enum variant, and its content in parentheses if it has any.
struct EnumVariant<'a, 'de>(&'a mut Plain<'de>);

impl<'de> EnumAccess<'de> for EnumVariant<'_, 'de> {
    type Error = NotPlain;
    type Variant = Self;

    fn variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<(S::Value, Self)> {
        let word = self.0.word()?;
        Ok((seed.deserialize(BorrowedStrDeserializer::new(word))?, self))
    }
}

impl<'de> VariantAccess<'de> for EnumVariant<'_, 'de> {
    type Error = NotPlain;

    fn unit_variant(self) -> Result<()> {
        Ok(())
    }

    fn newtype_variant_seed<S: DeserializeSeed<'de>>(self, _: S) -> Result<S::Value> {
        Err(NotPlain)
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, visitor: V) -> Result<V::Value> {
        self.0.values(visitor)
    }

    fn struct_variant<V: Visitor<'de>>(self, _: &'static [&'static str], visitor: V) -> Result<V::Value> {
        self.0.fields(visitor)
    }
}

macro_rules! refuse {
    ($($method:ident($($argument:ty),*);)*) => {$(
        fn $method<V: Visitor<'de>>(self, $(_: $argument,)* _: V) -> Result<V::Value> {
            Err(NotPlain)
        }
    )*};
}

impl<'de> Deserializer<'de> for &mut Plain<'de> {
    type Error = NotPlain;

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        let (number, _) = self.number()?;
        visitor.visit_f64(number.parse().map_err(Error::custom)?)
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        match self.word()? {
            "true" => visitor.visit_bool(true),
            "false" => visitor.visit_bool(false),
            _ => Err(NotPlain),
        }
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        visitor.visit_borrowed_str(self.string()?)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        self.deserialize_str(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        let start = self.at;
        if matches!(self.word(), Ok("Some" | "None")) {
            return Err(NotPlain);
        }
        self.at = start;
        visitor.visit_some(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        self.enclosed(*b"[]", |items| visitor.visit_seq(items))
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, _: usize, visitor: V) -> Result<V::Value> {
        self.values(visitor)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value> {
        self.fields(visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value> {
        visitor.visit_enum(EnumVariant(self))
    }

    /// Reads a string, a number without an exponent, a tuple whose first value is a number, or named fields.
    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        match self.peek() {
            Some(b'"') => self.deserialize_str(visitor),
            Some(b'(') => {
                let start = self.at;
                self.at += 1;
                self.skip_space();
                let is_named = self.peek().is_some_and(|byte| byte.is_ascii_alphabetic());
                if !is_named {
                    self.number()?;
                }
                self.at = start;
                if is_named { self.fields(visitor) } else { self.values(visitor) }
            }
            _ => match self.number()? {
                (number, true) if number.starts_with('-') => {
                    visitor.visit_i64(number.parse().map_err(Error::custom)?)
                }
                (number, true) => visitor.visit_u64(number.parse().map_err(Error::custom)?),
                (number, false) if number.contains(['e', 'E']) => Err(NotPlain),
                (number, false) => visitor.visit_f64(number.parse().map_err(Error::custom)?),
            },
        }
    }

    refuse! {
        deserialize_i8();
        deserialize_i16();
        deserialize_i32();
        deserialize_i64();
        deserialize_u8();
        deserialize_u16();
        deserialize_u32();
        deserialize_u64();
        deserialize_f32();
        deserialize_char();
        deserialize_bytes();
        deserialize_byte_buf();
        deserialize_unit();
        deserialize_unit_struct(&'static str);
        deserialize_newtype_struct(&'static str);
        deserialize_tuple_struct(&'static str, usize);
        deserialize_map();
        deserialize_identifier();
        deserialize_ignored_any();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use proptest::sample::{Index, select};

    use super::super::general_parser::options;
    use super::*;
    use crate::scene::document::EntityDocument;

    /// All forms of entities.
    const ENTITIES: &str = r##"[
        (name: "a", parent: "Ä b", transform: (translation: (-0.0, 2, 3.25e-1), scale: 2), shape: Sphere(radius: 1), material: "red"),
        (transform: (rotation: Euler(0, 90, -45.5), scale: (1, 2.5, -0)), shape: Box(size: (1, 1E3, 1e+2,),), material: "red"),
        (transform: (rotation: AxisAngle((0, 1, 0), 30), scale: -3)),
        (transform: (rotation: Quat(0, 0, 0.5, 1), scale: 1.5), shape: Plane(normal: (0, 1, 0))),
        (),
        (light: Point(intensity: (1, 1, 1), falloff: (1, 0, 0.1))),
        (light: Spot(intensity: (1, 1, 1), angle: 30, softness: 0.5, casts_shadows: false)),
        (light: Directional(intensity: (007, 1, 1), direction: (0, -1, 0), casts_shadows: true)),
        (light: Area(shape: Sphere(radius: 0.5), intensity: (1, 1, 1), samples: 16)),
        (light: Area(shape: Rectangle(width: 1, height: 2), intensity: (1, 1, 1), samples: 4.0)),
        (shape: Sphere(radius: 1), color: (255, 0, 7.5)),
        (shape: Sphere(radius: 1), material: "red", color: "#00ff7f"),
        (material: (k_a: 0.25, color: (1, 2, 3), ambient_color: "#ff0000", specular: (k_s: 0.5, shininess: 9))),
        (material: ( k_d: 1, reflective: (k_r: 1), refractive: (k_t: 1, ior: 1.5, absorption: (1, 2, 3), fresnel: true))),
        (material: (pattern: Checker(color: (1, 2, 3), size: 2)), color: (0, 0, 0)),
    ]"##;

    /// Adversarial pieces of text to insert anywhere.
    const PIECES: [&str; 43] = [
        "",
        " ",
        "\n",
        "\t",
        "\r",
        "\u{b}",
        ",",
        ",,",
        "(",
        ")",
        "[",
        "]",
        ":",
        "\"",
        "\\",
        "\\n",
        "r#\"",
        "#",
        "-",
        "+",
        ".",
        "_",
        "e",
        "E5",
        "0",
        "0x1",
        "1_0",
        "1e400",
        "18446744073709551616",
        "9007199254740993",
        "inf",
        "NaN",
        "f64",
        "Some(",
        "None",
        "Entity",
        "true",
        "false",
        "// ",
        "/* ",
        " */",
        "é",
        "name: \"n\"",
    ];

    fn of_all(text: &str) -> Option<String> {
        let entities: Option<Vec<EntityDocument>> = options().from_str(text).ok();
        // The debug format includes the signs of zeros.
        entities.map(|entities| format!("{entities:?}"))
    }

    fn of_plain(text: &str) -> Option<String> {
        let start = text.len() - text.trim_start().len();
        let (entities, end): (Vec<EntityDocument>, usize) = read_plain(text, start).ok()?;
        text[end..].trim().is_empty().then(|| format!("{entities:?}"))
    }

    #[test]
    fn fast_path_reads_every_entity_field() {
        assert!(of_all(ENTITIES).is_some());
        assert_eq!(of_plain(ENTITIES), of_all(ENTITIES));
    }

    #[test]
    fn fast_path_rejects_unusual_syntax() {
        for entity in [
            "name: \"\\u{41}\"",
            "name: Some(\"a\")",
            "name: None",
            "name: r\"a\"",
            "/* */ name: \"a\"",
            "shape: Sphere(radius: 1_0)",
            "shape: Sphere(radius: +1)",
            "shape: Sphere(radius: inf)",
            "shape: Sphere(radius: .5)",
            "shape: Sphere(radius: 5.)",
            "transform: Transform()",
            "transform: (scale: 1e3)",
            "material: Material(k_d: 1)",
            "material: Some((k_d: 1))",
        ] {
            let text = format!("[({entity})]");
            assert!(of_all(&text).is_some() && of_plain(&text).is_none(), "{text}");
        }
        for entity in [
            "name: \"a\", name: \"b\"",
            "nam: \"a\"",
            "shape: Cone(radius: 1)",
            "shape: Sphere()",
            "material: ()",
            "material: red",
            "material: (k_s: 1)",
            "material: (k_d: 1, k_d: 1)",
            "color: (r: 1, g: 2, b: 3)",
        ] {
            let text = format!("[({entity})]");
            assert!(of_all(&text).is_none() && of_plain(&text).is_none(), "{text}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn fast_path_equals_the_general_parser(
            edits in prop::collection::vec((any::<Index>(), 0..4_usize, select(&PIECES[..])), 1..4),
        ) {
            let mut text = ENTITIES.to_owned();
            for (at, length, piece) in edits {
                let start = text.ceil_char_boundary(at.index(text.len() + 1));
                let end = text.ceil_char_boundary((start + length).min(text.len()));
                text.replace_range(start..end, piece);
            }
            if let Some(found) = of_plain(&text) {
                prop_assert_eq!(Some(found), of_all(&text), "{}", text);
            }
        }
    }
}
