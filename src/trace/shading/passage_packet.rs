//! Attenuation along sixteen rays: the operations of [`PathState::passage`](super::PathState::passage), in the same order.

use fearless_simd::{f32x16, prelude::*};

use super::medium_stack::{MediumStack, MediumStacks};
use super::path_packet::PathPacket;
use crate::color::Rgb;
use crate::trace::effects::Effects;
use crate::trace::math::{Colors, F64s, Numbers, bits16, exp, lanes, splat};
use crate::trace::rays::RayPacket;
use crate::trace::scene::{PreparedFog, PreparedScene};

/// The attenuation along rays: incoming light times `transmitted`, plus `added`.
#[derive(Clone, Copy)]
pub(crate) struct PassageLanes<S: Simd> {
    pub(crate) transmitted: [f32x16<S>; 3],
    pub(crate) added: [f32x16<S>; 3],
}

/// Rays along which light is attenuated, with their absorption coefficients.
pub(crate) struct Absorbers {
    /// Lanes of the rays.
    pub(crate) lanes: u32,
    /// Absorption coefficients of the solids that contain the rays, per unit of length.
    absorption: Colors,
    /// True if any absorption coefficient is not zero.
    in_solids: bool,
}

impl Absorbers {
    /// Finds the attenuated rays in the lanes `active`.
    #[inline(always)]
    pub(crate) fn of(
        scene: &PreparedScene,
        effects: Effects,
        (paths, media): (&PathPacket, &MediumStacks),
        active: u32,
    ) -> Self {
        let in_fog = effects.extras && scene.fog.density != 0.0;
        let mut all = Self {
            lanes: if in_fog { active } else { 0 },
            absorption: Colors::splat(Rgb::ZERO),
            in_solids: false,
        };
        if effects.in_media() {
            for lane in lanes(active).filter(|lane| paths.media[*lane] != MediumStack::NONE) {
                let absorption = media.absorption(scene, paths.media[lane]);
                if absorption != Rgb::ZERO {
                    all.lanes |= 1 << lane;
                    all.absorption.set(lane, absorption);
                    all.in_solids = true;
                }
            }
        }
        all
    }

    /// Returns the lanes in which the light of rays that hit nothing is attenuated.
    #[inline(always)]
    pub(crate) fn endless<S: Simd>(&self, simd: S, fog: &PreparedFog, rays: &RayPacket) -> u32 {
        let PassageLanes { transmitted, .. } = self.over(simd, fog, rays, &Numbers::splat(f64::INFINITY));
        let one = f32x16::splat(simd, 1.0);
        let clear = transmitted.map(|channel| bits16(channel.simd_eq(one)));
        self.lanes & !(clear[0] & clear[1] & clear[2])
    }

    /// Computes the attenuation over lengths, which are infinite for rays that hit nothing.
    #[inline(always)]
    pub(crate) fn over<S: Simd>(
        &self,
        simd: S,
        fog: &PreparedFog,
        rays: &RayPacket,
        lengths: &Numbers,
    ) -> PassageLanes<S> {
        let one = f32x16::splat(simd, 1.0);
        let mut absorbed = [one; 3];
        if self.in_solids {
            let coefficients = self.absorption.load(simd);
            for channel in 0..3 {
                let (first, second) = coefficients[channel].widen();
                let share = shares(simd, (first, second), lengths);
                // 0 times an infinite length is NaN; the transmittance is then 1.
                let none = coefficients[channel].simd_eq(f32x16::splat(simd, 0.0));
                absorbed[channel] = none.select(one, share);
            }
        }
        let mut seen = one;
        if fog.density != 0.0 && fog.is_uniform() {
            let density = splat(simd, fog.density);
            seen = shares(simd, (density, density), lengths);
        } else if fog.density != 0.0 {
            let mut depths = Numbers::splat(0.0);
            for lane in lanes(self.lanes) {
                let (origin, direction) = (rays.origins.get(lane), rays.directions.get(lane));
                depths.set(lane, fog.optical_depth(origin, direction, lengths.get(lane)));
            }
            let one = splat(simd, 1.0);
            seen = shares(simd, (one, one), &depths);
        }
        let fogged = one - seen;
        PassageLanes {
            transmitted: [absorbed[0] * seen, absorbed[1] * seen, absorbed[2] * seen],
            added: [
                absorbed[0] * (fogged * fog.color.x),
                absorbed[1] * (fogged * fog.color.y),
                absorbed[2] * (fogged * fog.color.z),
            ],
        }
    }
}

/// Computes the transmittance of an absorbing solid over finite lengths, per channel and lane:
/// [`transmittance`](crate::trace::scene::transmittance).
#[inline(always)]
pub(crate) fn transmittances<S: Simd>(simd: S, absorption: Rgb, lengths: &Numbers) -> [f32x16<S>; 3] {
    let mut transmitted = [f32x16::splat(simd, 1.0); 3];
    for (channel, coefficient) in transmitted.iter_mut().zip(absorption.to_array()) {
        let coefficient = splat(simd, f64::from(coefficient));
        *channel = shares(simd, (coefficient, coefficient), lengths);
    }
    transmitted
}

/// Computes exp(-coefficient length). `first` and `second` are the coefficients of the two halves of the lanes.
#[inline(never)]
fn shares<S: Simd>(simd: S, (first, second): (F64s<S>, F64s<S>), lengths: &Numbers) -> f32x16<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            let mut shares = Numbers::splat(0.0);
            for (half, coefficients) in [first, second].into_iter().enumerate() {
                shares.store(half, exp(-coefficients * lengths.load(simd, half)));
            }
            shares.rounded(simd)
        },
    )
}
