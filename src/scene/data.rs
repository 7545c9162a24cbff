//! Deserialization of script data into document types. Files use the same types, so that errors are detected and worded alike.

use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, Expected, IntoDeserializer, MapAccess, SeqAccess,
    Unexpected, VariantAccess, Visitor,
};
use serde::forward_to_deserialize_any;

use super::document::{EntityDocument, SurfaceDocument};
use super::suggest;
use crate::script::Data;

/// Deserializes the entity described by a map. The second line of an error message, if any, is the remedy.
pub(super) fn entity(data: Data) -> Result<EntityDocument, String> {
    let data = with_transform(data).map_err(|mistake| mistake.to_string())?;
    serde::Deserialize::deserialize(DataDeserializer(data)).map_err(|mistake: DataError| mistake.to_string())
}

/// Moves `translation`, `rotation` and `scale` into `transform`. Scripts may write them directly in the entity.
fn with_transform(data: Data) -> Result<Data, DataError> {
    let Data::Map(fields) = data else { return Ok(data) };
    let (parts, mut fields): (Vec<_>, Vec<_>) = fields
        .into_iter()
        .partition(|(name, _)| ["translation", "rotation", "scale"].contains(&name.as_str()));
    if parts.is_empty() {
        return Ok(Data::Map(fields));
    }
    if fields.iter().any(|(name, _)| name == "transform") {
        let message = format!("both `transform` and `{}`\nkeep one of the two", parts[0].0);
        return Err(DataError::custom(message));
    }
    fields.push(("transform".to_owned(), Data::Map(parts)));
    Ok(Data::Map(fields))
}

/// A deserialization error with the path of fields to the value.
#[derive(Debug)]
struct DataError {
    path: Vec<String>,
    message: String,
    help: Option<String>,
}

impl DataError {
    fn within(mut self, field: &str) -> Self {
        self.path.insert(0, field.to_owned());
        self
    }

    fn with_help(message: String, help: String) -> Self {
        Self { path: Vec::new(), message, help: Some(help) }
    }
}

impl std::fmt::Display for DataError {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if !self.path.is_empty() {
            write!(formatter, "`{}`: ", self.path.join("."))?;
        }
        formatter.write_str(&self.message)?;
        self.help.as_ref().map_or(Ok(()), |help| write!(formatter, "\n{help}"))
    }
}

impl std::error::Error for DataError {}

impl Error for DataError {
    fn custom<T: std::fmt::Display>(message: T) -> Self {
        let message = message.to_string();
        match message.split_once('\n') {
            Some((message, help)) => Self::with_help(message.to_owned(), help.to_owned()),
            None => Self { path: Vec::new(), message, help: None },
        }
    }

    fn invalid_type(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        let found = match found {
            Unexpected::Seq => "a list".to_owned(),
            Unexpected::Map => "a map".to_owned(),
            Unexpected::Unit => "nothing".to_owned(),
            Unexpected::Float(number) => format!("the number {number}"),
            Unexpected::Signed(number) => format!("the number {number}"),
            Unexpected::Str(text) => Data::Text(text.to_owned()).description(),
            Unexpected::Bool(flag) => flag.to_string(),
            other => other.to_string(),
        };
        let expected = describe(expected);
        Self::custom(format!("expected {expected}, found {found}"))
    }

    fn invalid_length(length: usize, expected: &dyn Expected) -> Self {
        let values = if length == 1 { "value" } else { "values" };
        Self::custom(format!("expected {}, found {length} {values}", describe(expected)))
    }

    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        Self::with_help(format!("unknown field `{field}`"), suggest::remedy(field, expected, "fields"))
    }

    fn unknown_variant(variant: &str, expected: &'static [&'static str]) -> Self {
        Self::with_help(
            format!("unknown word `{variant}`"),
            suggest::remedy(variant, expected, "possibilities"),
        )
    }

    fn missing_field(field: &'static str) -> Self {
        let help = format!("add `{field}: ..`; the scene reference says what it takes");
        Self::with_help(format!("missing field `{field}`"), help)
    }
}

fn describe(expected: &dyn Expected) -> String {
    let expected = expected.to_string();
    let variant = expected.split_once("variant ").map(|(_, name)| {
        let name = name.rsplit("::").next().unwrap_or(name);
        name.split(' ').next().unwrap_or(name)
    });
    match variant {
        Some("Euler") => return "three angles in degrees, as euler(0, 90, 0)".to_owned(),
        Some("AxisAngle") => return "an axis and an angle, as axis_angle([0, 1, 0], 90)".to_owned(),
        Some("Quat") => return "four numbers, as quaternion(0, 0, 0, 1)".to_owned(),
        Some(_) => return "a map of its fields, as #{ name: value }".to_owned(),
        None => {}
    }
    match expected.as_str() {
        "an array of length 3" => "three numbers, as [0, 1, 0]".to_owned(),
        "f64" => "a number".to_owned(),
        "u64" => "a whole number, 0 or more, as floor(x) gives it".to_owned(),
        "a string" => "a text".to_owned(),
        "a boolean" => "true or false".to_owned(),
        text if text.starts_with(SurfaceDocument::NOUN) => {
            format!("{}: its name, or its fields, as #{{ color: [255, 120, 60] }}", SurfaceDocument::NOUN)
        }
        text if text.starts_with("struct ") => "a map, as #{ name: value }".to_owned(),
        // Values in parentheses in a file are a list in a script.
        _ => expected.replace('(', "[").replace(')', "]"),
    }
}

struct DataDeserializer(Data);

impl<'de> Deserializer<'de> for DataDeserializer {
    type Error = DataError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DataError> {
        match self.0 {
            Data::Nothing => visitor.visit_unit(),
            Data::Flag(flag) => visitor.visit_bool(flag),
            Data::Number(number) => visitor.visit_f64(number),
            Data::Whole(whole) => visitor.visit_i64(whole),
            Data::Text(text) => visitor.visit_string(text),
            Data::List(list) => read_list(list, visitor),
            Data::Map(map) => visitor.visit_map(Fields { rest: map.into_iter(), value: None }),
            Data::Other(what) => Err(DataError::custom(format!("{what} has no meaning here"))),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DataError> {
        match self.0 {
            Data::Nothing => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    /// Accepts an integral float, such as the result of a division in a script.
    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DataError> {
        const LARGEST: f64 = 9_007_199_254_740_992.0;
        match self.0 {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a whole number within the range"
            )]
            Data::Number(number) if number.fract() == 0.0 && (0.0..=LARGEST).contains(&number) => {
                visitor.visit_u64(number as u64)
            }
            _ => self.deserialize_any(visitor),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, DataError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DataError> {
        let (variant, content) = match self.0 {
            Data::Text(variant) => (variant, Data::Nothing),
            Data::Map(map) if map.len() == 1 => {
                map.into_iter().next().unwrap_or_else(|| (String::new(), Data::Nothing))
            }
            Data::List(list) if name == "Rotation" && list.len() == 3 => {
                ("Euler".to_owned(), Data::List(list))
            }
            Data::List(list) if name == "Rotation" && list.len() == 4 => {
                ("Quat".to_owned(), Data::List(list))
            }
            other => {
                let example = match name {
                    "Rotation" => "a rotation, as [0, 90, 0] in degrees or axis_angle([0, 1, 0], 90)",
                    "Light" => "a light, as point(#{ intensity: [1, 1, 1] })",
                    _ => "a shape, as sphere(1)",
                };
                let message = format!("expected {example}, found {}", other.description());
                return Err(DataError::custom(message));
            }
        };
        if !variants.contains(&variant.as_str()) {
            return Err(DataError::unknown_variant(&variant, variants));
        }
        visitor.visit_enum(ChosenVariant { variant, content })
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 f32 f64 char str string bytes byte_buf unit unit_struct seq tuple
        tuple_struct map struct identifier ignored_any
    }
}

/// Visits a list. Returns an error if the visitor leaves values unread.
fn read_list<'de, V: Visitor<'de>>(list: Vec<Data>, visitor: V) -> Result<V::Value, DataError> {
    let length = list.len();
    let mut values = ListElements(list.into_iter());
    // `visit_seq` consumes the visitor.
    let expected = (&visitor as &dyn Expected).to_string();
    let value = visitor.visit_seq(&mut values)?;
    if values.0.len() == 0 { Ok(value) } else { Err(DataError::invalid_length(length, &expected.as_str())) }
}

struct ListElements(std::vec::IntoIter<Data>);

impl<'de> SeqAccess<'de> for &mut ListElements {
    type Error = DataError;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, DataError> {
        self.0.next().map(|value| seed.deserialize(DataDeserializer(value))).transpose()
    }
}

struct Fields {
    rest: std::vec::IntoIter<(String, Data)>,
    value: Option<(String, Data)>,
}

impl<'de> MapAccess<'de> for Fields {
    type Error = DataError;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, DataError> {
        let Some((name, value)) = self.rest.next() else { return Ok(None) };
        let key = seed.deserialize(name.as_str().into_deserializer());
        self.value = Some((name, value));
        key.map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, DataError> {
        let (name, value) = self.value.take().unwrap_or_else(|| (String::new(), Data::Nothing));
        seed.deserialize(DataDeserializer(value)).map_err(|mistake| mistake.within(&name))
    }
}

struct ChosenVariant {
    variant: String,
    content: Data,
}

impl<'de> EnumAccess<'de> for ChosenVariant {
    type Error = DataError;
    type Variant = ChoiceContent;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, ChoiceContent), DataError> {
        Ok((seed.deserialize(self.variant.into_deserializer())?, ChoiceContent(self.content)))
    }
}

struct ChoiceContent(Data);

impl<'de> VariantAccess<'de> for ChoiceContent {
    type Error = DataError;

    fn unit_variant(self) -> Result<(), DataError> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, DataError> {
        seed.deserialize(DataDeserializer(self.0))
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, visitor: V) -> Result<V::Value, DataError> {
        DataDeserializer(self.0).deserialize_any(visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DataError> {
        let fields = match self.0 {
            Data::Nothing => Data::Map(Vec::new()),
            fields => fields,
        };
        DataDeserializer(fields).deserialize_any(visitor)
    }
}
