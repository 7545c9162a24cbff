//! The spans of entities in a text.

use std::ops::Range;
use std::sync::Arc;

use crate::scene::document::{EntityDocument, SceneDocument};
use crate::scene::spans::{list_items, list_of};

/// The list of entities in a text.
#[derive(Debug)]
pub(super) struct List {
    /// The span of its content.
    pub(super) content: Range<usize>,
    pub(super) items: Vec<Range<usize>>,
}

impl List {
    pub(super) fn of(text: &str, entities: &[Arc<EntityDocument>]) -> Option<Self> {
        let start = list_of(text, SceneDocument::ENTITIES)?;
        let (items, end) = list_items(text, start);
        Some(Self { content: start..end, items }).filter(|list| list.are(entities, text))
    }

    /// Returns whether the items can be these entities: their number is equal, each item ends with `)`, and `]` follows the list.
    pub(super) fn are(&self, entities: &[Arc<EntityDocument>], text: &str) -> bool {
        let is_in_brackets =
            |item: &Range<usize>| text.get(item.clone()).is_some_and(|item| item.ends_with(')'));
        text.as_bytes().get(self.content.end) == Some(&b']')
            && self.items.len() == entities.len()
            && self.items.iter().all(is_in_brackets)
    }
}
