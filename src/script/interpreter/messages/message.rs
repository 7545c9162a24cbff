//! Error messages, and the messages shared by compile-time and run-time errors.

use crate::script::limits;

/// An error message.
pub(in crate::script) struct Message {
    pub(in crate::script) message: String,
    /// Annotation of the marked span.
    pub(in crate::script) label: String,
    pub(in crate::script) help: Option<String>,
}

impl Message {
    pub(super) fn here(message: impl Into<String>) -> Self {
        Self { message: message.into(), label: "here".to_owned(), help: None }
    }

    pub(in crate::script) fn with_help(
        message: impl Into<String>,
        label: &str,
        help: impl Into<String>,
    ) -> Self {
        Self { message: message.into(), label: label.to_owned(), help: Some(help.into()) }
    }

    pub(super) fn too_many_variables() -> Self {
        Self::with_help(
            "too many variables",
            "one too many",
            format!("there can be {} at a time; a list or a map holds several values", limits::VARIABLES),
        )
    }

    pub(super) fn expected(expected: &str, found: &str) -> Self {
        let help = match expected {
            // Only indices have to be integers.
            "a number" if found == "a number" => return Self::index(),
            "true or false" => "compare it, as x > 0",
            "a text" => "values of a map are chosen by their names: map.name, or map[\"name\"]",
            "a number" => "values of a list are chosen by whole numbers: list[0]",
            _ => return Self::here(format!("expected {expected}, found {found}")),
        };
        Self::with_help(format!("expected {expected}, found {found}"), "here", help)
    }

    pub(super) fn index() -> Self {
        Self::with_help(
            "an index must be a whole number",
            "not whole, or too large to be",
            "values are counted from 0; floor(x) gives whole numbers up to 9007199254740992",
        )
    }

    pub(super) fn constant(name: &str) -> Self {
        Self::with_help(
            format!("`{}` cannot be changed", shortened(name)),
            "given from outside, or a constant",
            "use a variable of your own: `let x = ..;`",
        )
    }

    /// Returns the message for a value that is too large, given Rhai's name for its type.
    pub(super) fn too_large(what: &str) -> Self {
        let (what, most) = if what.contains("tring") {
            ("text", format!("texts have at most {} bytes", limits::TEXT))
        } else if what.contains("map") {
            ("map", format!("maps have at most {} values", limits::MAP))
        } else {
            ("list", format!("lists have at most {} values", limits::LIST))
        };
        let help = format!("{most}, with those of all that is in them");
        Self::with_help(format!("a {what} that is too large"), "too large", help)
    }
}

/// Truncates a long name or string of a script.
pub(in crate::script) fn shortened(text: &str) -> String {
    const MOST: usize = 80;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}..", &text[..end]),
        None => text.to_owned(),
    }
}

/// Returns the name of the function in Rhai's signature of a call.
pub(in crate::script) fn function_name(signature: &str) -> &str {
    signature.split([' ', '(']).next().unwrap_or(signature)
}

pub(super) fn type_name(name: &str) -> &str {
    match name {
        "i64" | "f64" | "int" | "float" | "integer" => "a number",
        "bool" => "true or false",
        "char" => "a character",
        "array" | "rhai::Array" => "a list",
        "map" | "rhai::Map" => "a map",
        "()" => "nothing",
        "Fn" => "a function",
        name if name.contains("tring") || name.contains("str") => "a text",
        name if name.contains("ange") || name.ends_with("Numbers") => "a range",
        name => name,
    }
}

/// Returns the kind of value for Rhai's name of an expression.
pub(super) fn expression_kind(name: &str) -> &str {
    match name {
        "a boolean" | "a boolean expression" => "true or false",
        "a floating-point number" | "a number" | "an integer number" => "a number",
        "a string" => "a text",
        "an array" => "a list",
        "an object map" => "a map",
        "an iterable value" => "a range or a list",
        "()" => "nothing",
        name => name,
    }
}

pub(super) fn lower_first(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| first.to_lowercase().chain(characters).collect())
}
