//! The usual families of easing: Penner's, under the names by which the web and animation programs know them.

use std::f64::consts::{FRAC_PI_4, TAU};

/// How progress gathers speed: a rise from 0 to 1, slow at first.
///
/// [`Easing`](super::Easing) runs it forwards, backwards, or both, half the way each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ease {
    /// A quarter of a cosine wave.
    Sine,
    /// u^2.
    Quad,
    /// u^3.
    Cubic,
    /// u^4.
    Quart,
    /// u^5.
    Quint,
    /// (2^(10u) - 1) / 1023: doubles ten times. It starts at 0, where the often seen 2^(10u - 10) starts at 1/1024.
    Expo,
    /// A quarter of a circle.
    Circ,
    /// Swings back by a tenth before it goes forward.
    Back,
    /// Swings about the start, ever wider.
    Elastic,
    /// Bounces off the start, ever higher.
    Bounce,
}

impl Ease {
    /// All families.
    pub const ALL: [Self; 10] = [
        Self::Sine,
        Self::Quad,
        Self::Cubic,
        Self::Quart,
        Self::Quint,
        Self::Expo,
        Self::Circ,
        Self::Back,
        Self::Elastic,
        Self::Bounce,
    ];

    /// The rise at `u` in 0..=1.
    pub(super) fn rise(self, u: f64) -> f64 {
        match self {
            Self::Sine => {
                let sine = libm::sin(u * FRAC_PI_4);
                2.0 * sine * sine
            }
            Self::Quad => u * u,
            Self::Cubic => u * u * u,
            Self::Quart => (u * u) * (u * u),
            Self::Quint => (u * u) * (u * u) * u,
            Self::Expo => (libm::exp2(10.0 * u) - 1.0) / 1023.0,
            Self::Circ => u * u / (1.0 + (1.0 - u * u).sqrt()),
            Self::Back => back(u, OVERSHOOT),
            Self::Elastic => elastic(u, 3.0),
            Self::Bounce => 1.0 - bounces(1.0 - u),
        }
    }

    /// The rise as half of a way there and back; what swings, swings as far as over a whole way, or slower.
    pub(super) fn half_rise(self, u: f64) -> f64 {
        match self {
            Self::Back => back(u, 1.525 * OVERSHOOT),
            Self::Elastic => elastic(u, 4.5),
            _ => self.rise(u),
        }
    }
}

/// Of `Back`: goes back by a tenth of the way.
const OVERSHOOT: f64 = 1.70158;

fn back(u: f64, overshoot: f64) -> f64 {
    u * u * ((overshoot + 1.0) * u - overshoot)
}

/// Ten `period`ths of a swing, growing as `Expo`.
fn elastic(u: f64, period: f64) -> f64 {
    Ease::Expo.rise(u) * libm::cos((1.0 - u) * 10.0 * TAU / period)
}

/// A fall from 1 and three bounces, each half as long as the one before and a quarter as high: parabolas, 4/11, 8/11,
/// 10/11 and 1 being the moments of touching the ground. Here the ground is at 1.
fn bounces(u: f64) -> f64 {
    let (middle, height) = match u * 11.0 {
        time if time < 4.0 => (0.0, 0.0),
        time if time < 8.0 => (6.0, 0.75),
        time if time < 10.0 => (9.0, 0.9375),
        _ => (10.5, 0.984_375),
    };
    let since = u - middle / 11.0;
    7.5625 * since * since + height
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(ease: Ease, u: f64, expected: f64) {
        let found = ease.rise(u);
        assert!((found - expected).abs() < 4e-16, "{ease:?} at {u}: {found}, not {expected}");
    }

    /// Values worked out by hand.
    #[test]
    fn rises_go_where_their_formulas_say() {
        close(Ease::Sine, 1.0 / 3.0, 1.0 - 0.75_f64.sqrt());
        close(Ease::Sine, 2.0 / 3.0, 0.5);
        close(Ease::Quad, 0.5, 0.25);
        close(Ease::Cubic, 0.5, 0.125);
        close(Ease::Quart, 0.5, 0.0625);
        close(Ease::Quint, 0.5, 0.03125);
        close(Ease::Expo, 0.5, 1.0 / 33.0);
        close(Ease::Expo, 0.1, 1.0 / 1023.0);
        close(Ease::Circ, 0.6, 0.2);
        close(Ease::Circ, 0.8, 0.4);
        close(Ease::Back, 0.5, 0.125 * (1.0 - 1.70158));
        // A period of 0.3: half a swing before the end it is at its lowest.
        close(Ease::Elastic, 0.85, -Ease::Expo.rise(0.85));
        close(Ease::Elastic, 0.7, Ease::Expo.rise(0.7));
    }

    #[test]
    fn a_bounce_touches_the_ground_and_rises_to_a_quarter_each_time() {
        for touch in [4.0, 8.0, 10.0, 11.0] {
            assert!((bounces(touch / 11.0) - 1.0).abs() < 1e-15, "{touch}");
            let before = bounces(f64::next_down(touch / 11.0));
            assert!((before - 1.0).abs() < 1e-14, "{touch}: {before}");
        }
        for (top, drop) in [(6.0, 0.25), (9.0, 0.0625), (10.5, 0.015_625)] {
            assert!((bounces(top / 11.0) - (1.0 - drop)).abs() < 1e-15, "{top}");
        }
    }

    #[test]
    fn going_back_goes_back_by_a_tenth() {
        let lowest = |rise: &dyn Fn(f64) -> f64| {
            (0..=100_000).map(|step| rise(f64::from(step) / 1e5)).fold(0.0, f64::min)
        };
        assert!((lowest(&|u| Ease::Back.rise(u)) + 0.1).abs() < 1e-5);
        // Half of the whole way there is a way of 1/2.
        assert!((0.5 * lowest(&|u| Ease::Back.half_rise(u)) + 0.1).abs() < 1e-3);
    }
}
