//! Times as exact ratios of integers.

use std::fmt;
use std::str::FromStr;

/// A time, in exact rational seconds from the start of the timeline.
#[derive(Clone, Copy, Debug)]
pub struct Time {
    pub(super) numerator: u64,
    pub(super) denominator: u64,
}

impl Default for Time {
    fn default() -> Self {
        Self::ZERO
    }
}

impl Time {
    /// The start of the timeline.
    pub const ZERO: Self = Self { numerator: 0, denominator: 1 };

    /// The exclusive limit of both parts, so that one division gives the correctly rounded seconds.
    const LARGEST_PART: u64 = 1 << 53;

    /// Creates the time of `numerator / denominator` seconds. Returns `None` if the denominator is 0 or a part is 2^53 or more.
    #[must_use]
    pub fn from_ratio(numerator: u64, denominator: u64) -> Option<Self> {
        let allowed = denominator > 0 && numerator < Self::LARGEST_PART && denominator < Self::LARGEST_PART;
        allowed.then_some(Self { numerator, denominator })
    }

    /// Returns the seconds, rounded once to `f64`.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "both parts are below 2^53")]
    pub fn seconds(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }

    /// Returns the numerator and the denominator in lowest terms: the same for equal times, however they were given.
    pub(crate) fn lowest_terms(self) -> (u64, u64) {
        let (mut divisor, mut rest) = (self.denominator, self.numerator);
        while rest != 0 {
            (divisor, rest) = (rest, divisor % rest);
        }
        (self.numerator / divisor, self.denominator / divisor)
    }

    /// Returns this time plus `numerator / denominator` seconds, but not before the start. Returns `None` outside the range of
    /// [`Time::from_ratio`].
    pub(crate) fn moved(self, numerator: i128, denominator: u64) -> Option<Self> {
        let way = numerator.checked_mul(i128::from(self.denominator))?;
        let sum = i128::from(self.numerator).checked_mul(i128::from(denominator))?.checked_add(way)?;
        let sum = u128::try_from(sum.max(0)).ok()?;
        let product = u128::from(self.denominator) * u128::from(denominator);
        let (mut divisor, mut rest) = (product, sum);
        while rest != 0 {
            (divisor, rest) = (rest, divisor % rest);
        }
        let divisor = divisor.max(1);
        Self::from_ratio((sum / divisor).try_into().ok()?, (product / divisor).try_into().ok()?)
    }

    /// Returns the number of whole steps of the given length between the start and this time, counted in integers.
    pub(crate) fn whole_steps(self, step: Self) -> u64 {
        let elapsed = u128::from(self.numerator) * u128::from(step.denominator);
        let length = u128::from(self.denominator) * u128::from(step.numerator);
        u64::try_from(elapsed / length.max(1)).unwrap_or(u64::MAX)
    }

    /// Returns the end of step `count` of this length: `count * self`. Returns `None` outside the range of [`Time::from_ratio`].
    pub(crate) fn times(self, count: u64) -> Option<Self> {
        Self::from_ratio(self.numerator.checked_mul(count)?, self.denominator)
    }
}

impl PartialEq for Time {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Time {}

impl PartialOrd for Time {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Time {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let left = u128::from(self.numerator) * u128::from(other.denominator);
        let right = u128::from(other.numerator) * u128::from(self.denominator);
        left.cmp(&right)
    }
}

impl fmt::Display for Time {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} s", self.seconds())
    }
}

/// The error of a text that is not a time.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is not a time: write seconds such as `1.5s` or `2`, with at most nine decimals, from 0 up to 1000000"
)]
pub struct TimeError(String);

debug_as_message!(TimeError);

impl FromStr for Time {
    type Err = TimeError;

    /// Parses seconds as a decimal number, exactly: `1.5s`, `0.04`, `2 s`.
    fn from_str(text: &str) -> Result<Self, TimeError> {
        const NANOSECONDS: u64 = 1_000_000_000;
        let error = || TimeError(text.to_owned());
        let number = text.trim();
        let number = number.strip_suffix('s').unwrap_or(number).trim_end();
        let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
        let digits = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
        if whole.is_empty() && fraction.is_empty()
            || !digits(whole)
            || !digits(fraction)
            || fraction.len() > 9
        {
            return Err(error());
        }
        let whole: u64 = if whole.is_empty() { 0 } else { whole.parse().map_err(|_| error())? };
        let nanoseconds: u64 = format!("{fraction:0<9}").parse().map_err(|_| error())?;
        let total =
            whole.checked_mul(NANOSECONDS).and_then(|sum| sum.checked_add(nanoseconds)).ok_or_else(error)?;
        if whole > 1_000_000 {
            return Err(error());
        }
        // Reduced decimal fractions keep both parts small.
        let divisor =
            [NANOSECONDS, 1_000_000, 1_000].into_iter().find(|divisor| total % divisor == 0).unwrap_or(1);
        Self::from_ratio(total / divisor, NANOSECONDS / divisor).ok_or_else(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::FrameRate;

    #[test]
    fn seconds_are_read_exactly() {
        assert_eq!("1.5s".parse(), Ok(Time { numerator: 3, denominator: 2 }));
        assert_eq!("2".parse(), Ok(Time { numerator: 2, denominator: 1 }));
        assert_eq!(".25 s".parse(), Ok(Time { numerator: 1, denominator: 4 }));
        assert_eq!("0.1".parse::<Time>().map(Time::seconds), Ok(0.1));
        for wrong in ["", "s", "-1", "1e3", "1.0000000001", "99999999999999999999", "1000001", "nan", "."] {
            assert!(wrong.parse::<Time>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn moments_are_moved_exactly_and_not_before_the_start() {
        let half = Time::from_ratio(1, 2).unwrap();
        assert_eq!(half.moved(-1, 3), Time::from_ratio(1, 6));
        assert_eq!(half.moved(-2, 3), Some(Time::ZERO));
    }

    #[test]
    fn lowest_terms_have_no_common_divisor() {
        assert_eq!(FrameRate::new(24, 1).unwrap().time_of(36).lowest_terms(), (3, 2));
    }

    #[test]
    fn steps_are_counted_in_integers() {
        let step = Time::from_ratio(1, 240).unwrap();
        let rate = FrameRate::new(24, 1).unwrap();
        assert_eq!(rate.time_of(240).whole_steps(step), 2400);
        assert_eq!(rate.time_of(1).whole_steps(Time::from_ratio(1, 10).unwrap()), 0);
        assert_eq!(
            FrameRate::new(10, 1).unwrap().time_of(3).whole_steps(Time::from_ratio(1, 10).unwrap()),
            3
        );
    }
}
