//! The quick path: a text that differs little from one that was parsed before is parsed only where it differs.
//!
//! # What it does
//!
//! Most of a long scene is its list `entities`. [`Parsed`] keeps a text, the entities that it was parsed to and, once they have
//! been looked up, the places of these entities in the text. For another text it finds the longest common start and the longest
//! common end of the two: what lies between them is the change. Entities that lie whole in the common start or in the common
//! end are taken over by their `Arc`, but for the first one after the change. All else is parsed, by the parser that reads
//! every scene and with the same options: it is given the text with marks, which are entities of a name of their own, in the
//! places of those that are taken over.
//!
//! ```text
//! before    Scene(.. entities: [ a, b, c,    d, e, f ], ..)
//! now       Scene(.. entities: [ a, b, c, x, d, e, f ], ..)
//! parsed    Scene(.. entities: [ mark, c, x, d, mark ], ..)
//! kept                           a, b, c        e, f
//! ```
//!
//! The neighbours of the change, `c` and `d`, are parsed along with it, so that every new token stands beside the same tokens
//! as in the whole text. The entity before the change is kept all the same; the one after it is the new one. The first mark is
//! always there, the second only if an entity lies in the common end.
//!
//! # When it is taken
//!
//! Only a [`Reader`](crate::scene::Reader) takes it, for each file of a scene by itself, once the file has been parsed.
//! `Scene::load` and its kin parse whole texts. A text that is refused is not kept: the next one is compared with the last good
//! one.
//!
//! # Why the result is that of a parse of the whole
//!
//! 1. What an entity means depends on its own text alone: RON has no references, and a scene with extensions
//!    (`#![enable(..)]`), which could change the meaning of a text, is always parsed as a whole.
//! 2. An entity is taken over only if all its bytes are the same. Before the change, it ends with a bracket, which ends a value
//!    whatever follows; after the change, the byte before it is the same too, so that nothing new has joined its first token.
//! 3. The places of entities are found by the scanner of `spans`, which is simpler than the parser and may misread odd texts.
//!    They are believed only if there are as many as the parser found, each ends with `)`, and `]` follows the last.
//! 4. The list is where it is taken to be, and the change neither opens a comment or a text that swallows what follows nor
//!    closes the list early: otherwise the parser would not find the marks as the first and the last of the entities. Without a
//!    second mark nothing after the change is taken over, and the parser reads the text to its end as it is.
//! 5. Entity documents are shared and never changed. Scripts add what they spawn to the document, not to the entities that are
//!    kept here.
//!
//! # What makes it fall back
//!
//! [`Parsed::parse_again`] returns `None`, and the whole text is parsed, if
//!
//! - the text from before has extensions, or no list that can be believed (3);
//! - the closing bracket of the list lies neither in the common start nor in the common end;
//! - the change begins before the list, and the new text has extensions, no list, or a list that begins only after what would
//!   be parsed;
//! - a name in the change might be that of the marks: it is written there, or a backslash, which may stand for any letter;
//! - the parser refuses the text with the marks: messages about mistakes always come from a parse of the whole;
//! - the marks are not the first and the last of what was parsed (4).
//!
//! # What holds it
//!
//! - `what_is_parsed_again_is_what_a_parse_of_the_whole_gives` compares 6000 sequences of random edits with parses of the
//!   whole, to the signs of zeros. What is put in is meant to confuse: brackets, quotes, ends of comments, a second list. At
//!   least seven in ten of the good texts must have taken the quick path.
//! - `what_looks_like_another_thing_is_not_taken_for_it` holds pairs of texts that would deceive a rule less.
//! - `only_what_an_edit_touches_is_other_than_before` says which entities are taken over.
//! - `any_edits_lead_to_where_a_cold_start_does`, in `tests/engine/reload`, edits random scenes of several files under one
//!   `Reader`: worlds, pictures and messages are those of a cold start. `tests/endurance.rs` compares pictures with a cold
//!   start's in a long session.

mod change;
mod list;
mod parsed;
#[cfg(test)]
mod tests;

pub(super) use parsed::Parsed;
