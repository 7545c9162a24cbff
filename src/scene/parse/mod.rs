//! Parsing of texts to documents, with diagnostics for invalid texts.
//!
//! `in_parts` parses long lists of entities on all threads. `plain` is a fast path for a simple subset of RON.
//!
//! The RON parser reports, for example, that it expected an identifier, and the position where it stopped. A useful message names the valid
//! alternatives, and the position where something is missing. A rejected text is therefore parsed once more with a `trail`, which records
//! the requested values. `around` finds the tokens at the error, `wanted` describes the expected value, with `examples` of its forms, and
//! `explain` builds the diagnostic.

mod characters;
mod examples;
mod expectations;
mod expected;
mod explain;
mod fast_path;
mod parallel;
mod read;
mod token_context;
mod whole;

pub(super) use read::{parse, read};
#[cfg(test)]
pub(super) use whole::options;
