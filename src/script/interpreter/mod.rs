//! The scripting language on Rhai: compilation, execution, functions, limits and error messages.

mod arithmetic;
mod budget;
mod builtins;
mod context;
mod dynamic;
mod errors;
mod language;
mod lists;
mod maths;
mod messages;
mod noise;
mod positions;
mod result;
mod spawning;
#[cfg(test)]
mod tests;

pub(crate) use context::ScriptContext;
pub(crate) use language::{Language, Script};
pub(crate) use spawning::run_spawning;

use super::error::text_span;
use super::{Data, NoResult, Read, ScriptError, SpawnBudget, Spawned, UnknownName, limits};
