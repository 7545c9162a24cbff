//! Messages for run-time errors.

use rhai::EvalAltResult;

use super::message::{Message, function_name, lower_first, shortened, type_name};
use crate::script::interpreter::builtins::{Purpose, usage};
use crate::script::limits;

impl Message {
    /// Returns the message for a run-time error.
    pub(in crate::script) fn of_running(error: &EvalAltResult, purpose: Purpose) -> Self {
        Self::of_bounds(error, purpose)
            .or_else(|| Self::of_parts(error))
            .or_else(|| Self::of_calls(error))
            .unwrap_or_else(|| {
                let message = error.to_string();
                Self::here(lower_first(message.split(" (line").next().unwrap_or_default()))
            })
    }

    /// Returns the message for an exceeded limit.
    fn of_bounds(error: &EvalAltResult, purpose: Purpose) -> Option<Self> {
        use EvalAltResult as Run;
        Some(match error {
            Run::ErrorTooManyOperations(_) | Run::ErrorTerminated(..) => Self::endless(purpose),
            Run::ErrorStackOverflow(_) => Self::with_help(
                "functions call each other too deep",
                format!("more than {} calls deep", limits::CALLS).as_str(),
                "does a function call itself without end? Use a loop",
            ),
            Run::ErrorTooManyVariables(_) => Self::too_many_variables(),
            Run::ErrorDataTooLarge(what, _) => Self::too_large(what),
            _ => return None,
        })
    }

    /// Returns the message for a missing element or property.
    fn of_parts(error: &EvalAltResult) -> Option<Self> {
        use EvalAltResult as Run;
        Some(match error {
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
            _ => return None,
        })
    }

    /// Returns the message for an invalid call, loop, assignment or operation, or for a thrown value.
    fn of_calls(error: &EvalAltResult) -> Option<Self> {
        use EvalAltResult as Run;
        Some(match error {
            Run::ErrorFunctionNotFound(signature, _) => Self::misfit(signature),
            Run::ErrorArithmetic(message, _) => Self::here(lower_first(message)),
            Run::ErrorMismatchDataType(expected, found, _) => {
                Self::expected(type_name(expected), type_name(found))
            }
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
            Run::ErrorRuntime(value, _) if value.is_unit() => {
                Self::here("the script stops itself by `throw`")
            }
            Run::ErrorRuntime(value, _) => Self::here(shortened(&value.to_string())),
            _ => return None,
        })
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

    /// Returns the message for a function that does not accept the types of its arguments.
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
}

/// Lists the kinds of the arguments in Rhai's signature of a call.
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

/// Returns the message for a missing property. Rhai's message quotes the property and then the type of the value.
fn property_message(message: &str) -> String {
    let mut quoted = message.split('\'').skip(1).step_by(2);
    match (quoted.next(), quoted.next()) {
        (Some(name), Some(kind)) => format!("{} has no `{}`", type_name(kind), shortened(name)),
        (Some(name), None) => format!("this has no `{}`", shortened(name)),
        _ => "this has no such part".to_owned(),
    }
}
