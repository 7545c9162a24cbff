//! The environment of the shapes: the background, and fog.

use glam::DVec3;

use crate::color::{Rgb, to_f32};
use crate::trace::math::{Bytes, exp};

/// The colour of rays that hit nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PreparedBackground {
    /// The same colour everywhere.
    Flat(Rgb),
    /// `bottom` straight down, `top` straight up. In between, with the unit direction's y component y: without a horizon, a share (1 + y)/2 of
    /// `top`; with one, a share |y| of the colour straight up or down, and the rest of the horizon's colour.
    Gradient {
        /// Colour straight down.
        bottom: Rgb,
        /// Colour of level directions, if it is not the mean of the others.
        horizon: Option<Rgb>,
        /// Colour straight up.
        top: Rgb,
    },
}

impl Default for PreparedBackground {
    /// Returns black.
    fn default() -> Self {
        Self::Flat(Rgb::ZERO)
    }
}

impl PreparedBackground {
    /// Writes the bytes of everything that pictures depend on.
    pub(super) fn write(&self, bytes: &mut Bytes) {
        match *self {
            Self::Flat(color) => {
                bytes.count(0_u32);
                bytes.colors([color]);
            }
            Self::Gradient { bottom, horizon, top } => {
                bytes.count(if horizon.is_some() { 2_u32 } else { 1 });
                bytes.colors([bottom, top]);
                horizon.into_iter().for_each(|horizon| bytes.colors([horizon]));
            }
        }
    }

    /// Returns the colour in a direction of any length except zero.
    #[must_use]
    pub fn towards(&self, direction: DVec3) -> Rgb {
        match *self {
            Self::Flat(color) => color,
            Self::Gradient { bottom, horizon, top } => {
                let y = direction.y / direction.length();
                let (from, to, share) = match horizon {
                    None => (bottom, top, 0.5 + 0.5 * y),
                    Some(horizon) => (horizon, if y < 0.0 { bottom } else { top }, y.abs()),
                };
                let share = to_f32(share);
                from * (1.0 - share) + to * share
            }
        }
    }

    /// Returns the mean over all directions.
    pub(crate) fn mean(&self) -> Rgb {
        match *self {
            Self::Flat(color) => color,
            Self::Gradient { bottom, horizon, top } => {
                let mean = (bottom + top) * 0.5;
                // The mean of |y| over the unit sphere is 1/2.
                horizon.map_or(mean, |horizon| (mean + horizon) * 0.5)
            }
        }
    }

    /// Returns an upper bound of each channel over all directions.
    pub(crate) fn radiance_bound(&self) -> Rgb {
        match *self {
            Self::Flat(color) => color,
            Self::Gradient { bottom, horizon, top } => {
                let ends = bottom.max(top);
                horizon.map_or(ends, |horizon| horizon.max(ends))
            }
        }
    }
}

/// Fog: over a length d, a share exp(-density d) of the light behind is visible, and the rest is `color`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PreparedFog {
    /// The colour of the fog.
    pub color: Rgb,
    /// The extinction per unit of length, 0 or more.
    pub density: f64,
}

/// The effect of the medium along a ray on light: incoming light times `transmitted`, plus `added`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attenuation {
    /// The share of the incoming light that is transmitted.
    pub transmitted: Rgb,
    /// The light that is added along the ray.
    pub added: Rgb,
}

impl Attenuation {
    /// The identity: no medium along the ray.
    pub const CLEAR: Self = Self { transmitted: Rgb::ONE, added: Rgb::ZERO };

    /// Computes the passage through `length` of an absorbing medium that contains fog.
    pub(crate) fn through(absorption: Rgb, fog: &PreparedFog, length: f64) -> Self {
        let absorbed = transmittance(absorption, length);
        let seen = share(fog.density, length);
        Self { transmitted: absorbed * seen, added: absorbed * (fog.color * (1.0 - seen)) }
    }

    /// Applies the passage to incoming light.
    #[must_use]
    pub fn of(&self, light: Rgb) -> Rgb {
        self.transmitted * light + self.added
    }
}

/// Computes the transmittance by the Beer-Lambert law, per channel: exp(-absorption length). The length may be infinite.
pub(crate) fn transmittance(absorption: Rgb, length: f64) -> Rgb {
    Rgb::from_array(absorption.to_array().map(|coefficient| share(f64::from(coefficient), length)))
}

/// Returns exp(-coefficient length); 1 if the coefficient is 0, even for an infinite length.
fn share(coefficient: f64, length: f64) -> f32 {
    if coefficient == 0.0 { 1.0 } else { to_f32(exp(-coefficient * length)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_infinite_way_hides_all_or_nothing() {
        let absorption = Rgb::new(0.0, 1e-9, 2.0);
        assert_eq!(transmittance(absorption, f64::INFINITY), Rgb::new(1.0, 0.0, 0.0));
        let fog = PreparedFog { color: Rgb::splat(0.5), density: 1e-3 };
        assert_eq!(Attenuation::through(Rgb::ZERO, &fog, f64::INFINITY).of(Rgb::ONE), Rgb::splat(0.5));
        assert_eq!(
            Attenuation::through(Rgb::ZERO, &PreparedFog::default(), f64::INFINITY),
            Attenuation::CLEAR
        );
    }

    #[test]
    fn media_thin_out_as_exponentials_do() {
        let absorption = Rgb::new(0.5, 1.0, 2.0);
        let through = transmittance(absorption, 1.5);
        for (channel, coefficient) in through.to_array().into_iter().zip(absorption.to_array()) {
            assert!((f64::from(channel) - libm::exp(-1.5 * f64::from(coefficient))).abs() < 1e-7);
        }
        // Twice the length squares the transmittance.
        let difference = transmittance(absorption, 3.0) - through * through;
        assert!(difference.abs().max_element() < 1e-7);
    }

    #[test]
    fn a_gradient_goes_from_bottom_to_top() {
        let (bottom, top) = (Rgb::new(1.0, 0.0, 0.5), Rgb::new(0.0, 1.0, 0.5));
        let sky = PreparedBackground::Gradient { bottom, horizon: None, top };
        assert_eq!(sky.towards(DVec3::NEG_Y * 3.0), bottom);
        assert_eq!(sky.towards(DVec3::Y * 7.0), top);
        assert_eq!(sky.towards(DVec3::X), (bottom + top) * 0.5);
        assert_eq!(sky.radiance_bound(), Rgb::new(1.0, 1.0, 0.5));
    }

    #[test]
    fn a_gradient_with_a_horizon_has_its_colour_on_level_directions() {
        let (bottom, horizon, top) = (Rgb::X, Rgb::new(0.25, 1.5, 0.5), Rgb::Z);
        let sky = PreparedBackground::Gradient { bottom, horizon: Some(horizon), top };
        assert_eq!(sky.towards(DVec3::NEG_Y * 3.0), bottom);
        assert_eq!(sky.towards(DVec3::Y * 7.0), top);
        assert_eq!(sky.towards(DVec3::new(-2.0, 0.0, 5.0)), horizon);
        assert_eq!(sky.towards(DVec3::new(0.0, -3.0, 4.0)), horizon * (1.0 - 0.6_f32) + bottom * 0.6_f32);
        assert_eq!(sky.radiance_bound(), Rgb::new(1.0, 1.5, 1.0));
        // Archimedes: y of points on the sphere is uniformly distributed.
        let heights = (0..1000).map(|step| (f64::from(step) + 0.5) / 500.0 - 1.0);
        let colors = heights.map(|y| sky.towards(DVec3::new((1.0 - y * y).sqrt(), y, 0.0)));
        let mean = colors.sum::<Rgb>() / 1000.0;
        assert!((mean - sky.mean()).abs().max_element() < 1e-5, "{mean} {}", sky.mean());
    }
}
