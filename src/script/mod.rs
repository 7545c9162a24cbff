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
//!
//! `interpreter` holds the language, on Rhai. Without the feature `script`, `rejection` replaces it: every script is then an error.

mod compiled;
mod data;
mod error;
#[cfg(feature = "script")]
mod interpreter;
pub(crate) mod limits;
mod no_result;
#[cfg(not(feature = "script"))]
mod rejection;
mod spawned;

pub(crate) use compiled::CompiledScripts;
pub(crate) use data::Data;
pub(crate) use error::{ScriptError, UnknownName};
#[cfg(feature = "script")]
pub(crate) use interpreter::{Language, Script, ScriptContext, run_spawning};
pub(crate) use no_result::{NoResult, Read};
#[cfg(not(feature = "script"))]
pub(crate) use rejection::{
    NoContext as ScriptContext, NoLanguage as Language, NoScript as Script, run_spawning,
};
pub(crate) use spawned::{SpawnBudget, Spawned};
