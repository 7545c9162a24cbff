//! The values that are written in a part of a scene, with what they may be.

use std::fs;
use std::ops::Range;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::Override;
use super::set_value::{counts_other_files, value_at};
use super::write_back::scene_files;
use crate::scene::assist::describe;
use crate::scene::format::{FieldForm, NumberLimits, SceneFormat, ValueForm};
use crate::scene::spans::{BracketMember, bracket, literal_text, root};

/// Fields with colours, besides those that are called so.
const COLORS: [&str; 4] = ["background", "bottom", "horizon", "top"];

/// A part of a scene.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ScenePart {
    /// A field of the scene itself, such as `fog`.
    Setting(String),
    /// A camera; the one of the field `camera` is called `camera`.
    Camera(String),
    /// A material.
    Material(String),
    /// An entity; without a name, `#` and its index in document order.
    Entity(String),
}

/// A value in the text of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WrittenValue {
    /// The path, as an [`Override`] has it before its `=`.
    pub path: String,
    /// The text of the value.
    pub text: String,
    /// The kind of value.
    pub kind: WrittenKind,
    /// The meaning, unit, range and default, from the reference.
    pub about: String,
    /// The least valid number, if the value is a number with one.
    pub least: Option<f64>,
    /// The greatest valid number, if the value is a number with one.
    pub most: Option<f64>,
    /// True for a default of a field that is not written.
    pub is_default: bool,
}

/// The kind of a written value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum WrittenKind {
    /// A number.
    Number,
    /// A whole number.
    Whole,
    /// Two or three numbers in parentheses.
    Vector,
    /// An RGB colour from 0 to 255: three numbers in parentheses, or a string such as `"#ffcc00"`.
    Color,
    /// `true` or `false`.
    Flag,
}

impl WrittenValue {
    /// Returns the values in the part of the scene that a path leads to, in the order of the text, in the first file that has the path. Lists,
    /// such as keys of tracks, words and names are left out. A field of the scene itself may be a value.
    #[must_use]
    pub fn all(path: &[String], files: &[PathBuf]) -> Vec<Self> {
        let mut values = Vec::new();
        for file in scene_files(files) {
            let Ok(text) = fs::read_to_string(file) else { continue };
            if counts_other_files(&text, path) {
                break;
            }
            let Some(span) = value_at(&text, path) else { continue };
            match path {
                [field] => collect_fields(&text, root(&text), &[], Some(field), &mut values),
                _ => collect(&text, span, path, &mut values),
            }
            break;
        }
        values
    }
}

/// Adds the values in a span to a list.
fn collect(text: &str, span: Range<usize>, path: &[String], values: &mut Vec<WrittenValue>) {
    collect_fields(text, span.start, path, None, values);
}

/// Adds the values of the fields in the bracket at a byte, or of one of them, to a list.
fn collect_fields(
    text: &str,
    start: usize,
    path: &[String],
    only: Option<&str>,
    values: &mut Vec<WrittenValue>,
) {
    let Some(found) = bracket(text, start) else { return };
    if found.opening != b'(' {
        return;
    }
    for BracketMember { name, value } in found.members {
        let Some(name) = name else { return };
        let field = &text[name.clone()];
        if only.is_some_and(|only| only != field) {
            continue;
        }
        let path = [path, &[field.to_owned()]].concat();
        match kind(text, field, &value) {
            Some(kind) => values.push(described(text, &path, name, value, kind)),
            None => collect(text, value, &path, values),
        }
    }
}

/// Returns the kind of a field's value; `None` for fields with other content.
pub(super) fn kind(text: &str, name: &str, span: &Range<usize>) -> Option<WrittenKind> {
    let value = &text[span.clone()];
    let is_color = name.contains("color") || COLORS.contains(&name);
    if let Some(color) = literal_text(value) {
        return (is_color && color.starts_with('#')).then_some(WrittenKind::Color);
    }
    if matches!(value, "true" | "false") {
        return Some(WrittenKind::Flag);
    }
    let is_number = |value: &str| ron::from_str::<f64>(value).is_ok();
    let Some(found) = bracket(text, span.start) else {
        return is_number(value).then_some(WrittenKind::Number);
    };
    // A word may precede the numbers, as in `Euler(0, 90, 0)`.
    let is_vector = found.opening == b'('
        && matches!(found.members.len(), 2 | 3)
        && found.members.iter().all(|member| member.name.is_none() && is_number(&text[member.value.clone()]));
    is_vector.then_some(if is_color { WrittenKind::Color } else { WrittenKind::Vector })
}

/// Returns a value that nothing more is known of.
pub(super) fn written(path: String, text: String, kind: WrittenKind) -> WrittenValue {
    WrittenValue { path, text, kind, about: String::new(), least: None, most: None, is_default: false }
}

/// Returns a field's value with what the reference says of it.
fn described(
    text: &str,
    path: &[String],
    name: Range<usize>,
    value: Range<usize>,
    kind: WrittenKind,
) -> WrittenValue {
    let described = describe(text, name.start);
    let limits = described.as_ref().and_then(|described| limits(&described.title));
    let kind = match (kind, &limits) {
        (WrittenKind::Number, Some(FieldLimits { is_whole: true, .. })) => WrittenKind::Whole,
        _ => kind,
    };
    WrittenValue {
        about: described.map(|described| described.about).unwrap_or_default(),
        least: limits.as_ref().and_then(|limits| limits.least),
        most: limits.as_ref().and_then(|limits| limits.most),
        ..written(joined(path), text[value].to_owned(), kind)
    }
}

/// Returns a path as an override has it before its `=`.
pub(crate) fn joined(path: &[String]) -> String {
    let whole = Override { path: path.to_vec(), value: String::new() }.to_string();
    whole.trim_end_matches('=').to_owned()
}

/// The ends of a field's range.
pub(super) struct FieldLimits {
    pub(super) least: Option<f64>,
    pub(super) most: Option<f64>,
    pub(super) is_whole: bool,
}

/// Returns the ends of the range of a field, which is given as in `k_d of Material`.
fn limits(title: &str) -> Option<FieldLimits> {
    let (name, of) = title.split_once(" of ")?;
    limits_of(&fields(of)?.iter().find(|field| field.name == name)?.form)
}

/// Returns the fields of a type.
pub(super) fn fields(of: &str) -> Option<&'static [FieldForm]> {
    match &SceneFormat::get().types.get(of)?.form {
        ValueForm::Fields(fields) => Some(fields),
        _ => None,
    }
}

pub(super) fn limits_of(form: &ValueForm) -> Option<FieldLimits> {
    match form {
        ValueForm::Whole(least, most) => {
            Some(FieldLimits { least: Some(*least as f64), most: Some(*most as f64), is_whole: true })
        }
        ValueForm::Number(NumberLimits { least, most, .. }) => Some(FieldLimits {
            least: least.map(|end| end.value),
            most: most.map(|end| end.value),
            is_whole: false,
        }),
        _ => None,
    }
}
