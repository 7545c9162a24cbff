//! The document order of shapes. It is separate from their ids, which stay valid when shapes are renumbered.

use crate::trace::rays::ShapeId;

/// The order of a scene's shapes in its document. Of coincident surfaces, the first is visible.
///
/// Until shapes are renumbered, it is the order of their ids, and nothing is stored.
#[derive(Clone, Debug, Default)]
pub(crate) struct DocumentOrder {
    /// By id.
    ranks: Vec<Rank>,
    /// By rank.
    ids: Vec<ShapeId>,
}

/// Index of a shape in the document, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Rank(u32);

impl Rank {
    /// Returns the index.
    pub(crate) fn number(self) -> u32 {
        self.0
    }
}

impl DocumentOrder {
    /// Appends the next shapes.
    pub(super) fn extend(&mut self, ids: impl IntoIterator<Item = ShapeId>) {
        if self.ids.is_empty() {
            return;
        }
        for id in ids {
            assert_eq!(id.index(), self.ids.len(), "ids are given in turn");
            self.ranks.push(Rank(id.0));
            self.ids.push(id);
        }
    }

    /// Removes all shapes.
    pub(super) fn clear(&mut self) {
        self.ranks.clear();
        self.ids.clear();
    }

    /// Sets another order of `count` shapes.
    ///
    /// # Panics
    ///
    /// Unless it has every shape once.
    pub(super) fn renumber(&mut self, count: usize, ids: &[ShapeId]) {
        assert_eq!(ids.len(), count, "an order has every shape once");
        let mut ranks = vec![None; ids.len()];
        for (rank, id) in (0..).map(Rank).zip(ids) {
            ranks[id.index()] = Some(rank);
        }
        let ranks: Option<Vec<Rank>> = ranks.into_iter().collect();
        *self = Self { ranks: ranks.expect("an order has every shape once"), ids: ids.to_vec() };
    }

    /// Returns the rank of a shape.
    #[inline]
    pub(crate) fn rank(&self, id: ShapeId) -> Rank {
        self.ranks.get(id.index()).copied().unwrap_or(Rank(id.0))
    }

    /// Returns the shape with a rank, from 0.
    pub(super) fn shape_at(&self, rank: u32) -> ShapeId {
        self.ids.get(rank as usize).copied().unwrap_or(ShapeId(rank))
    }
}
