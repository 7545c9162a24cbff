//! The render context: the inputs of a render, and the values derived from them for all rays.

use std::cmp::Ordering;

use glam::DVec3;

use super::contribution::RadianceBound;
use super::medium_stack::{MediumStack, MediumStacks};
use crate::color::Rgb;
use crate::trace::effects::Effects;
use crate::trace::math::PixelSampling;
use crate::trace::rays::ShapeId;
use crate::trace::scene::{PixelCenters, PreparedCamera, PreparedLight, PreparedScene, RayClass};
use crate::trace::shapes::Bounds;

/// A scene, its camera, the samples to take, and the values derived from them.
pub(crate) struct RenderContext<'a> {
    /// The scene as camera rays see it.
    pub(crate) scene: &'a PreparedScene,
    /// The scene as secondary rays see it.
    pub(crate) secondary: &'a PreparedScene,
    /// The scene as shadow rays see it.
    pub(crate) shadow: &'a PreparedScene,
    /// True if shapes are searched by a test of every shape, as the reference path does.
    pub(crate) scans_all: bool,
    pub(crate) camera: &'a PreparedCamera,
    pub(crate) sampling: PixelSampling,
    pub(crate) effects: Effects,
    pub(crate) radiance_bound: RadianceBound,
    pub(crate) pixel_centers: PixelCenters,
    /// Lights with nonzero intensity, with their indices in document order; before them the [dome](RenderContext::DOME), if ambient light is
    /// occluded, so that it is added to emission first like ambient light that is not.
    pub(crate) lights: Vec<(usize, PreparedLight)>,
    /// True if ambient light is occluded: `lights` begins with the dome.
    pub(crate) occludes_ambient: bool,
    start: StartMedia,
}

/// Transparent solids in which rays may start, outer solids first.
struct StartMedia(Vec<ShapeId>);

impl<'a> RenderContext<'a> {
    /// The index that takes the place of a light's in the sample keys of the dome, which is no light of the document.
    pub(crate) const DOME: usize = usize::MAX;

    pub(crate) fn new(
        scene: &'a PreparedScene,
        camera: &'a PreparedCamera,
        sampling: PixelSampling,
        effects: Effects,
    ) -> Self {
        let dome = scene.dome().filter(|_| effects.extras && effects.shadows());
        let lights = scene.lights.iter().copied().enumerate();
        let lights = lights.filter(|(_, light)| light.intensity != Rgb::ZERO);
        let occludes_ambient = dome.is_some();
        let lights = dome.map(|dome| (Self::DOME, dome)).into_iter().chain(lights).collect();
        let (radiance_bound, start) = (RadianceBound::of(scene), StartMedia::near(scene, camera.eye()));
        let pixel_centers = PixelCenters::of(camera);
        let [secondary, shadow] = [RayClass::Secondary, RayClass::Shadow].map(|class| scene.seen_by(class));
        Self {
            scene,
            secondary,
            shadow,
            scans_all: false,
            camera,
            sampling,
            effects,
            radiance_bound,
            pixel_centers,
            lights,
            occludes_ambient,
            start,
        }
    }

    /// Returns the scene as rays of a class see it.
    pub(crate) fn seen_by(&self, class: RayClass) -> &'a PreparedScene {
        match class {
            RayClass::Camera => self.scene,
            RayClass::Secondary => self.secondary,
            RayClass::Shadow => self.shadow,
        }
    }

    /// Returns the ambient light as a light source, if it is occluded.
    #[inline]
    pub(crate) fn dome(&self) -> Option<&PreparedLight> {
        self.lights.first().filter(|_| self.occludes_ambient).map(|(_, dome)| dome)
    }

    /// Returns the number of bounces to trace. Camera rays are the first one, which is always traced.
    pub(crate) fn bounces(&self) -> u32 {
        self.scene.depth.max(1)
    }

    /// Returns whether a surface may spawn two rays.
    pub(crate) fn branches(&self) -> bool {
        self.effects.media() && self.scene.surfaces().branches
    }

    /// Returns whether camera rays may start inside transparent solids.
    pub(crate) fn may_start_inside(&self) -> bool {
        self.effects.in_media() && !self.start.0.is_empty()
    }

    /// Returns the light that is seen if the camera position is not finite.
    pub(crate) fn unplaced_camera_color(&self) -> Rgb {
        self.scene.miss_radiance(DVec3::Z)
    }

    /// Returns the stack of transparent solids that contain the origin of a camera ray.
    pub(crate) fn medium(&self, origin: DVec3, media: &mut MediumStacks) -> MediumStack {
        self.start.around(self.scene, origin, media)
    }

    /// Returns the stack of transparent solids that contain the origin of any ray.
    pub(crate) fn medium_anywhere(&self, origin: DVec3, media: &mut MediumStacks) -> MediumStack {
        StartMedia::near(self.scene, (origin, 0.0)).around(self.scene, origin, media)
    }
}

impl StartMedia {
    /// Collects the solids in which rays may start at most `reach` away from a point.
    fn near(scene: &PreparedScene, (eye, reach): (DVec3, f64)) -> Self {
        let near = |id: &ShapeId| {
            let bounds = scene.geometry().bounds(*id);
            bounds.is_none_or(|Bounds { min, max }| {
                (min - reach).cmple(eye).all() && (max + reach).cmpge(eye).all()
            })
        };
        let transparent = scene.surfaces().transparent.iter().copied();
        let transparent = transparent.filter(|id| scene.sees(*id) && scene.may_be_medium(*id));
        let mut solids: Vec<ShapeId> = transparent.filter(near).collect();
        solids.sort_by(|one, other| outer_first(scene, *one, *other));
        Self(solids)
    }

    /// Returns the stack of the solids that contain a point.
    fn around(&self, scene: &PreparedScene, point: DVec3, media: &mut MediumStacks) -> MediumStack {
        let around = self.0.iter().filter(|id| scene.geometry().contains(**id, point));
        around.fold(MediumStack::NONE, |medium, id| media.added(medium, *id))
    }
}

/// Compares two solids that contain a point: outer solids come first. Nested solids are smaller, and half-spaces are the largest. Of solids
/// of equal extent, the first in document order is the medium.
pub(super) fn outer_first(scene: &PreparedScene, one: ShapeId, other: ShapeId) -> Ordering {
    let extent = |id| scene.geometry().bounds(id).map_or(f64::INFINITY, |bounds| bounds.extent());
    let larger_first = extent(other).partial_cmp(&extent(one)).unwrap_or(Ordering::Equal);
    larger_first.then(scene.order().rank(other).cmp(&scene.order().rank(one)))
}
