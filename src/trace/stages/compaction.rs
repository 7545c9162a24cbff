//! Compaction of the rays of a bounce into wavefronts: packets with enough active lanes are kept, the rays of other packets are merged.
//!
//! Light is added to a slot in the order of the wavefront. A ray therefore goes into a packet after all packets with earlier rays of its slot.
//! The rays of a slot keep their order, and no packet has two of them.

use super::ray_queue::{QueuedPacket, RayQueue};
use super::tile::{PACKETS, TILE_PIXELS};
use super::wavefront::Wavefront;
use crate::trace::math::{LANES, lanes};

/// Minimum number of active lanes for which a packet is kept without compaction.
const FEW: u32 = 12;

/// Fills the wavefront with the next rays of a bounce, up to its capacity. Returns `false` if none are left.
pub(super) fn fill(wavefront: &mut Wavefront, bounce: &mut RayQueue) -> bool {
    wavefront.clear();
    let mut shared = SharedPackets::default();
    let rest = &bounce.packets()[bounce.taken..];
    let mut taken = 0;
    for queued in rest {
        if wavefront.count == PACKETS {
            break;
        }
        taken += 1;
        if queued.branches.rays.lanes.count_ones() >= FEW {
            wavefront.add(&queued.branches, &queued.slots);
            shared.record(queued, wavefront.count);
        } else {
            shared.add(queued, wavefront);
        }
    }
    bounce.taken += taken;
    wavefront.count > 0
}

/// The packets of a wavefront into which rays are merged.
struct SharedPackets {
    /// By packet of the wavefront: the number of occupied lanes.
    filled: [usize; PACKETS],
    /// The index of the first packet that may have a free lane.
    first: usize,
    /// By slot: the smallest index of a packet that its next ray may use.
    behind: [u8; TILE_PIXELS],
}

impl Default for SharedPackets {
    fn default() -> Self {
        Self { filled: [LANES; PACKETS], first: 0, behind: [0; TILE_PIXELS] }
    }
}

impl SharedPackets {
    /// Records that a packet was kept as the last of `count` packets.
    fn record(&mut self, queued: &QueuedPacket, count: usize) {
        for slot in queued.slots {
            self.behind[slot as usize % TILE_PIXELS] = byte(count);
        }
    }

    /// Merges the rays of a packet into shared packets. The wavefront must have room for one more packet.
    fn add(&mut self, queued: &QueuedPacket, wavefront: &mut Wavefront) {
        for lane in lanes(queued.branches.rays.lanes) {
            let slot = queued.slots[lane];
            let behind = &mut self.behind[slot as usize % TILE_PIXELS];
            let from = self.first.max(usize::from(*behind));
            let partial = (from..wavefront.count).find(|packet| self.filled[*packet] < LANES);
            let packet = partial.unwrap_or_else(|| {
                self.filled[wavefront.count] = 0;
                wavefront.add_empty()
            });
            wavefront.copy((packet, self.filled[packet]), (&queued.branches, lane), slot);
            self.filled[packet] += 1;
            *behind = byte(packet + 1);
            while self.first < wavefront.count && self.filled[self.first] == LANES {
                self.first += 1;
            }
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a wave has sixteen packets at most")]
fn byte(packets: usize) -> u8 {
    packets as u8
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::trace::rays::PreparedRay;

    /// Creates packets from their active lanes, first pixels and pixel strides. Also returns the pixel and the number of each ray.
    fn bounce(packets: &[(u32, u32, u32)]) -> (RayQueue, Vec<(u32, f64)>) {
        let (mut bounce, mut rays) = (RayQueue::default(), Vec::new());
        for (filled, first, step) in packets {
            let mut pixels = [0; LANES];
            pixels.iter_mut().zip(0..).for_each(|(pixel, lane)| *pixel = (first + step * lane) % 256);
            bounce.add(&pixels, false);
            let queued = bounce.packets_mut().last_mut().unwrap();
            for lane in lanes(*filled) {
                let number = f64::from(u32::try_from(rays.len()).unwrap());
                queued.branches.rays.set(lane, &PreparedRay::new(DVec3::splat(number), DVec3::X).unwrap());
                rays.push((pixels[lane], number));
            }
        }
        (bounce, rays)
    }

    /// Returns the pixel and the number of each ray of a wavefront, packet by packet.
    fn rays_of(wavefront: &Wavefront) -> Vec<Vec<(u32, f64)>> {
        let rays = |packet: usize| {
            lanes(wavefront.rays[packet].lanes)
                .map(move |lane| (wavefront.slots[packet][lane], wavefront.rays[packet].origins.get(lane).x))
        };
        (0..wavefront.count).map(|packet| rays(packet).collect()).collect()
    }

    proptest! {
        #[test]
        fn all_rays_go_on_in_the_order_of_their_pixels(
            packets in prop::collection::vec(
                (prop_oneof![Just(0xffff_u32), Just(0), 0..0x10000_u32, (0..16_u32).prop_map(|lane| 1 << lane)], 0..256_u32, prop_oneof![Just(1_u32), Just(3), Just(17)]),
                0..60,
            ),
        ) {
            let (mut bounce, mut expected) = bounce(&packets);
            let (mut wavefront, mut found, mut whole) = (Wavefront::new(), Vec::new(), 0);
            while fill(&mut wavefront, &mut bounce) {
                for packet in rays_of(&wavefront) {
                    let mut pixels: Vec<u32> = packet.iter().map(|(pixel, _)| *pixel).collect();
                    pixels.sort_unstable();
                    pixels.dedup();
                    prop_assert_eq!(pixels.len(), packet.len(), "one ray of a pixel in a packet");
                    prop_assert!(!packet.is_empty());
                    whole += usize::from(packet.len() == LANES);
                    found.extend(packet);
                }
            }
            prop_assert!(whole >= packets.iter().filter(|(filled, ..)| *filled == 0xffff).count());
            // The rays of each pixel are in order.
            found.sort_by_key(|(pixel, _)| *pixel);
            expected.sort_by_key(|(pixel, _)| *pixel);
            prop_assert_eq!(found, expected);
        }
    }

    #[test]
    fn few_rays_of_different_pixels_share_a_packet() {
        let (mut bounce, _) = bounce(&[(0b1111, 0, 1), (0b11, 0, 1), (0xffff, 100, 1), (0b11_1111, 50, 1)]);
        let mut wavefront = Wavefront::new();
        assert!(fill(&mut wavefront, &mut bounce));
        let sizes: Vec<usize> = rays_of(&wavefront).iter().map(Vec::len).collect();
        assert_eq!(sizes, [10, 2, 16]);
        assert!(!fill(&mut wavefront, &mut bounce));
    }
}
