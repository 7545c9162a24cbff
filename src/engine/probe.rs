//! What one sample of a pixel sees.

use hecs::Entity;

use crate::color::Rgb;
use crate::systems::Preparation;
use crate::trace::reference::{RayEnd, RayTree, ray_tree};
use crate::trace::{self, Slot};

/// Everything that goes into a sample of a pixel: its rays, what they find, and what that adds to the colour.
#[derive(Clone, Debug)]
pub struct Probe<'a> {
    preparation: &'a Preparation,
    /// The rays, breadth first.
    pub tree: RayTree,
}

impl<'a> Probe<'a> {
    pub(super) fn new(preparation: &'a Preparation, camera_ray: trace::Ray) -> Self {
        Self { preparation, tree: ray_tree(preparation.scene(), camera_ray) }
    }

    /// The sample's colour. Where pixels have one sample it is the pixel's, as it is in the film, or would be if it had not
    /// overflowed; where they have more the pixel is the mean of all.
    #[must_use]
    pub fn color(&self) -> Rgb {
        self.tree.color(self.preparation.scene())
    }

    /// The light that comes back from what a ray finds. Times the ray's throughput it is what the ray adds to the sample.
    #[must_use]
    pub fn light(&self, end: &RayEnd) -> Rgb {
        end.light(self.preparation.scene())
    }

    /// The colour of what rays see that find nothing.
    #[must_use]
    pub fn background(&self) -> Rgb {
        self.preparation.scene().background
    }

    /// Whose shape is in a slot.
    #[must_use]
    pub fn entity(&self, slot: Slot) -> Entity {
        self.preparation.entity(slot)
    }

    /// The lights, in the order in which surfaces list them.
    #[must_use]
    pub fn lights(&self) -> &[Entity] {
        self.preparation.lights()
    }
}
