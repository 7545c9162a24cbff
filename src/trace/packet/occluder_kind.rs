//! What shapes do to the light on its way to surfaces.

use crate::trace::rays::ShapeId;
use crate::trace::scene::PreparedScene;

/// What counts as an occluder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Occluders {
    /// A shape that does not: the light's own.
    pub(crate) except: Option<ShapeId>,
    /// Whether clear shapes hide nothing, but are crossed.
    pub(crate) clear: bool,
}

/// What a shape does to a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OccluderKind {
    Opaque,
    /// It weakens it.
    Transparent,
    /// It and others that equal it do, for which rays are followed one by one.
    Coincident,
    Excluded,
}

impl Occluders {
    /// Returns what a shape does, as `PreparedScene::occluder` and `PreparedScene::occluder_or_crossed` see it.
    #[inline(always)]
    pub(super) fn role(&self, scene: &PreparedScene, id: ShapeId) -> OccluderKind {
        let group = scene.equal_shapes.group(id);
        if self.except == Some(id) && group.is_none() {
            return OccluderKind::Excluded;
        }
        if !self.clear {
            return OccluderKind::Opaque;
        }
        match group {
            Some(group) if group.opaque(self.except).is_none() => OccluderKind::Coincident,
            None if scene.material(id).refraction.is_some() => OccluderKind::Transparent,
            Some(_) | None => OccluderKind::Opaque,
        }
    }
}
