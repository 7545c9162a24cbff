//! Shapes that are equal bit by bit, and therefore coincide.
//!
//! Every ray query returns the same result for all shapes of a group. Only the first in document order is therefore queried, and a group of
//! a hundred thousand costs a ray as much as a single shape. The shape that is visible, the shapes that occlude a light, and those that
//! transmit it depend on the materials; they are determined here once for all rays.

use rayon::prelude::*;

use super::fingerprint::{BloomFilter, Fingerprint};
use super::geometry::Geometry;
use super::ray_visibility::RayClass;
use crate::trace::rays::ShapeId;

/// The groups of equal shapes of a scene.
#[derive(Clone, Debug, Default)]
pub(crate) struct EqualShapes {
    groups: Vec<EqualGroup>,
    /// Index of a shape's group, by id. Empty in a scene without groups.
    group_of: Vec<Option<u32>>,
    /// By id. Empty until a shape changes.
    fingerprints: Vec<u64>,
}

/// Two or more equal shapes.
#[derive(Clone, Debug)]
pub(crate) struct EqualGroup {
    /// All shapes of the group, in document order.
    ids: Vec<ShapeId>,
    /// The transparent shapes, in document order.
    transparent: Vec<ShapeId>,
    /// The first two opaque shapes.
    opaque: Vec<ShapeId>,
    /// See [`EqualGroup::media`].
    media: Vec<ShapeId>,
}

impl EqualShapes {
    /// Finds the groups of equal shapes among those that rays of a class see. [`EqualShapes::sort`] must be called afterwards.
    pub(crate) fn find(&mut self, geometry: &Geometry, class: RayClass) {
        let Self { groups, group_of, .. } = self;
        self.fingerprints = Vec::new();
        let fingerprints = fingerprints(geometry);
        let mut suspects: Vec<(u64, ShapeId)> =
            repeated(&fingerprints).into_iter().map(|id| (fingerprints[id.index()], id)).collect();
        suspects.retain(|(_, id)| geometry.visibility(*id).sees(class));
        suspects.par_sort_unstable_by_key(|(fingerprint, id)| (*fingerprint, geometry.order().rank(*id)));
        groups.clear();
        for alike in suspects.chunk_by(|one, other| one.0 == other.0) {
            let mut rest: Vec<ShapeId> = alike.iter().map(|(_, id)| *id).collect();
            // All of them are equal, unless different shapes have the same fingerprint by chance.
            while let Some(first) = rest.first().copied() {
                let equals = |id: &ShapeId| *id == first || geometry.are_equal(first, *id);
                let (equal, others) = rest.into_iter().partition(equals);
                groups.extend(EqualGroup::new(equal));
                rest = others;
            }
        }
        group_of.clear();
        group_of.resize(if groups.is_empty() { 0 } else { fingerprints.len() }, None);
        for (index, group) in (0..).zip(&*groups) {
            for id in &group.ids {
                group_of[id.index()] = Some(index);
            }
        }
    }

    /// Updates the fingerprints of shapes that have changed. Returns whether the groups are still valid; if not, they must be found again.
    #[must_use]
    pub(super) fn remain_after(&mut self, geometry: &Geometry, changed: &[ShapeId]) -> bool {
        const BITS_A_CHANGE: usize = 64;
        if changed.iter().any(|id| self.group(*id).is_some()) {
            return false;
        }
        if self.fingerprints.is_empty() {
            self.fingerprints = fingerprints(geometry);
        }
        let mut filter = BloomFilter::new(changed.len() * BITS_A_CHANGE);
        for id in changed {
            let fingerprint = fingerprint(geometry, *id);
            self.fingerprints[id.index()] = fingerprint;
            filter.insert(fingerprint);
        }
        let mut suspects: Vec<u64> = self
            .fingerprints
            .par_iter()
            .copied()
            .filter(|fingerprint| filter.may_contain(*fingerprint))
            .collect();
        suspects.sort_unstable();
        suspects.windows(2).all(|pair| pair[0] != pair[1])
    }

    /// Divides each group into transparent and opaque shapes.
    pub(crate) fn sort(&mut self, is_transparent: impl Fn(ShapeId) -> bool) {
        for group in &mut self.groups {
            group.sort(&is_transparent);
        }
    }

    /// Returns whether any shapes are equal.
    #[inline]
    pub(crate) fn any(&self) -> bool {
        !self.groups.is_empty()
    }

    /// Returns the group that contains a shape.
    #[inline]
    pub(crate) fn group(&self, id: ShapeId) -> Option<&EqualGroup> {
        let index = (*self.group_of.get(id.index())?)?;
        Some(&self.groups[index as usize])
    }

    /// Returns the first in document order of all shapes that equal a shape: the one that rays query.
    #[inline]
    pub(crate) fn first(&self, id: ShapeId) -> ShapeId {
        self.group(id).map_or(id, |group| group.ids[0])
    }
}

impl EqualGroup {
    /// Creates a group; `None` for a single shape.
    fn new(ids: Vec<ShapeId>) -> Option<Self> {
        let (transparent, opaque, media) = (Vec::new(), Vec::new(), Vec::new());
        (ids.len() > 1).then_some(Self { ids, transparent, opaque, media })
    }

    fn sort(&mut self, is_transparent: impl Fn(ShapeId) -> bool) {
        const EACH_END: usize = 2;
        self.transparent = self.ids.iter().copied().filter(|id| is_transparent(*id)).collect();
        self.opaque = self.ids.iter().copied().filter(|id| !is_transparent(*id)).take(2).collect();
        let last = self.transparent.len().saturating_sub(EACH_END).max(EACH_END);
        self.media = self.transparent.iter().copied().take(EACH_END).collect();
        self.media.extend(self.transparent.iter().skip(last));
    }

    /// Returns all shapes of the group, in document order.
    pub(crate) fn ids(&self) -> &[ShapeId] {
        &self.ids
    }

    /// Returns the first opaque shape other than `except`.
    pub(crate) fn opaque(&self, except: Option<ShapeId>) -> Option<ShapeId> {
        self.opaque.iter().copied().find(|id| Some(*id) != except)
    }

    /// Returns the transparent shapes, in document order.
    pub(crate) fn transparent(&self) -> &[ShapeId] {
        &self.transparent
    }

    /// Returns the transparent shapes that may count among the solids that contain a ray. They are entered and left together, so that only
    /// the first and the last can be the innermost, or their neighbours where the first or the last is a light's own shape.
    pub(crate) fn media(&self) -> &[ShapeId] {
        &self.media
    }
}

/// Returns the fingerprints of all shapes, by id.
fn fingerprints(geometry: &Geometry) -> Vec<u64> {
    geometry.par_ids().map(|id| fingerprint(geometry, id)).collect()
}

fn fingerprint(geometry: &Geometry, id: ShapeId) -> u64 {
    let mut fingerprint = Fingerprint::default();
    geometry.numbers(id, |number| fingerprint.add(number));
    fingerprint.finish()
}

/// Returns the ids of all shapes whose fingerprints may occur twice; usually there are none.
fn repeated(fingerprints: &[u64]) -> Vec<ShapeId> {
    const BITS_A_FINGERPRINT: usize = 16;
    let room = fingerprints.len() * BITS_A_FINGERPRINT;
    let (mut once, mut twice) = (BloomFilter::new(room), BloomFilter::new(room));
    let mut any = false;
    for fingerprint in fingerprints {
        if once.insert(*fingerprint) {
            twice.insert(*fingerprint);
            any = true;
        }
    }
    let suspects =
        (0..).map(ShapeId).zip(fingerprints).filter(|(_, fingerprint)| twice.may_contain(**fingerprint));
    if any { suspects.map(|(id, _)| id).collect() } else { Vec::new() }
}
