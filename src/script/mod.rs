//! Programs in scenes: the language of [`scene::language`](crate::scene::language), compiled and run within limits.
//!
//! | | |
//! |---|---|
//! | [`Language`] | compiles and runs programs |
//! | [`ScriptContext`] | the values that a program can read: the time, its entity, other channels |
//! | [`Data`] | the result of a program; [`Notation`](crate::animation::Notation) makes an animated value of it |
//! | [`run_spawning`] | runs a program that spawns |
//! | [`ScriptError`] | the error of a program, with its place |
//! | [`limits`] | the limits of a program |

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
pub(crate) use language::{Language, Programs, Stop};
pub(crate) use spawning::{SpawnBudget, run_spawning};
