//! Rods without rounding: entries, exits and containment.

use super::intersection::{ExactCrossing, ExactHit, Face, Side};
use super::slabs::ExactSlab;
use super::sphere::roots;
use crate::trace::math::{Exact, Exact3, ExactRoot};

/// A line and a rod without rounding, in the rod's own coordinates, all vectors to points and along the line multiplied by a factor.
pub(super) struct ExactRod {
    /// The origin, from the start of the axis.
    pub(super) origin: Exact3,
    pub(super) direction: Exact3,
    /// The vector from the start of the axis to its stop, not multiplied.
    pub(super) stop: Exact3,
    /// Greater than 0.
    pub(super) factor: Exact,
    pub(super) radius: f64,
}

/// A part of a line.
enum LinePart {
    Nothing,
    All,
    Between(Box<ExactCrossing>),
}

/// The numbers of the quadratic equation a t^2 - 2 b t + c = 0 of a rod's side.
pub(super) struct SideEquation {
    pub(super) a: Exact,
    pub(super) b: Exact,
    pub(super) c: Exact,
}

const SIDE: Face = Face { axis: 0, upper: false };
pub(super) const START: Face = Face { axis: 1, upper: false };
const STOP: Face = Face { axis: 1, upper: true };

impl ExactRod {
    /// Returns the squared length of the axis.
    pub(super) fn squared_length(&self) -> Exact {
        self.stop.dot(&self.stop)
    }

    fn scaled_radius(&self) -> Exact {
        &self.factor * &self.radius.into()
    }

    pub(super) fn side_equation(&self) -> SideEquation {
        let (across, turned) = (self.origin.cross(&self.stop), self.direction.cross(&self.stop));
        let radius = self.scaled_radius();
        let square = &(&radius * &radius) * &self.squared_length();
        SideEquation { a: turned.dot(&turned), b: -&across.dot(&turned), c: &across.dot(&across) - &square }
    }

    fn side(&self) -> LinePart {
        let SideEquation { a, b, c } = self.side_equation();
        if a.sign().is_eq() {
            return if c.sign().is_gt() { LinePart::Nothing } else { LinePart::All };
        }
        let hit = |t, side| ExactHit { t, face: SIDE, side };
        match ExactRoot::of_quadratic(&a, &b, &c) {
            None => LinePart::Nothing,
            Some([near, far]) => LinePart::Between(Box::new([hit(near, Side::Entry), hit(far, Side::Exit)])),
        }
    }

    /// Returns the slab between the planes across the axis at its ends.
    fn slab(&self) -> ExactSlab {
        let along = self.origin.dot(&self.stop);
        let top = &self.squared_length() * &self.factor;
        ExactSlab { low: -&along, high: &top - &along, speed: self.direction.dot(&self.stop) }
    }

    /// Returns the crossings with the spheres at both ends.
    pub(super) fn balls(&self) -> [Option<ExactCrossing>; 2] {
        let radius = self.scaled_radius();
        let [to_start, to_stop] = self.to_ends();
        [(to_start, START), (to_stop, STOP)].map(|(to_center, face)| {
            Some(roots(&to_center, &self.direction, &radius)?.map(|hit| ExactHit { face, ..hit }))
        })
    }

    fn to_ends(&self) -> [Exact3; 2] {
        let zero = Exact3([Exact::ZERO, Exact::ZERO, Exact::ZERO]);
        let stop = Exact3(self.stop.0.each_ref().map(|part| part * &self.factor));
        [&zero - &self.origin, &stop - &self.origin]
    }

    /// Returns the entry and the exit. `planes` is the slab of a cylinder, `None` for a capsule.
    pub(super) fn cross(&self, planes: Option<ExactSlab>) -> Option<ExactCrossing> {
        match planes {
            Some(slab) => between(self.side(), &slab),
            None => {
                let [start, stop] = self.balls();
                // On the circles where side and spheres meet, the spheres count.
                let parts = [start, stop, between(self.side(), &self.slab())];
                parts.into_iter().flatten().reduce(|[entry, exit], [near, far]| {
                    [if near.t < entry.t { near } else { entry }, if far.t > exit.t { far } else { exit }]
                })
            }
        }
    }

    /// Returns the exit of a line that starts on the rod and goes inwards.
    pub(super) fn exit(&self, planes: Option<ExactSlab>) -> Option<ExactHit> {
        let hit = match planes {
            Some(slab) => {
                let ahead = slab.speed.sign().is_ne().then(|| {
                    let [_, exit] = slab.meetings(START.axis);
                    exit
                });
                let side = match self.side() {
                    LinePart::Between(crossing) => {
                        let [_, exit] = *crossing;
                        Some(exit)
                    }
                    LinePart::Nothing => Some(self.nearest()),
                    LinePart::All => None,
                };
                side.into_iter().chain(ahead).min_by(|one, other| one.t.cmp(&other.t))?
            }
            None => match self.cross(None) {
                Some([_, exit]) => exit,
                None => self.nearest(),
            },
        };
        Some(hit.ahead())
    }

    /// Returns the point closest to the rod, for a line that misses it by the rounding of its origin.
    fn nearest(&self) -> ExactHit {
        let hit = |t, face| ExactHit { t, face, side: Side::Exit };
        let along = self.origin.dot(&self.stop);
        let beyond = (&along - &(&self.squared_length() * &self.factor)).sign().is_gt();
        let [to_start, to_stop] = self.to_ends();
        let to_center = if beyond { to_stop } else { to_start };
        let at_end =
            || ExactRoot::quotient(&to_center.dot(&self.direction), &self.direction.dot(&self.direction));
        if beyond {
            return hit(at_end(), STOP);
        }
        if along.sign().is_lt() {
            return hit(at_end(), START);
        }
        let SideEquation { a, b, .. } = self.side_equation();
        if a.sign().is_eq() { hit(ExactRoot::ZERO, SIDE) } else { hit(ExactRoot::quotient(&b, &a), SIDE) }
    }

    /// Returns whether the origin is strictly inside; of a cylinder, inside the infinite one.
    pub(super) fn contains(&self, is_cylinder: bool) -> bool {
        let along = self.origin.dot(&self.stop);
        let top = &self.squared_length() * &self.factor;
        if is_cylinder || along.sign().is_ge() && (&top - &along).sign().is_ge() {
            return self.side_equation().c.sign().is_lt();
        }
        let radius = self.scaled_radius();
        let square = &radius * &radius;
        let [to_start, to_stop] = self.to_ends();
        let to_center = if along.sign().is_lt() { to_start } else { to_stop };
        (&to_center.dot(&to_center) - &square).sign().is_lt()
    }
}

/// Returns the part of a line within both the side and a slab. Where both are entered or left at the same `t`, the side counts.
fn between(side: LinePart, slab: &ExactSlab) -> Option<ExactCrossing> {
    let is_parallel = slab.speed.sign().is_eq();
    if is_parallel && (slab.low.sign().is_gt() || slab.high.sign().is_lt()) {
        return None;
    }
    let crossing = match side {
        LinePart::Nothing => return None,
        LinePart::All if is_parallel => return None,
        LinePart::All => slab.meetings(START.axis),
        LinePart::Between(side) if is_parallel => *side,
        LinePart::Between(side) => {
            let [entry, exit] = *side;
            let [near, far] = slab.meetings(START.axis);
            [if near.t > entry.t { near } else { entry }, if far.t < exit.t { far } else { exit }]
        }
    };
    let [entry, exit] = &crossing;
    (entry.t <= exit.t).then_some(crossing)
}
