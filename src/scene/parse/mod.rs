//! From a text to a document, with diagnostics for texts that are not scenes.
//!
//! Long lists of entities are read on all threads, by `in_parts`, and what is written plainly in a quick way, by `plain`.
//!
//! The parser reports that it expected an identifier, and the place where it noticed. What people need is what they could have
//! written, and the place where it is missing. So a text that is refused is read once more, along a `trail` that records what is
//! asked for; `around` finds the tokens at the place, `wanted` describes what was asked for, with `examples` of its forms, and
//! `explain` puts it all together.

mod around;
mod characters;
mod examples;
mod explain;
mod in_parts;
mod plain;
mod read;
mod trail;
mod wanted;
mod whole;

pub(super) use read::{parse, read};
#[cfg(test)]
pub(super) use whole::options;
