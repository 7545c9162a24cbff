//! Easings of the segment between two keys.

use std::f64::consts::{FRAC_PI_4, TAU};

use glam::DVec3;

use super::cubic_bezier::bezier;

/// The easing of a value from one key to the next. It belongs to the key at the start of the segment.
///
/// All but the last four follow the straight segment. They differ in the progress after a fraction u of the segment's time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Easing {
    /// Constant: keeps this key's value until the next key.
    Hold,
    /// Linear: constant speed.
    #[default]
    Linear,
    /// Ease in, from rest: u^2.
    EaseIn,
    /// Ease out, to rest: 1 - (1-u)^2.
    EaseOut,
    /// Ease in and out, from rest to rest: 3u^2 - 2u^3.
    EaseInOut,
    /// The curve of a family: slow at the start.
    In(Ease),
    /// The reversed curve of a family: slow at the end.
    Out(Ease),
    /// Both curves of a family, for one half each: slow at the start and at the end.
    InOut(Ease),
    /// A number of equal jumps at the ends of equal fractions of the time, the last one at the next key; 0 counts as 1.
    Steps(u32),
    /// The curve from (0, 0) to (1, 1) with handles (x1, y1) and (x2, y2), where x is time and y is progress, as `cubic-bezier` in CSS.
    /// Times outside 0..=1 are clamped. Progress may leave that range; the value then overshoots the keys.
    Bezier(f64, f64, f64, f64),
    /// A smooth curve through the keys: cubic Hermite with slopes from the neighbouring keys and their times.
    Cubic,
    /// A smooth curve through the keys, close to the straight segments and without loops or cusps: centripetal Catmull-Rom.
    CatmullRom,
    /// A smooth curve through the keys, each component of which stays between the keys' values.
    Monotone,
    /// A cubic Bezier curve of the value. Its two handles are given as offsets from this key's value and from the next key's value, in the
    /// form of [`Interpolate::difference`](super::Interpolate::difference). They are at one third and two thirds of the time.
    Handles(DVec3, DVec3),
}

impl Easing {
    /// Returns the progress along the segment for elapsed fraction `u` in 0..=1: 0 at 0, and 1 at 1 for all but `Hold`. The smooth curves
    /// bend the path and have linear progress.
    #[must_use]
    pub fn progress(self, u: f64) -> f64 {
        match self {
            Self::Hold => 0.0,
            // The ends are exact, regardless of rounding.
            _ if u <= 0.0 => 0.0,
            _ if u >= 1.0 => 1.0,
            Self::Linear | Self::Cubic | Self::CatmullRom | Self::Monotone | Self::Handles(..) => u,
            Self::EaseIn => u * u,
            Self::EaseOut => u * (2.0 - u),
            Self::EaseInOut => u * u * (3.0 - 2.0 * u),
            Self::In(ease) => ease.rise(u),
            Self::Out(ease) => 1.0 - ease.rise(1.0 - u),
            Self::InOut(ease) if u < 0.5 => 0.5 * ease.half_rise(2.0 * u),
            Self::InOut(ease) => 1.0 - 0.5 * ease.half_rise(2.0 - 2.0 * u),
            Self::Steps(count) => {
                let count = f64::from(count.max(1));
                (u * count).floor() / count
            }
            Self::Bezier(x1, y1, x2, y2) => bezier([x1, y1, x2, y2], u),
        }
    }
}

/// A family of easing curves: a rise from 0 to 1, slow at the start. These are Penner's families, under their names on the web and in
/// animation software.
///
/// [`Easing`] uses a family forwards, reversed, or both for one half each.
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
    /// (2^(10u) - 1) / 1023: doubles ten times. It starts at 0, where the common 2^(10u - 10) starts at 1/1024.
    Expo,
    /// A quarter of a circle.
    Circ,
    /// An overshoot below 0 by a tenth before the rise.
    Back,
    /// An oscillation about the start with growing amplitude.
    Elastic,
    /// Bounces off the start with growing height.
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

    /// Returns the rise at `u` in 0..=1.
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

    /// Returns the rise for half of an ease in and out. `Back` overshoots by the same amount over the full range, and `Elastic` oscillates
    /// more slowly.
    pub(super) fn half_rise(self, u: f64) -> f64 {
        match self {
            Self::Back => back(u, 1.525 * OVERSHOOT),
            Self::Elastic => elastic(u, 4.5),
            _ => self.rise(u),
        }
    }
}

/// The constant of `Back`, for an overshoot of a tenth of the range.
const OVERSHOOT: f64 = 1.70158;

fn back(u: f64, overshoot: f64) -> f64 {
    u * u * ((overshoot + 1.0) * u - overshoot)
}

/// Returns `10 / period` oscillations with the amplitude of `Expo`.
fn elastic(u: f64, period: f64) -> f64 {
    Ease::Expo.rise(u) * libm::cos((1.0 - u) * 10.0 * TAU / period)
}

/// Returns a fall from a height of 1 and three bounces, each half as long as the previous one and a quarter as high: parabolas that touch
/// the ground at 4/11, 8/11, 10/11 and 1. The result is 1 at the ground.
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

    /// Easings whose progress never decreases.
    fn steady() -> Vec<Easing> {
        let mut all = vec![Easing::Linear, Easing::EaseIn, Easing::EaseOut, Easing::EaseInOut];
        all.extend([Easing::Steps(1), Easing::Steps(7), Easing::Bezier(0.25, 0.1, 0.25, 1.0)]);
        all.extend([Easing::Cubic, Easing::CatmullRom, Easing::Monotone]);
        let swings = |ease: &Ease| matches!(ease, Ease::Back | Ease::Elastic | Ease::Bounce);
        for ease in Ease::ALL.into_iter().filter(|ease| !swings(ease)) {
            all.extend([Easing::In(ease), Easing::Out(ease), Easing::InOut(ease)]);
        }
        all
    }

    fn swinging() -> Vec<Easing> {
        let mut all = vec![Easing::Bezier(0.3, -0.6, 0.7, 1.6)];
        for ease in [Ease::Back, Ease::Elastic, Ease::Bounce] {
            all.extend([Easing::In(ease), Easing::Out(ease), Easing::InOut(ease)]);
        }
        all
    }

    fn walk(easing: Easing) -> Vec<f64> {
        (0..=1000).map(|step| easing.progress(f64::from(step) / 1000.0)).collect()
    }

    #[test]
    fn every_easing_starts_at_0_and_all_but_hold_end_at_1() {
        for easing in steady().into_iter().chain(swinging()) {
            assert_eq!(easing.progress(0.0), 0.0, "{easing:?}");
            assert_eq!(easing.progress(1.0), 1.0, "{easing:?}");
        }
        assert_eq!(Easing::Hold.progress(0.999), 0.0);
    }

    #[test]
    fn progress_is_monotone_except_for_swinging_easings() {
        for easing in steady() {
            assert!(walk(easing).is_sorted(), "{easing:?}");
        }
        for easing in swinging() {
            assert!(!walk(easing).is_sorted(), "{easing:?}");
        }
    }

    /// Checks that progress does not jump, not even at the ends: a thousandth of the time makes less than a tenth of the progress.
    #[test]
    fn progress_is_continuous_up_to_the_ends() {
        for easing in steady().into_iter().chain(swinging()) {
            let largest = walk(easing).windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
            assert_eq!(largest < 0.1, !matches!(easing, Easing::Steps(_)), "{easing:?}: {largest}");
            if matches!(easing, Easing::Steps(_)) {
                continue;
            }
            let (first, last) = (easing.progress(1e-9), easing.progress(f64::next_down(1.0)));
            assert!(first.abs() < 1e-4 && (last - 1.0).abs() < 1e-7, "{easing:?}: {first} {last}");
        }
    }

    #[test]
    fn out_mirrors_in_and_in_out_is_symmetric() {
        for ease in Ease::ALL {
            for step in 0..=64 {
                let u = f64::from(step) / 64.0;
                assert_eq!(Easing::Out(ease).progress(u), 1.0 - Easing::In(ease).progress(1.0 - u));
                let both = Easing::InOut(ease).progress(u) + Easing::InOut(ease).progress(1.0 - u);
                assert!((both - 1.0).abs() < 1e-15, "{ease:?} at {u}");
            }
            assert!((Easing::InOut(ease).progress(0.5) - 0.5).abs() < 1e-15, "{ease:?}");
        }
        assert_eq!(Easing::EaseInOut.progress(0.5), 0.5);
        assert_eq!(Easing::EaseIn.progress(0.3), Easing::In(Ease::Quad).progress(0.3));
    }

    #[test]
    fn steps_jump_at_the_ends_of_equal_shares() {
        let found = [0.1, 0.25, 0.49, 0.5, 0.75, 0.99, 1.0].map(|u| Easing::Steps(4).progress(u));
        assert_eq!(found, [0.0, 0.25, 0.25, 0.5, 0.75, 0.75, 1.0]);
        assert_eq!(Easing::Steps(0).progress(0.5), 0.0);
    }

    fn close(ease: Ease, u: f64, expected: f64) {
        let found = ease.rise(u);
        assert!((found - expected).abs() < 4e-16, "{ease:?} at {u}: {found}, not {expected}");
    }

    /// Compares with values calculated by hand.
    #[test]
    fn rises_match_their_formulas() {
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
        // The period is 0.3: half a period before the end, the value is at its lowest.
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
    fn back_easing_overshoots_by_a_tenth() {
        let lowest = |rise: &dyn Fn(f64) -> f64| {
            (0..=100_000).map(|step| rise(f64::from(step) / 1e5)).fold(0.0, f64::min)
        };
        assert!((lowest(&|u| Ease::Back.rise(u)) + 0.1).abs() < 1e-5);
        // Half of an ease in and out has a range of 1/2.
        assert!((0.5 * lowest(&|u| Ease::Back.half_rise(u)) + 0.1).abs() < 1e-3);
    }
}
