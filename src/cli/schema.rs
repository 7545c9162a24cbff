//! `rayreel schema`: the scene format as JSON Schema.

use serde_json::{Map, Value, json};

use rayreel::scene::format::{FieldForm, NumberLimits, RonValue, SceneFormat, TypeForm, ValueForm, WordForm};

use super::exit::Failure;
use super::print;

/// The mapping from RON to JSON, and the limits of the schema.
const ABOUT: &str = "A scene of rayreel, or a part that scenes include, written in RON. The schema describes the same values in JSON: \
    a group with names, as (radius: 1), is an object, and the name of a type before it is omitted; values without names, as (0, 1, 0), \
    are an array, like a list in square brackets; a map is an object; a word alone, as Srgb, is a string; a word with content, as \
    Sphere(radius: 1), is an object with the word as its one key, and with the content as the value: an object, an array of several \
    values, or a single value; None is null. Relations between values, such as names that must exist, are not in the schema: \
    `rayreel check` reports them.";

pub(super) fn run() -> Result<(), Failure> {
    Ok(print::result(&format!("{:#}\n", schema(SceneFormat::get())))?)
}

fn schema(format: &SceneFormat) -> Value {
    let mut types = Map::new();
    for (name, TypeForm { form, about }) in &format.types {
        let mut of_type = of_form(form);
        if *name == SceneFormat::ANIMATION {
            of_type["allOf"] = format.keys.iter().map(of_keys).collect();
        }
        types.insert((*name).to_owned(), described(of_type, about));
    }
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "rayreel scene",
        "description": ABOUT,
        "$ref": reference(SceneFormat::SCENE),
        "$defs": types,
    })
}

fn reference(name: &str) -> String {
    format!("#/$defs/{name}")
}

fn described(mut schema: Value, about: &str) -> Value {
    if !about.is_empty() {
        schema["description"] = about.into();
    }
    schema
}

/// Returns the condition for the keys of some channels.
fn of_keys((channels, key): &(Vec<&'static str>, ValueForm)) -> Value {
    let keys = json!({ "type": "array", "items": of_form(key) });
    json!({
        "if": { "properties": { "channel": { "enum": channels } } },
        "then": { "properties": { "track": { "properties": { "Keys": keys } } } },
    })
}

fn of_form(form: &ValueForm) -> Value {
    match form {
        ValueForm::Number(range) => of_number(range),
        ValueForm::Whole(least, most) => json!({ "type": "integer", "minimum": least, "maximum": most }),
        ValueForm::Flag => json!({ "type": "boolean" }),
        ValueForm::Text => json!({ "type": "string" }),
        ValueForm::HexColor => json!({ "type": "string", "pattern": "^#[0-9A-Fa-f]{6}$" }),
        ValueForm::List(item) => json!({ "type": "array", "items": of_form(item) }),
        ValueForm::Map(value) => json!({ "type": "object", "additionalProperties": of_form(value) }),
        ValueForm::Tuple(items, needed) if items.iter().all(|item| item == &items[0]) => json!({
            "type": "array",
            "items": of_form(&items[0]),
            "minItems": needed,
            "maxItems": items.len(),
        }),
        ValueForm::Tuple(items, needed) => json!({
            "type": "array",
            "prefixItems": items.iter().map(of_form).collect::<Value>(),
            "items": false,
            "minItems": needed,
        }),
        ValueForm::Fields(fields) => of_fields(fields),
        ValueForm::Words(words) => json!({ "oneOf": words.iter().map(of_word).collect::<Value>() }),
        ValueForm::Type(name) => json!({ "$ref": reference(name) }),
        ValueForm::Either(forms) => json!({ "anyOf": forms.iter().map(of_form).collect::<Value>() }),
        ValueForm::Keys => json!({ "type": "array" }),
    }
}

fn of_number(range: &NumberLimits) -> Value {
    let mut schema = json!({ "type": "number" });
    for (end, included, excluded) in
        [(range.least, "minimum", "exclusiveMinimum"), (range.most, "maximum", "exclusiveMaximum")]
    {
        if let Some(end) = end {
            schema[if end.is_excluded { excluded } else { included }] = number(end.value);
        }
    }
    if range.is_not_zero {
        schema["not"] = json!({ "const": 0 });
    }
    schema
}

fn of_fields(fields: &[FieldForm]) -> Value {
    let properties = fields.iter().map(|field| (field.name.to_owned(), of_field(field)));
    let mut schema = json!({
        "type": "object",
        "properties": properties.collect::<Map<_, _>>(),
        "additionalProperties": false,
    });
    let names = |is_wanted: fn(&FieldForm) -> bool| -> Vec<&str> {
        fields.iter().filter(|field| is_wanted(field)).map(|field| field.name).collect()
    };
    let required = names(|field| field.is_required);
    let mut choices = vec![json!({ "required": required })];
    for name in names(|field| field.replaces_required) {
        choices.push(json!({ "required": [name], "maxProperties": 1 }));
    }
    if choices.len() > 1 {
        schema["oneOf"] = choices.into();
    } else if !required.is_empty() {
        schema["required"] = json!(required);
    }
    schema
}

fn of_field(field: &FieldForm) -> Value {
    let mut form = of_form(&field.form);
    if field.is_optional {
        let nothing = json!({ "type": "null" });
        match form.get_mut("anyOf").and_then(Value::as_array_mut) {
            Some(forms) => forms.push(nothing),
            None => form = json!({ "anyOf": [form, nothing] }),
        }
    }
    let mut schema = described(form, &field.about);
    if let Some(default) = field.default.and_then(RonValue::parse) {
        schema["default"] = to_json(&default);
    }
    schema
}

fn of_word(WordForm { word, content, about }: &WordForm) -> Value {
    let schema = match content {
        None => json!({ "const": word }),
        Some(content) => json!({
            "type": "object",
            "properties": { *word: of_form(content) },
            "required": [word],
            "additionalProperties": false,
        }),
    };
    described(schema, about)
}

/// Returns a number in JSON, without a fraction if it is an integer.
fn number(number: f64) -> Value {
    serde_json::from_str(&number.to_string()).unwrap_or_default()
}

/// Returns a value of a scene in JSON.
fn to_json(value: &RonValue) -> Value {
    match value {
        RonValue::Empty => Value::Null,
        RonValue::Flag(flag) => json!(flag),
        RonValue::Number(value) => number(*value),
        RonValue::Text(text) | RonValue::Word(text) => json!(text),
        RonValue::Values(values) => values.iter().map(to_json).collect(),
        RonValue::Named(fields) => {
            fields.iter().map(|(name, value)| (name.clone(), to_json(value))).collect()
        }
        RonValue::Variant(word, content) => json!({ word: to_json(content) }),
    }
}
