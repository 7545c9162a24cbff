//! What is said of where a ray meets a shape.

use glam::DVec3;

use crate::trace::math::{BoundedT, Double, ExactRoot, Real};
#[cfg(test)]
use crate::trace::rays::Ray;

/// A meeting to the last bit of `f64`, with the surface there.
#[derive(Clone, Copy, Debug)]
pub struct RefinedHit {
    /// Right to some bits beyond an `f64`'s.
    pub t: Double,
    /// origin + t direction, rounded once.
    pub point: DVec3,
    /// The outward unit normal.
    pub normal: DVec3,
}

/// What `f64` can say about where a ray meets a shape.
#[derive(Clone, Copy, Debug)]
pub enum Intersection {
    /// It does.
    ShapeHit(BoundedT),
    /// It does not.
    Miss,
    /// Too close to call.
    Ambiguous,
}

/// What a ray has to do with a shape, or each ray of half a packet.
#[derive(Clone, Copy)]
pub(crate) struct Verdict<R: Real> {
    pub(crate) t: R,
    pub(crate) error: R,
    /// Where it certainly meets it, at `t`.
    pub(crate) hit: R::Mask,
    /// Where it is not certain that it meets it or not.
    pub(crate) open: R::Mask,
}

impl From<Verdict<f64>> for Intersection {
    #[inline(always)]
    fn from(verdict: Verdict<f64>) -> Self {
        if verdict.hit {
            Self::ShapeHit(BoundedT::within(verdict.t, verdict.error))
        } else if verdict.open {
            Self::Ambiguous
        } else {
            Self::Miss
        }
    }
}

/// None stands for what all rays certainly miss.
impl From<Option<Verdict<f64>>> for Intersection {
    #[inline(always)]
    fn from(verdict: Option<Verdict<f64>>) -> Self {
        verdict.map_or(Self::Miss, Self::from)
    }
}

/// Where a line enters and where it leaves a convex shape.
pub(crate) type ExactCrossing = [ExactHit; 2];

/// Where a line meets a surface, without any rounding.
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

/// From which side a surface is met.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Side {
    /// The line enters the shape.
    Entry,
    /// It leaves the shape.
    Exit,
    /// A plane has no inside.
    Either,
}

/// One of a box's six faces. Other shapes have but one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Face {
    pub(crate) axis: usize,
    pub(crate) upper: bool,
}

impl ExactHit {
    /// Of a shape with one face.
    pub(crate) fn new(t: ExactRoot, side: Side) -> Self {
        Self { t, face: Face::default(), side }
    }

    /// The same, or at once, where rounding has put the ray's origin beyond it.
    pub(crate) fn ahead(self) -> Self {
        if self.t.sign().is_lt() { Self { t: ExactRoot::ZERO, ..self } } else { self }
    }
}

#[cfg(test)]
impl Intersection {
    /// The `t` for a direction as it was before it became a [`Ray`](super::Ray)'s, if there is one; `exact` has the last word where
    /// the verdict is open.
    pub(crate) fn decided(
        self,
        direction: glam::DVec3,
        exact: impl FnOnce() -> Option<ExactCrossing>,
    ) -> Option<f64> {
        match self {
            Self::ShapeHit(root) => {
                let ray = Ray::new(glam::DVec3::ZERO, direction)?;
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
