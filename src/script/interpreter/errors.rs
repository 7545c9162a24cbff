//! Script errors from those of Rhai.

use rhai::{EvalAltResult, ParseError, ParseErrorType, Position};

use super::builtins::{KnownFunctions, Purpose};
use super::messages::{Message, function_name, shortened};
use super::positions::span_of;
use super::{ScriptError, UnknownName, limits};

impl ScriptError {
    pub(super) fn parsing(text: &str, error: &ParseError, purpose: Purpose) -> Self {
        let cause = Message::of_parsing(error.err_type());
        match error.err_type() {
            ParseErrorType::VariableUndefined(name) => {
                Self::unknown_variable(text, name, error.position(), purpose)
            }
            ParseErrorType::Reserved(word) if purpose.elsewhere(word).is_some() => {
                let help = purpose.elsewhere(word).map(str::to_owned);
                Self::at(text, error.position(), Message { help, ..cause })
            }
            _ => Self::at(text, error.position(), cause),
        }
    }

    pub(super) fn running(text: &str, error: &EvalAltResult, known: &KnownFunctions<'_>) -> Self {
        let error = innermost(error);
        match error {
            EvalAltResult::ErrorFunctionNotFound(signature, position)
                if signature.starts_with(char::is_alphabetic) && !known.has(function_name(signature)) =>
            {
                Self::unknown_function(text, function_name(signature), *position, known)
            }
            EvalAltResult::ErrorVariableNotFound(name, position) => {
                Self::unknown_variable(text, name, *position, known.purpose)
            }
            _ => Self::at(text, error.position(), Message::of_running(error, known.purpose)),
        }
    }

    pub(super) fn unknown_function(
        text: &str,
        name: &str,
        position: Position,
        known: &KnownFunctions<'_>,
    ) -> Self {
        let names = known.names().map(str::to_owned).collect();
        let unknown = UnknownName { name: name.to_owned(), kind: "functions", known: names };
        let message = format!("there is no function `{}`", shortened(name));
        Self::unknown(text, position, message, unknown, known.purpose)
    }

    fn unknown_variable(text: &str, name: &str, position: Position, purpose: Purpose) -> Self {
        let known = purpose.variables().map(str::to_owned).collect();
        let unknown = UnknownName { name: name.to_owned(), kind: "names", known };
        Self::unknown(text, position, format!("nothing is called `{}`", shortened(name)), unknown, purpose)
    }

    /// Creates the error for an unknown name. If scripts with the other purpose know the name, the message states this and lists no known
    /// names.
    fn unknown(
        text: &str,
        position: Position,
        message: String,
        unknown: UnknownName,
        purpose: Purpose,
    ) -> Self {
        let help = purpose.elsewhere(&unknown.name).map(str::to_owned);
        let unknown = help.is_none().then(|| unknown.into());
        let label = "not known here".to_owned();
        Self { unknown, ..Self::at(text, position, Message { message, label, help }) }
    }

    pub(super) fn long_call(text: &str, name: &str, position: Position) -> Self {
        let cause = Message::with_help(
            format!("`{}` is called with too many values", shortened(name)),
            "too many",
            format!("a function takes at most {}; a list holds more", limits::ARGUMENTS),
        );
        Self::at(text, position, cause)
    }

    pub(super) fn endless_number(text: &str, position: Position) -> Self {
        let help = "numbers reach to about 1.8e308";
        Self::at(text, position, Message::with_help("this number is too large", "beyond all numbers", help))
    }

    fn at(text: &str, position: Position, cause: Message) -> Self {
        let Message { message, label, help } = cause;
        let (message, help) = match message.split_once('\n') {
            Some((message, help)) => (message.to_owned(), Some(help.to_owned())),
            None => (message, help),
        };
        Self { message, label, help, unknown: None, span: span_of(text, position) }
    }
}

/// Returns the innermost error that has a position.
fn innermost(error: &EvalAltResult) -> &EvalAltResult {
    match error {
        EvalAltResult::ErrorInFunctionCall(_, _, inner, _) if inner.position() != Position::NONE => {
            innermost(inner)
        }
        error => error,
    }
}
