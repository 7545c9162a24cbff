//! Parsing of texts to documents, with diagnostics for invalid texts.
//!
//! `entities` parses each entity of a scene on its own, on all threads, and only the edited ones of a text that was parsed before.
//! `fast_path` is a parser for a simple subset of RON.
//!
//! The RON parser reports, for example, that it expected an identifier, and the position where it stopped. A useful message names the valid
//! alternatives, and the position where something is missing. A rejected text is therefore parsed once more with a `Trail`, which records
//! the requested values. `token_context` finds the tokens at the error, `expected` describes the expected value, with `examples` of its
//! forms, and `explain` builds the diagnostic, with `foreign` for names from other programs. `recover` goes on to the next mistake.
//!
//! `pending` finds the values that are expected where a text ends, for editors and for the schema.

mod characters;
mod entities;
mod examples;
mod expectations;
mod expected;
mod explain;
mod fast_path;
mod foreign;
mod general_parser;
mod pending;
mod read;
mod recover;
mod token_context;

pub(super) use entities::ParsedEntities;
pub(super) use examples::form_of;
pub(super) use expectations::{Expectation, VariantContent};
#[cfg(test)]
pub(super) use general_parser::options;
pub(super) use pending::{FieldOwner, depth_of, missing, owner, pending, reads};
pub(super) use read::{check_notation, parse};
