//! Finds the format with sample scenes.

use crate::components::Property;
use crate::scene::parse::{Expectation, FieldOwner, VariantContent, depth_of, missing, owner, pending};
use crate::scene::reference::{self, ManualSection, about_field};

use super::around::TextAround;
use super::{FieldForm, SceneFormat, TypeForm, ValueForm, WordForm};

/// Values for all requests with several notations.
const SAMPLES: [&str; 5] = ["1", "\"#ff783c\"", "\"a\"", "(1, 1, 1)", "(1, 1)"];

pub(super) fn explore() -> SceneFormat {
    let mut explorer = Explorer::default();
    let scene = TextAround { before: "(".to_owned(), after: ")".to_owned() };
    if let Some(of_scene) = owner(&scene.before) {
        explorer.named(SceneFormat::SCENE, |explorer| explorer.fields(&scene, &of_scene));
    }
    explorer.keys();
    explorer.format
}

#[derive(Default)]
struct Explorer {
    format: SceneFormat,
}

impl Explorer {
    /// Finds a type, unless it is known, and returns its name as a form.
    fn named(&mut self, name: &'static str, find: impl FnOnce(&mut Self) -> ValueForm) -> ValueForm {
        if !self.format.types.contains_key(name) {
            let about = reference::section(name).map(ManualSection::about).unwrap_or_default();
            self.format
                .types
                .insert(name, TypeForm { form: ValueForm::Fields(Vec::new()), about: about.clone() });
            let form = find(self);
            self.format.types.insert(name, TypeForm { form, about });
        }
        ValueForm::Type(name)
    }

    /// Finds the form of a value.
    fn form(&mut self, around: &TextAround) -> ValueForm {
        match around.expectation() {
            Some(Expectation::Number) => ValueForm::Number(around.number_range()),
            Some(Expectation::Flag) => ValueForm::Flag,
            Some(Expectation::List) => ValueForm::List(Box::new(self.form(&around.within("[", "]")))),
            Some(Expectation::Map) => ValueForm::Map(Box::new(self.form(&around.within("{\"a\": ", "}")))),
            Some(Expectation::Fields { name, fields }) => {
                let owner = FieldOwner { of: name, variant: None, fields };
                self.named(name, |explorer| explorer.fields(&around.within("(", ")"), &owner))
            }
            Some(Expectation::Values { count, .. }) => self.tuple(&around.within("(", ")"), count),
            Some(Expectation::Choice { name, words }) => {
                self.named(name, |explorer| explorer.words(around, name, words))
            }
            Some(Expectation::Any { .. }) => self.several(around),
            Some(Expectation::Text | Expectation::FieldName | Expectation::VariantContent { .. }) | None => {
                ValueForm::Text
            }
        }
    }

    /// Finds the forms of the fields in a bracket.
    fn fields(&mut self, bracket: &TextAround, owner: &FieldOwner) -> ValueForm {
        let required = required(&bracket.before);
        let is_required = |field: &str| required.iter().any(|(name, _)| name == field);
        let place = |field: &str| owner.fields.iter().position(|name| *name == field);
        let mut fields = Vec::new();
        for &name in owner.fields {
            let text_of = |is_wanted: &dyn Fn(&str) -> bool| -> String {
                let wanted = required.iter().filter(|(other, _)| other != name && is_wanted(other.as_str()));
                wanted.map(|(other, sample)| format!("{other}: {sample}, ")).collect()
            };
            let before = text_of(&|other| place(other) < place(name));
            let after = text_of(&|other| place(other) > place(name));
            let mut around = bracket.within(&format!("{before}{name}: "), &format!(", {after}"));
            let alone = bracket.within(&format!("{name}: "), "");
            let sample = sample(&alone.before).unwrap_or_default();
            let replaces_required = !around.reads(&sample) && alone.reads(&sample);
            if replaces_required {
                around = alone;
            }
            let entry = reference::section(owner.of).and_then(|section| section.field(name));
            fields.push(FieldForm {
                name,
                form: self.form(&around),
                is_required: is_required(name),
                replaces_required,
                is_optional: around.reads("None"),
                about: about_field(owner.of, owner.variant.as_deref(), name),
                default: entry.filter(|entry| !entry.is_required).map(|entry| entry.value),
            });
        }
        ValueForm::Fields(fields)
    }

    /// Finds the forms of unnamed values in a bracket.
    fn tuple(&mut self, bracket: &TextAround, count: usize) -> ValueForm {
        let samples = samples(&bracket.before, count);
        let forms = (0..count).map(|index| {
            let [before, after] = [&samples[..index], &samples[index + 1..]].map(|values| values.join(", "));
            let [first, last] = [&before, &after].map(|values| if values.is_empty() { "" } else { ", " });
            self.form(&bracket.within(&format!("{before}{first}"), &format!("{last}{after}")))
        });
        let forms = forms.collect();
        let needed = (1..count).find(|needed| bracket.reads(&samples[..*needed].join(", ")));
        ValueForm::Tuple(forms, needed.unwrap_or(count))
    }

    /// Finds the forms of the words of a type.
    fn words(
        &mut self,
        around: &TextAround,
        name: &'static str,
        words: &'static [&'static str],
    ) -> ValueForm {
        let section = reference::section(name);
        let forms = words.iter().map(|&word| {
            // Turns are valid for rotations only, and the first channel is none.
            let of_rotation = TextAround {
                before: "(animate: [(channel: Rotation, track: ".to_owned(),
                after: ")])".to_owned(),
            };
            let around = if (name, word) == ("Track", "Turns") { &of_rotation } else { around };
            let bracket = around.within(&format!("{word}("), ")");
            let content = variant_content(&bracket.before, word).map(|content| match content {
                _ if (name, word) == ("Track", "Keys") => ValueForm::Keys,
                VariantContent::One => self.form(&bracket),
                VariantContent::Several(count) => self.tuple(&bracket, count),
                VariantContent::Fields(fields) => {
                    let owner = FieldOwner { of: name, variant: Some(word.to_owned()), fields };
                    self.fields(&bracket, &owner)
                }
            });
            let about = section.map(|section| section.about_variant(word)).unwrap_or_default();
            WordForm { word, content, about }
        });
        ValueForm::Words(forms.collect())
    }

    /// Finds the forms of a value with several notations.
    fn several(&mut self, around: &TextAround) -> ValueForm {
        let number = |around: &TextAround, is_number: bool| match is_number {
            true => ValueForm::Number(around.number_range()),
            false => {
                let (least, most) = around.whole_range();
                ValueForm::Whole(least, most)
            }
        };
        let mut forms = Vec::new();
        if around.reads("1") {
            forms.push(number(around, around.reads("0.5")));
        }
        if around.reads("\"a\"") {
            forms.push(ValueForm::Text);
        } else if around.reads("\"#ff783c\"") {
            forms.push(ValueForm::HexColor);
        }
        for count in 2..=3 {
            if around.reads(&format!("({})", vec!["1"; count].join(", "))) {
                let ones = |count: usize| vec!["1"; count];
                let items = (0..count).map(|index| {
                    let before: String = ones(index).iter().map(|one| format!("{one}, ")).collect();
                    let after: String =
                        ones(count - index - 1).iter().map(|one| format!(", {one}")).collect();
                    let item = around.within(&format!("({before}"), &format!("{after})"));
                    number(&item, item.reads("0.5"))
                });
                forms.push(ValueForm::Tuple(items.collect(), count));
            }
        }
        let bracket = around.within("(", ")");
        if let Some(owner) = owner(&bracket.before) {
            forms.push(self.named(owner.of, |explorer| explorer.fields(&bracket, &owner)));
        }
        if forms.len() == 1 { forms.remove(0) } else { ValueForm::Either(forms) }
    }

    /// Finds the forms of keys: one for all channels whose values have the same notation and range.
    fn keys(&mut self) {
        let mut known = Vec::new();
        for property in Property::ALL {
            match known.iter().position(|quantity| *quantity == property.quantity()) {
                Some(index) => self.format.keys[index].0.push(property.name()),
                None => {
                    let before = format!("(animate: [(channel: {}, track: Keys([", property.name());
                    let form = self.form(&TextAround { before, after: "]))])".to_owned() });
                    known.push(property.quantity());
                    self.format.keys.push((vec![property.name()], form));
                }
            }
        }
    }
}

/// Returns the content of the bracket after a word, which a text ends with; `None` if the word takes none.
fn variant_content(text: &str, word: &str) -> Option<VariantContent> {
    pending(text)?.into_iter().rev().find_map(|request| match request {
        Expectation::VariantContent { word: of, content, .. } if of == word => Some(content),
        _ => None,
    })
}

/// Returns the required fields of the bracket that a text ends with, each with a valid value: those that are missing without any field, or,
/// where a bracket without fields has another meaning, beside one of the others.
fn required(text: &str) -> Vec<(String, String)> {
    let needed = missing_beside(text, Vec::new());
    let Some(FieldOwner { fields, .. }) = owner(text).filter(|_| needed.is_empty()) else { return needed };
    let mut needed = Vec::new();
    for name in fields {
        if let Some(value) = sample(&format!("{text}{name}: ")) {
            let beside = missing_beside(text, vec![((*name).to_owned(), value)]);
            needed.extend(beside.into_iter().skip(1));
        }
    }
    needed.sort_by_key(|(name, _)| fields.iter().position(|field| field == name));
    needed.dedup();
    needed
}

/// Returns some fields of a bracket, and those that are missing beside them.
fn missing_beside(text: &str, mut given: Vec<(String, String)>) -> Vec<(String, String)> {
    loop {
        let written: String = given.iter().map(|(name, value)| format!("{name}: {value}, ")).collect();
        let Some(name) = missing(&format!("{text}{written})")) else { return given };
        let Some(value) = sample(&format!("{text}{written}{name}: ")) else { return given };
        if given.iter().any(|(known, _)| *known == name) {
            return given;
        }
        given.push((name, value));
    }
}

/// Returns valid values for a bracket of unnamed ones, which a text ends with.
fn samples(text: &str, count: usize) -> Vec<String> {
    let mut values: Vec<String> = Vec::new();
    for _ in 0..count {
        let before: String = values.iter().map(|value| format!("{value}, ")).collect();
        values.push(sample(&format!("{text}{before}")).unwrap_or_default());
    }
    values
}

/// Returns a value whose notation is valid at the end of a text.
fn sample(text: &str) -> Option<String> {
    let in_brackets = |values: Vec<(String, String)>| {
        let fields: Vec<String> = values.iter().map(|(name, value)| format!("{name}: {value}")).collect();
        format!("({})", fields.join(", "))
    };
    Some(match pending(text)?.pop()? {
        Expectation::Number => "1".to_owned(),
        Expectation::Flag => "true".to_owned(),
        Expectation::Text => "\"a\"".to_owned(),
        Expectation::List => "[]".to_owned(),
        Expectation::Map => "{}".to_owned(),
        Expectation::Fields { .. } => in_brackets(required(&format!("{text}("))),
        Expectation::Values { count, .. } => {
            format!("({})", samples(&format!("{text}("), count).join(", "))
        }
        Expectation::Choice { words, .. } => {
            let word = words.first()?;
            let bracket = format!("{text}{word}(");
            match variant_content(&bracket, word) {
                None => (*word).to_owned(),
                Some(VariantContent::One) => format!("{word}({})", sample(&bracket)?),
                Some(VariantContent::Several(count)) => {
                    format!("{word}({})", samples(&bracket, count).join(", "))
                }
                Some(VariantContent::Fields(_)) => format!("{word}{}", in_brackets(required(&bracket))),
            }
        }
        Expectation::Any { .. } => {
            let depth = depth_of(text);
            let is_read = |value: &&&str| depth_of(&format!("{text}{value}")) < depth;
            SAMPLES.iter().find(is_read).map(|value| (*value).to_owned())?
        }
        Expectation::FieldName | Expectation::VariantContent { .. } => return None,
    })
}
