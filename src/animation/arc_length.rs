//! Arc lengths of curves of Hermite segments, and points at a given length from the start.
//!
//! The speed |v(u)| of a cubic is the root of a polynomial, and its integral has no closed form. Each segment is halved recursively, until
//! Gauss-Legendre quadrature of a part agrees with the sum over its halves. Such a part, a panel, is short enough for the same rule to
//! measure any part of it. Lengths are therefore inverted by Newton's method within one panel.

use glam::DVec3;

use super::hermite::{hermite, hermite_velocity};

/// A cubic Hermite segment, relative to its start point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Segment {
    /// The vector from the segment's start to its end.
    pub(super) difference: DVec3,
    /// The derivatives at the segment's start and end.
    pub(super) slopes: [DVec3; 2],
}

/// Segments with their lengths. Coordinates must be far from the limits of f64 when squared.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ArcLength {
    segments: Vec<Segment>,
    /// The panels in the order of the curve; not empty.
    panels: Vec<Panel>,
    length: f64,
}

/// A part of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Panel {
    segment: usize,
    /// The parameters of the panel's start and end.
    from: f64,
    to: f64,
    /// The length of the curve before the panel, and the length of the panel.
    before: f64,
    length: f64,
}

/// The largest error of a panel, as a fraction of the segment's length. 1e-6 is required.
const TOLERANCE: f64 = 1e-13;

/// The maximum number of halvings of a segment, reached only near a point where it almost stops and turns.
const DEEPEST: u32 = 40;

impl Segment {
    /// Returns the point at `u` in 0..=1, relative to the segment's start.
    pub(super) fn at(&self, u: f64) -> DVec3 {
        hermite(self.difference, self.slopes, u)
    }

    /// Returns the direction of motion at `u`, as a unit vector. Where the path reverses and has no velocity, it is the direction of the whole
    /// segment.
    pub(super) fn direction(&self, u: f64) -> DVec3 {
        let velocity = hermite_velocity(self.difference, self.slopes, u);
        velocity.try_normalize().unwrap_or_else(|| self.difference.normalize_or_zero())
    }

    fn speed(&self, u: f64) -> f64 {
        hermite_velocity(self.difference, self.slopes, u).length()
    }

    /// Computes the length between two parameters, exact for speeds that are polynomials of degree 15.
    fn length(&self, from: f64, to: f64) -> f64 {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let pair = |(node, weight): (f64, f64)| {
            weight * (self.speed(middle - half * node) + self.speed(middle + half * node))
        };
        half * GAUSS_LEGENDRE.into_iter().map(pair).sum::<f64>()
    }
}

/// The positive nodes of 8-point Gauss-Legendre quadrature, and their weights.
const GAUSS_LEGENDRE: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

impl ArcLength {
    /// Measures a curve of segments. Returns `None` if there are no segments.
    pub(super) fn new(segments: Vec<Segment>) -> Option<Self> {
        let mut measured = Self { panels: Vec::new(), length: 0.0, segments };
        for index in 0..measured.segments.len() {
            let whole = measured.segments[index].length(0.0, 1.0);
            measured.measure(index, (0.0, 1.0), whole, TOLERANCE * whole, DEEPEST);
        }
        (!measured.panels.is_empty()).then_some(measured)
    }

    /// Measures a part of a segment whose length is roughly `whole`.
    fn measure(&mut self, index: usize, (from, to): (f64, f64), whole: f64, tolerance: f64, depth: u32) {
        let segment = &self.segments[index];
        let middle = 0.5 * (from + to);
        let (left, right) = (segment.length(from, middle), segment.length(middle, to));
        if depth > 0 && (left + right - whole).abs() > tolerance {
            self.measure(index, (from, middle), left, tolerance, depth - 1);
            self.measure(index, (middle, to), right, tolerance, depth - 1);
        } else {
            self.panels.push(Panel { segment: index, from, to, before: self.length, length: left + right });
            self.length += left + right;
        }
    }

    /// Returns the length of the whole curve.
    pub(super) fn length(&self) -> f64 {
        self.length
    }

    pub(super) fn segment(&self, index: usize) -> &Segment {
        &self.segments[index]
    }

    /// Returns the segment and the parameter in 0..=1 at a length from the start; the nearest end for lengths outside the curve.
    pub(super) fn locate(&self, length: f64) -> (usize, f64) {
        let after = self.panels.partition_point(|panel| panel.before <= length);
        let panel = &self.panels[after.saturating_sub(1)];
        (panel.segment, self.parameter(panel, length - panel.before))
    }

    /// Inverts the length by Newton's method, with bisection if a step leaves the bracket.
    fn parameter(&self, panel: &Panel, length: f64) -> f64 {
        /// More iterations than bisection alone needs.
        const MOST: usize = 64;
        if length <= 0.0 {
            return panel.from;
        }
        if length >= panel.length {
            return panel.to;
        }
        let segment = &self.segments[panel.segment];
        let (mut low, mut high) = (panel.from, panel.to);
        let mut u = low + (high - low) * (length / panel.length);
        for _ in 0..MOST {
            let excess = segment.length(panel.from, u) - length;
            if excess > 0.0 {
                high = u;
            } else {
                low = u;
            }
            let newton = u - excess / segment.speed(u);
            let next = if (low..=high).contains(&newton) { newton } else { 0.5 * (low + high) };
            if (next - u).abs() <= f64::EPSILON * u {
                return next;
            }
            u = next;
        }
        u
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(difference: DVec3, slopes: [DVec3; 2]) -> ArcLength {
        ArcLength::new(vec![Segment { difference, slopes }]).unwrap()
    }

    #[test]
    fn lengths_agree_with_closed_forms() {
        let straight = measured(DVec3::new(3.0, 4.0, 0.0), [DVec3::new(3.0, 4.0, 0.0); 2]);
        assert!((straight.length() - 5.0).abs() < 1e-14);
        // x = u, y = u^2: (2 sqrt 5 + asinh 2) / 4.
        let parabola = measured(DVec3::new(1.0, 1.0, 0.0), [DVec3::X, DVec3::new(1.0, 2.0, 0.0)]);
        let expected = 0.25 * (2.0 * 5.0_f64.sqrt() + libm::asinh(2.0));
        assert!((parabola.length() - expected).abs() < 1e-14);
        // x = u^2, y = u^3, which starts from rest: (13 sqrt 13 - 8) / 27.
        let resting = measured(DVec3::new(1.0, 1.0, 0.0), [DVec3::ZERO, DVec3::new(2.0, 3.0, 0.0)]);
        let expected = (13.0 * 13.0_f64.sqrt() - 8.0) / 27.0;
        assert!((resting.length() - expected).abs() < 1e-14, "{}", resting.length() - expected);
        // x = (2u - 1)^2, y = (2u - 1)^3, which has a cusp in its middle: twice that length.
        let cusp =
            measured(DVec3::new(0.0, 2.0, 0.0), [DVec3::new(-4.0, 6.0, 0.0), DVec3::new(4.0, 6.0, 0.0)]);
        assert!((cusp.length() - 2.0 * expected).abs() < 1e-13, "{}", cusp.length() - 2.0 * expected);
        // x = (3u - 1)^2, y = (3u - 1)^3, with a small rise: it almost rests at a parameter that no halving hits.
        let (slopes, rise) = ([(-6.0, 9.0), (12.0, 36.0)], 1e-6);
        let near = measured(DVec3::new(3.0, 9.0, rise), slopes.map(|(x, y)| DVec3::new(x, y, rise)));
        let fine: f64 = (0..100_000)
            .map(|step| {
                let from = f64::from(step) / 1e5;
                near.segments[0].length(from, from + 1e-5)
            })
            .sum();
        assert!((near.length() / fine - 1.0).abs() < 1e-11, "{}", near.length() / fine - 1.0);
    }

    #[test]
    fn positions_have_the_requested_length() {
        let curves = [
            measured(DVec3::new(1.0, 1.0, 0.0), [DVec3::X, DVec3::new(1.0, 2.0, 0.0)]),
            measured(DVec3::new(1.0, 1.0, 0.0), [DVec3::ZERO, DVec3::new(2.0, 3.0, 0.0)]),
            measured(DVec3::new(0.0, 2.0, 0.0), [DVec3::new(-4.0, 6.0, 0.0), DVec3::new(4.0, 6.0, 0.0)]),
            measured(DVec3::new(1.0, 0.0, 0.0), [DVec3::ZERO; 2]),
        ];
        for curve in &curves {
            for step in 0..=1000 {
                let length = curve.length() * f64::from(step) / 1000.0;
                let (_, u) = curve.locate(length);
                // The sum is taken panel by panel, so that it is as exact as the panels.
                let whole: f64 =
                    curve.panels.iter().filter(|panel| panel.to <= u).map(|panel| panel.length).sum();
                let part = curve.panels.iter().find(|panel| panel.from < u && u < panel.to);
                let part = part.map_or(0.0, |panel| curve.segments[0].length(panel.from, u));
                assert!((whole + part - length).abs() < 2e-15 * curve.length(), "{length}: {u}");
            }
            assert_eq!((curve.locate(-1.0), curve.locate(9.0)), ((0, 0.0), (0, 1.0)));
        }
    }

    #[test]
    fn smooth_segments_need_few_panels() {
        let gentle = measured(DVec3::new(1.0, 1.0, 0.0), [DVec3::X, DVec3::Y]);
        assert!(gentle.panels.len() <= 4, "{}", gentle.panels.len());
    }
}
