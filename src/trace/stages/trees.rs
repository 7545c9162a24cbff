//! Ray trees of samples whose paths can branch into a reflected and a refracted ray. All rays of a sample at a bounce determine which of them
//! are cut.

use fearless_simd::dispatch;

use super::ray_queue::QueuedPacket;
use super::tile::TILE_PIXELS;
use crate::trace::math::{LANES, SimdLevel, lanes};
use crate::trace::shading::{ErrorBudget, RadianceBound};

/// The state of the ray trees of a tile's samples, by slot.
#[derive(Clone, Debug, Default)]
pub(super) struct Trees {
    /// The number of rays traced.
    pub(super) sizes: Vec<u32>,
    /// The light that may still be cut.
    budgets: Vec<ErrorBudget>,
    /// The rays of a bounce, sorted by slot and in queue order within a slot: the upper bound of each ray's contribution, and its index.
    weighed: Vec<(f32, usize)>,
    /// By slot: the end of its rays in that list.
    ends: Vec<usize>,
    /// By packet of a bounce: upper bounds of the contributions of its rays.
    mosts: Vec<[f32; LANES]>,
    /// By packet of a bounce: the lanes of rays that are cut.
    pub(super) cut: Vec<u32>,
}

impl Trees {
    /// Resets the state for a sample.
    pub(super) fn begin(&mut self, budget: ErrorBudget) {
        self.sizes.clear();
        self.sizes.resize(TILE_PIXELS, 1);
        self.budgets.clear();
        self.budgets.resize(TILE_PIXELS, budget);
    }

    /// Bounds the contributions of a bounce's rays. `bounces` is the number of bounces left, including this one.
    pub(super) fn weigh(
        &mut self,
        level: SimdLevel,
        radiance_bound: &RadianceBound,
        packets: &[QueuedPacket],
        bounces: u32,
    ) {
        self.mosts.clear();
        dispatch!(level.level(), simd => {
            for queued in packets {
                self.mosts.push(radiance_bound.mosts(simd, &queued.branches.paths.throughputs, bounces));
            }
        });
    }

    /// Decides which rays of a bounce are cut, by the bounds that `weigh` has computed.
    pub(super) fn find_cut(&mut self, packets: &[QueuedPacket]) {
        self.cut.clear();
        self.cut.resize(packets.len(), 0);
        self.sort(packets);
        let mut start = 0;
        for (end, budget) in self.ends.iter().zip(&mut self.budgets) {
            let rays = &mut self.weighed[start..*end];
            start = *end;
            if rays.is_empty() {
                continue;
            }
            let count = budget.cut(rays);
            for (_, ray) in &rays[..count] {
                self.cut[ray / LANES] |= 1 << (ray % LANES);
            }
        }
    }

    /// Sorts the rays of a bounce by slot, stably.
    fn sort(&mut self, packets: &[QueuedPacket]) {
        let Self { weighed, ends, mosts, .. } = self;
        let rays = |queued: &QueuedPacket| lanes(queued.branches.rays.lanes);
        ends.clear();
        ends.resize(TILE_PIXELS, 0);
        for queued in packets {
            rays(queued).for_each(|lane| ends[queued.slots[lane] as usize % TILE_PIXELS] += 1);
        }
        // First, the start of each slot's rays.
        let mut count = 0;
        for end in &mut *ends {
            (count, *end) = (count + *end, count);
        }
        weighed.clear();
        weighed.resize(count, (0.0, 0));
        for (packet, (queued, mosts)) in packets.iter().zip(&*mosts).enumerate() {
            for lane in rays(queued) {
                let end = &mut ends[queued.slots[lane] as usize % TILE_PIXELS];
                weighed[*end] = (mosts[lane], packet * LANES + lane);
                *end += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::super::ray_queue::RayQueue;
    use super::*;
    use crate::color::Rgb;
    use crate::trace::scene::{Geometry, PreparedScene};
    use crate::trace::shading::{MediumStack, PathState, TreeRay};
    use crate::trace::{PreparedBackground, PreparedRay};

    proptest! {
        /// Compares the cuts with one budget per pixel, for two bounces of packets in which pixels have several rays or none.
        #[test]
        fn each_pixel_has_a_budget_of_its_own(
            cutoff in prop_oneof![Just(0.0_f32), 1e-3..1.0_f32],
            bounces in prop::collection::vec(prop::collection::vec((0..0x10000_u32, 0..8_u32, prop::array::uniform16(-9.0..1.0_f32)), 0..12), 2),
        ) {
            let mut scene = PreparedScene::new(Geometry::default(), Vec::new());
            (scene.cutoff, scene.background) = (cutoff, PreparedBackground::Flat(Rgb::ONE));
            let radiance_bound = RadianceBound::of(&scene);
            let mut trees = Trees::default();
            trees.begin(ErrorBudget::new(&scene));
            let mut budgets = vec![ErrorBudget::new(&scene); TILE_PIXELS];
            for packets in bounces {
                let mut bounce = RayQueue::default();
                let mut by_pixel: Vec<Vec<(f32, usize)>> = vec![Vec::new(); TILE_PIXELS];
                for (number, (filled, first, digits)) in packets.into_iter().enumerate() {
                    let mut pixels = [0; LANES];
                    pixels.iter_mut().zip(first * 8..).for_each(|(pixel, place)| *pixel = place % 64);
                    bounce.add(&pixels, false);
                    let queued = bounce.packets_mut().last_mut().unwrap();
                    for lane in lanes(filled) {
                        let throughput = Rgb::splat(libm::exp10f(digits[lane]));
                        let state = PathState { throughput, ..PathState::at_camera(MediumStack::NONE) };
                        queued.branches.set(lane, &TreeRay { ray: PreparedRay::new(DVec3::ZERO, DVec3::X).unwrap(), state });
                        by_pixel[queued.slots[lane] as usize].push((radiance_bound.most(throughput, 0), number * LANES + lane));
                    }
                }
                trees.weigh(SimdLevel::best(), &radiance_bound, bounce.packets(), 0);
                trees.find_cut(bounce.packets());
                let mut expected = vec![0; bounce.packets().len()];
                for (rays, budget) in by_pixel.iter_mut().zip(&mut budgets) {
                    let count = budget.cut(rays);
                    rays[..count].iter().for_each(|(_, ray)| expected[ray / LANES] |= 1 << (ray % LANES));
                }
                prop_assert_eq!(&trees.cut, &expected);
            }
        }
    }
}
