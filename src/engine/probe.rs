//! The ray tree of a single sample.

use hecs::Entity;

use crate::color::Rgb;
use crate::systems::Preparation;
use crate::trace::ShapeId;
use crate::trace::reference::RayTree;

/// The ray tree of a sample of a pixel: its rays, their hits, and their contributions to the colour.
#[derive(Clone, Debug)]
pub struct Probe<'a> {
    preparation: &'a Preparation,
    /// The rays in breadth-first order.
    pub tree: RayTree,
}

impl<'a> Probe<'a> {
    pub(super) fn new(preparation: &'a Preparation, tree: RayTree) -> Self {
        Self { preparation, tree }
    }

    /// Returns the colour of the sample. If pixels have one sample, it is the pixel's colour in the film, unless that has overflowed. If
    /// they have several, the pixel's colour is the mean of all samples.
    #[must_use]
    pub fn color(&self) -> Rgb {
        self.tree.color()
    }

    /// Returns the entity whose shape is in a slot.
    #[must_use]
    pub fn entity(&self, slot: ShapeId) -> Entity {
        self.preparation.entity(slot)
    }

    /// Returns the entities of the lights, in the order in which surfaces list them.
    #[must_use]
    pub fn lights(&self) -> &[Entity] {
        self.preparation.lights()
    }

    /// Returns the number of samples of a light per lit point: 1 except for area lights.
    #[must_use]
    pub fn light_samples(&self, index: usize) -> u32 {
        self.preparation.scene().lights.get(index).map_or(1, |light| light.samples)
    }
}
