//! The Pareto front of measured settings: those for which no other setting is both better and cheaper.
//!
//! Measured times scatter. If medians alone decided, settings would enter and leave the front from run to run, mostly settings that differ
//! little or not at all. A setting is therefore dominated only by comparisons that do not depend on scatter:
//!
//! 1. **By rays**, which are counted, among settings that differ only in the number of rays: a setting is cheaper if it traces fewer rays
//!    of some kind and more of none.
//! 2. **By time**, among the remaining settings, if rays do not decide: a setting is cheaper if it takes less time by more than the
//!    [resolution](Resolution), and as cheap if it takes no more time.
//!
//! In both steps, errors are equal if they differ by no more than the uncertainty of the reference allows. A setting is dominated by one
//! that is cheaper and at least as good, or better and at least as cheap.
//!
//! The front is never empty. In the first step, a dominating setting has no more rays, and has fewer rays or a smaller error. In the second
//! step, it takes no more time, and takes less time or has a smaller error. No chain of dominating settings can therefore return to its
//! start.

use std::cmp::Ordering;

use super::MedianRange;
use crate::trace::{Precision, RayCounts};

/// The smallest differences of measurements that are significant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resolution {
    /// The smallest significant difference of RMS errors, in output values.
    pub rms: f64,
    /// The smallest significant difference of times, as a fraction of the time.
    pub time: f64,
}

impl Resolution {
    /// Returns the resolution of errors against a reference, and of times with this spread. `values` is the number of the reference's
    /// values, and `max` the bound of the error of the most uncertain value.
    ///
    /// Let the reference have an independent error d_j in its value j, and let two pictures differ by x_j. The difference of their mean
    /// square errors is then off by twice the mean of x_j d_j. The standard deviation of this mean is at most s RMS(x) / sqrt(values), with
    /// s the standard deviation of the most uncertain value. RMS(x) is at most the sum of both errors.
    pub(super) fn of(max: f64, values: f64, times: &[MedianRange]) -> Self {
        let relative: Vec<f64> =
            times.iter().map(|time| (time.high - time.low) / time.median.max(f64::MIN_POSITIVE)).collect();
        Self { rms: 2.0 * max / values.max(1.0).sqrt(), time: MedianRange::of(&relative).median }
    }
}

/// The settings that affect the time besides the number of rays: the precision, and the instants and the film's size if they are not the
/// scene's own.
pub(super) type CostClass = (Option<Precision>, Option<u32>, Option<(u32, u32)>);

/// A setting that may be on the front.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrontPoint {
    /// The RMS error.
    pub(super) error: f64,
    /// The time, as a multiple of the time of the scene's own settings.
    pub(super) time: f64,
    pub(super) rays: RayCounts,
    /// The kind of the candidate, if all pixels have the same number of samples. Candidates of the same kind are compared by rays.
    pub(super) kind: Option<CostClass>,
}

/// Returns, for each candidate, whether it is on the front.
pub(super) fn front(candidates: &[FrontPoint], resolution: Resolution) -> Vec<bool> {
    let Resolution { rms, time } = resolution;
    let is_as_good = |one: &FrontPoint, other: &FrontPoint| one.error <= other.error + rms;
    let is_better = |one: &FrontPoint, other: &FrontPoint| one.error < other.error - rms;
    let rays = |one: &FrontPoint, other: &FrontPoint| {
        if one.kind.is_some() && one.kind == other.kind { compare(&one.rays, &other.rays) } else { None }
    };
    let by_rays = |one: &FrontPoint, other: &FrontPoint| match rays(one, other) {
        Some(Ordering::Less) => is_as_good(one, other),
        Some(Ordering::Equal) => is_better(one, other),
        Some(Ordering::Greater) | None => false,
    };
    let by_time = |one: &FrontPoint, other: &FrontPoint| {
        let (is_cheaper, is_as_cheap) = (one.time < other.time * (1.0 - time), one.time <= other.time);
        rays(one, other).is_none()
            && (is_cheaper && is_as_good(one, other) || is_as_cheap && is_better(one, other))
    };
    let unbeaten: Vec<bool> =
        candidates.iter().map(|other| !candidates.iter().any(|one| by_rays(one, other))).collect();
    let is_beaten = |other: &FrontPoint| {
        candidates.iter().zip(&unbeaten).any(|(one, is_unbeaten)| *is_unbeaten && by_time(one, other))
    };
    candidates.iter().zip(&unbeaten).map(|(other, is_unbeaten)| *is_unbeaten && !is_beaten(other)).collect()
}

/// Compares ray counts; `None` if one has more rays of one kind and fewer of another.
fn compare(one: &RayCounts, other: &RayCounts) -> Option<Ordering> {
    let kinds = |rays: &RayCounts| [rays.camera, rays.shadow, rays.reflection, rays.refraction];
    let (one, other) = (kinds(one), kinds(other));
    let is_at_most = |one: [u64; 4], other: [u64; 4]| one.iter().zip(other).all(|(one, other)| *one <= other);
    match (is_at_most(one, other), is_at_most(other, one)) {
        (true, true) => Some(Ordering::Equal),
        (true, false) => Some(Ordering::Less),
        (false, true) => Some(Ordering::Greater),
        (false, false) => None,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn candidate(error: f64, time: f64, rays: [u64; 4], kind: Option<CostClass>) -> FrontPoint {
        let [camera, shadow, reflection, refraction] = rays;
        FrontPoint { error, time, rays: RayCounts { camera, shadow, reflection, refraction }, kind }
    }

    const ROBUST: Option<CostClass> = Some((None, None, None));

    #[test]
    fn beaten_settings_are_not_on_the_front() {
        let uniform = |error, time, camera| candidate(error, time, [camera, 0, 0, 0], ROBUST);
        let adaptive = |error, time| candidate(error, time, [1; 4], None);
        let resolution = Resolution { rms: 0.1, time: 0.1 };
        for (candidates, expected) in [
            // More samples give a smaller error and take longer.
            (vec![uniform(4.0, 1.0, 1), uniform(2.0, 2.0, 2), uniform(1.0, 4.0, 4)], vec![true, true, true]),
            // The same picture with fewer rays, whatever the measured times.
            (vec![uniform(2.0, 1.0, 4), uniform(2.05, 1.2, 3)], vec![false, true]),
            // A smaller error with the same number of rays.
            (vec![uniform(2.0, 1.0, 4), uniform(1.0, 1.2, 4)], vec![false, true]),
            // More rays of one kind and fewer of another are compared by time.
            (
                vec![candidate(2.0, 1.0, [4, 4, 0, 0], ROBUST), candidate(1.0, 0.8, [2, 2, 1, 0], ROBUST)],
                vec![false, true],
            ),
            // Instants take time in addition to rays.
            (
                vec![uniform(2.0, 1.0, 4), candidate(2.0, 1.2, [3, 0, 0, 0], Some((None, Some(2), None)))],
                vec![true, false],
            ),
            // Other kinds are compared by time, if the difference is significant.
            (vec![uniform(2.0, 1.0, 4), adaptive(2.0, 1.05)], vec![true, true]),
            (vec![uniform(2.0, 1.0, 4), adaptive(2.0, 1.2)], vec![true, false]),
            (vec![uniform(2.0, 1.0, 4), adaptive(1.5, 1.05)], vec![true, true]),
            (vec![uniform(2.0, 1.0, 4), adaptive(1.5, 0.95)], vec![false, true]),
            (vec![uniform(2.0, 1.0, 4), adaptive(1.5, 1.2)], vec![true, true]),
            (vec![adaptive(f64::MAX, f64::MAX)], vec![true]),
            (Vec::new(), Vec::new()),
        ] {
            assert_eq!(front(&candidates, resolution), expected, "{candidates:?}");
        }
    }

    /// Measurements of a scene with mirrors, lamps and a lens, in four rounds each. Times scatter by 8 %, as on a busy machine.
    #[test]
    fn stars_do_not_depend_on_scatter() {
        let uniform = |error, time, rays| candidate(error, time, rays, ROBUST);
        let exact = [
            uniform(3.399, 1.0, [518_400, 804_000, 173_000, 0]),
            uniform(15.38, 0.05, [32_400, 50_200, 10_800, 0]),
            uniform(11.551, 0.14, [64_800, 100_500, 21_600, 0]),
            uniform(7.183, 0.26, [129_600, 201_000, 43_200, 0]),
            uniform(4.895, 0.52, [259_200, 402_000, 86_500, 0]),
            candidate(3.177, 1.75, [400_000, 900_000, 212_000, 0], None),
            candidate(1.9, 4.1, [900_000, 2_000_000, 500_000, 0], None),
            uniform(3.289, 1.14, [518_400, 1_495_000, 173_000, 0]),
            uniform(3.254, 1.55, [518_400, 2_878_000, 173_000, 0]),
            uniform(3.245, 2.22, [518_400, 5_644_000, 173_000, 0]),
            uniform(9.596, 0.61, [518_400, 466_000, 0, 0]),
            uniform(3.406, 0.86, [518_400, 760_000, 136_000, 0]),
            uniform(3.4, 0.96, [518_400, 795_000, 165_000, 0]),
            uniform(3.399, 1.02, [518_400, 806_000, 177_000, 0]),
            uniform(3.4, 0.97, [518_400, 794_000, 166_000, 0]),
            candidate(
                3.399,
                2.85,
                [518_400, 804_000, 173_000, 0],
                Some((Some(Precision::NaiveF64), None, None)),
            ),
            candidate(
                3.403,
                3.05,
                [518_400, 804_160, 173_000, 0],
                Some((Some(Precision::NaiveF32), None, None)),
            ),
        ];
        let mut state = 1_u64;
        let mut scatter = move || {
            // The sum of twelve uniform numbers is nearly normal.
            let mut sum = -6.0;
            for _ in 0..12 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                sum += f64::from(u32::try_from(state >> 32).unwrap()) / 4_294_967_296.0;
            }
            1.0 + 0.08 * sum
        };
        let mut choice = |is_by_medians: bool| {
            let times: Vec<MedianRange> =
                exact.iter().map(|one| MedianRange::of(&[(); 4].map(|()| one.time * scatter()))).collect();
            let resolution = Resolution::of(24.95, 97_200.0, &times);
            let measured: Vec<FrontPoint> = exact
                .iter()
                .zip(&times)
                .map(|(one, time)| FrontPoint { time: time.median, ..*one })
                .map(|one| if is_by_medians { FrontPoint { kind: None, ..one } } else { one })
                .collect();
            front(&measured, if is_by_medians { Resolution::default() } else { resolution })
        };
        let mut changes = |is_by_medians: bool| {
            let first = choice(is_by_medians);
            let runs = (0..500).map(|_| choice(is_by_medians));
            runs.map(|stars| stars.iter().zip(&first).filter(|(one, other)| one != other).count())
                .sum::<usize>()
        };
        let (by_medians, by_resolution) = (changes(true), changes(false));
        assert!(by_medians > 500, "the scatter is too small to show anything: {by_medians}");
        assert!(by_resolution < 25, "{by_resolution} of {} stars changed", 500 * exact.len());
    }

    proptest! {
        #[test]
        fn there_is_always_a_front_and_nothing_beats_it_beyond_the_resolution(
            candidates in prop::collection::vec(
                (0.0..4.0_f64, 0.5..2.0_f64, prop::array::uniform4(0..3_u64), any::<bool>()), 1..12),
            rms in 0.0..1.0_f64,
            time in 0.0..0.5_f64,
        ) {
            let candidates: Vec<FrontPoint> = candidates
                .into_iter()
                .map(|(error, time, rays, is_uniform)| candidate(error, time, rays, ROBUST.filter(|_| is_uniform)))
                .collect();
            let found = front(&candidates, Resolution { rms, time });
            prop_assert!(found.contains(&true));
            let on_front = || candidates.iter().zip(&found).filter(|(_, on_front)| **on_front).map(|(one, _)| one);
            for (one, other) in on_front().flat_map(|one| on_front().map(move |other| (one, other))) {
                let is_far = one.error < other.error - rms && one.time < other.time * (1.0 - time);
                let rays_decide = one.kind.is_some() && one.kind == other.kind && compare(&one.rays, &other.rays).is_some();
                prop_assert!(!is_far || rays_decide, "{:?} {:?}", one, other);
            }
        }
    }
}
