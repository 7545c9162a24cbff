//! Errors from images of small shapes in mirrors and glass that no sample may have hit.

use std::collections::BTreeMap;

use super::evidence::{Class, PixelPacket, single};
use super::output_curve::OutputCurve;
use crate::trace::math::lanes;
use crate::trace::render::visibility::HiddenImage;

/// Sums of squared errors if images are missed, in quarter-octave bins of the image area.
#[derive(Clone, Debug)]
pub(super) struct HiddenImages(BTreeMap<i32, f64>);

impl HiddenImages {
    /// Sorts the images that a picture may show into bins.
    pub(super) fn new(found: &[HiddenImage], curve: OutputCurve) -> Self {
        let mut images = BTreeMap::new();
        for HiddenImage { area, radiance, count } in found {
            #[expect(clippy::cast_possible_truncation, reason = "of a few pixels")]
            let size = libm::floor(4.0 * libm::log2(*area)) as i32;
            let change = f64::from(curve.value(radiance * single(area.min(1.0))));
            *images.entry(size).or_insert(0.0) += count * change * change * area.max(1.0);
        }
        Self(images)
    }

    /// Returns the expected sum of squared errors, given the samples of the pixels.
    pub(super) fn square(&self, packets: &[PixelPacket]) -> f64 {
        if self.0.is_empty() {
            return 0.0;
        }
        let (mut pixels, mut samples) = (0.0, 0.0);
        for packet in packets {
            for lane in lanes(packet.classes[Class::Plain as usize]) {
                (pixels, samples) = (pixels + 1.0, samples + f64::from(packet.taken[lane]));
            }
        }
        if pixels == 0.0 {
            return 0.0;
        }
        // An image is missed with probability exp(-n), for n samples in its area on average.
        let missed = |(size, square): (&i32, &f64)| {
            let area = libm::exp2((f64::from(*size) + 0.5) / 4.0);
            square * libm::exp(-area * samples / pixels)
        };
        self.0.iter().map(missed).sum()
    }
}
