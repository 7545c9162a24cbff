//! Incremental parsing: a text that differs little from the previous one is parsed only where it differs.
//!
//! # Algorithm
//!
//! Most of a long scene is its list `entities`. [`Parsed`] keeps a text, its parsed entities and, once they have been located, the spans of
//! these entities. For a new text it finds the longest common prefix and the longest common suffix of the two texts; the text between them
//! is the change. Entities that lie entirely in the common prefix or in the common suffix are reused by their `Arc`, except the first one
//! after the change. The rest is parsed by the ordinary parser, with the same options. Its input is the text with marks, which are entities
//! with a reserved name, in place of the reused entities.
//!
//! ```text
//! before    Scene(.. entities: [ a, b, c,    d, e, f ], ..)
//! now       Scene(.. entities: [ a, b, c, x, d, e, f ], ..)
//! parsed    Scene(.. entities: [ mark, c, x, d, mark ], ..)
//! kept                           a, b, c        e, f
//! ```
//!
//! The neighbours of the change, `c` and `d`, are parsed along with it, so that every new token is adjacent to the same tokens as in the
//! whole text. The entity before the change is reused all the same; the one after it is the newly parsed one. The first mark is always
//! present, the second only if an entity lies in the common suffix.
//!
//! # Use
//!
//! Only a [`Reader`](crate::scene::Reader) parses incrementally, for each file of a scene separately, after the file has been parsed once.
//! `Scene::load` and related functions parse whole texts. A text that is rejected is not kept: the next text is compared with the last
//! valid one.
//!
//! # Correctness
//!
//! 1. The meaning of an entity depends on its own text alone: RON has no references, and a scene with extensions (`#![enable(..)]`), which
//!    could change the meaning of a text, is always parsed as a whole.
//! 2. An entity is reused only if all its bytes are unchanged. Before the change, it ends with a bracket, which ends a value regardless of
//!    the following text. After the change, the byte before it is unchanged too, so that no new text can join its first token.
//! 3. The scanner of `spans` locates the entities. It is simpler than the parser and may misread unusual texts. Its spans are accepted only
//!    if they are as many as the parsed entities, each ends with `)`, and `]` follows the last.
//! 4. The list is located correctly, and the change neither opens a comment or a string that swallows the following text nor closes the
//!    list early: otherwise the parser would not return the marks as the first and the last entity. Without a second mark no entity after
//!    the change is reused, and the parser reads the text to its actual end.
//! 5. Entity documents are shared and never changed. Scripts add spawned entities to the document, not to the entities that are kept here.
//!
//! # Fallbacks
//!
//! [`Parsed::parse_again`] returns `None`, and the whole text is parsed, if
//!
//! - the previous text has extensions, or its list fails the checks of (3);
//! - the closing bracket of the list lies neither in the common prefix nor in the common suffix;
//! - the change begins before the list, and the new text has extensions, no list, or a list that begins only after the range to parse;
//! - the change might contain the name of the marks, literally or by a backslash, which can escape any letter;
//! - the parser rejects the text with the marks: error messages always come from a parse of the whole text;
//! - the marks are not the first and the last of the parsed entities (4).
//!
//! # Tests
//!
//! - `what_is_parsed_again_is_what_a_parse_of_the_whole_gives` compares 6000 sequences of random edits with parses of the whole text,
//!   including the signs of zeros. The inserted pieces are adversarial: brackets, quotes, ends of comments, a second list. More than 70 %
//!   of the valid texts must be parsed incrementally.
//! - `what_looks_like_another_thing_is_not_taken_for_it` checks pairs of texts that weaker rules would misread.
//! - `only_what_an_edit_touches_is_other_than_before` checks which entities are reused.
//! - `any_edits_lead_to_where_a_cold_start_does`, in `tests/engine/reload`, edits random scenes of several files with one `Reader`, and
//!   compares worlds, pictures and messages with a cold start. `tests/endurance.rs` compares pictures with a cold start in a long session.

mod change;
mod list;
mod parsed;
#[cfg(test)]
mod tests;

pub(super) use parsed::Parsed;
