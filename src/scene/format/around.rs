//! A scene around one value, and the numbers that are valid there.

use std::path::Path;

use super::{NumberLimits, RangeEnd};
use crate::animation::limits::LARGEST;
use crate::scene::LoadError;
use crate::scene::files::Files;
use crate::scene::parse::{Expectation, pending, reads};

/// A path in no folder: nothing that a sample scene names can be read.
const NOWHERE: &str = "\0/scene.ron";

/// The text of a scene before and after a value.
#[derive(Clone, Debug)]
pub(super) struct TextAround {
    pub(super) before: String,
    pub(super) after: String,
}

impl TextAround {
    /// Returns the text around a value within the value.
    pub(super) fn within(&self, before: &str, after: &str) -> Self {
        Self { before: format!("{}{before}", self.before), after: format!("{after}{}", self.after) }
    }

    fn with(&self, value: &str) -> String {
        format!("{}{value}{}", self.before, self.after)
    }

    /// Returns the innermost request of the parser for the value.
    pub(super) fn expectation(&self) -> Option<Expectation> {
        pending(&self.before)?.pop()
    }

    /// Returns whether the notation of a value is valid here.
    pub(super) fn reads(&self, value: &str) -> bool {
        reads(&self.with(value))
    }

    /// Returns whether a value is valid here: whether no mistake is at the value itself.
    fn accepts(&self, value: &str) -> bool {
        let mut files = Files::from_text(Path::new(NOWHERE), self.with(value));
        files.validate();
        if files.are_good() {
            return true;
        }
        let (start, end) = (self.before.len(), self.before.len() + value.len());
        let error = LoadError::new(files);
        let mut spans = error.mistakes().filter_map(|mistake| mistake.diagnostic.span.clone());
        !spans.any(|span| start <= span.start && span.end <= end)
    }

    /// Returns the range of valid numbers.
    pub(super) fn number_range(&self) -> NumberLimits {
        let accepts = |number: f64| self.accepts(&format!("{number:?}"));
        if !accepts(GOOD) {
            // Because of other values; no number is beyond these.
            let [least, most] = [-LARGEST, LARGEST].map(|value| Some(RangeEnd { value, is_excluded: false }));
            return NumberLimits { least, most, is_not_zero: false };
        }
        let [least, most] = [-1.0, 1.0].map(|sign: f64| range_end(sign, &accepts));
        let has_zero = least.is_none_or(|end| end.value < 0.0);
        NumberLimits { least, most, is_not_zero: has_zero && !accepts(0.0) }
    }

    /// Returns the range of valid integers.
    pub(super) fn whole_range(&self) -> (u64, u64) {
        let accepts = |number: u64| self.accepts(&number.to_string());
        let (mut good, mut bad) = (1, u64::MAX);
        if accepts(bad) {
            good = bad;
        }
        while bad - good > 1 {
            let middle = good + (bad - good) / 2;
            if accepts(middle) { good = middle } else { bad = middle }
        }
        (u64::from(!accepts(0)), good)
    }
}

/// A number that is valid wherever numbers are, except where no number is because of the values around it.
const GOOD: f64 = 1.0;

/// Returns the end of the range of valid numbers on one side. An end with many digits follows from other values, and is left to the largest
/// number of all.
fn range_end(sign: f64, accepts: &impl Fn(f64) -> bool) -> Option<RangeEnd> {
    /// Maximum length of a number that is an end, as `1.8e2`.
    const LONGEST: usize = 8;
    if accepts(sign * f64::MAX) {
        return None;
    }
    let (mut good, mut bad) = (index(GOOD), index(sign * f64::MAX));
    // Most numbers are coordinates.
    if accepts(sign * LARGEST) {
        good = index(sign * LARGEST);
        let next = number(if sign < 0.0 { good - 1 } else { good + 1 });
        bad = if accepts(next) { bad } else { index(next) };
    }
    while good.abs_diff(bad) > 1 {
        let middle = i64::midpoint(good, bad);
        if accepts(number(middle)) { good = middle } else { bad = middle }
    }
    let length = |number: f64| format!("{number:e}").len();
    let [good, bad] = [good, bad].map(number);
    let is_excluded = length(bad) < length(good);
    let value = if is_excluded { bad } else { good };
    let own = RangeEnd { value, is_excluded };
    let of_all = RangeEnd { value: sign * LARGEST, is_excluded: false };
    Some(if length(value) <= LONGEST { own } else { of_all })
}

/// Returns the index of a number in the order of all numbers.
fn index(number: f64) -> i64 {
    let bits = number.to_bits().cast_signed();
    if bits < 0 { i64::MIN - bits } else { bits }
}

/// Returns the number with an index.
fn number(index: i64) -> f64 {
    let bits = if index < 0 { i64::MIN - index } else { index };
    f64::from_bits(bits.cast_unsigned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_indexed_in_order() {
        let numbers = [-f64::MAX, -1.0, -5e-324, 0.0, 5e-324, 0.5, 1.0, f64::MAX];
        assert!(numbers.map(index).is_sorted_by(|left, right| left < right));
        assert_eq!(numbers.map(|each| number(index(each))), numbers);
    }
}
