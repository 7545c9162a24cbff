//! Scripts in scenes, written in the language of [`scene::language`](crate::scene::language), compiled and run with limits.
//!
//! | | |
//! |---|---|
//! | [`Language`] | compiles and runs scripts |
//! | [`ScriptContext`] | the inputs of a script: the time, its entity, other channels |
//! | [`Data`] | the result of a script; [`Notation`](crate::animation::Notation) converts it to an animated value |
//! | [`run_spawning`] | runs a script that spawns entities |
//! | [`ScriptError`] | the error of a script, with its position |
//! | [`limits`] | the limits of a script |

mod arithmetic;
mod budget;
mod builtins;
mod context;
mod data;
mod error;
mod language;
pub(crate) mod limits;
mod lists;
mod maths;
mod messages;
mod noise;
mod positions;
mod result;
mod spawning;
#[cfg(test)]
mod tests;

pub(crate) use context::{Read, ScriptContext};
pub(crate) use data::Data;
pub(crate) use error::{ScriptError, UnknownName};
pub(crate) use language::{CompiledScripts, Language, NoResult};
pub(crate) use spawning::{SpawnBudget, run_spawning};
