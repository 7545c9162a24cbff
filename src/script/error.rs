//! What is wrong with a program, and where.

use std::ops::Range;

use rhai::{EvalAltResult, LexError, ParseError, ParseErrorType, Position};

use super::{language, limits};

/// A mistake in a program, or one that shows when it runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScriptError {
    /// What is wrong.
    pub message: String,
    /// What about the marked place.
    pub label: String,
    /// How to mend it, where that is known.
    pub help: Option<String>,
    /// A name that nobody knows, and those that are known.
    pub unknown: Option<Box<Unknown>>,
    /// Bytes of the program's text.
    pub span: Range<usize>,
}

/// A name that nobody knows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// The name.
    pub name: String,
    /// What it would be the name of, in the plural.
    pub kind: &'static str,
    /// The names that are known.
    pub known: Vec<String>,
}

impl ScriptError {
    /// An error that is not about one place in the text.
    #[must_use]
    pub fn whole(
        text: &str,
        message: impl Into<String>,
        label: impl Into<String>,
        help: Option<String>,
    ) -> Self {
        let span = span_of(text, Position::NONE);
        Self { message: message.into(), label: label.into(), help, unknown: None, span }
    }

    pub(super) fn parsing(text: &str, error: &ParseError) -> Self {
        let (message, label, help) = explain_parsing(error.err_type());
        let mut explained = Self::at(text, error.position(), message, &label, help);
        if let ParseErrorType::VariableUndefined(name) = error.err_type() {
            explained.unknown = Some(unknown_variable(name).into());
        }
        explained
    }

    pub(super) fn running(text: &str, error: &EvalAltResult, functions: &[String]) -> Self {
        let error = innermost(error);
        if let EvalAltResult::ErrorFunctionNotFound(signature, position) = error
            && signature.starts_with(char::is_alphabetic)
            && !functions.iter().any(|known| known == function_name(signature))
        {
            return Self::unknown_function(text, function_name(signature), *position, functions.to_vec());
        }
        let (message, label, help) = explain_running(error);
        let mut explained = Self::at(text, error.position(), message, &label, help);
        if let EvalAltResult::ErrorVariableNotFound(name, _) = error {
            explained.unknown = Some(unknown_variable(name).into());
        }
        explained
    }

    pub(super) fn unknown_function(text: &str, name: &str, position: Position, known: Vec<String>) -> Self {
        let message = format!("there is no function `{name}`");
        let unknown = Unknown { name: name.to_owned(), kind: "functions", known };
        Self { unknown: Some(unknown.into()), ..Self::at(text, position, message, "not known here", None) }
    }

    pub(super) fn endless_number(text: &str, position: Position) -> Self {
        let help = Some("numbers reach to about 1.8e308".to_owned());
        Self::at(text, position, "this number is too large".to_owned(), "beyond all numbers", help)
    }

    fn at(text: &str, position: Position, message: String, label: &str, help: Option<String>) -> Self {
        let (message, help) = match message.split_once('\n') {
            Some((message, help)) => (message.to_owned(), Some(help.to_owned())),
            None => (message, help),
        };
        Self { message, label: label.to_owned(), help, unknown: None, span: span_of(text, position) }
    }
}

/// What stands at a position: the whole text, without the space around it, for none.
pub(super) fn span_of(text: &str, position: Position) -> Range<usize> {
    match byte_of(text, position) {
        Some(start) => start..token_end(text, start),
        None => text.len() - text.trim_start().len()..text.trim_end().len(),
    }
}

fn unknown_variable(name: &str) -> Unknown {
    let known = language::variables().map(str::to_owned).collect();
    Unknown { name: name.to_owned(), kind: "names", known }
}

/// The error in the function that was called last.
fn innermost(error: &EvalAltResult) -> &EvalAltResult {
    match error {
        EvalAltResult::ErrorInFunctionCall(_, _, inner, _) if inner.position() != Position::NONE => {
            innermost(inner)
        }
        error => error,
    }
}

/// Lines and columns count from 1, columns in characters.
fn byte_of(text: &str, position: Position) -> Option<usize> {
    let line_start = match position.line()? {
        0 | 1 => 0,
        line => text.match_indices('\n').nth(line - 2)?.0 + 1,
    };
    let column = position.position().unwrap_or(1);
    let line = &text[line_start..];
    let offset = line.char_indices().nth(column - 1).map_or(line.len(), |(offset, _)| offset);
    Some((line_start + offset).min(text.len()))
}

/// The end of the name, number or sign that starts at a byte.
fn token_end(text: &str, start: usize) -> usize {
    let rest = &text[start..];
    let is_word = |character: char| character.is_alphanumeric() || character == '_';
    match rest.chars().next() {
        Some(first) if is_word(first) => {
            start + rest.find(|character| !is_word(character)).unwrap_or(rest.len())
        }
        Some(first) => start + first.len_utf8(),
        None => start,
    }
}

fn function_name(signature: &str) -> &str {
    signature.split([' ', '(']).next().unwrap_or(signature)
}

/// The values that a function was called with, in words.
fn arguments(signature: &str) -> String {
    let inside = signature.split_once('(').map_or("", |(_, inside)| inside.trim_end_matches(')'));
    let names: Vec<&str> =
        inside.split(", ").map(str::trim).filter(|name| !name.is_empty()).map(type_name).collect();
    match names.split_last() {
        None => "nothing".to_owned(),
        Some((last, [])) => (*last).to_owned(),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
    }
}

fn type_name(name: &str) -> &str {
    match name {
        "i64" | "f64" | "int" | "float" => "a number",
        "bool" => "true or false",
        "char" => "a character",
        "array" | "rhai::Array" => "a list",
        "map" | "rhai::Map" => "a map",
        "()" => "nothing",
        "Fn" => "a function",
        name if name.contains("tring") || name.contains("str") => "a text",
        name if name.contains("range") || name.contains("Range") => "a range",
        name => name,
    }
}

type Explained = (String, String, Option<String>);

fn here(message: impl Into<String>) -> Explained {
    (message.into(), "here".to_owned(), None)
}

fn with_help(message: impl Into<String>, label: &str, help: impl Into<String>) -> Explained {
    (message.into(), label.to_owned(), Some(help.into()))
}

fn explain_parsing(error: &ParseErrorType) -> Explained {
    use ParseErrorType as Parse;
    match error {
        Parse::UnexpectedEOF => {
            with_help("the script ends too early", "something is missing here", "is a bracket not closed?")
        }
        Parse::VariableUndefined(name) => {
            (format!("nothing is called `{name}`"), "not known here".to_owned(), None)
        }
        Parse::MissingToken(token, why) => here(format!("expected `{token}` {why}")),
        Parse::Reserved(word) | Parse::BadInput(LexError::ImproperSymbol(word, _)) => with_help(
            format!("`{word}` means nothing here"),
            "not part of the language",
            "scripts have no files, no modules, no clock and no printing; choose another name for something of your own",
        ),
        Parse::BadInput(error) => here(lower_first(&error.to_string())),
        Parse::ExprTooDeep => {
            with_help("this is nested too deep", "too deep", "give its parts names: `let a = ..;`")
        }
        Parse::LiteralTooLarge(..) => with_help(
            "this is too large",
            "too large",
            format!("lists have at most {} values, texts {} bytes", limits::LIST, limits::TEXT),
        ),
        Parse::AssignmentToConstant(name) => with_help(
            format!("`{name}` cannot be changed"),
            "given from outside, or a constant",
            "use a variable of your own: `let x = ..;`",
        ),
        Parse::MismatchedType(expected, found) => {
            here(format!("expected {}, found {}", expression_kind(expected), expression_kind(found)))
        }
        other => here(lower_first(&other.to_string())),
    }
}

/// What an expression gives, in the words of messages.
fn expression_kind(name: &str) -> &str {
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

fn explain_running(error: &EvalAltResult) -> Explained {
    use EvalAltResult as Run;
    match error {
        Run::ErrorVariableNotFound(name, _) => {
            (format!("nothing is called `{name}`"), "not known here".to_owned(), None)
        }
        Run::ErrorFunctionNotFound(signature, _) => {
            let name = function_name(signature);
            let message = format!("`{name}` does not take {}", arguments(signature));
            let range = name
                .starts_with("..")
                .then_some("the ends of a range are whole numbers, as floor(x) gives them");
            let help = range.map(str::to_owned).or_else(|| language::usage(name));
            (message, "called with other values".to_owned(), help)
        }
        Run::ErrorArithmetic(message, _) => here(lower_first(message)),
        Run::ErrorTooManyOperations(_) | Run::ErrorTerminated(..) => with_help(
            "this takes too long",
            "still running here",
            "does a loop never end? What is the same in every frame can be written as keys",
        ),
        Run::ErrorStackOverflow(_) => with_help(
            "functions call each other too deep",
            format!("more than {} calls deep", limits::CALLS).as_str(),
            "does a function call itself without end? Use a loop",
        ),
        Run::ErrorTooManyVariables(_) => with_help(
            "too many variables",
            "one too many",
            format!("there can be {} at a time", limits::VARIABLES),
        ),
        Run::ErrorDataTooLarge(..) => with_help(
            "this becomes too large",
            "too large",
            format!(
                "lists have at most {} values, maps {}, and texts {} bytes, all in them included",
                limits::LIST,
                limits::MAP,
                limits::TEXT
            ),
        ),
        Run::ErrorMismatchDataType(expected, found, _) => {
            let (expected, found) = (type_name(expected), type_name(found));
            here(format!("expected {expected}, found {found}"))
        }
        Run::ErrorIndexingType(..) => here("this has no parts to choose from by an index"),
        Run::ErrorArrayBounds(length, index, _) => with_help(
            format!("there is no value {index} in a list of {length}"),
            "outside the list",
            "values are counted from 0",
        ),
        Run::ErrorFor(_) => with_help(
            "a loop needs a range or a list",
            "neither",
            "write `for i in 0..10 { .. }`; the ends of a range are whole numbers, as floor(x) gives them",
        ),
        Run::ErrorAssignmentToConstant(name, _) => with_help(
            format!("`{name}` cannot be changed"),
            "given from outside, or a constant",
            "use a variable of your own: `let x = ..;`",
        ),
        Run::ErrorPropertyNotFound(name, _) => here(format!("the map has no `{name}`")),
        Run::ErrorDotExpr(message, _) => here(property_message(message)),
        Run::ErrorBitFieldBounds(_, index, _) => with_help(
            format!("a whole number has no bit {index}"),
            "outside the number",
            "bits are counted from 0 to 63",
        ),
        Run::ErrorRuntime(value, _) => here(value.to_string()),
        other => here(lower_first(other.to_string().split(" (line").next().unwrap_or_default())),
    }
}

/// Of a value that has no such property: Rhai names it first, and the value's type next.
fn property_message(message: &str) -> String {
    let mut quoted = message.split('\'').skip(1).step_by(2);
    match (quoted.next(), quoted.next()) {
        (Some(name), Some(kind)) => format!("{} has no `{name}`", type_name(kind)),
        (Some(name), None) => format!("this has no `{name}`"),
        _ => "this has no such part".to_owned(),
    }
}

fn lower_first(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| first.to_lowercase().chain(characters).collect())
}
