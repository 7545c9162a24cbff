//! Shapes that a ray hits at exactly the same point.

use glam::DVec3;

use super::shape_id::ShapeId;

/// A list in [`TieLists`]: the shapes, besides the hit shape and its equals, that a ray hits at exactly the same point. Usually it is
/// empty, and costs nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct CoincidentHits {
    start: u32,
    count: u32,
}

/// A tied shape, with its outward unit normal at the point. The first in document order represents all equal shapes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tie {
    pub(crate) id: ShapeId,
    pub(crate) normal: DVec3,
}

/// The ties of the surfaces that rays hit, one list after another, so that rays and surface points own no memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct TieLists {
    ties: Vec<Tie>,
    /// Kept to reuse its memory.
    spare: Vec<Tie>,
}

impl CoincidentHits {
    pub(crate) const NONE: Self = Self { start: 0, count: 0 };
}

impl TieLists {
    /// Adds a list, given in any order.
    pub(crate) fn add(&mut self, ties: impl Iterator<Item = Tie>) -> CoincidentHits {
        let start = self.ties.len();
        self.ties.extend(ties);
        self.ties[start..].sort_unstable_by_key(|tie| tie.id.0);
        self.from(start)
    }

    /// Returns a list, sorted by id.
    #[inline]
    pub(crate) fn of(&self, ties: CoincidentHits) -> &[Tie] {
        let CoincidentHits { start, count } = ties;
        if count == 0 { &[] } else { &self.ties[start as usize..][..count as usize] }
    }

    pub(crate) fn clear(&mut self) {
        self.ties.clear();
    }

    /// Drops all lists except these, whose positions are updated.
    pub(crate) fn keep<'a>(&mut self, lists: impl Iterator<Item = &'a mut CoincidentHits>) {
        if self.ties.is_empty() {
            return;
        }
        let mut before = std::mem::replace(&mut self.ties, std::mem::take(&mut self.spare));
        for list in lists.filter(|list| list.count > 0) {
            let start = self.ties.len();
            self.ties.extend_from_slice(&before[list.start as usize..][..list.count as usize]);
            *list = self.from(start);
        }
        before.clear();
        self.spare = before;
    }

    /// Returns the list from `start` to the end.
    fn from(&self, start: usize) -> CoincidentHits {
        // Memory is exhausted long before.
        let number = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
        CoincidentHits { start: number(start), count: number(self.ties.len() - start) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_sorted_and_go_on_when_others_are_dropped() {
        let tie = |id| Tie { id: ShapeId(id), normal: DVec3::Y };
        let ids = |lists: &TieLists, ties| lists.of(ties).iter().map(|tie| tie.id.0).collect::<Vec<_>>();
        let mut lists = TieLists::default();
        let (_, mut two, none) =
            (lists.add([tie(9)].into_iter()), lists.add([tie(5), tie(3)].into_iter()), CoincidentHits::NONE);
        let mut three = lists.add([tie(1), tie(8), tie(4)].into_iter());
        assert_eq!((ids(&lists, two), ids(&lists, none)), (vec![3, 5], vec![]));
        let mut nothing = none;
        lists.keep([&mut three, &mut nothing, &mut two].into_iter());
        assert_eq!((ids(&lists, three), ids(&lists, two), nothing), (vec![1, 4, 8], vec![3, 5], none));
        assert_eq!(lists.ties.len(), 5);
    }
}
