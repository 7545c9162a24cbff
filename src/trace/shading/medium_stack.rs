//! Stacks of the transparent solids that contain a ray.

use std::cmp::Reverse;

use glam::DVec3;

use crate::color::Rgb;
use crate::trace::intersect::SurfacePoint;
use crate::trace::rays::{ShapeId, TieLists};
use crate::trace::scene::{PreparedScene, Refraction};

/// The transparent solids that contain a ray, last entered first, as a position in a [`MediumStacks`]. The last entered solid is the
/// medium.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct MediumStack(u32);

impl MediumStack {
    /// The empty stack.
    pub(crate) const NONE: Self = Self(0);
}

/// Linked lists of solids with shared tails. A ray that enters a solid prepends it to the list of the ray that it continues.
#[derive(Clone, Debug, Default)]
pub(crate) struct MediumStacks(Vec<(ShapeId, MediumStack)>);

impl MediumStacks {
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }

    /// Returns the number of list nodes, for [`truncate`](Self::truncate).
    pub(crate) fn mark(&self) -> usize {
        self.0.len()
    }

    /// Drops all stacks created since a mark.
    pub(crate) fn truncate(&mut self, mark: usize) {
        self.0.truncate(mark);
    }

    /// Iterates over the solids of a stack, last entered first.
    pub(crate) fn solids(&self, mut medium: MediumStack) -> impl Iterator<Item = ShapeId> {
        std::iter::from_fn(move || {
            let (id, outer) = self.node(medium)?;
            medium = outer;
            Some(id)
        })
    }

    fn node(&self, medium: MediumStack) -> Option<(ShapeId, MediumStack)> {
        Some(self.0[medium.0.checked_sub(1)? as usize])
    }

    /// Returns the stack with a solid pushed, or unchanged if it contains the solid.
    pub(crate) fn entered(&mut self, medium: MediumStack, id: ShapeId) -> MediumStack {
        if self.solids(medium).any(|other| other == id) {
            return medium;
        }
        self.added(medium, id)
    }

    /// Returns the stack with a solid pushed that it does not contain.
    pub(crate) fn added(&mut self, medium: MediumStack, id: ShapeId) -> MediumStack {
        self.0.push((id, medium));
        MediumStack(u32::try_from(self.0.len()).unwrap_or(0))
    }

    /// Returns the stack with a solid removed, or unchanged if it does not contain the solid.
    pub(crate) fn left(&mut self, medium: MediumStack, id: ShapeId) -> MediumStack {
        // The solid is usually the last entered one.
        if let Some((_, outer)) = self.node(medium).filter(|(last, _)| *last == id) {
            return outer;
        }
        let Some(depth) = self.solids(medium).position(|other| other == id) else {
            return medium;
        };
        // Other stacks share the nodes of the solids entered later, so they are copied.
        let later: Vec<ShapeId> = self.solids(medium).take(depth).collect();
        let mut rest = medium;
        for _ in 0..=depth {
            rest = self.node(rest).map_or(MediumStack::NONE, |(_, outer)| outer);
        }
        later.into_iter().rev().fold(rest, |medium, id| self.added(medium, id))
    }

    /// Returns the stack after a ray in `direction` has crossed a surface and all shapes tied with it. Solids entered at the same point are
    /// pushed in an order that makes the first in document order the medium.
    pub(crate) fn through(
        &mut self,
        scene: &PreparedScene,
        medium: MediumStack,
        surface: &SurfacePoint,
        ties: &TieLists,
        direction: DVec3,
    ) -> MediumStack {
        let mut medium = medium;
        let mut entered: Vec<ShapeId> = Vec::new();
        let tied = ties.of(surface.ties).iter().map(|tie| (&tie.id, direction.dot(tie.normal) < 0.0));
        for (first_equal, entering) in tied.chain([(&surface.first_equal, surface.from_outside)]) {
            for solid in scene.media_at(first_equal) {
                if entering {
                    entered.push(*solid);
                } else {
                    medium = self.left(medium, *solid);
                }
            }
        }
        entered.sort_unstable_by_key(|id| Reverse(scene.order().rank(*id)));
        for id in entered {
            medium = self.entered(medium, id);
        }
        medium
    }

    /// Returns the refractive index of the medium: 1 outside all solids.
    pub(crate) fn ior(&self, scene: &PreparedScene, medium: MediumStack) -> f64 {
        self.innermost(scene, medium).map_or(1.0, |refraction| refraction.ior)
    }

    /// Returns the absorption coefficients of the medium, per unit of length.
    pub(crate) fn absorption(&self, scene: &PreparedScene, medium: MediumStack) -> Rgb {
        self.innermost(scene, medium).map_or(Rgb::ZERO, |refraction| refraction.absorption)
    }

    fn innermost<'a>(&self, scene: &'a PreparedScene, medium: MediumStack) -> Option<&'a Refraction> {
        let (id, _) = self.node(medium)?;
        scene.material(id).refraction.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_entered_counts_and_any_may_be_left() {
        let mut media = MediumStacks::default();
        let list = |media: &MediumStacks, medium| media.solids(medium).map(|id| id.0).collect::<Vec<_>>();
        let one = media.entered(MediumStack::NONE, ShapeId(1));
        let two = media.entered(one, ShapeId(2));
        let three = media.entered(two, ShapeId(3));
        assert_eq!(list(&media, three), [3, 2, 1]);
        assert_eq!(media.entered(three, ShapeId(2)), three);
        let without = media.left(three, ShapeId(2));
        assert_eq!(list(&media, without), [3, 1]);
        assert_eq!(media.left(three, ShapeId(3)), two);
        assert_eq!(media.left(two, ShapeId(7)), two);
        assert_eq!(list(&media, three), [3, 2, 1], "lists do not change");
    }
}
