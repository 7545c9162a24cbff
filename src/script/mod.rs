//! Scripts in scenes: the language of [`scene::language`](crate::scene::language), compiled and run within limits.
//!
//! | | |
//! |---|---|
//! | [`Language`] | compiles and runs scripts |
//! | [`ScriptContext`] | the values that a script can read: the time, its entity, other channels |
//! | [`Data`] | the result of a script; [`Notation`](crate::animation::Notation) makes an animated value of it |
//! | [`run_spawning`] | runs a script that spawns |
//! | [`ScriptError`] | the error of a script, with its place |
//! | [`limits`] | the limits of a script |

mod arithmetic;
mod context;
mod data;
mod error;
mod language;
pub(crate) mod limits;
mod lists;
mod maths;
mod noise;
mod outcome;
mod positions;
mod spawning;
#[cfg(test)]
mod tests;
mod vocabulary;
mod wording;
mod work;

pub(crate) use context::{Read, ScriptContext};
pub(crate) use data::Data;
pub(crate) use error::{ScriptError, Unknown};
pub(crate) use language::{CompiledScripts, Language, Stop};
pub(crate) use spawning::{SpawnBudget, run_spawning};
