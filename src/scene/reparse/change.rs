//! The difference between two successive texts.

use std::ops::Range;
use std::sync::Arc;

use super::list::List;
use crate::scene::document::{EntityDocument, SceneDocument};
use crate::scene::spans::{list_items, list_of};

/// The name of the marks, which stand for reused entities.
const MARK: &str = "those that are written as before";

/// The part of a new text to parse, and the entities of the old text to reuse.
#[derive(Debug)]
pub(super) struct Change {
    /// The span of the list's content in the new text.
    content: Range<usize>,
    /// The number of unchanged entities before the change.
    pub(super) first: usize,
    /// The index of the first reused entity after the change; the number of entities if there is none.
    pub(super) next: usize,
    /// The span of the new text to parse: the change and its neighbours.
    parsed: Range<usize>,
    /// The end of the neighbour before the change, or the start of the list.
    from: usize,
    /// The end of the last entity in the new text, if it lies in the common suffix; otherwise the end of the list.
    rest: usize,
    /// True if an entity after the change lies entirely in the common suffix.
    is_cut: bool,
    /// The lengths of the old and the new text.
    lengths: (usize, usize),
}

impl Change {
    /// Finds the change between two texts; `list` is the list of the old one. `None` if the change includes the closing bracket of the
    /// list, or if it begins before the list and the new text has no list.
    pub(super) fn between(old: &str, new: &str, list: &List) -> Option<Self> {
        let List { content, items } = list;
        let (head, tail) = same_ends(old, new);
        let lengths = (old.len(), new.len());
        let moved = |at: usize| moved(at, lengths);
        let is_at_place = content.start <= head;
        let start = if is_at_place { content.start } else { list_of(new, SceneDocument::ENTITIES)? };
        let end = if content.end < head {
            content.end
        } else if old.len() - content.end <= tail {
            moved(content.end)
        } else {
            return None;
        };

        // An entity ends with its bracket, regardless of the following text. The byte before a reused entity must be unchanged.
        let first = if is_at_place { items.partition_point(|item| item.end <= head) } else { 0 };
        let last = items.partition_point(|item| old.len() - item.start >= tail);
        let (before, from) = match first.checked_sub(1).and_then(|before| items.get(before)) {
            Some(neighbour) => (neighbour.start, neighbour.end),
            None => (start, start),
        };
        let (until, next, rest) = match (items.get(last), items.last()) {
            (Some(neighbour), Some(item)) => (moved(neighbour.end), last + 1, moved(item.end)),
            _ => (end, last, end),
        };
        let is_cut = last < items.len();
        Some(Self { content: start..end, first, next, parsed: before..until, from, rest, is_cut, lengths })
    }

    /// Returns the new text with marks in place of the reused entities. `None` if the change might contain the name of the marks, literally
    /// or by an escape.
    pub(super) fn marked(&self, text: &str) -> Option<String> {
        let (above, below) = (text.get(..self.content.start)?, text.get(self.rest..)?);
        let change = text.get(self.parsed.clone())?;
        if change.contains(MARK) || change.contains('\\') {
            return None;
        }
        let mark = format!("(name: {MARK:?})");
        let end_mark = if self.is_cut { format!(",{mark}") } else { String::new() };
        Some(format!("{above}{mark},{change}{end_mark}{below}"))
    }

    /// Returns the parsed entities without the marks and without the neighbour before the change. `None` if the marks are not in their
    /// positions: the change may have swallowed a neighbour, in part or as a whole, but then it has swallowed the mark as well.
    pub(super) fn without_marks(
        &self,
        mut parsed: Vec<Arc<EntityDocument>>,
    ) -> Option<impl Iterator<Item = Arc<EntityDocument>> + use<>> {
        let is_mark = |entity: &Arc<EntityDocument>| entity.name.as_deref() == Some(MARK);
        let ends_marked = !self.is_cut || parsed.len() > 1 && parsed.pop().is_some_and(|last| is_mark(&last));
        if !(ends_marked && parsed.first().is_some_and(is_mark)) {
            return None;
        }
        Some(parsed.into_iter().skip(if self.first > 0 { 2 } else { 1 }))
    }

    /// Returns the spans of the entities in the new text, given the spans in the old one.
    pub(super) fn list(&self, text: &str, List { items, .. }: &List) -> Option<List> {
        let found = list_items(text.get(..self.parsed.end)?, self.from).0;
        let moved = |at: usize| moved(at, self.lengths);
        let after = items[self.next..].iter().map(|item| moved(item.start)..moved(item.end));
        let items = items[..self.first].iter().cloned().chain(found).chain(after).collect();
        Some(List { content: self.content.clone(), items })
    }
}

/// Returns the offset in the new text of a byte of the common suffix.
fn moved(at: usize, (old, new): (usize, usize)) -> usize {
    at + new - old
}

/// Returns the lengths of the common prefix and the common suffix of two texts. They do not overlap.
pub(super) fn same_ends(old: &str, new: &str) -> (usize, usize) {
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
