#![doc = include_str!("language.md")]
//!
//! # In Rust
//!
//! | | |
//! |---|---|
//! | [`Language`] | compiles and runs [programs](Program) |
//! | [`ScriptContext`] | what a program can read: the time, its entity, other channels |
//! | [`Data`] | what it gives; [`Notation`](crate::animation::Notation) makes an animated value of it |
//! | [`run_spawning`] | runs a program that spawns |
//! | [`ScriptError`] | what is wrong with a program, and where |
//! | [`limits`] | how much a program may do |

mod arithmetic;
mod context;
mod data;
mod error;
mod language;
pub mod limits;
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

pub use context::{Read, ScriptContext};
pub use data::Data;
pub use error::{ScriptError, Unknown};
pub use language::{Language, Program, Programs, Stop};
pub use spawning::{SpawnBudget, Spawned, run_spawning};
