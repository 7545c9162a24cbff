//! Rhai's errors in the words of this program, with remedies.

use rhai::{EvalAltResult, LexError, ParseErrorType};

use super::limits;
use super::vocabulary::{Purpose, usage};

/// The message for the head of a function with too many values.
pub(super) const LONG_HEAD: &str = "a function of too many values";

/// An error in words.
pub(super) struct Told {
    pub(super) message: String,
    /// The remark at the marked place.
    pub(super) label: String,
    pub(super) help: Option<String>,
}

impl Told {
    fn here(message: impl Into<String>) -> Self {
        Self { message: message.into(), label: "here".to_owned(), help: None }
    }

    pub(super) fn with_help(message: impl Into<String>, label: &str, help: impl Into<String>) -> Self {
        Self { message: message.into(), label: label.to_owned(), help: Some(help.into()) }
    }

    /// Describes an error of compiling.
    pub(super) fn of_parsing(error: &ParseErrorType) -> Self {
        use ParseErrorType as Parse;
        match error {
            Parse::UnexpectedEOF => Self::with_help(
                "the script ends too early",
                "something is missing here",
                "is a bracket not closed?",
            ),
            Parse::MissingToken(token, why) => Self::missing(token, why),
            Parse::Reserved(word) => Self::foreign(word),
            Parse::BadInput(error) => Self::of_signs(error),
            Parse::UnknownOperator(sign) => Self::with_help(
                format!("`{sign}` means nothing here"),
                "no operator",
                "there are + - * / % **, == != < <= > >=, && || ! and `in`",
            ),
            Parse::ExprTooDeep => Self::with_help(
                "this is nested too deep",
                "too deep",
                format!(
                    "expressions are at most {} deep, {} in functions; give parts of it names: `let a = ..;`",
                    limits::NESTING,
                    limits::NESTING_IN_FUNCTIONS
                ),
            ),
            Parse::LiteralTooLarge(what, _) => Self::too_large(what),
            Parse::ForbiddenVariable(_) => Self::too_many_variables(),
            Parse::TooManyFunctions => Self::with_help(
                "too many functions",
                "one too many",
                format!("a script has at most {}", limits::FUNCTIONS),
            ),
            Parse::AssignmentToConstant(name) if !name.is_empty() => Self::constant(name),
            Parse::AssignmentToConstant(_) | Parse::AssignmentToInvalidLHS(_) => Self::with_help(
                "this cannot be given a value",
                "not a variable",
                "only variables and parts of them can: `x = 1`, `list[0] = 1`, `map.name = 1`; two values are compared by `==`",
            ),
            Parse::MismatchedType(expected, found) => {
                Self::expected(expression_kind(expected), expression_kind(found))
            }
            Parse::ExprExpected(_) => {
                Self::with_help("a value is missing", "expected here", "write an expression, as 1 or x + 1")
            }
            Parse::MalformedIndexExpr(_) => Self::index(),
            Parse::DuplicatedProperty(name) => Self::with_help(
                format!("`{}` is twice in this map", shortened(name)),
                "again here",
                "keep one of the two",
            ),
            Parse::DuplicatedVariable(name) | Parse::FnDuplicatedParam(_, name) => Self::with_help(
                format!("two are called `{}`", shortened(name)),
                "again here",
                "give each a name of its own",
            ),
            Parse::FnDuplicatedDefinition(name, count) => {
                let values = if *count == 1 { "value" } else { "values" };
                Self::with_help(
                    format!("there are two functions `{}` of {count} {values}", shortened(name)),
                    "again here",
                    "give one of them another name",
                )
            }
            Parse::WrongFnDefinition => Self::with_help(
                "a function inside of something else",
                "not here",
                "functions are written outside of all blocks and other functions",
            ),
            Parse::FnMissingName | Parse::FnMissingParams(_) | Parse::FnMissingBody(_) => Self::with_help(
                "this function is not complete",
                "something is missing here",
                "write `fn name(x) { x * 2 }`",
            ),
            Parse::PropertyExpected => Self::with_help(
                "a name is missing",
                "expected here",
                "names in maps are written as #{ name: 1 } and map.name",
            ),
            Parse::VariableExpected => Self::with_help(
                "the name of a variable is missing",
                "expected here",
                "write `let x = 1;`, `for i in 0..10 { .. }` or `catch (error) { .. }`",
            ),
            Parse::WrongSwitchDefaultCase
            | Parse::WrongSwitchIntegerCase
            | Parse::WrongSwitchCaseCondition => Self::with_help(
                "a case of `switch` at a wrong place",
                "here",
                "single values come first, then ranges, and `_`, which stands alone, last",
            ),
            Parse::WrongDocComment => {
                Self::with_help("`///` stands before functions only", "here", "write `//` for other comments")
            }
            Parse::LoopBreak => Self::with_help(
                "there is no loop to leave or to go on with",
                "outside of all loops",
                "`return` ends a function, or the script",
            ),
            other => Self::here(lower_first(&other.to_string())),
        }
    }

    /// Describes an error of characters that make no token.
    fn of_signs(error: &LexError) -> Self {
        match error {
            LexError::ImproperSymbol(sign, _) | LexError::UnexpectedInput(sign) => Self::foreign(sign),
            LexError::UnterminatedString => Self::with_help(
                "this text is never closed",
                "opened here",
                "close it with the same quote; only a text between backticks goes on over several lines",
            ),
            LexError::MalformedEscapeSequence(sequence) => Self::with_help(
                format!("`{}` stands for no character", shortened(sequence)),
                "after a backslash",
                r"write \\ for a backslash, \n for a new line, \u00e4 for a character by its number",
            ),
            LexError::MalformedNumber(number) => Self::with_help(
                format!("`{}` is not a number", shortened(number)),
                "not a number",
                "write one as 1, 0.25 or 1e-3; whole numbers reach to 9223372036854775807",
            ),
            LexError::MalformedChar(_) => Self::with_help(
                "this is not one character",
                "between single quotes",
                "texts stand in double quotes, as \"clay\"",
            ),
            LexError::MalformedIdentifier(name) => Self::with_help(
                format!("`{}` cannot be a name", shortened(name)),
                "not a name",
                "names have letters, digits and `_`, and begin with no digit",
            ),
            LexError::Runtime(message) if message == LONG_HEAD => Self::with_help(
                LONG_HEAD,
                "too many",
                format!("it takes at most {}; a list holds more", limits::ARGUMENTS),
            ),
            other => Self::here(lower_first(&other.to_string())),
        }
    }

    /// Describes an error about a word or sign that the language does not have.
    fn foreign(word: &str) -> Self {
        let help = match word {
            "=" => "`==` compares; `=` gives a value to a variable, in a statement of its own",
            "===" => "write `==`",
            "!==" => "write `!=`",
            ":=" | "<-" => "write `=`",
            "++" => "write `x += 1`",
            "--" => "write `x -= 1`",
            "->" | "=>" => "a function gives its last expression: `fn double(x) { 2 * x }`",
            "?" => "write `if a { b } else { c }`",
            "#" | "# {" => "maps are written as #{ name: value }",
            "(*" | "*)" => "comments stand after `//`, or between `/*` and `*/`",
            "var" => "write `let`",
            "null" | "nil" | "None" => "write `()`",
            "match" | "case" | "default" => "write `switch x { 1 => a, _ => b }`",
            word if word.starts_with(|first: char| first.is_alphabetic() || first == '_') => {
                "scripts have no files, no modules, no clock and no printing; choose another name for something of your own"
            }
            _ => "texts stand in double quotes; what is it meant to do?",
        };
        Self::with_help(format!("`{}` means nothing here", shortened(word)), "not part of the language", help)
    }

    /// Describes an error about a missing bracket or separator.
    fn missing(token: &str, why: &str) -> Self {
        let help = match token {
            ";" => "statements end with `;`: is one missing before this, or an operator?",
            ")" | "]" | "}" if why.contains("separate") || why.contains("end") => {
                "values are separated by commas: is one missing before this?"
            }
            ")" | "]" | "}" => "close what is open before this",
            "," => "values are separated by commas: is one missing before this?",
            ":" => "write `name: value`",
            "{" => "blocks stand in braces: `if a { b } else { c }`",
            "(" => "write the values of a function in brackets: f(x)",
            "in" => "write `for i in 0..10 { .. }`",
            "=>" => "write `switch x { 1 => a, _ => b }`",
            "while' or 'until" => "write `do { .. } while x;`",
            _ => return Self::here(format!("expected `{token}`")),
        };
        Self::with_help(format!("expected `{token}`"), "before this", help)
    }

    /// Describes an error of running.
    pub(super) fn of_running(error: &EvalAltResult, purpose: Purpose) -> Self {
        use EvalAltResult as Run;
        match error {
            Run::ErrorFunctionNotFound(signature, _) => Self::misfit(signature),
            Run::ErrorArithmetic(message, _) => Self::here(lower_first(message)),
            Run::ErrorTooManyOperations(_) | Run::ErrorTerminated(..) => Self::endless(purpose),
            Run::ErrorStackOverflow(_) => Self::with_help(
                "functions call each other too deep",
                format!("more than {} calls deep", limits::CALLS).as_str(),
                "does a function call itself without end? Use a loop",
            ),
            Run::ErrorTooManyVariables(_) => Self::too_many_variables(),
            Run::ErrorDataTooLarge(what, _) => Self::too_large(what),
            Run::ErrorMismatchDataType(expected, found, _) => {
                Self::expected(type_name(expected), type_name(found))
            }
            Run::ErrorIndexingType(..) => Self::with_help(
                "this has no parts to choose from by an index",
                "has no parts",
                "lists have, as list[0], and maps, as map[\"name\"]",
            ),
            Run::ErrorArrayBounds(0, ..) => Self::with_help(
                "the list is empty",
                "outside the list",
                "len(list) says how many values there are",
            ),
            Run::ErrorArrayBounds(length, index, _) => Self::with_help(
                format!("there is no value {index} in a list of {length}"),
                "outside the list",
                format!("values are counted from 0: the last is {}", length - 1),
            ),
            Run::ErrorStringBounds(length, index, _) => Self::with_help(
                format!("there is no character {index} in a text of {length}"),
                "outside the text",
                "characters are counted from 0",
            ),
            Run::ErrorFor(_) => Self::with_help(
                "a loop needs a range or a list",
                "neither",
                "write `for i in 0..10 { .. }`; the ends of a range are whole numbers, as floor(x) gives them",
            ),
            Run::ErrorAssignmentToConstant(name, _) => Self::constant(name),
            Run::ErrorNonPureMethodCallOnConstant(name, _) => Self::with_help(
                format!("`{}` cannot change this", shortened(name)),
                "given from outside, or a constant",
                "use a variable of your own: `let x = ..;`",
            ),
            Run::ErrorPropertyNotFound(name, _) => Self::with_help(
                format!("the map has no `{}`", shortened(name)),
                "not in the map",
                "keys(map) lists what it has, and contains(map, \"name\") says whether it has a name",
            ),
            Run::ErrorDotExpr(message, _) => Self::with_help(
                property_message(message),
                "not here",
                "maps have values with names; a function is called as f(x)",
            ),
            Run::ErrorBitFieldBounds(_, index, _) => Self::with_help(
                format!("a whole number has no bit {index}"),
                "outside the number",
                "bits are counted from 0 to 63",
            ),
            Run::ErrorRuntime(value, _) if value.is_unit() => {
                Self::here("the script stops itself by `throw`")
            }
            Run::ErrorRuntime(value, _) => Self::here(shortened(&value.to_string())),
            other => Self::here(lower_first(other.to_string().split(" (line").next().unwrap_or_default())),
        }
    }

    fn too_many_variables() -> Self {
        Self::with_help(
            "too many variables",
            "one too many",
            format!("there can be {} at a time; a list or a map holds several values", limits::VARIABLES),
        )
    }

    fn endless(purpose: Purpose) -> Self {
        let help = match purpose {
            Purpose::Drive => {
                "does a loop never end? What is the same in every frame can be written as keys".to_owned()
            }
            Purpose::Spawn => format!(
                "does a loop never end? There are {} operations, and {} more for each entity, {} at most",
                limits::SPAWNING_OPERATIONS,
                limits::OPERATIONS_PER_ENTITY,
                limits::MOST_SPAWNING_OPERATIONS
            ),
        };
        Self::with_help("this takes too long", "still running here", help)
    }

    /// Describes an error about a function that does not take the given values.
    fn misfit(signature: &str) -> Self {
        let name = function_name(signature);
        let message = format!("`{}` does not take {}", shortened(name), arguments(signature));
        let range =
            name.starts_with("..").then_some("the ends of a range are whole numbers, as floor(x) gives them");
        let compared = ["<", "<=", ">", ">="]
            .contains(&name)
            .then_some("only numbers with numbers, and texts with texts");
        let help = range.or(compared).map(str::to_owned).or_else(|| usage(name));
        Self { message, label: "called with other values".to_owned(), help }
    }

    fn expected(expected: &str, found: &str) -> Self {
        let help = match expected {
            // Only indices must be whole.
            "a number" if found == "a number" => return Self::index(),
            "true or false" => "compare it, as x > 0",
            "a text" => "values of a map are chosen by their names: map.name, or map[\"name\"]",
            "a number" => "values of a list are chosen by whole numbers: list[0]",
            _ => return Self::here(format!("expected {expected}, found {found}")),
        };
        Self::with_help(format!("expected {expected}, found {found}"), "here", help)
    }

    fn index() -> Self {
        Self::with_help(
            "an index must be a whole number",
            "not whole, or too large to be",
            "values are counted from 0; floor(x) gives whole numbers up to 9007199254740992",
        )
    }

    fn constant(name: &str) -> Self {
        Self::with_help(
            format!("`{}` cannot be changed", shortened(name)),
            "given from outside, or a constant",
            "use a variable of your own: `let x = ..;`",
        )
    }

    /// Describes an error about something too large, by Rhai's name for it.
    fn too_large(what: &str) -> Self {
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

/// Cuts a long name or text of a script.
pub(super) fn shortened(text: &str) -> String {
    const MOST: usize = 80;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}..", &text[..end]),
        None => text.to_owned(),
    }
}

/// Returns the name of the function in Rhai's signature of a call.
pub(super) fn function_name(signature: &str) -> &str {
    signature.split([' ', '(']).next().unwrap_or(signature)
}

/// Lists the kinds of values in Rhai's signature of a call.
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

/// Returns the kind of value that Rhai's name of an expression stands for.
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

/// Describes an error about a property that a value does not have, from a message that names the property and then the type.
fn property_message(message: &str) -> String {
    let mut quoted = message.split('\'').skip(1).step_by(2);
    match (quoted.next(), quoted.next()) {
        (Some(name), Some(kind)) => format!("{} has no `{}`", type_name(kind), shortened(name)),
        (Some(name), None) => format!("this has no `{}`", shortened(name)),
        _ => "this has no such part".to_owned(),
    }
}

fn lower_first(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| first.to_lowercase().chain(characters).collect())
}
