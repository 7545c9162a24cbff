//! Tests of the schema against the parser: what one accepts, the other accepts, and what one rejects, the other rejects.
//!
//! The schema knows no relations between values. Documents are therefore compared by mistakes of the notation, and by numbers that are out
//! of their range. Mistakes of the notation hide all others: a document has a `without` that is a mistake, which is found only if the notation
//! is valid.

use std::fs;
use std::ops::Range;
use std::process::Command;
use std::sync::OnceLock;

use rayreel::Scene;
use rayreel::scene::LoadError;
use rayreel::scene::format::RonValue;
use serde_json::{Map, Value, json};

use crate::splitmix::Random;
use crate::{root, scenes_in};

fn schema() -> &'static Value {
    static SCHEMA: OnceLock<Value> = OnceLock::new();
    SCHEMA.get_or_init(|| {
        let printed = Command::new(env!("CARGO_BIN_EXE_rayreel")).arg("schema").output().unwrap();
        serde_json::from_slice(&printed.stdout).unwrap()
    })
}

fn target(reference: &Value) -> &'static Value {
    schema().pointer(reference.as_str().unwrap().trim_start_matches('#')).unwrap()
}

/// Returns whether a value matches a schema, by the rules that this schema has. Panics for another rule.
fn matches(schema: &Value, value: &Value) -> bool {
    let Value::Object(rules) = schema else { return *schema == json!(true) };
    let number = value.as_f64();
    let is_in = |is: fn(f64, f64) -> bool, bound: &Value| {
        number.is_none_or(|number| is(number, bound.as_f64().unwrap()))
    };
    let entries = || value.as_object().into_iter().flatten();
    let items = value.as_array();
    let count = |rules: &Value| rules.as_array().unwrap().iter().filter(|rule| matches(rule, value)).count();
    rules.iter().all(|(rule, of)| match rule.as_str() {
        "$ref" => matches(target(of), value),
        "type" => match of.as_str().unwrap() {
            "number" => value.is_number(),
            "integer" => number.is_some_and(|number| number.fract() == 0.0),
            "boolean" => value.is_boolean(),
            "string" => value.is_string(),
            "array" => value.is_array(),
            "object" => value.is_object(),
            kind => kind == "null" && value.is_null(),
        },
        "const" => value == of || number.is_some_and(|number| Some(number) == of.as_f64()),
        "enum" => of.as_array().unwrap().contains(value),
        "minimum" => is_in(|number, bound| number >= bound, of),
        "maximum" => is_in(|number, bound| number <= bound, of),
        "exclusiveMinimum" => is_in(|number, bound| number > bound, of),
        "exclusiveMaximum" => is_in(|number, bound| number < bound, of),
        "pattern" => {
            assert_eq!(of, "^#[0-9A-Fa-f]{6}$");
            let digits = value.as_str().map(|text| text.strip_prefix('#').unwrap_or_default());
            digits.is_none_or(|digits| {
                digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit())
            })
        }
        "properties" => {
            entries().all(|(name, value)| of.get(name).is_none_or(|schema| matches(schema, value)))
        }
        "required" => {
            !value.is_object()
                || of.as_array().unwrap().iter().all(|name| value.get(name.as_str().unwrap()).is_some())
        }
        "additionalProperties" => {
            let known = |name: &str| rules.get("properties").is_some_and(|known| known.get(name).is_some());
            entries().all(|(name, value)| known(name) || matches(of, value))
        }
        "maxProperties" => entries().count() <= 1,
        "prefixItems" => items.is_none_or(|items| {
            items.iter().zip(of.as_array().unwrap()).all(|(item, schema)| matches(schema, item))
        }),
        "items" => {
            let first = rules.get("prefixItems").map_or(0, |first| first.as_array().unwrap().len());
            items.is_none_or(|items| items.iter().skip(first).all(|item| matches(of, item)))
        }
        "minItems" => items.is_none_or(|items| items.len() as u64 >= of.as_u64().unwrap()),
        "maxItems" => items.is_none_or(|items| items.len() as u64 <= of.as_u64().unwrap()),
        "anyOf" => count(of) > 0,
        "oneOf" => count(of) == 1,
        "allOf" => of.as_array().unwrap().iter().all(|schema| matches(schema, value)),
        "not" => !matches(of, value),
        "if" => !matches(of, value) || matches(&rules["then"], value),
        "then" | "title" | "description" | "default" | "$schema" | "$defs" => true,
        _ => panic!("the test does not know the rule {rule}"),
    })
}

fn to_json(value: &RonValue) -> Value {
    match value {
        RonValue::Empty => Value::Null,
        RonValue::Flag(flag) => json!(flag),
        RonValue::Number(number) => json!(number),
        RonValue::Text(text) | RonValue::Word(text) => json!(text),
        RonValue::Values(values) => values.iter().map(to_json).collect(),
        RonValue::Named(fields) => {
            fields.iter().map(|(name, value)| (name.clone(), to_json(value))).collect()
        }
        RonValue::Variant(word, content) => json!({ word: to_json(content) }),
    }
}

/// Returns whether the text of a scene matches the schema.
fn text_matches(text: &str) -> bool {
    RonValue::parse(text).is_some_and(|value| matches(schema(), &to_json(&value)))
}

/// Labels of mistakes about numbers that are out of their range.
const OUT_OF_RANGE: [&str; 5] = ["zero", "out of range", "below 0", "too small", "not finite"];

/// Returns whether a message is about several numbers: frames are a product of two, and keys follow each other.
fn is_relation(message: &str) -> bool {
    message.ends_with("100000000 frames") || message.contains(" follows one at ")
}

/// A part of the mistake of a `without` in a scene that extends no other.
const CANARY: &str = "removes nothing";

/// Returns whether the parser finds the notation of a document valid, and all numbers within their ranges.
fn is_read(text: &str) -> Result<(), String> {
    let Err(error) = Scene::from_text("nowhere/a.ron", text.to_owned()) else { return Ok(()) };
    let is_number = |span: &Range<usize>| text[span.clone()].parse::<f64>().is_ok();
    let mut wrong = error.mistakes().filter(|mistake| {
        let diagnostic = mistake.diagnostic;
        OUT_OF_RANGE.contains(&diagnostic.label.as_str())
            && diagnostic.span.as_ref().is_some_and(is_number)
            && !is_relation(&diagnostic.message)
    });
    let is_notation_valid =
        error.mistakes().any(|mistake| mistake.diagnostic.message.contains(CANARY)) || error.unlisted() > 0;
    if is_notation_valid && wrong.next().is_none() { Ok(()) } else { Err(error.to_string()) }
}

/// A document, and its schema.
fn resolved(schema: &'static Value) -> &'static Value {
    schema.get("$ref").map_or(schema, |reference| resolved(target(reference)))
}

/// Returns a random value that matches a schema.
fn random(schema: &'static Value, random_bits: &mut Random, depth: usize) -> Value {
    let schema = resolved(schema);
    let choices =
        schema.get("anyOf").or_else(|| schema.get("oneOf").filter(|_| schema.get("properties").is_none()));
    if let Some(choices) = choices.and_then(Value::as_array) {
        return random(&choices[random_bits.index(choices.len())], random_bits, depth);
    }
    if let Some(word) = schema.get("const") {
        return word.clone();
    }
    match schema["type"].as_str().unwrap() {
        "null" => Value::Null,
        "boolean" => json!(random_bits.once_in(2)),
        "string" if schema.get("pattern").is_some() => json!("#0aF83c"),
        "string" => json!("a"),
        "integer" => {
            let [least, most] = ["minimum", "maximum"].map(|end| schema[end].as_u64().unwrap());
            json!(
                [least, most.min(1 << 53), least.saturating_add(random_bits.bits() % 9).min(most)]
                    [random_bits.index(3)]
            )
        }
        "number" => {
            let end = |name: &str| schema.get(name).and_then(Value::as_f64);
            let least = end("minimum").or(end("exclusiveMinimum").map(f64::next_up)).unwrap_or(-1e60);
            let most = end("maximum").or(end("exclusiveMaximum").map(f64::next_down)).unwrap_or(1e60);
            let middle = if (least..=most).contains(&0.75) { 0.75 } else { least };
            let number = [least, most, middle][random_bits.index(3)];
            json!(if schema.get("not").is_some() && number == 0.0 { 1.0 } else { number })
        }
        "array" if schema.get("prefixItems").is_some() => {
            let forms = schema["prefixItems"].as_array().unwrap();
            let least = usize::try_from(schema["minItems"].as_u64().unwrap()).unwrap();
            let count = least + random_bits.index(forms.len() - least + 1);
            forms[..count].iter().map(|form| random(form, random_bits, depth + 1)).collect()
        }
        "array" if schema.get("maxItems").is_some() => {
            let count = schema["maxItems"].as_u64().unwrap();
            (0..count).map(|_| random(&schema["items"], random_bits, depth + 1)).collect()
        }
        "array" => {
            let Some(form) = schema.get("items") else { return json!([]) };
            (0..random_bits.index(3)).map(|_| random(form, random_bits, depth + 1)).collect()
        }
        _ => random_object(schema, random_bits, depth),
    }
}

fn random_object(schema: &'static Value, random_bits: &mut Random, depth: usize) -> Value {
    let Some(properties) = schema.get("properties").and_then(Value::as_object) else {
        return json!({ "a": random(&schema["additionalProperties"], random_bits, depth + 1) });
    };
    let choices =
        schema.get("oneOf").map_or(std::slice::from_ref(schema), |choices| choices.as_array().unwrap());
    let choice = &choices[random_bits.index(choices.len())];
    let required = choice.get("required").cloned().unwrap_or(json!([]));
    let is_required = |name: &str| required.as_array().unwrap().contains(&json!(name));
    let rarely = 1 + u64::try_from(depth).unwrap();
    let mut object = Map::new();
    for (name, form) in properties {
        let is_replaced = choices.len() > 1 && !is_required(name) && choice.get("maxProperties").is_some();
        let is_other = choices.iter().any(|other| other != choice && other["required"] == json!([name]));
        if is_required(name) || !is_replaced && !is_other && random_bits.once_in(rarely) {
            object.insert(name.clone(), random(form, random_bits, depth + 1));
        }
    }
    let mut value = Value::Object(object);
    if let Some(form) = keys_of(schema, &value)
        && let Some(keys) = value.pointer_mut("/track/Keys")
    {
        *keys = random(form, random_bits, depth + 1);
    }
    value
}

/// Returns the schema of the keys of an animation, which depends on its channel.
fn keys_of<'a>(schema: &'a Value, animation: &Value) -> Option<&'a Value> {
    let conditions = schema.get("allOf")?.as_array()?;
    let condition = conditions.iter().find(|condition| matches(&condition["if"], animation));
    condition
        .filter(|_| animation.get("channel").is_some())?
        .pointer("/then/properties/track/properties/Keys")
}

/// Returns a value in RON. A value that does not match the schema is written as what it resembles.
fn to_ron(value: &Value, schema: &Value) -> String {
    if let Some(reference) = schema.get("$ref") {
        return to_ron(value, target(reference));
    }
    let joined = |parts: Vec<String>| parts.join(", ");
    if let Some(forms) = schema.get("anyOf").and_then(Value::as_array) {
        let fits = |form: &&Value| {
            let form: &Value = form.get("$ref").map_or(*form, |reference| target(reference));
            let is_words = form.get("oneOf").is_some() && form.get("type").is_none();
            match value {
                Value::Object(_) => form["type"] == "object" || is_words,
                Value::Array(_) => form["type"] == "array",
                Value::String(_) => form["type"] == "string" || is_words,
                _ => false,
            }
        };
        // A form with a choice in it is one of its forms.
        let nested = |form: &&Value| form.get("anyOf").is_some();
        return to_ron(value, forms.iter().find(fits).or(forms.iter().find(nested)).unwrap_or(&Value::Null));
    }
    let is_words = schema.get("oneOf").is_some() && schema.get("type").is_none();
    match value {
        Value::Null => "None".to_owned(),
        Value::String(word) if is_words => word.clone(),
        Value::Array(items) if schema.get("prefixItems").is_some() => {
            let forms = schema["prefixItems"].as_array().unwrap();
            let form = |index: usize| forms.get(index).unwrap_or(&Value::Null);
            format!(
                "({})",
                joined(items.iter().enumerate().map(|(index, item)| to_ron(item, form(index))).collect())
            )
        }
        Value::Array(items) => {
            let form = schema.get("items").unwrap_or(&Value::Null);
            let items = joined(items.iter().map(|item| to_ron(item, form)).collect());
            if schema.get("maxItems").is_some() { format!("({items})") } else { format!("[{items}]") }
        }
        Value::Object(fields) if is_words && fields.is_empty() => "()".to_owned(),
        Value::Object(fields) if is_words => {
            let content = |(word, content): (&String, &Value)| {
                let forms = schema["oneOf"].as_array().unwrap().iter();
                let form =
                    forms.filter_map(|form| form["properties"].get(word)).next().unwrap_or(&Value::Null);
                let inside = to_ron(content, form);
                // The bracket of several values, or of fields, is that of the word.
                let is_tuple = ["prefixItems", "maxItems"].iter().any(|rule| form.get(*rule).is_some());
                let is_bracket = content.is_object() && form["type"] == "object" || is_tuple;
                if is_bracket { format!("{word}{inside}") } else { format!("{word}({inside})") }
            };
            joined(fields.iter().map(content).collect())
        }
        Value::Object(fields) if schema.get("properties").is_none() => {
            let form = schema.get("additionalProperties").unwrap_or(&Value::Null);
            format!(
                "{{{}}}",
                joined(
                    fields.iter().map(|(key, value)| format!("{key:?}: {}", to_ron(value, form))).collect()
                )
            )
        }
        Value::Object(fields) => {
            // A channel determines the form of the track after it.
            let mut fields: Vec<(&String, &Value)> = fields.iter().collect();
            fields.sort_by_key(|(name, _)| *name != "channel");
            let form = |name: &str| schema["properties"].get(name).unwrap_or(&Value::Null);
            let written = |name: &str, of_field: &Value| match (of_field.get("Keys"), keys_of(schema, value))
            {
                // What a mutation adds to the keys is written, too.
                (Some(keys), Some(form)) if of_field.as_object().is_some_and(|track| track.len() == 1) => {
                    format!("Keys({})", to_ron(keys, form))
                }
                _ => to_ron(of_field, form(name)),
            };
            format!(
                "({})",
                joined(
                    fields
                        .into_iter()
                        .map(|(name, value)| format!("{name}: {}", written(name, value)))
                        .collect()
                )
            )
        }
        Value::Bool(_) | Value::Number(_) => value.to_string(),
        Value::String(text) => format!("{text:?}"),
    }
}

/// Returns the paths of all values in a value.
fn paths(value: &Value, path: &str, found: &mut Vec<String>) {
    let mut each = |name: &str, value: &Value| {
        let path = format!("{path}/{name}");
        found.push(path.clone());
        paths(value, &path, found);
    };
    match value {
        Value::Object(fields) => fields.iter().for_each(|(name, value)| each(name, value)),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(index, item)| each(&index.to_string(), item));
        }
        _ => {}
    }
}

/// Changes a document in one place: a name, a value of another type, a number, a missing or an additional field.
fn mutate(value: &mut Value, random_bits: &mut Random) {
    let mut all = Vec::new();
    paths(value, "", &mut all);
    all.retain(|path| !path.starts_with("/without"));
    if all.is_empty() {
        return;
    }
    let path = &all[random_bits.index(all.len())];
    let (outer, name) = path.rsplit_once('/').unwrap();
    let change = random_bits.index(5);
    match (change, value.pointer_mut(outer).unwrap()) {
        (0, Value::Object(fields)) => {
            let content = fields.remove(name).unwrap();
            fields.insert(format!("{name}_zz"), content);
        }
        (1, Value::Object(fields)) => drop(fields.remove(name)),
        (2, Value::Object(fields)) => drop(fields.insert("additional".to_owned(), json!(1))),
        (3, outer) => {
            let others = [json!(true), json!(1e70), json!("text"), json!([[]]), json!({ "other": 1 })];
            let other = &others[random_bits.index(others.len())];
            match outer {
                Value::Object(fields) => drop(fields.insert(name.to_owned(), other.clone())),
                outer => outer[name.parse::<usize>().unwrap()] = other.clone(),
            }
        }
        (_, _) => {
            if let Some(number) = value.pointer_mut(path).filter(|value| value.is_number()) {
                *number = json!([-1e61, -1.0, 0.0, 0.5, 300.0, 1e61][random_bits.index(6)]);
            }
        }
    }
}

#[test]
fn shipped_scenes_match_the_schema() {
    let folders = ["scenes", "scenes/parts", "scenes/data", "scenes/lesson", "tests/hard_cases"];
    let scenes: Vec<_> = folders.into_iter().flat_map(scenes_in).collect();
    assert!(scenes.len() > 30);
    for path in scenes {
        assert!(text_matches(&fs::read_to_string(&path).unwrap()), "{}", path.display());
    }
}

#[test]
fn random_documents_and_mutations_match_if_the_parser_reads_them() {
    let scene = target(&schema()["$ref"]);
    let (mut valid, mut invalid, mut different) = (0, 0, Vec::new());
    for seed in 0..1500 {
        let mut bits = Random(seed);
        let mut document = random(scene, &mut bits, 0);
        document.as_object_mut().unwrap().remove("extends");
        document["without"] = json!(["a"]);
        for is_mutated in [false, true] {
            if is_mutated {
                mutate(&mut document, &mut bits);
            }
            // In place of a name, the parser takes `()` for no material.
            let text = to_ron(&document, scene).replace("material: ()", "material: (k_a: 0.5)");
            let read = is_read(&text);
            let is_matched = matches(schema(), &document);
            assert!(is_mutated || is_matched, "seed {seed}: {document:#}");
            // The mistake of a number that is too large everywhere can be hidden by another one of its group.
            let is_too_large = is_mutated && (text.contains("1e+61") || text.contains("1e+70"));
            if is_matched != read.is_ok() && !is_too_large {
                different.push(format!(
                    "seed {seed}, {is_matched} in the schema: {document}\n{text}\n{}",
                    read.err().unwrap_or_default()
                ));
            }
            if is_matched { valid += 1 } else { invalid += 1 }
        }
    }
    assert!(different.is_empty(), "{} differences\n{}", different.len(), different.join("\n\n"));
    assert!(valid > 1500 && invalid > 300, "{valid} valid, {invalid} invalid");
}

/// Returns the spans of the numbers in a text without strings that hold digits after spaces.
fn numbers(text: &str) -> Vec<Range<usize>> {
    let is_part = |character: char| character.is_alphanumeric() || "_.+-\"".contains(character);
    let mut found = Vec::new();
    for (start, word) in text
        .split(|character| !is_part(character))
        .map(|word| (word.as_ptr() as usize - text.as_ptr() as usize, word))
    {
        if word.parse::<f64>().is_ok() {
            found.push(start..start + word.len());
        }
    }
    found
}

#[test]
fn numbers_are_out_of_range_in_both() {
    let text = fs::read_to_string(root().join("tests/hard_cases/every_number.ron")).unwrap();
    let found = numbers(&text);
    assert!(found.len() > 100);
    let (mut rejected, mut different) = (0, Vec::new());
    for span in found {
        for number in [
            "-1e61", "-2", "-1", "0", "0.001", "0.5", "1.5", "91", "181", "256", "1001", "32769", "65537",
            "2000000", "1e31", "1e61",
        ] {
            let changed = format!("{}{number}{}", &text[..span.start], &text[span.end..]);
            let end = span.start + number.len();
            let error = Scene::from_text("a.ron", changed.clone()).err();
            let mistakes = error.iter().flat_map(LoadError::mistakes);
            let is_here = |at: &Range<usize>| span.start <= at.start && at.end <= end;
            let mut here = mistakes.filter(|mistake| mistake.diagnostic.span.as_ref().is_some_and(is_here));
            let first = here.next().map(|mistake| mistake.diagnostic.message.clone());
            let first = first.filter(|message| !is_relation(message));
            let is_matched = text_matches(&changed);
            rejected += usize::from(!is_matched);
            let place = &text[span.start.saturating_sub(40)..span.end];
            if is_matched != first.is_none() {
                different.push(format!("{number} in place of the last of {place}: {first:?}"));
            }
        }
    }
    assert!(different.is_empty(), "{}", different.join("\n"));
    assert!(rejected > 500, "{rejected}");
}
