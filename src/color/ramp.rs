//! Colour ramps.

use super::{Rgb, blend, to_f32};

/// Colours at increasing positions, the stops. Between two stops, they are blended linearly; beyond the first and the last one, the colour is
/// constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorRamp {
    count: usize,
    /// The stops; the rest is zero.
    stops: [(f64, Rgb); Self::LARGEST_COUNT],
}

impl ColorRamp {
    /// The largest number of stops.
    pub const LARGEST_COUNT: usize = 16;

    /// Creates a ramp. Returns `None` for fewer than two stops or more than [`LARGEST_COUNT`](Self::LARGEST_COUNT), and for positions that do
    /// not increase or are not finite.
    #[must_use]
    pub fn new(stops: &[(f64, Rgb)]) -> Option<Self> {
        let increase = |pair: &[(f64, Rgb)]| pair[0].0 < pair[1].0;
        let is_valid = (2..=Self::LARGEST_COUNT).contains(&stops.len())
            && stops.windows(2).all(increase)
            && stops.iter().all(|(position, _)| position.is_finite());
        let mut ramp = Self { count: stops.len(), stops: [(0.0, Rgb::ZERO); Self::LARGEST_COUNT] };
        is_valid.then(|| {
            ramp.stops[..stops.len()].copy_from_slice(stops);
            ramp
        })
    }

    /// Returns the stops.
    #[must_use]
    pub fn stops(&self) -> &[(f64, Rgb)] {
        &self.stops[..self.count]
    }

    /// Returns the ramp with each colour replaced by the result of a function.
    #[must_use]
    pub(crate) fn with_colors(mut self, replaced: impl Fn(Rgb) -> Rgb) -> Self {
        self.stops[..self.count].iter_mut().for_each(|(_, color)| *color = replaced(*color));
        self
    }

    /// Returns the colour at a position, exactly the colour of a stop at its position.
    #[must_use]
    pub fn at(&self, position: f64) -> Rgb {
        let (before, after, share) = self.around(position);
        blend(before, after, share)
    }

    /// Returns the colours of the stops before and after a position, and the share of the latter.
    pub(crate) fn around(&self, position: f64) -> (Rgb, Rgb, f32) {
        let stops = self.stops();
        let next = stops.iter().position(|(stop, _)| position < *stop).unwrap_or(stops.len());
        if next == 0 || next == stops.len() {
            let (_, end) = stops[next.saturating_sub(1)];
            return (end, end, 0.0);
        }
        let ((from, before), (to, after)) = (stops[next - 1], stops[next]);
        (before, after, to_f32((position - from) / (to - from)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramps_are_exact_at_stops_linear_between_and_constant_beyond() {
        let stops = [(-0.5, Rgb::X), (0.1, Rgb::new(0.3, 0.7, 2.0)), (0.3, Rgb::ZERO), (1.0, Rgb::Z)];
        let ramp = ColorRamp::new(&stops).unwrap();
        assert_eq!(ramp.stops(), stops);
        for (position, color) in stops {
            assert_eq!(ramp.at(position), color);
        }
        assert_eq!(ramp.at(-0.6), Rgb::X);
        assert_eq!(ramp.at(1.5), Rgb::Z);
        let between = ramp.at(0.65) - Rgb::Z * 0.5;
        assert!(between.abs().max_element() < 1e-6, "{between}");
        for (before, after) in [(-0.3, -0.4), (0.2, 0.25), (0.8, 0.9)] {
            assert!(ramp.at(before) != ramp.at(after));
        }
    }

    #[test]
    fn invalid_ramps_are_refused() {
        let many: Vec<(f64, Rgb)> = (0..17).map(|index| (f64::from(index), Rgb::ONE)).collect();
        assert!(ColorRamp::new(&many[..16]).is_some());
        for stops in [
            &many[..],
            &many[..1],
            &[],
            &[(0.0, Rgb::ONE), (0.0, Rgb::ZERO)],
            &[(1.0, Rgb::ONE), (0.0, Rgb::ZERO)],
            &[(0.0, Rgb::ONE), (f64::NAN, Rgb::ZERO)],
            &[(0.0, Rgb::ONE), (f64::INFINITY, Rgb::ZERO)],
        ] {
            assert_eq!(ColorRamp::new(stops), None);
        }
    }
}
