//! The scene format as data: the form of every value, found by the parser itself.
//!
//! `explore` begins with a scene of nothing but an opening bracket. The parser then requests the name of a field; for each of the fields it
//! requests a value, and so on, until every type of the format is known. There is no list of types, fields, variants or ranges besides the
//! parser and the validation; descriptions and defaults come from the [reference](super::manual).
//!
//! Relations between values, such as names that must exist, are not part of a form.

mod around;
mod explore;
mod value;

use std::collections::BTreeMap;
use std::sync::OnceLock;

pub use value::RonValue;

/// The form of a value.
#[derive(Clone, Debug, PartialEq)]
pub enum ValueForm {
    /// A number.
    Number(NumberLimits),
    /// An integer between two others, inclusive.
    Whole(u64, u64),
    /// `true` or `false`.
    Flag,
    /// A string.
    Text,
    /// A string of a hash and six hexadecimal digits.
    HexColor,
    /// A list in square brackets.
    List(Box<ValueForm>),
    /// A map of strings to values, in braces.
    Map(Box<ValueForm>),
    /// Values in parentheses, and the number of them that must be written.
    Tuple(Vec<ValueForm>, usize),
    /// Named values in parentheses.
    Fields(Vec<FieldForm>),
    /// One of several words, some with content in parentheses.
    Words(Vec<WordForm>),
    /// A type of [`SceneFormat::types`].
    Type(&'static str),
    /// One of several forms.
    Either(Vec<ValueForm>),
    /// A list whose values have the form that [`SceneFormat::keys`] returns for the channel.
    Keys,
}

/// The valid range of a number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NumberLimits {
    /// The lower end.
    pub least: Option<RangeEnd>,
    /// The upper end.
    pub most: Option<RangeEnd>,
    /// True if 0 lies in the range and is invalid.
    pub is_not_zero: bool,
}

/// An end of a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeEnd {
    /// The number.
    pub value: f64,
    /// True if the number itself is invalid.
    pub is_excluded: bool,
}

/// A field.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldForm {
    /// The name.
    pub name: &'static str,
    /// The form of the value.
    pub form: ValueForm,
    /// True if the field must be written.
    pub is_required: bool,
    /// True if the field is written in place of all required ones.
    pub replaces_required: bool,
    /// True if the value can be `None`.
    pub is_optional: bool,
    /// The description in the reference.
    pub about: String,
    /// The default value in the reference.
    pub default: Option<&'static str>,
}

/// A word that is a value, or stands before one in parentheses.
#[derive(Clone, Debug, PartialEq)]
pub struct WordForm {
    /// The word.
    pub word: &'static str,
    /// The form of the content of the parentheses; `None` for a word alone.
    pub content: Option<ValueForm>,
    /// The description in the reference.
    pub about: String,
}

/// A type of the format.
#[derive(Clone, Debug, PartialEq)]
pub struct TypeForm {
    /// The form.
    pub form: ValueForm,
    /// The description in the reference.
    pub about: String,
}

/// All types of the scene format.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneFormat {
    /// The types by name.
    pub types: BTreeMap<&'static str, TypeForm>,
    /// The forms of keys, each with the channels that have such keys.
    pub keys: Vec<(Vec<&'static str>, ValueForm)>,
}

impl SceneFormat {
    /// The name of the type of a whole scene.
    pub const SCENE: &'static str = "Scene";
    /// The name of the type of animations, in which the form of a track depends on the channel.
    pub const ANIMATION: &'static str = "Animation";

    /// Returns the format.
    ///
    /// ```
    /// use rayreel::scene::format::{SceneFormat, ValueForm};
    /// let ValueForm::Fields(fields) = &SceneFormat::get().types["Film"].form else { panic!() };
    /// assert_eq!((fields[0].name, &fields[0].form), ("width", &ValueForm::Whole(1, 32768)));
    /// ```
    #[must_use]
    pub fn get() -> &'static Self {
        static FORMAT: OnceLock<SceneFormat> = OnceLock::new();
        FORMAT.get_or_init(explore::explore)
    }
}
