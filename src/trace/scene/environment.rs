//! The environment of the shapes: the background, and fog.

use glam::DVec3;

use crate::color::{ColorRamp, Rgb, blend, to_f32};
use crate::trace::math::{Bytes, exp};

/// The colour of rays that hit nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "a scene has one background, which is copied like other settings"
)]
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
    /// Colours at values of the unit direction's y component.
    Stops(ColorRamp),
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
            Self::Stops(ramp) => {
                bytes.count(3_u32);
                bytes.count(ramp.stops().len() as u64);
                for (height, color) in ramp.stops() {
                    bytes.number(*height);
                    bytes.colors([*color]);
                }
            }
        }
    }

    /// Returns the colour in a direction of any length except zero.
    #[must_use]
    pub fn towards(&self, direction: DVec3) -> Rgb {
        match self {
            Self::Flat(color) => *color,
            Self::Gradient { .. } | Self::Stops(_) => {
                self.gradient_terms(direction).map_or(Rgb::ZERO, |terms| terms.color())
            }
        }
    }

    /// Returns the terms of the gradient in a direction of any length except zero; `None` without a gradient.
    #[inline]
    pub(super) fn gradient_terms(&self, direction: DVec3) -> Option<GradientTerms> {
        let y = direction.y / direction.length();
        let (from, to, share) = match self {
            Self::Flat(_) => return None,
            Self::Gradient { bottom, horizon: None, top } => (*bottom, *top, to_f32(0.5 + 0.5 * y)),
            Self::Gradient { bottom, horizon: Some(horizon), top } => {
                (*horizon, if y < 0.0 { *bottom } else { *top }, to_f32(y.abs()))
            }
            Self::Stops(ramp) => ramp.around(y),
        };
        Some(GradientTerms { from, to, share })
    }

    /// Returns the detail of the gradient within an angle of a unit direction. `None` if its colour changes there by at most 1/64, about four
    /// 8-bit levels of light. Only stops have any.
    pub(crate) fn detail(&self, unit: DVec3, angle: f64) -> Option<GradientDetail> {
        let Self::Stops(ramp) = self else { return None };
        // y changes by at most the angle.
        let (low, high) = (unit.y - angle, unit.y + angle);
        let changes = ramp.stops().windows(2).any(|pair| {
            let (from, to) = (low.max(pair[0].0), high.min(pair[1].0));
            from < to && (ramp.at(to) - ramp.at(from)).abs().max_element() > 1.0 / 64.0
        });
        let mut detail = GradientDetail { height: f64::INFINITY, radiance: 0.0 };
        for band in ramp.stops().windows(3).filter(|band| low <= band[0].0 && band[2].0 <= high) {
            detail.height = detail.height.min(band[2].0 - band[0].0);
            detail.radiance = band.iter().fold(detail.radiance, |most, stop| most.max(stop.1.max_element()));
        }
        changes.then_some(detail)
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
            Self::Stops(ramp) => {
                // y is uniformly distributed, and the ramp is linear between its stops.
                let heights = ramp.stops().iter().map(|(height, _)| height.clamp(-1.0, 1.0));
                let heights: Vec<f64> = [-1.0].into_iter().chain(heights).chain([1.0]).collect();
                let pieces = heights.windows(2).map(|piece| {
                    (ramp.at(piece[0]) + ramp.at(piece[1])) * to_f32(0.25 * (piece[1] - piece[0]))
                });
                pieces.sum()
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
            Self::Stops(ramp) => ramp.stops().iter().fold(Rgb::ZERO, |most, (_, color)| most.max(*color)),
        }
    }
}

/// A part of a gradient in which its colour changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GradientDetail {
    /// The height of the narrowest band between three stops, in units of the direction's y component; infinite for an edge.
    pub height: f64,
    /// The largest radiance of such a band.
    pub radiance: f32,
}

/// The terms of a gradient in a direction: (1 - s) c1 + s c2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GradientTerms {
    /// c1: the colour straight down, the horizon's, or that of the stop below.
    pub from: Rgb,
    /// c2: the colour straight up, straight down below a horizon, or that of the stop above.
    pub to: Rgb,
    /// s: with the unit direction's y component y, (1 + y)/2, or |y| with a horizon, or the position between two stops.
    pub share: f32,
}

impl GradientTerms {
    #[inline]
    fn color(&self) -> Rgb {
        blend(self.from, self.to, self.share)
    }
}

/// Fog: over an optical depth t, a share exp(-t) of the light behind is visible, and the rest is `color`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PreparedFog {
    /// The colour of the fog.
    pub color: Rgb,
    /// The extinction per unit of length, 0 or more.
    pub density: f64,
    /// The decrease of the density with height; `None` for uniform fog.
    pub layer: Option<FogLayer>,
    /// False if rays that hit nothing see the background without fog.
    pub hides_background: bool,
}

/// A density that falls with height: at y, it is multiplied by exp(-(y - level) / height).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FogLayer {
    /// The y at which the density is as given.
    pub level: f64,
    /// The height over which the density falls to 1/e, greater than 0.
    pub height: f64,
}

impl Default for PreparedFog {
    /// Returns no fog.
    fn default() -> Self {
        Self { color: Rgb::ZERO, density: 0.0, layer: None, hides_background: true }
    }
}

impl PreparedFog {
    /// Returns whether the optical depth of every ray is its length, infinite if it hits nothing, times the density.
    #[inline]
    pub(crate) fn is_uniform(&self) -> bool {
        self.layer.is_none() && self.hides_background
    }

    /// Returns the optical depth along a ray, whose length is infinite if it hits nothing.
    pub(crate) fn optical_depth(&self, origin: DVec3, direction: DVec3, length: f64) -> f64 {
        if length == f64::INFINITY && !self.hides_background {
            return 0.0;
        }
        let Some(layer) = &self.layer else { return self.density * length };
        let slope = direction.y / direction.length();
        self.density * layer.equivalent_length(origin.y, slope, length)
    }

    /// Writes the bytes of everything except colour and density that pictures depend on; nothing for uniform fog.
    pub(super) fn write_layer(&self, bytes: &mut Bytes) {
        if self.is_uniform() {
            return;
        }
        bytes.count(u32::from(self.hides_background) + 2 * u32::from(self.layer.is_some()));
        let layer = self.layer.iter().flat_map(|layer| [layer.level, layer.height]);
        layer.for_each(|number| bytes.number(number));
    }
}

impl FogLayer {
    /// Returns the length in fog of constant density that has the optical depth of a ray from the height `y`: the integral of
    /// exp(-(y - level) / height) along it. `slope` is the rise per length.
    fn equivalent_length(&self, y: f64, slope: f64, length: f64) -> f64 {
        if length == 0.0 {
            return 0.0;
        }
        // 0 times an infinite length is NaN.
        let rise = if slope == 0.0 { 0.0 } else { slope * length };
        let climb = rise.abs() / self.height;
        // The integral relative to the density at the lower end: neither factor overflows where their product does not. For nearly level
        // rays, 1 - exp(-climb) would cancel; `expm1` does not.
        let relative = match -libm::expm1(-climb) {
            _ if climb == 0.0 => length,
            fall if climb < 1.0 => length * (fall / climb),
            fall => fall * (self.height / slope.abs()),
        };
        // Without a bound, even where the density underflows to 0.
        if relative == f64::INFINITY {
            return relative;
        }
        let lowest = y + rise.min(0.0);
        relative * libm::exp((self.level - lowest) / self.height)
    }
}

/// The medium along a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PassageTerms {
    /// The absorption coefficients of the transparent solid that the ray is inside, per unit of length.
    pub absorption: Rgb,
    /// The colour of the fog.
    pub fog: Rgb,
    /// The optical depth of the fog.
    pub optical_depth: f64,
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

    /// Computes the passage through `length` of a medium.
    pub(crate) fn through(medium: &PassageTerms, length: f64) -> Self {
        let PassageTerms { absorption, fog, optical_depth } = *medium;
        let absorbed = transmittance(absorption, length);
        let seen = share(1.0, optical_depth);
        Self { transmitted: absorbed * seen, added: absorbed * (fog * (1.0 - seen)) }
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
        let gray = Rgb::splat(0.5);
        let fog = PreparedFog { color: gray, density: 1e-3, ..PreparedFog::default() };
        let medium = |optical_depth| PassageTerms { absorption: Rgb::ZERO, fog: gray, optical_depth };
        let endless = |fog: &PreparedFog| {
            let depth = fog.optical_depth(DVec3::ZERO, DVec3::Z, f64::INFINITY);
            Attenuation::through(&medium(depth), f64::INFINITY)
        };
        assert_eq!(endless(&fog).of(Rgb::ONE), gray);
        assert_eq!(endless(&PreparedFog { hides_background: false, ..fog }), Attenuation::CLEAR);
        assert_eq!(Attenuation::through(&medium(0.0), f64::INFINITY), Attenuation::CLEAR);
    }

    /// Integrates a density that falls with height by Simpson's rule, with ever finer steps near the lower end.
    fn integrated(layer: &FogLayer, y: f64, slope: f64, length: f64) -> f64 {
        const STEPS: u32 = 40_000;
        let density = |s: f64| libm::exp((layer.level - (y + slope * s)) / layer.height);
        let step = length / f64::from(STEPS);
        let sum: f64 = (0..=STEPS)
            .map(|at| {
                let weight = if at == 0 || at == STEPS { 1.0 } else { f64::from(2 + 2 * (at % 2)) };
                weight * density(f64::from(at) * step)
            })
            .sum();
        sum * step / 3.0
    }

    #[test]
    fn fog_with_height_has_the_optical_depth_of_its_integral() {
        let layer = FogLayer { level: -0.5, height: 1.75 };
        for slope in [0.0, 1e-300, -1e-12, 1e-7, -1e-3, 0.02, -0.4, 0.75, -1.0, 1.0] {
            for (y, length) in [(0.0, 1e-9), (3.0, 0.5), (-4.0, 2.0), (12.0, 20.0), (1.0, 40.0)] {
                let (found, expected) =
                    (layer.equivalent_length(y, slope, length), integrated(&layer, y, slope, length));
                let error = (found - expected).abs() / expected;
                assert!(error < 1e-12, "{slope} from {y} over {length}: {found:e} {expected:e}");
            }
        }
    }

    /// Checks that a ray and the same ray backwards, and the sum of two parts of a ray, agree.
    #[test]
    fn fog_with_height_is_the_same_both_ways_and_in_parts() {
        let layer = FogLayer { level: 2.0, height: 0.3 };
        for (y, slope, length) in
            [(2.0, 0.3, 5.0), (400.0, -0.9, 440.0), (-20.0, 1e-9, 3.0), (0.0, -1.0, 2.0)]
        {
            let whole = layer.equivalent_length(y, slope, length);
            let back = layer.equivalent_length(y + slope * length, -slope, length);
            let middle = y + slope * length / 4.0;
            let parts = layer.equivalent_length(y, slope, length / 4.0)
                + layer.equivalent_length(middle, slope, length * 0.75);
            for other in [back, parts] {
                assert!((other - whole).abs() < 1e-11 * whole, "{whole:e} {other:e}");
            }
        }
    }

    #[test]
    fn endless_rays_leave_fog_with_height_only_upwards() {
        let layer = FogLayer { level: 1.0, height: 2.0 };
        let endless = |y, slope| layer.equivalent_length(y, slope, f64::INFINITY);
        assert_eq!(endless(1.0, 1.0), 2.0);
        assert_eq!(endless(1.0, 0.5), 4.0);
        assert!((endless(5.0, 0.25) - 8.0 * libm::exp(-2.0)).abs() < 1e-15);
        for (y, slope) in [(1.0, 0.0), (1e9, 0.0), (1.0, -1e-9), (1e9, -1.0)] {
            assert_eq!(endless(y, slope), f64::INFINITY, "{slope} from {y}");
        }
    }

    #[test]
    fn extreme_fog_with_height_is_never_nan() {
        let extremes = [0.0, 5e-324, 1e-60, 1.0, 1e60, 1e300, f64::MAX];
        let signed = || extremes.into_iter().flat_map(|number| [number, -number]);
        for height in extremes.into_iter().skip(1) {
            for level in signed() {
                let layer = FogLayer { level, height };
                for y in signed() {
                    for slope in [0.0, 5e-324, -5e-324, 1e-9, -0.5, 1.0] {
                        for length in extremes.into_iter().chain([f64::INFINITY]) {
                            let found = layer.equivalent_length(y, slope, length);
                            assert!(found >= 0.0, "{layer:?} {y} {slope} {length}: {found}");
                        }
                    }
                }
            }
        }
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
    fn stops_are_the_general_form_of_gradients() {
        let (bottom, horizon, top) = (Rgb::new(1.0, 0.0, 0.5), Rgb::new(0.25, 1.5, 0.5), Rgb::Z);
        let stops = |stops: &[(f64, Rgb)]| PreparedBackground::Stops(ColorRamp::new(stops).unwrap());
        for (stops, short) in [
            (
                stops(&[(-1.0, bottom), (1.0, top)]),
                PreparedBackground::Gradient { bottom, horizon: None, top },
            ),
            (
                stops(&[(-1.0, bottom), (0.0, horizon), (1.0, top)]),
                PreparedBackground::Gradient { bottom, horizon: Some(horizon), top },
            ),
        ] {
            for y in [-1.0, -0.9, -0.3, 0.0, 1e-9, 0.4, 0.99, 1.0_f64] {
                let direction = DVec3::new((1.0 - y * y).sqrt(), y, 0.0) * 3.0;
                let difference = stops.towards(direction) - short.towards(direction);
                assert!(difference.abs().max_element() < 1e-6, "{y}: {difference}");
            }
            assert!((stops.mean() - short.mean()).abs().max_element() < 1e-6);
            assert_eq!(stops.radiance_bound(), short.radiance_bound());
        }
        // Constant beyond the first and the last stop: half of the directions are below the horizon.
        let dawn = stops(&[(0.0, Rgb::X), (0.5, Rgb::Z)]);
        assert_eq!(dawn.towards(DVec3::new(1.0, -0.01, 0.0)), Rgb::X);
        assert_eq!(dawn.towards(DVec3::Y), Rgb::Z);
        assert!((dawn.mean() - Rgb::new(0.625, 0.0, 0.375)).abs().max_element() < 1e-6);
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
