//! Keyframed values.

use super::hermite::{Gap, Stretch};
use super::{Easing, Interpolate, Playback, Repeat};

/// A keyframe: a value at a time, and the easing to the next key.
#[derive(Clone, Debug, PartialEq)]
pub struct Key<T> {
    /// Seconds from the start of the timeline; finite.
    pub time: f64,
    /// The value at that time.
    pub value: T,
    /// The easing from this key to the next.
    pub easing: Easing,
}

/// A value over time, given by keys. Before the first and after the last key, the value of the nearest key holds unless the playback
/// [repeats](Self::played).
#[derive(Clone, Debug, PartialEq)]
pub struct Track<T> {
    keys: Vec<Key<T>>,
    playback: Playback,
}

impl<T: Interpolate> Track<T> {
    /// Creates a track through `keys`. Returns `None` if there is no key or the times are not strictly ascending.
    #[must_use]
    pub fn new(keys: Vec<Key<T>>) -> Option<Self> {
        let ascending = keys.is_sorted_by(|left, right| left.time < right.time);
        (ascending && !keys.is_empty()).then(|| Self { keys, playback: Playback::default() })
    }

    /// Returns the same keys with another playback.
    ///
    /// ```
    /// use rayreel::animation::{Easing, Key, Playback, Repeat, Track};
    /// let key = |time, value| Key { time, value, easing: Easing::Linear };
    /// let track = Track::new(vec![key(0.0, 1.0), key(2.0, 3.0)]).unwrap();
    /// let track = track.played(Playback { repeat: Repeat::PingPong, offset: 1.0, speed: 2.0 });
    /// assert_eq!([1.0, 1.5, 2.0, 2.5, 3.0].map(|seconds| track.at(seconds)), [1.0, 2.0, 3.0, 2.0, 1.0]);
    /// ```
    #[must_use]
    pub fn played(self, playback: Playback) -> Self {
        Self { playback, ..self }
    }

    /// Returns the value at `seconds`.
    ///
    /// ```
    /// use rayreel::animation::{Easing, Key, Track};
    /// let key = |time, value, easing| Key { time, value, easing };
    /// let track = Track::new(vec![key(0.0, 1.0, Easing::EaseInOut), key(2.0, 3.0, Easing::Hold)]).unwrap();
    /// assert_eq!((track.at(-1.0), track.at(1.0), track.at(9.0)), (1.0, 2.0, 3.0));
    /// ```
    #[must_use]
    pub fn at(&self, seconds: f64) -> T {
        let last = self.keys.len() - 1;
        let time = self.playback.time(seconds, self.keys[0].time, self.keys[last].time);
        let next = self.keys.partition_point(|key| key.time <= time);
        let Some(index) = next.checked_sub(1) else {
            return self.keys[0].value.clone();
        };
        let start = &self.keys[index];
        let Some(end) = self.keys.get(next) else {
            return start.value.clone();
        };
        let u = (time - start.time) / (end.time - start.time);
        match start.easing {
            Easing::Cubic => T::curve(&start.value, &end.value, self.stretch(index).parabolic(), u),
            Easing::Monotone => T::curve(&start.value, &end.value, self.stretch(index).monotone(), u),
            Easing::CatmullRom => self.stretch(index).centripetal(u).map_or_else(
                || start.value.clone(),
                |(slopes, along)| T::curve(&start.value, &end.value, slopes, along),
            ),
            // Slopes at the ends of a Bezier curve are three times the offsets of its handles.
            Easing::Handles(out, back) => T::curve(&start.value, &end.value, [out * 3.0, back * -3.0], u),
            easing => T::between(&start.value, &end.value, easing.progress(u)),
        }
    }

    /// Returns the segment after key `index`, which must exist, with its neighbours. The neighbours of the outermost segments depend on the
    /// playback: a loop continues across its seam as at any key, and a ping-pong continues with the mirror image of the segment.
    fn stretch(&self, index: usize) -> Stretch {
        let last = self.keys.len() - 2;
        let image = |gap: Gap| Gap { difference: -gap.difference, ..gap };
        let beyond = |end: usize, other: usize| match self.playback.repeat {
            Repeat::Clamp => None,
            Repeat::Loop => Some(self.gap(other)),
            Repeat::PingPong => Some(image(self.gap(end))),
        };
        Stretch {
            before: if index == 0 { beyond(0, last) } else { Some(self.gap(index - 1)) },
            here: self.gap(index),
            after: if index == last { beyond(last, 0) } else { Some(self.gap(index + 1)) },
        }
    }

    /// Returns the gap between key `index` and the next, which must exist.
    fn gap(&self, index: usize) -> Gap {
        let (start, end) = (&self.keys[index], &self.keys[index + 1]);
        Gap { difference: T::difference(&start.value, &end.value), length: end.time - start.time }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec3, Vec3};
    use proptest::prelude::*;

    use super::*;
    use crate::animation::{Ease, Rotation};

    fn every_easing() -> Vec<Easing> {
        let mut all = vec![Easing::Hold, Easing::Linear, Easing::EaseIn, Easing::EaseOut, Easing::EaseInOut];
        all.extend([Easing::Cubic, Easing::CatmullRom, Easing::Monotone]);
        all.extend([Easing::Steps(5), Easing::Bezier(0.4, 0.0, 0.2, 1.0)]);
        for ease in Ease::ALL {
            all.extend([Easing::In(ease), Easing::Out(ease), Easing::InOut(ease)]);
        }
        all
    }

    fn track(keys: &[(f64, f64, Easing)]) -> Track<f64> {
        let keys = keys.iter().map(|&(time, value, easing)| Key { time, value, easing }).collect();
        Track::new(keys).unwrap()
    }

    /// Compares with Bernstein's form, for vectors and for light.
    #[test]
    fn handles_make_bezier_curves_of_values() {
        let (from, to) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 0.5, 2.0));
        let (out, back) = (DVec3::new(0.5, -1.0, 2.0), DVec3::new(-2.0, 0.25, 1.0));
        let easing = Easing::Handles(out, back);
        let keys = |from, to| {
            Track::new(vec![Key { time: 1.0, value: from, easing }, Key { time: 3.0, value: to, easing }])
                .unwrap()
        };
        let points = keys(from, to);
        for step in 0..=20 {
            let u = f64::from(step) / 20.0;
            let rest = 1.0 - u;
            let expected = from * (rest * rest * rest)
                + (from + out) * (3.0 * rest * rest * u)
                + (to + back) * (3.0 * rest * u * u)
                + to * (u * u * u);
            let found = points.at(1.0 + 2.0 * u);
            assert!((found - expected).length() < 1e-14, "{u}: {found}, not {expected}");
        }
        assert_eq!([points.at(1.0), points.at(3.0)], [from, to]);
        let light = Track::new(vec![
            Key {
                time: 0.0,
                value: Vec3::splat(0.5),
                easing: Easing::Handles(DVec3::NEG_ONE * 2.0, DVec3::ZERO),
            },
            Key { time: 1.0, value: Vec3::ONE, easing },
        ]);
        assert_eq!(light.unwrap().at(0.3), Vec3::ZERO);
    }

    #[test]
    fn keys_are_interpolated_exactly() {
        for easing in every_easing() {
            let keys = [(0.1, 0.3, easing), (0.7, 9.1, easing), (1.3, -2.7, easing), (4.9, 0.1, easing)];
            let track = track(&keys);
            for (time, value, _) in keys {
                assert_eq!(track.at(time), value, "{easing:?}");
            }
        }
    }

    #[test]
    fn a_cubic_reproduces_a_parabola_between_inner_keys_and_has_no_kinks() {
        let parabola = |time: f64| 2.0 * time * time - 3.0 * time + 1.0;
        let keys: Vec<_> =
            [0.0, 0.5, 2.0, 3.0, 3.25].map(|time| (time, parabola(time), Easing::Cubic)).into();
        let track = track(&keys);
        for step in 50..300 {
            let time = f64::from(step) / 100.0;
            assert!((track.at(time) - parabola(time)).abs() < 1e-12, "{time}");
        }
        let h = 1e-6;
        for (time, _, _) in &keys[1..4] {
            let left = (track.at(*time) - track.at(time - h)) / h;
            let right = (track.at(time + h) - track.at(*time)) / h;
            assert!((left - right).abs() < 1e-4, "kink at {time}: {left} {right}");
        }
    }

    /// Uneven times and values: a long segment, a short one, one that reverses, and one between equal values.
    fn uneven<T: Interpolate>(value: impl Fn(f64, f64) -> T, easing: Easing) -> Track<T> {
        let keys = [
            (0.0, 0.0, 0.0),
            (0.5, 6.0, 2.0),
            (2.0, 6.1, 2.3),
            (2.25, -3.0, 0.5),
            (4.0, -3.0, 0.5),
            (5.0, 0.0, 0.0),
        ];
        Track::new(keys.map(|(time, x, y)| Key { time, value: value(x, y), easing }).into()).unwrap()
    }

    fn played<T: Interpolate>(track: &Track<T>, repeat: Repeat) -> Track<T> {
        track.clone().played(Playback { repeat, ..Playback::default() })
    }

    const SMOOTH: [Easing; 3] = [Easing::Cubic, Easing::CatmullRom, Easing::Monotone];

    /// Returns the largest difference of the slopes before and after `time`, both taken over `h` seconds.
    fn kink<T: Interpolate>(track: &Track<T>, time: f64, h: f64) -> f64 {
        let [before, at, after] = [time - h, time, time + h].map(|time| track.at(time));
        (T::difference(&before, &at) - T::difference(&at, &after)).length() / h
    }

    /// Asserts that the difference of slopes vanishes with h, as it does for a curve without kinks.
    fn assert_smooth<T: Interpolate>(track: &Track<T>, times: &[f64], what: &str) {
        for time in times {
            let (wide, narrow) = (kink(track, *time, 1e-4), kink(track, *time, 1e-6));
            assert!(narrow < 1e-6 + 0.02 * wide, "{what}: kink at {time}: {wide} {narrow}");
        }
    }

    fn point(x: f64, y: f64) -> DVec3 {
        DVec3::new(x, y, 0.3 * x * y)
    }

    fn turned(x: f64, y: f64) -> DQuat {
        let angles = DVec3::new(0.4 * x, y, 0.1 * x * y).map(f64::to_degrees);
        Rotation::Euler(angles).quaternion() * if x > 6.05 { -1.0 } else { 1.0 }
    }

    #[test]
    fn smooth_curves_have_no_kinks_at_keys_nor_at_seams_nor_where_they_turn() {
        let inner = [0.5, 2.0, 2.25, 4.0];
        let seams = [-5.0, 0.0, 0.5, 2.0, 4.0, 5.0, 5.5, 10.0];
        for easing in SMOOTH {
            for (repeat, times) in
                [(Repeat::Clamp, &inner[..]), (Repeat::Loop, &seams), (Repeat::PingPong, &seams)]
            {
                let what = format!("{easing:?}, {repeat:?}");
                assert_smooth(&played(&uneven(|x, _| x, easing), repeat), times, &what);
                assert_smooth(&played(&uneven(point, easing), repeat), times, &what);
                assert_smooth(&played(&uneven(turned, easing), repeat), times, &what);
            }
        }
        // The measure detects a kink.
        assert!(kink(&uneven(point, Easing::Linear), 0.5, 1e-6) > 1.0);
        assert!(kink(&played(&uneven(turned, Easing::Linear), Repeat::Loop), 5.0, 1e-6) > 1.0);
        // Light has few digits, so that slopes are taken over longer times. It has no kink where it is not clamped at 0.
        for easing in SMOOTH {
            let track = played(&uneven(|x, y| (point(x, y) + 20.0).as_vec3(), easing), Repeat::Loop);
            for time in seams {
                let (wide, narrow) = (kink(&track, time, 1e-2), kink(&track, time, 1e-3));
                assert!(narrow < 0.01 + 0.2 * wide, "{easing:?}: kink at {time}: {wide} {narrow}");
            }
        }
    }

    #[test]
    fn monotone_components_stay_between_their_keys_and_others_do_not() {
        let swings = |easing| {
            let track = uneven(point, easing);
            let beyond = |step: u32| {
                let time = f64::from(step) / 1000.0;
                let index = track.keys.partition_point(|key| key.time <= time) - 1;
                let (start, end) = (track.keys[index].value, track.keys[index + 1].value);
                let value = track.at(time);
                (start.min(end) - value).max(value - start.max(end)).max_element()
            };
            (0..5000).map(beyond).fold(0.0, f64::max)
        };
        assert!(swings(Easing::Monotone) < 1e-14);
        assert!(swings(Easing::Cubic) > 1.0);
    }

    /// Counts the self-intersections in the xy plane of a polyline through many points of a track.
    fn crossings(track: &Track<DVec3>, from: f64, to: f64) -> usize {
        let points: Vec<DVec3> =
            (0..=400).map(|step| track.at(from + (to - from) * f64::from(step) / 400.0)).collect();
        let side = |a: DVec3, b: DVec3, c: DVec3| (b - a).cross(c - a).z;
        let parts: Vec<_> = points.windows(2).map(|pair| (pair[0], pair[1])).collect();
        let mut count = 0;
        for (index, (a, b)) in parts.iter().enumerate() {
            for (c, d) in parts.iter().skip(index + 2) {
                let apart = |a, b, c, d| side(a, b, c) * side(a, b, d) < 0.0;
                count += usize::from(apart(*a, *b, *c, *d) && apart(*c, *d, *a, *b));
            }
        }
        count
    }

    /// Checks a short segment between long ones, evenly timed. A uniform curve has a loop in it.
    #[test]
    fn centripetal_segments_have_no_loops_and_no_cusps() {
        let points = [(-4.0, 3.0), (0.0, 0.0), (0.3, 0.0), (-3.0, -4.0), (-3.0, -4.2), (5.0, -3.0)];
        let track = |easing| {
            let keys = points.iter().zip([0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
            let keys = keys.map(|((x, y), time)| Key { time, value: DVec3::new(*x, *y, 0.0), easing });
            Track::new(keys.collect()).unwrap()
        };
        let (uniform, centripetal) = (track(Easing::Cubic), track(Easing::CatmullRom));
        let loops = |track| [0.0, 1.0, 2.0, 3.0, 4.0].map(|from| crossings(track, from, from + 1.0));
        assert!(loops(&uniform).iter().sum::<usize>() > 0);
        assert_eq!(loops(&centripetal), [0; 5]);
        // There are no cusps: the speed is never 0.
        for step in 0..4999 {
            let time = f64::from(step) / 1000.0;
            let speed = (centripetal.at(time + 1e-3) - centripetal.at(time)).length() / 1e-3;
            assert!(speed > 0.05, "{speed} at {time}");
        }
    }

    /// Compares with Barry and Goldman's published pyramid, for keys whose knots are proportional to their times.
    #[test]
    fn centripetal_segments_match_barry_and_goldman() {
        let knots = [0.0, 1.0, 3.0, 4.5];
        let mut points = [DVec3::ZERO; 4];
        for (index, direction) in
            [DVec3::X, DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.0, -0.6, 0.8)].iter().enumerate()
        {
            let gap: f64 = knots[index + 1] - knots[index];
            points[index + 1] = points[index] + *direction * (gap * gap);
        }
        let keys = knots.iter().zip(points).map(|(time, value)| Key {
            time: *time,
            value,
            easing: Easing::CatmullRom,
        });
        let track = Track::new(keys.collect()).unwrap();
        let blend =
            |t: f64, [from, to]: [f64; 2], a: DVec3, b: DVec3| (a * (to - t) + b * (t - from)) / (to - from);
        for step in 0..100 {
            let t = 1.0 + 2.0 * f64::from(step) / 100.0;
            let [a, b, c] = [0, 1, 2].map(|i| blend(t, [knots[i], knots[i + 1]], points[i], points[i + 1]));
            let (d, e) = (blend(t, [knots[0], knots[2]], a, b), blend(t, [knots[1], knots[3]], b, c));
            let expected = blend(t, [knots[1], knots[2]], d, e);
            assert!((track.at(t) - expected).length() < 1e-14, "{t}");
        }
    }

    #[test]
    fn rotations_about_one_axis_turn_by_the_curve_of_the_angle() {
        // Steps of less than half a turn. The curve between them swings by more than half a turn.
        let keys = [(0.0, 0.0), (0.5, 2.9), (1.5, 0.2), (1.7, 3.0), (4.0, 5.9), (4.5, 8.5)];
        for easing in SMOOTH {
            let angle: Vec<_> = keys.map(|(time, angle)| (time, angle, easing)).into();
            let angle = track(&angle);
            let rotation =
                |angle: f64| Rotation::AxisAngle(DVec3::new(2.0, -1.0, 0.5), angle.to_degrees()).quaternion();
            let turning = keys.map(|(time, angle)| Key {
                time,
                value: rotation(angle) * (1.0 - 2.0 * (angle % 2.0).round()),
                easing,
            });
            let turning = Track::new(turning.into()).unwrap();
            for step in 0..450 {
                let time = f64::from(step) / 100.0;
                let off = DQuat::difference(&turning.at(time), &rotation(angle.at(time))).length();
                assert!(off < 1e-13, "{easing:?} at {time}: {off}");
            }
        }
    }

    #[test]
    fn opposite_and_equal_rotations_interpolate() {
        let half = |axis| Rotation::AxisAngle(axis, 180.0).quaternion();
        let one = DQuat::IDENTITY;
        for values in [
            [one, half(DVec3::X), half(DVec3::Y), half(DVec3::Z)],
            [one, -one, half(DVec3::X), -half(DVec3::X)],
            [half(DVec3::X), one, half(DVec3::X), one],
            [one; 4],
        ] {
            for easing in SMOOTH {
                for gaps in [[1.0, 1.0, 1.0], [1e-9, 1.0, 1e-9], [5e-324, 1.0, 1.0]] {
                    let times = [0.0, gaps[0], gaps[0] + gaps[1], gaps[0] + gaps[1] + gaps[2]];
                    let keys =
                        times.iter().zip(values).map(|(time, value)| Key { time: *time, value, easing });
                    let Some(track) = Track::new(keys.collect()) else { continue };
                    for step in 0..=200 {
                        let found = track.at(f64::from(step) / 100.0);
                        assert!((found.length() - 1.0).abs() < 1e-15, "{found}");
                    }
                    for (time, value) in times.iter().zip(values) {
                        assert!(DQuat::difference(&track.at(*time), &value).length() < 1e-15);
                    }
                }
            }
        }
    }

    #[test]
    fn swinging_easings_overshoot_but_light_stays_valid() {
        let swing = Easing::Bezier(0.3, -2.0, 0.7, 3.0);
        let lowest = |values: &dyn Fn(f64) -> f64| {
            (0..100).map(|step| values(f64::from(step) / 100.0)).fold(f64::MAX, f64::min)
        };
        let number = track(&[(0.0, 0.0, swing), (1.0, 1.0, swing)]);
        assert!(lowest(&|time| number.at(time)) < -0.2);
        let key = |time, value| Key { time, value, easing: swing };
        let light = Track::new(vec![key(0.0, Vec3::ZERO), key(1.0, Vec3::ONE)]).unwrap();
        assert_eq!(lowest(&|time| f64::from(light.at(time).min_element())), 0.0);
        let turn = |angle: f64| Rotation::AxisAngle(DVec3::Y, angle.to_degrees()).quaternion();
        let turning = Track::new(vec![
            Key { time: 0.0, value: turn(0.0), easing: swing },
            Key { time: 1.0, value: turn(1.0), easing: swing },
        ])
        .unwrap();
        for step in 0..100 {
            let time = f64::from(step) / 100.0;
            assert!(DQuat::difference(&turning.at(time), &turn(number.at(time))).length() < 1e-14, "{time}");
        }
    }

    #[test]
    fn a_loop_shows_no_frame_twice() {
        for easing in [Easing::Linear, Easing::Cubic, Easing::CatmullRom, Easing::Monotone] {
            let sawtooth =
                played(&track(&[(0.0, 0.0, easing), (0.35, 3.5, easing), (0.7, 7.0, easing)]), Repeat::Loop);
            for frame in 0..2000_u32 {
                let found = sawtooth.at(f64::from(frame) / 10.0);
                let expected = f64::from(frame % 7);
                assert!((found - expected).abs() < 1e-10, "{easing:?}, frame {frame}: {found}");
            }
        }
    }

    fn any_easing() -> impl Strategy<Value = Easing> {
        let handles = (0.0..=1.0, -3.0..3.0, 0.0..=1.0, -3.0..3.0);
        prop_oneof![
            3 => prop::sample::select(every_easing()),
            1 => handles.prop_map(|(x1, y1, x2, y2)| Easing::Bezier(x1, y1, x2, y2)),
        ]
    }

    fn any_number() -> impl Strategy<Value = f64> {
        let extreme = vec![0.0, 1.0, 1e60, -1e60, 1e-60, 5e-324, -1e-9, 1e9];
        prop_oneof![2 => -10.0..10.0, 1 => prop::sample::select(extreme)]
    }

    fn any_playback() -> impl Strategy<Value = Playback> {
        let repeat = prop::sample::select(vec![Repeat::Clamp, Repeat::Loop, Repeat::PingPong]);
        let not_zero = |speed: &f64| *speed != 0.0;
        (repeat, any_number(), any_number().prop_filter("not 0", not_zero))
            .prop_map(|(repeat, offset, speed)| Playback { repeat, offset, speed })
    }

    proptest! {
        #[test]
        fn values_are_finite_for_any_keys(
            keys in prop::collection::vec((any_number(), [any_number(), any_number(), any_number()], any_easing()), 1..7),
            playback in any_playback(),
            moments in prop::collection::vec(any_number(), 20),
        ) {
            let mut keys = keys;
            keys.sort_by(|left, right| left.0.total_cmp(&right.0));
            keys.dedup_by(|left, right| left.0 == right.0);
            let vectors = keys.iter().map(|(time, value, easing)| Key { time: *time, value: DVec3::from(*value), easing: *easing });
            let vectors = Track::new(vectors.collect()).unwrap().played(playback);
            let turns = vectors.keys.iter().map(|key| {
                let value = Rotation::Euler(key.value).quaternion();
                Key { time: key.time, value, easing: key.easing }
            });
            let turns = Track::new(turns.collect()).unwrap().played(playback);
            let light = vectors.keys.iter().map(|key| {
                let value = key.value.abs().as_vec3().min(Vec3::splat(1e30));
                Key { time: key.time, value, easing: key.easing }
            });
            let light = Track::new(light.collect()).unwrap().played(playback);
            let between = vectors.keys.windows(2).map(|pair| 0.3 * pair[0].time + 0.7 * pair[1].time);
            for moment in moments.into_iter().chain(between) {
                prop_assert!(vectors.at(moment).is_finite(), "{:?} at {}", vectors, moment);
                prop_assert!((turns.at(moment).length() - 1.0).abs() < 1e-14, "{:?} at {}", turns, moment);
                let light = light.at(moment);
                prop_assert!(light.is_finite() && light.min_element() >= 0.0, "{light}");
            }
            // The values at the keys are exact.
            let clamped = vectors.clone().played(Playback::default());
            for key in &vectors.keys {
                prop_assert_eq!(clamped.at(key.time), key.value);
            }
        }
    }

    #[test]
    fn wrong_keys_are_refused() {
        let key = |time| Key { time, value: DVec3::ZERO, easing: Easing::Linear };
        assert!(Track::<DVec3>::new(vec![]).is_none());
        assert!(Track::new(vec![key(1.0), key(1.0)]).is_none());
        assert!(Track::new(vec![key(1.0), key(f64::NAN)]).is_none());
        assert!(Track::new(vec![key(1.0), key(2.0)]).is_some());
    }
}
