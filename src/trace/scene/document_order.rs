//! Which shape comes first in the document: a key beside ids, which go on meaning the same shapes when it is renumbered.

use crate::trace::rays::ShapeId;

/// The order of a scene's shapes in its document. Of surfaces in the same place the first is seen.
#[derive(Clone, Debug, Default)]
pub(crate) struct DocumentOrder {
    /// By id.
    ranks: Vec<Rank>,
    /// By rank.
    ids: Vec<ShapeId>,
}

/// A shape's place in the document, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Rank(u32);

impl DocumentOrder {
    /// Adds the next shape, after all others.
    pub(super) fn push(&mut self, id: ShapeId) {
        self.extend([id]);
    }

    /// Adds the next shapes, after all others.
    pub(super) fn extend(&mut self, ids: impl IntoIterator<Item = ShapeId, IntoIter: Clone>) {
        let ids = ids.into_iter();
        self.ranks.extend(ids.clone().map(|id| Rank(id.0)));
        self.ids.extend(ids);
        debug_assert_eq!(
            self.ids.last().map_or(0, |id| id.index() + 1),
            self.ids.len(),
            "ids are given in turn"
        );
    }

    /// Removes all.
    pub(super) fn clear(&mut self) {
        self.ranks.clear();
        self.ids.clear();
    }

    /// Puts the shapes into another order.
    ///
    /// # Panics
    ///
    /// Unless it has every shape once.
    pub(super) fn renumber(&mut self, ids: &[ShapeId]) {
        assert_eq!(ids.len(), self.ids.len(), "an order has every shape once");
        let mut ranks = vec![None; ids.len()];
        for (rank, id) in (0..).map(Rank).zip(ids) {
            ranks[id.index()] = Some(rank);
        }
        let ranks: Option<Vec<Rank>> = ranks.into_iter().collect();
        *self = Self { ranks: ranks.expect("an order has every shape once"), ids: ids.to_vec() };
    }

    /// Returns a shape's place.
    #[inline]
    pub(crate) fn rank(&self, id: ShapeId) -> Rank {
        self.ranks[id.index()]
    }

    /// Returns all shapes, the first of the document first.
    pub(crate) fn ids(&self) -> &[ShapeId] {
        &self.ids
    }
}
