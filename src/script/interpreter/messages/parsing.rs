//! Messages for compile-time errors.

use rhai::{LexError, ParseErrorType};

use super::message::{Message, expression_kind, lower_first, shortened};
use crate::script::limits;

/// Message for a function head with too many parameters.
pub(in crate::script) const LONG_HEAD: &str = "a function of too many values";

impl Message {
    /// Returns the message for a compile-time error.
    pub(in crate::script) fn of_parsing(error: &ParseErrorType) -> Self {
        Self::of_tokens(error)
            .or_else(|| Self::of_limits(error))
            .or_else(|| Self::of_values(error))
            .or_else(|| Self::of_repetitions(error))
            .or_else(|| Self::of_places(error))
            .unwrap_or_else(|| Self::here(lower_first(&error.to_string())))
    }

    /// Returns the message for an invalid or missing token.
    fn of_tokens(error: &ParseErrorType) -> Option<Self> {
        use ParseErrorType as Parse;
        Some(match error {
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
            _ => return None,
        })
    }

    /// Returns the message for an exceeded limit.
    fn of_limits(error: &ParseErrorType) -> Option<Self> {
        use ParseErrorType as Parse;
        Some(match error {
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
            _ => return None,
        })
    }

    /// Returns the message for a value or name that is missing or of the wrong kind.
    fn of_values(error: &ParseErrorType) -> Option<Self> {
        use ParseErrorType as Parse;
        Some(match error {
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
            _ => return None,
        })
    }

    /// Returns the message for a duplicate.
    fn of_repetitions(error: &ParseErrorType) -> Option<Self> {
        use ParseErrorType as Parse;
        Some(match error {
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
            _ => return None,
        })
    }

    /// Returns the message for an incomplete or misplaced construct.
    fn of_places(error: &ParseErrorType) -> Option<Self> {
        use ParseErrorType as Parse;
        Some(match error {
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
            _ => return None,
        })
    }

    /// Returns the message for characters that form no token.
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

    /// Returns the message for a word or symbol that is not part of the language.
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

    /// Returns the message for a missing bracket or separator.
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
}
