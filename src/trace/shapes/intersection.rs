//! Results of ray-shape intersections.

use glam::DVec3;

use crate::trace::math::{BoundedT, Double, ExactRoot, Real};
#[cfg(test)]
use crate::trace::rays::PreparedRay;

/// A hit accurate to the last bit of `f64`, with the surface point and normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RefinedHit {
    /// Ray parameter, accurate to some bits beyond an `f64`.
    pub t: Double,
    /// The point origin + t direction, rounded once.
    pub point: DVec3,
    /// The outward unit normal.
    pub normal: DVec3,
}

/// The refined hit of one ray, or those of half a packet.
#[derive(Clone, Copy)]
pub(crate) struct Refined<R: Real> {
    pub(crate) t: Double<R>,
    pub(crate) point: [R; 3],
    pub(crate) normal: [R; 3],
    /// Rays whose refinement is valid. The others are refined exactly.
    pub(crate) found: R::Mask,
}

impl From<Refined<f64>> for RefinedHit {
    #[inline(always)]
    fn from(Refined { t, point, normal, .. }: Refined<f64>) -> Self {
        Self { t, point: point.into(), normal: normal.into() }
    }
}

impl From<Refined<f64>> for Option<RefinedHit> {
    #[inline(always)]
    fn from(refined: Refined<f64>) -> Self {
        refined.found.then(|| refined.into())
    }
}

/// Result of an intersection in `f64`.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Intersection {
    /// The ray hits the shape.
    Hit(BoundedT),
    /// The ray misses the shape.
    Miss,
    /// The rounding errors are too large to decide.
    Ambiguous,
}

/// Result of an intersection, generic over one ray and the rays of half a packet.
#[derive(Clone, Copy)]
pub(crate) struct Intersections<R: Real> {
    pub(crate) root: BoundedT<R>,
    /// Rays that certainly hit the shape, at `root`.
    pub(crate) hit: R::Mask,
    /// Rays that are undecided.
    pub(crate) undecided: R::Mask,
}

impl<R: Real> Intersections<R> {
    /// Decides the first hits at `t >= 0` from where lines enter and leave a convex shape. Lines in `outside` certainly miss, even if they are
    /// `undecided`.
    #[inline(always)]
    pub(super) fn first([entry, exit]: [BoundedT<R>; 2], outside: R::Mask, undecided: R::Mask) -> Self {
        let zero = entry.t().of(0.0);
        let undecided = undecided & !outside;
        let missed = outside | entry.earliest().greater(exit.latest()) | exit.latest().less(zero);
        let touching = exit.earliest().less_or_equal(entry.latest());
        let through = !(undecided | missed | touching);
        let enters = through & entry.earliest().greater(zero);
        let leaves = through & entry.latest().less(zero) & exit.earliest().greater(zero);
        let hit = enters | leaves;
        Self { root: BoundedT::pick(enters, entry, exit), hit, undecided: undecided | !(missed | hit) }
    }
}

impl From<Intersections<f64>> for Intersection {
    #[inline(always)]
    fn from(intersections: Intersections<f64>) -> Self {
        if intersections.hit {
            Self::Hit(intersections.root)
        } else if intersections.undecided {
            Self::Ambiguous
        } else {
            Self::Miss
        }
    }
}

/// Converts `None`, the result if all rays certainly miss, to [`Intersection::Miss`].
impl From<Option<Intersections<f64>>> for Intersection {
    #[inline(always)]
    fn from(intersections: Option<Intersections<f64>>) -> Self {
        intersections.map_or(Self::Miss, Self::from)
    }
}

/// Entry and exit of a line through a convex shape.
pub(crate) type ExactCrossing = [ExactHit; 2];

/// An exact hit of a line on a surface.
#[derive(Clone, Debug)]
pub(crate) struct ExactHit {
    pub(crate) t: ExactRoot,
    pub(crate) face: Face,
    pub(crate) side: Side,
}

/// The plane of a face: row.p = offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Facet {
    pub(crate) row: DVec3,
    pub(crate) offset: f64,
}

/// Direction in which a line crosses a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Side {
    /// The line enters the shape.
    Entry,
    /// The line leaves the shape.
    Exit,
    /// A plane has no inside.
    Either,
}

/// One of a box's six faces, or of a rod's three: axis 0 is the side, axis 1 the ends, upper at the stop. Other shapes have a single face.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Face {
    pub(crate) axis: usize,
    pub(crate) upper: bool,
}

impl ExactHit {
    /// Creates a hit on a shape with a single face.
    pub(crate) fn new(t: ExactRoot, side: Side) -> Self {
        Self { t, face: Face::default(), side }
    }

    /// Clamps `t` to 0, for a ray whose rounded origin lies beyond the hit.
    pub(crate) fn ahead(self) -> Self {
        if self.t.sign().is_lt() { Self { t: ExactRoot::ZERO, ..self } } else { self }
    }
}

#[cfg(test)]
impl Intersection {
    /// Returns the `t` in terms of `direction`, the direction that [`PreparedRay`] was created from, or `None` for a miss. `exact` decides
    /// ambiguous intersections.
    pub(crate) fn decided(
        self,
        direction: glam::DVec3,
        exact: impl FnOnce() -> Option<ExactCrossing>,
    ) -> Option<f64> {
        match self {
            Self::Hit(root) => {
                let ray = PreparedRay::new(glam::DVec3::ZERO, direction)?;
                Some(root.t() * ray.direction().abs().max_element() / direction.abs().max_element())
            }
            Self::Miss => None,
            Self::Ambiguous => {
                let first = exact()?.into_iter().find(|meeting| meeting.t.sign().is_ge())?;
                Some(first.t.rounded().rounded())
            }
        }
    }
}
