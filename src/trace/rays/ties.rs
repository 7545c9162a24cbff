//! Shapes that a ray meets at the very same place.

use std::sync::Arc;

use glam::DVec3;

use super::shape_id::ShapeId;

/// The shapes, besides the one that is seen and those that equal it, that a ray meets exactly where it meets that one, each with
/// its outward unit normal there. Of equal ones the first in document order stands for all. Mostly there are none, which costs
/// nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ties(Option<Arc<[Tie]>>);

/// One of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tie {
    pub(crate) id: ShapeId,
    pub(crate) normal: DVec3,
}

impl Ties {
    /// In any order.
    pub(crate) fn new(mut ties: Vec<Tie>) -> Self {
        if ties.is_empty() {
            return Self(None);
        }
        ties.sort_unstable_by_key(|tie| tie.id);
        Self(Some(ties.into()))
    }

    /// The shapes, in document order.
    pub fn ids(&self) -> impl Iterator<Item = ShapeId> {
        self.iter().map(|tie| tie.id)
    }

    /// The shapes with their normals, in document order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Tie> {
        self.0.iter().flat_map(|ties| ties.iter())
    }

    /// If the shape is among them: its outward normal.
    #[inline]
    pub(crate) fn normal_of(&self, id: ShapeId) -> Option<DVec3> {
        let ties = self.0.as_ref()?;
        let index = ties.binary_search_by_key(&id, |tie| tie.id).ok()?;
        Some(ties[index].normal)
    }
}
