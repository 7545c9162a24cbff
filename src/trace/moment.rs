//! What the kernel works with at one moment: what it is given, and what follows from that for all rays.

use std::cmp::Ordering;

use glam::DVec3;

use super::camera::PixelCenters;
use super::contribution::Brightest;
use super::media::{Inside, Nesting};
use super::{Bounds, Camera, Light, PreparedScene, Sampling, Slot};
use crate::color::Rgb;

/// A scene, the camera, which samples to take, and what follows.
pub(super) struct Moment<'a> {
    pub(super) scene: &'a PreparedScene,
    pub(super) camera: &'a Camera,
    pub(super) sampling: Sampling,
    pub(super) brightest: Brightest,
    pub(super) pixel_centers: PixelCenters,
    /// Those that are on, with their indices in document order.
    pub(super) lights: Vec<(usize, &'a Light)>,
    start: Start,
}

/// The clear solids that camera rays may start inside of, outer ones first.
struct Start(Vec<Slot>);

impl<'a> Moment<'a> {
    pub(super) fn new(scene: &'a PreparedScene, camera: &'a Camera, sampling: Sampling) -> Self {
        let lights = scene.lights.iter().enumerate();
        let lights = lights.filter(|(_, light)| light.intensity != Rgb::ZERO).collect();
        let (brightest, start) = (Brightest::of(scene), Start::new(scene, camera));
        let pixel_centers = camera.pixel_centers();
        Self { scene, camera, sampling, brightest, pixel_centers, lights, start }
    }

    /// How many generations of rays are traced: that of camera rays at least.
    pub(super) fn generations(&self) -> u32 {
        self.scene.depth.max(1)
    }

    /// What is seen where the camera is not in a finite place.
    pub(super) fn nowhere(&self) -> Rgb {
        self.scene.background.towards(DVec3::Z)
    }

    /// The solids that a ray from here is inside of.
    pub(super) fn inside(&self, origin: DVec3, nesting: &mut Nesting) -> Inside {
        let around = self.start.0.iter().filter(|slot| self.scene.geometry().contains(**slot, origin));
        around.fold(Inside::NONE, |inside, slot| nesting.added(inside, *slot))
    }
}

impl Start {
    fn new(scene: &PreparedScene, camera: &Camera) -> Self {
        let (eye, reach) = camera.eye();
        let near = |slot: &Slot| {
            let bounds = scene.geometry().bounds(*slot);
            bounds.is_none_or(|Bounds { min, max }| {
                (min - reach).cmple(eye).all() && (max + reach).cmpge(eye).all()
            })
        };
        let clear = scene.surfaces().clear.iter().copied().filter(|slot| scene.may_nest(*slot));
        let mut solids: Vec<Slot> = clear.filter(near).collect();
        // Nested ones are smaller, and half-spaces are the largest. Of equals, the first in document order counts.
        let extent =
            |slot: &Slot| scene.geometry().bounds(*slot).map_or(f64::INFINITY, |bounds| bounds.extent());
        solids.sort_by(|one, other| {
            let larger_first = extent(other).partial_cmp(&extent(one)).unwrap_or(Ordering::Equal);
            larger_first.then(other.cmp(one))
        });
        Self(solids)
    }
}
