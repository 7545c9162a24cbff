//! How a text differs from the one before it.

use std::ops::Range;
use std::sync::Arc;

use super::list::List;
use crate::scene::document::{EntityDocument, SceneDocument};
use crate::scene::spans::{list_items, list_of};

/// The name of an entity that stands for those that are taken over.
const MARK: &str = "those that are written as before";

/// What of a new text must be parsed, and which entities of the old one are taken over.
#[derive(Debug)]
pub(super) struct Change {
    /// The content of the list's brackets in the new text.
    content: Range<usize>,
    /// The number of entities before the change that are as before.
    pub(super) first: usize,
    /// The index of the first entity that is taken over after the change; that of the list's end if there is none.
    pub(super) next: usize,
    /// The part of the new list that is parsed: the change, and its neighbours.
    parsed: Range<usize>,
    /// Where the neighbour before the change ends, or the list begins.
    from: usize,
    /// Where the entities that are taken over end, in the new text.
    rest: usize,
    /// Whether there is an entity after the change that lies whole within the common end.
    is_cut: bool,
    /// The lengths of the texts, before and after.
    lengths: (usize, usize),
}

impl Change {
    /// Finds the change between two texts, of which the first has this list. `None` if it is not confined to what is before the
    /// list, in it or after it.
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

        // An item ends with a bracket, whatever follows. Before one there must be the same sign as there was.
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

    /// Returns the new text with marks in the places of entities that are taken over. `None` if a name in the change might be
    /// that of the marks, as written or by an escape.
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

    /// Returns the entities that were parsed, without the marks and without the neighbour before the change. `None` if the
    /// marks are not where they were put: what was written may have swallowed the start of a neighbour, or all of it, but then
    /// the mark as well.
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

    /// Returns the places of the entities in the new text, by those in the old one.
    pub(super) fn list(&self, text: &str, List { items, .. }: &List) -> Option<List> {
        let found = list_items(text.get(..self.parsed.end)?, self.from).0;
        let moved = |at: usize| moved(at, self.lengths);
        let after = items[self.next..].iter().map(|item| moved(item.start)..moved(item.end));
        let items = items[..self.first].iter().cloned().chain(found).chain(after).collect();
        Some(List { content: self.content.clone(), items })
    }
}

/// Returns where a byte of the common end is in the new text.
fn moved(at: usize, (old, new): (usize, usize)) -> usize {
    at + new - old
}

/// Returns the lengths of the common start and the common end of two texts, which do not overlap.
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
