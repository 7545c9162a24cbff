//! A parsed text as the base for incremental parsing.

use std::ops::Range;
use std::sync::Arc;

use super::change::Change;
use super::list::List;
use crate::scene::document::{EntityDocument, SceneDocument};
use crate::scene::parse::read;

/// A parsed text with its entities.
#[derive(Debug)]
pub(in crate::scene) struct Parsed {
    pub(super) text: Arc<String>,
    entities: Vec<Arc<EntityDocument>>,
    /// The spans of the entities, once they have been located.
    list: Option<List>,
}

impl Parsed {
    pub(in crate::scene) fn new(text: &Arc<String>, document: &SceneDocument) -> Self {
        Self { text: Arc::clone(text), entities: document.entities.clone(), list: None }
    }

    /// Parses another text, which then replaces this one. `None` if it must be parsed as a whole.
    pub(in crate::scene) fn parse_again(&mut self, text: &Arc<String>) -> Option<SceneDocument> {
        if self.list.is_none() {
            self.list = List::of(&self.text, &self.entities);
        }
        let list = self.list.as_ref()?;
        let change = Change::between(&self.text, text, list)?;
        let mut document = read(&change.marked(text)?).ok()?;

        let parsed = change.without_marks(std::mem::take(&mut document.entities))?;
        let kept = |range: Range<usize>| self.entities[range].iter().map(Arc::clone);
        let after = kept(change.next..list.items.len());
        document.entities = kept(0..change.first).chain(parsed).chain(after).collect();

        let list = change.list(text, list)?;
        self.list = Some(list).filter(|list| list.are(&document.entities, text));
        self.text = Arc::clone(text);
        self.entities.clone_from(&document.entities);
        Some(document)
    }
}
