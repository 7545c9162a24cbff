//! Which clear solids a ray is inside of.

use glam::DVec3;

use super::{PreparedScene, Refraction, Slot, Surface};
use crate::color::Rgb;

/// The solids that a ray is inside of, the last entered first: the one that counts. A place in a [`Nesting`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Inside(u32);

impl Inside {
    /// Of none.
    pub(super) const NONE: Self = Self(0);
}

/// Lists of solids that share their tails: a ray that enters a solid puts it before the list of the ray it continues.
#[derive(Clone, Debug, Default)]
pub(super) struct Nesting(Vec<(Slot, Inside)>);

impl Nesting {
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// A mark to go back to.
    pub(super) fn mark(&self) -> usize {
        self.0.len()
    }

    /// Forgets all places that were made since a mark.
    pub(super) fn truncate(&mut self, mark: usize) {
        self.0.truncate(mark);
    }

    /// The list, the last entered first.
    pub(super) fn solids(&self, mut inside: Inside) -> impl Iterator<Item = Slot> {
        std::iter::from_fn(move || {
            let (slot, outer) = self.node(inside)?;
            inside = outer;
            Some(slot)
        })
    }

    fn node(&self, inside: Inside) -> Option<(Slot, Inside)> {
        Some(self.0[inside.0.checked_sub(1)? as usize])
    }

    /// With a solid before the others, unless it is among them.
    pub(super) fn entered(&mut self, inside: Inside, slot: Slot) -> Inside {
        if self.solids(inside).any(|other| other == slot) {
            return inside;
        }
        self.added(inside, slot)
    }

    /// With a solid before the others, among which it is not.
    pub(super) fn added(&mut self, inside: Inside, slot: Slot) -> Inside {
        self.0.push((slot, inside));
        Inside(u32::try_from(self.0.len()).unwrap_or(0))
    }

    /// Without a solid.
    pub(super) fn left(&mut self, inside: Inside, slot: Slot) -> Inside {
        let Some(depth) = self.solids(inside).position(|other| other == slot) else {
            return inside;
        };
        let later: Vec<Slot> = self.solids(inside).take(depth).collect();
        let mut rest = inside;
        for _ in 0..=depth {
            rest = self.node(rest).map_or(Inside::NONE, |(_, outer)| outer);
        }
        later.into_iter().rev().fold(rest, |inside, slot| self.added(inside, slot))
    }

    /// After a ray with this direction has gone through a surface and through all that is tied with it there. What is entered at once is entered
    /// in such an order that the first in document order counts.
    pub(super) fn through(
        &mut self,
        scene: &PreparedScene,
        inside: Inside,
        surface: &Surface,
        direction: DVec3,
    ) -> Inside {
        let mut inside = inside;
        let mut entered: Vec<Slot> = Vec::new();
        let tied = surface.ties.iter().map(|tie| (&tie.slot, direction.dot(tie.normal) < 0.0));
        for (asked, entering) in tied.chain([(&surface.asked, surface.from_outside)]) {
            for solid in scene.nesting_at(asked) {
                if entering {
                    entered.push(*solid);
                } else {
                    inside = self.left(inside, *solid);
                }
            }
        }
        entered.sort_unstable_by(|one, other| other.cmp(one));
        for slot in entered {
            inside = self.entered(inside, slot);
        }
        inside
    }

    /// The index of refraction that counts: 1 outside of everything.
    pub(super) fn ior(&self, scene: &PreparedScene, inside: Inside) -> f64 {
        self.innermost(scene, inside).map_or(1.0, |refraction| refraction.ior)
    }

    /// What the medium takes away per unit of length.
    pub(super) fn absorption(&self, scene: &PreparedScene, inside: Inside) -> Rgb {
        self.innermost(scene, inside).map_or(Rgb::ZERO, |refraction| refraction.absorption)
    }

    fn innermost<'a>(&self, scene: &'a PreparedScene, inside: Inside) -> Option<&'a Refraction> {
        let (slot, _) = self.node(inside)?;
        scene.material(slot).refraction.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_entered_counts_and_any_may_be_left() {
        let mut nesting = Nesting::default();
        let list = |nesting: &Nesting, inside| nesting.solids(inside).map(|slot| slot.0).collect::<Vec<_>>();
        let one = nesting.entered(Inside::NONE, Slot(1));
        let two = nesting.entered(one, Slot(2));
        let three = nesting.entered(two, Slot(3));
        assert_eq!(list(&nesting, three), [3, 2, 1]);
        assert_eq!(nesting.entered(three, Slot(2)), three);
        let without = nesting.left(three, Slot(2));
        assert_eq!(list(&nesting, without), [3, 1]);
        assert_eq!(nesting.left(three, Slot(3)), two);
        assert_eq!(nesting.left(two, Slot(7)), two);
        assert_eq!(list(&nesting, three), [3, 2, 1], "lists do not change");
    }
}
