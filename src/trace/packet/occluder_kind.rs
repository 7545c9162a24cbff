//! Classification of shapes as occluders.

use crate::trace::rays::ShapeId;
use crate::trace::scene::PreparedScene;

/// The shapes that occlude a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Occluders {
    /// The light's own shape, which does not occlude it.
    pub(crate) except: Option<ShapeId>,
    /// True if transparent shapes do not occlude the light, but are recorded as crossed.
    pub(crate) clear: bool,
}

/// The effect of a shape on shadow rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OccluderKind {
    Opaque,
    /// Attenuates the light.
    Transparent,
    /// Equal to other shapes, none of which is opaque, except possibly the light's own shape. Rays that hit it escalate to scalar code.
    Coincident,
    /// The light's own shape.
    Excluded,
}

impl Occluders {
    /// Classifies a shape, consistently with `PreparedScene::occluder` and `PreparedScene::occluder_or_crossed`.
    #[inline(always)]
    pub(super) fn role(&self, scene: &PreparedScene, id: ShapeId) -> OccluderKind {
        let group = scene.equal_shapes.group(id);
        // At least one shape of a group of equal shapes is not the light's own.
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
