//! The fields that a part of a scene does not write, with their defaults.

use std::fs;
use std::ops::Range;
use std::path::PathBuf;

use super::set_value::{counts_other_files, value_at};
use super::write_back::scene_files;
use super::written::{WrittenKind, WrittenValue, fields, joined, kind, limits_of, written};
use crate::scene::format::{FieldForm, SceneFormat, ValueForm};
use crate::scene::spans::{bracket, root};

/// The fields of a camera of which one is written, and the default where none is.
const PROJECTIONS: [&str; 4] = ["screen", "fov", "horizontal_fov", "orthographic"];
const DEFAULT_FOV: &str = "45";

impl WrittenValue {
    /// Returns the defaults of the fields that the part at a path may have and does not write, in the order of the reference. A field of the
    /// scene itself need not be written. Fields without a default number, vector, colour or flag are left out.
    #[must_use]
    pub fn defaults(path: &[String], files: &[PathBuf]) -> Vec<Self> {
        let mut values = Vec::new();
        let texts = scene_files(files).filter_map(|file| fs::read_to_string(file).ok());
        let has_path = |text: &String| path.len() == 1 || value_at(text, path).is_some();
        let Some(text) = texts.into_iter().find(has_path) else { return values };
        if counts_other_files(&text, path) {
            return values;
        }
        let [list, ..] = path else { return values };
        let (span, above, of, only) = match list.as_str() {
            field if path.len() == 1 => {
                (Some(root(&text)..text.len()), &[][..], SceneFormat::SCENE, Some(field))
            }
            "entities" => (value_at(&text, path), path, "Entity", None),
            "materials" => (value_at(&text, path), path, "Material", None),
            "cameras" => (value_at(&text, path), path, "Camera", None),
            _ => return values,
        };
        add(&text, span, above, (of, only), &mut values);
        values
    }
}

/// Adds the defaults of a type's fields, or of one of them, that are missing in a span.
fn add(
    text: &str,
    span: Option<Range<usize>>,
    path: &[String],
    (of, only): (&str, Option<&str>),
    values: &mut Vec<WrittenValue>,
) {
    let found = span.and_then(|span| bracket(text, span.start));
    let written_at = |name: &str| found.as_ref().and_then(|found| found.field(text, name));
    let has_projection = PROJECTIONS.iter().any(|name| written_at(name).is_some());
    for field in fields(of).unwrap_or_default() {
        if only.is_some_and(|only| only != field.name) {
            continue;
        }
        let path = [path, &[field.name.to_owned()]].concat();
        let default = match field.default {
            None | Some("None") => (field.name == "fov" && !has_projection).then_some(DEFAULT_FOV),
            default => default,
        };
        let (span, default) = match (written_at(field.name), default) {
            (Some(span), _) => (Some(span), None),
            (None, Some(default)) => (None, Some(default)),
            (None, None) => continue,
        };
        match (&field.form, default) {
            (ValueForm::Type(inner), None | Some("()")) => add(text, span, &path, (inner, None), values),
            (_, Some(default)) => values.extend(value(field, &path, default)),
            _ => {}
        }
    }
}

/// Returns a default, if it is of a kind that can be listed.
fn value(field: &FieldForm, path: &[String], default: &str) -> Option<WrittenValue> {
    let limits = limits_of(&field.form);
    let kind = match kind(default, field.name, &(0..default.len()))? {
        WrittenKind::Number if limits.as_ref().is_some_and(|limits| limits.is_whole) => WrittenKind::Whole,
        kind => kind,
    };
    Some(WrittenValue {
        about: field.about.clone(),
        least: limits.as_ref().and_then(|limits| limits.least),
        most: limits.as_ref().and_then(|limits| limits.most),
        is_default: true,
        ..written(joined(path), default.to_owned(), kind)
    })
}
