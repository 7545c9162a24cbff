//! Everything that one sample of a pixel sees.

use hecs::Entity;

use crate::color::Rgb;
use crate::systems::Preparation;
use crate::trace::ShapeId;
use crate::trace::reference::RayTree;

/// Everything that goes into a sample of a pixel: its rays, their hits, and the contributions to the colour.
#[derive(Clone, Debug)]
pub struct Probe<'a> {
    preparation: &'a Preparation,
    /// The rays, breadth first.
    pub tree: RayTree,
}

impl<'a> Probe<'a> {
    pub(super) fn new(preparation: &'a Preparation, tree: RayTree) -> Self {
        Self { preparation, tree }
    }

    /// Returns the sample's colour. Where pixels have one sample it is the pixel's, as it is in the film, or would be if it had
    /// not overflowed; where they have more the pixel is the mean of all.
    #[must_use]
    pub fn color(&self) -> Rgb {
        self.tree.color()
    }

    /// Returns the entity whose shape is in a slot.
    #[must_use]
    pub fn entity(&self, slot: ShapeId) -> Entity {
        self.preparation.entity(slot)
    }

    /// Returns the lights, in the order in which surfaces list them.
    #[must_use]
    pub fn lights(&self) -> &[Entity] {
        self.preparation.lights()
    }

    /// Returns the number of samples of a light at every point: 1 unless it has a size.
    #[must_use]
    pub fn light_samples(&self, index: usize) -> u32 {
        self.preparation.scene().lights.get(index).map_or(1, |light| light.samples)
    }
}
