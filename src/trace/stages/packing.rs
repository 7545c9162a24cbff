//! How a generation's rays go on as waves: whole packets as they are, and the rays of others put together.
//!
//! Light is added to a pixel in the order of the wave. So a ray goes into a packet that is behind all those with other rays of its pixel:
//! what comes later in the generation comes later in the wave, and no packet has two rays of a pixel.

use super::generation::{Generation, SentPacket};
use super::tile::{PACKETS, TILE_PIXELS};
use super::wave::Wave;
use crate::trace::math::{LANES, lanes};

/// Of fewer rays packets are not worth their way through the stages.
const FEW: u32 = 12;

/// Fills the wave with the next rays of a generation, as many packets as there is room for, if there are any left.
pub(super) fn fill(wave: &mut Wave, generation: &mut Generation) -> bool {
    wave.clear();
    let mut shared = SharedPackets::default();
    let rest = &generation.packets()[generation.taken..];
    let mut taken = 0;
    for sent in rest {
        if wave.count == PACKETS {
            break;
        }
        taken += 1;
        if sent.branches.rays.lanes.count_ones() >= FEW {
            wave.add(&sent.branches, &sent.slots);
            shared.note(sent, wave.count);
        } else {
            shared.add(sent, wave);
        }
    }
    generation.taken += taken;
    wave.count > 0
}

/// The packets of a wave in which rays are put together.
struct SharedPackets {
    /// By packet of the wave: how many of its lanes are taken.
    filled: [usize; PACKETS],
    /// Packets before this one are full.
    first: usize,
    /// By slot: behind which packet of the wave its next ray goes, counted from 1.
    behind: [u8; TILE_PIXELS],
}

impl Default for SharedPackets {
    fn default() -> Self {
        Self { filled: [LANES; PACKETS], first: 0, behind: [0; TILE_PIXELS] }
    }
}

impl SharedPackets {
    /// Notes that a whole packet is the last of so many.
    fn note(&mut self, sent: &SentPacket, count: usize) {
        for slot in sent.slots {
            self.behind[slot as usize % TILE_PIXELS] = byte(count);
        }
    }

    /// Adds the rays of a packet to others, where there is room for one more packet.
    fn add(&mut self, sent: &SentPacket, wave: &mut Wave) {
        for lane in lanes(sent.branches.rays.lanes) {
            let slot = sent.slots[lane];
            let behind = &mut self.behind[slot as usize % TILE_PIXELS];
            let from = self.first.max(usize::from(*behind));
            let open = (from..wave.count).find(|packet| self.filled[*packet] < LANES);
            let packet = open.unwrap_or_else(|| {
                self.filled[wave.count] = 0;
                wave.add_empty()
            });
            wave.copy((packet, self.filled[packet]), (&sent.branches, lane), slot);
            self.filled[packet] += 1;
            *behind = byte(packet + 1);
            while self.first < wave.count && self.filled[self.first] == LANES {
                self.first += 1;
            }
        }
    }
}

/// Of a number of packets.
#[expect(clippy::cast_possible_truncation, reason = "a wave has sixteen packets at most")]
fn byte(packets: usize) -> u8 {
    packets as u8
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::trace::rays::Ray;

    /// Packets with rays in some lanes, of pixels that begin somewhere and lie so far from each other, each ray by its number.
    fn generation(packets: &[(u32, u32, u32)]) -> (Generation, Vec<(u32, f64)>) {
        let (mut generation, mut rays) = (Generation::default(), Vec::new());
        for (filled, first, step) in packets {
            let mut pixels = [0; LANES];
            pixels.iter_mut().zip(0..).for_each(|(pixel, lane)| *pixel = (first + step * lane) % 256);
            generation.add(&pixels, false);
            let sent = generation.packets_mut().last_mut().unwrap();
            for lane in lanes(*filled) {
                let number = f64::from(u32::try_from(rays.len()).unwrap());
                sent.branches.rays.set(lane, &Ray::new(DVec3::splat(number), DVec3::X).unwrap());
                rays.push((pixels[lane], number));
            }
        }
        (generation, rays)
    }

    /// The pixels of a wave's rays, and their numbers, packet by packet.
    fn rays_of(wave: &Wave) -> Vec<Vec<(u32, f64)>> {
        let rays = |packet: usize| {
            lanes(wave.rays[packet].lanes)
                .map(move |lane| (wave.slots[packet][lane], wave.rays[packet].origins.get(lane).x))
        };
        (0..wave.count).map(|packet| rays(packet).collect()).collect()
    }

    proptest! {
        #[test]
        fn all_rays_go_on_in_the_order_of_their_pixels(
            packets in prop::collection::vec(
                (prop_oneof![Just(0xffff_u32), Just(0), 0..0x10000_u32, (0..16_u32).prop_map(|lane| 1 << lane)], 0..256_u32, prop_oneof![Just(1_u32), Just(3), Just(17)]),
                0..60,
            ),
        ) {
            let (mut generation, mut expected) = generation(&packets);
            let (mut wave, mut found, mut whole) = (Wave::new(), Vec::new(), 0);
            while fill(&mut wave, &mut generation) {
                for packet in rays_of(&wave) {
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
            // Of one pixel they are in order.
            found.sort_by_key(|(pixel, _)| *pixel);
            expected.sort_by_key(|(pixel, _)| *pixel);
            prop_assert_eq!(found, expected);
        }
    }

    #[test]
    fn few_rays_of_different_pixels_share_a_packet() {
        let (mut generation, _) =
            generation(&[(0b1111, 0, 1), (0b11, 0, 1), (0xffff, 100, 1), (0b11_1111, 50, 1)]);
        let mut wave = Wave::new();
        assert!(fill(&mut wave, &mut generation));
        let sizes: Vec<usize> = rays_of(&wave).iter().map(Vec::len).collect();
        assert_eq!(sizes, [10, 2, 16]);
        assert!(!fill(&mut wave, &mut generation));
    }
}
