//! From a text to a document, and what is wrong with a text that is none.
//!
//! The parser says that it expected an identifier, and where it was when it noticed. What people need is what they could have
//! written, and the place where it is not. So a text that is refused is read once more, along a `trail` that remembers what was
//! asked for; `around` finds the words and signs at the place, `wanted` says what was asked for, with `examples` of how it is
//! written, and `explain` puts it all together.

mod around;
mod characters;
mod examples;
mod explain;
mod read;
mod trail;
mod wanted;

#[cfg(test)]
pub(super) use read::options;
pub(super) use read::{parse, read};
