//! Keyed values.

use super::{Easing, Interpolate};

/// A value at a moment, and how to go on from there.
#[derive(Clone, Debug, PartialEq)]
pub struct Key<T> {
    /// Seconds from the start of the timeline; finite.
    pub time: f64,
    /// The value at that moment.
    pub value: T,
    /// How to get from here to the next key.
    pub easing: Easing,
}

/// A value over time, given by keys. Before the first and after the last key the nearest key's value holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Track<T> {
    keys: Vec<Key<T>>,
}

impl<T: Interpolate> Track<T> {
    /// A track through `keys`, whose times ascend. `None` if there is no key or the times do not ascend strictly.
    #[must_use]
    pub fn new(keys: Vec<Key<T>>) -> Option<Self> {
        let ascending = keys.is_sorted_by(|left, right| left.time < right.time);
        (ascending && !keys.is_empty()).then_some(Self { keys })
    }

    /// The value at `seconds`.
    ///
    /// ```
    /// use rayreel::timeline::{Easing, Key, Track};
    /// let key = |time, value, easing| Key { time, value, easing };
    /// let track = Track::new(vec![key(0.0, 1.0, Easing::EaseInOut), key(2.0, 3.0, Easing::Hold)]).unwrap();
    /// assert_eq!((track.at(-1.0), track.at(1.0), track.at(9.0)), (1.0, 2.0, 3.0));
    /// ```
    #[must_use]
    pub fn at(&self, seconds: f64) -> T {
        let next = self.keys.partition_point(|key| key.time <= seconds);
        let Some(index) = next.checked_sub(1) else {
            return self.keys[0].value.clone();
        };
        let start = &self.keys[index];
        let Some(end) = self.keys.get(next) else {
            return start.value.clone();
        };
        let u = (seconds - start.time) / (end.time - start.time);
        match start.easing {
            Easing::Cubic => self.curve(index, u),
            easing => T::between(&start.value, &end.value, easing.progress(u)),
        }
    }

    /// Cubic Hermite between key `index` and the next. The slope at a key is the one of the parabola through it and its
    /// neighbours, so that uneven spacing does not overshoot more than it must; at the ends, of the straight line.
    fn curve(&self, index: usize, u: f64) -> T {
        let last = self.keys.len() - 1;
        let before = &self.keys[index.saturating_sub(1)];
        let (start, end) = (&self.keys[index], &self.keys[index + 1]);
        let after = &self.keys[(index + 2).min(last)];
        let length = end.time - start.time;

        // Hermite basis.
        let (squared, cubed) = (u * u, u * u * u);
        let at_start = 2.0 * cubed - 3.0 * squared + 1.0;
        let at_end = 3.0 * squared - 2.0 * cubed;
        let slope_start = cubed - 2.0 * squared + u;
        let slope_end = cubed - squared;

        // Slopes (in units per segment) as weights of [before, start, end, after]. Finite, however near two keys are, so that
        // a value that does not change stays where it is.
        let per_segment = |weight: f64| (weight * length).clamp(-1e300, 1e300);
        let start_slope = if index == 0 {
            [0.0, -1.0, 1.0, 0.0]
        } else {
            let [left, middle, right] = parabola_slope(start.time - before.time, length).map(per_segment);
            [left, middle, right, 0.0]
        };
        let end_slope = if index + 1 == last {
            [0.0, -1.0, 1.0, 0.0]
        } else {
            let [left, middle, right] = parabola_slope(length, after.time - end.time).map(per_segment);
            [0.0, left, middle, right]
        };
        let mut weights = [0.0, at_start, at_end, 0.0];
        for (weight, (left, right)) in weights.iter_mut().zip(start_slope.into_iter().zip(end_slope)) {
            *weight += slope_start * left + slope_end * right;
        }
        T::blend([&before.value, &start.value, &end.value, &after.value], weights)
    }
}

/// Weights of three values, `left` and `right` seconds apart, in the slope at the middle one of the parabola through them.
fn parabola_slope(left: f64, right: f64) -> [f64; 3] {
    let both = left + right;
    [-right / (left * both), (right - left) / (left * right), left / (right * both)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn track(keys: &[(f64, f64, Easing)]) -> Track<f64> {
        let keys = keys.iter().map(|&(time, value, easing)| Key { time, value, easing }).collect();
        Track::new(keys).unwrap()
    }

    #[test]
    fn keys_are_met_exactly() {
        for easing in
            [Easing::Hold, Easing::Linear, Easing::EaseIn, Easing::EaseOut, Easing::EaseInOut, Easing::Cubic]
        {
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

    #[test]
    fn wrong_keys_are_refused() {
        let key = |time| Key { time, value: DVec3::ZERO, easing: Easing::Linear };
        assert!(Track::<DVec3>::new(vec![]).is_none());
        assert!(Track::new(vec![key(1.0), key(1.0)]).is_none());
        assert!(Track::new(vec![key(1.0), key(f64::NAN)]).is_none());
        assert!(Track::new(vec![key(1.0), key(2.0)]).is_some());
    }
}
