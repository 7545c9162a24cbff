//! Parsing of the entities of a scene: each from its own text, on all threads, and after an edit only those that it touches.
//!
//! Most of a long scene is its list `entities`. Each entity is parsed as a RON value of its own, and the rest of the text as a scene
//! without entities:
//!
//! ```text
//! text      Scene(.. entities: [ a, b, c ], ..)
//! parsed    Scene(.. entities: [], ..)    a    b    c
//! ```
//!
//! [`ParsedEntities`] keeps a text with its entities. Entities that lie entirely in the common prefix or the common suffix of this text and
//! the next one are reused, and so is the scene without entities if the rest of the text is the same. All else is parsed.
//!
//! # Correctness
//!
//! 1. The meaning of an entity depends on its own text alone: RON has no references, and no list is found in a scene with extensions
//!    (`#![enable(..)]`), which could change the meaning of a text.
//! 2. The scanner of `spans` divides a valid text into the same values as the parser. If the parser accepts the rest, the list is therefore
//!    where the scanner found it. The content of the list is exactly entities, all of which the parser accepts, and commas between them.
//! 3. A long list is read in parts that begin at guessed places. The end of an entity and the start of the next one depend only on the
//!    text from the entity's start. Parts that join without a gap are therefore equal to a list that is read from its start; a part that begins at a
//!    wrong place is read again, from the end of the preceding part.
//! 4. An entity ends with its bracket. An entity in the common prefix is reused if the list starts at the same place; the entities in the
//!    common suffix are reused if the entities before them end exactly where these begin.
//! 5. Entity documents are shared and never changed. Scripts add spawned entities to the document, not to the entities that are kept here.
//!
//! If anything else is found, the whole text is parsed, so that error messages always come from a parse of the whole text. The document parsed last
//! is kept with its text.

#[cfg(test)]
mod tests;

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::fast_path::read_plain;
use super::general_parser::{options, read_general};
use crate::scene::document::{EntityDocument, SceneDocument};
use crate::scene::spans::{first_item, list_of, next_item, value_end};

/// The approximate length of a part of a list in bytes. A part takes some 50 us, as long as waking a thread; parts of 64 KiB are too few
/// for a scene of 300 KB.
pub(super) const PART: usize = 1 << 13;

/// The entities of a text, for parsing a later version of the text.
#[derive(Debug, Default)]
pub(in crate::scene) struct ParsedEntities {
    text: Arc<String>,
    /// The byte offset of the list's content.
    start: usize,
    list: EntityList,
    rest: Option<Arc<ParsedText>>,
}

/// A text that was parsed as a whole, such as that of a scene without its entities, and its document.
#[derive(Debug)]
struct ParsedText {
    text: String,
    document: SceneDocument,
}

/// Successive entities with their spans.
#[derive(Debug, Default)]
struct EntityList {
    documents: Vec<Arc<EntityDocument>>,
    spans: Vec<Range<usize>>,
    /// The byte offset of the next entity, or of the closing bracket of the list.
    end: usize,
}

impl ParsedEntities {
    /// Parses another text, in parts of about `part` bytes. Its entities then replace these. `None` if the text must be parsed as a whole;
    /// these entities are then unchanged.
    pub(super) fn parse_next(&mut self, text: &Arc<String>, part: usize) -> Option<SceneDocument> {
        let (head, tail) = same_ends(&self.text, text);
        let moved = |at: usize| at + text.len() - self.text.len();
        let spans = &self.list.spans;
        let first = spans.partition_point(|span| span.end <= head);
        let next = spans.partition_point(|span| self.text.len() - span.start > tail);
        let start = if first > 0 { self.start } else { list_of(text, SceneDocument::ENTITIES)? };
        let from = match spans[..first].last() {
            Some(last) => next_item(text, last.end)?,
            None => first_item(text, start),
        };
        let (until, guessed_end) = match spans.get(next) {
            Some(span) => (moved(span.start), moved(self.list.end)),
            None => (text.len(), from + text[from..].find(']')?),
        };
        let starts = starts_of_parts(text, from..guessed_end.min(until), part);
        let rest = |end: usize| self.read_unless_same(format!("{}{}", &text[..start], &text[end..])).ok();
        let read = || EntityList::read_parts(text, &starts, until);
        let (read, guessed_rest) = match starts.len() {
            1 => (read(), rest(guessed_end)),
            _ => rayon::join(read, || rest(guessed_end)),
        };
        let mut read = read?;
        let next = if read.end == until {
            next
        } else {
            // The change reaches the end of the list, or the start of the entities after it.
            read.append(EntityList::read(text, read.end, text.len())?);
            spans.len()
        };
        let end = if next < spans.len() { guessed_end } else { read.end };
        if text.as_bytes().get(end) != Some(&b']') {
            return None;
        }
        let rest = if end == guessed_end { guessed_rest? } else { rest(end)? };

        let unmoved = first + read.spans.len();
        self.list.documents.splice(first..next, read.documents);
        self.list.spans.splice(first..next, read.spans);
        for span in &mut self.list.spans[unmoved..] {
            *span = moved(span.start)..moved(span.end);
        }
        self.list.end = end;
        (self.start, self.text) = (start, Arc::clone(text));
        let rest = self.rest.insert(rest);
        Some(SceneDocument { entities: self.list.documents.clone(), ..rest.document.clone() })
    }

    /// Parses a text as a whole, and keeps its document.
    pub(super) fn parse_whole(&mut self, text: &str) -> ron::error::SpannedResult<SceneDocument> {
        let whole = self.read_unless_same(text.to_owned())?;
        Ok(self.rest.insert(whole).document.clone())
    }

    /// Parses a text as a whole, unless it is the same as the last one.
    fn read_unless_same(&self, text: String) -> ron::error::SpannedResult<Arc<ParsedText>> {
        if let Some(rest) = self.rest.as_ref().filter(|rest| rest.text == text) {
            return Ok(Arc::clone(rest));
        }
        let document = read_general(&text)?;
        Ok(Arc::new(ParsedText { text, document }))
    }
}

impl EntityList {
    /// Reads the entities from the first start until a byte offset. `None` if any text is not an entity.
    fn read_parts(text: &str, starts: &[usize], until: usize) -> Option<Self> {
        let end = |part: usize| starts.get(part + 1).copied().unwrap_or(until);
        if let [start] = starts {
            return Self::read(text, *start, until);
        }
        let read = |(part, start): (usize, &usize)| Self::read(text, *start, end(part));
        let parts: Vec<Option<Self>> = starts.par_iter().enumerate().map(read).collect();
        let mut all = Self { end: *starts.first()?, ..Self::default() };
        for (part, (start, read)) in starts.iter().zip(parts).enumerate() {
            let is_guessed_right = *start == all.end;
            all.append(if is_guessed_right { read? } else { Self::read(text, all.end, end(part))? });
        }
        Some(all)
    }

    /// Reads the entities that start from `start` until a byte offset or the end of the list. `start` is the start of an entity, or the end
    /// of the list.
    fn read(text: &str, start: usize, until: usize) -> Option<Self> {
        let mut read = Self { end: start, ..Self::default() };
        while read.end < until && text.as_bytes()[read.end] != b']' {
            let start = read.end;
            let (document, end) = read_plain(text, start).ok().or_else(|| {
                let end = value_end(text, start);
                let entity = text[start..end].ends_with(')').then(|| options().from_str(&text[start..end]));
                Some((entity?.ok()?, end))
            })?;
            read.documents.push(document);
            read.spans.push(start..end);
            read.end = next_item(text, end)?;
        }
        Some(read)
    }

    fn append(&mut self, mut next: Self) {
        self.documents.append(&mut next.documents);
        self.spans.append(&mut next.spans);
        self.end = next.end;
    }
}

/// Returns the start of a range, and guesses the start of an entity in each part of it: an opening bracket after `),`.
fn starts_of_parts(text: &str, range: Range<usize>, part: usize) -> Vec<usize> {
    let guess = |from: usize| {
        let near = text.floor_char_boundary(from)..text.floor_char_boundary(range.end.min(from + part));
        let mut ends = text[near.clone()].match_indices("),");
        ends.find_map(|(end, _)| {
            next_item(text, near.start + end + 1).filter(|at| text[*at..].starts_with('('))
        })
    };
    let others = range.clone().step_by(part).skip(1).filter_map(guess).filter(|start| *start < range.end);
    let mut starts: Vec<usize> = std::iter::once(range.start).chain(others).collect();
    starts.dedup();
    starts
}

/// Returns the lengths of the common prefix and the common suffix of two texts. They do not overlap.
fn same_ends(old: &str, new: &str) -> (usize, usize) {
    /// The number of bytes compared at once.
    const BLOCK: usize = 4096;
    let (old, new) = (old.as_bytes(), new.as_bytes());
    let blocks = old.chunks_exact(BLOCK).zip(new.chunks_exact(BLOCK));
    let head = BLOCK * blocks.take_while(|(old, new)| old == new).count();
    let rest = old[head..].iter().zip(&new[head..]);
    let head = head + rest.take_while(|(old, new)| old == new).count();

    let (old, new) = (&old[head..], &new[head..]);
    let blocks = old.rchunks_exact(BLOCK).zip(new.rchunks_exact(BLOCK));
    let tail = BLOCK * blocks.take_while(|(old, new)| old == new).count();
    let rest = old[..old.len() - tail].iter().rev().zip(new[..new.len() - tail].iter().rev());
    (head, tail + rest.take_while(|(old, new)| old == new).count())
}
