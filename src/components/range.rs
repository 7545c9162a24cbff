//! The valid ranges of numbers, checked and described in the same words for scene files, scripts and worlds.

use std::f64::consts::PI;
use std::fmt;
use std::ops::RangeInclusive;

use crate::animation::limits::SMALLEST;

/// The valid range of a number. Its display form is a predicate: `from 0 to 1`, for example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ValidRange {
    /// Any finite number.
    Any,
    /// Numbers that are 0 or more.
    NotNegative,
    /// Numbers greater than 0; in files and scripts, at least the smallest size of the file format.
    Positive,
    /// Numbers from the first to the second.
    Between(f64, f64),
    /// Numbers greater than 0, up to this one.
    AboveZero(f64),
    /// Angles greater than 0 degrees, up to 180.
    SpotAngle,
    /// Angles greater than 0 and less than 180 degrees.
    FieldOfView,
}

/// A number that is out of its range. The display form follows the name of the number: `must be from 0 to 1, not 7`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeError {
    /// The range.
    pub range: ValidRange,
    /// The number; angles are in degrees.
    pub value: f64,
}

impl ValidRange {
    /// Checks a number as written in files: angles are in degrees.
    pub(crate) fn check(self, value: f64) -> Result<(), RangeError> {
        let is_valid = match self {
            Self::Any => true,
            Self::NotNegative => value >= 0.0,
            Self::Positive => value >= SMALLEST,
            Self::Between(least, most) => (least..=most).contains(&value),
            Self::AboveZero(most) => value > 0.0 && value <= most,
            Self::SpotAngle => value > 0.0 && value <= 180.0,
            Self::FieldOfView => value > 0.0 && value < 180.0,
        };
        if is_valid { Ok(()) } else { Err(RangeError { range: self, value }) }
    }

    /// Returns the range to which values of the world are clamped. Angles are in radians.
    pub(crate) const fn limits(self) -> RangeInclusive<f64> {
        match self {
            Self::Any => f64::NEG_INFINITY..=f64::INFINITY,
            Self::NotNegative => 0.0..=f64::INFINITY,
            Self::Positive => SMALLEST..=f64::INFINITY,
            Self::Between(least, most) => least..=most,
            Self::AboveZero(most) => SMALLEST..=most,
            Self::SpotAngle => SMALLEST..=PI,
            Self::FieldOfView => SMALLEST..=PI.next_down(),
        }
    }

    /// Returns the error for a value of the world that is out of range. An angle is in radians.
    pub(crate) fn violated_by(self, value: f64) -> RangeError {
        RangeError { range: self, value: self.written(value) }
    }

    /// Converts a value of the world to the notation of files: radians to degrees, without the rounding error of the conversion to radians.
    pub(crate) fn written(self, value: f64) -> f64 {
        const DIGITS: f64 = 1e9;
        match self {
            Self::SpotAngle | Self::FieldOfView => libm::round(value.to_degrees() * DIGITS) / DIGITS,
            _ => value,
        }
    }
}

impl RangeError {
    /// Returns the requirement, which may be stricter than the range: `0 or more, and finite`.
    pub(crate) fn requirement(self) -> String {
        match self.range {
            ValidRange::Positive if self.value > 0.0 && self.value < SMALLEST => {
                format!("at least {SMALLEST:e}")
            }
            ValidRange::NotNegative | ValidRange::Positive if !self.value.is_finite() => {
                format!("{}, and finite", self.range)
            }
            range => range.to_string(),
        }
    }
}

impl fmt::Display for ValidRange {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Any => formatter.write_str("finite"),
            Self::NotNegative => formatter.write_str("0 or more"),
            Self::Positive => formatter.write_str("greater than 0"),
            Self::Between(least, most) => write!(formatter, "from {} to {}", Figure(*least), Figure(*most)),
            Self::AboveZero(most) => write!(formatter, "above 0, at most {}", Figure(*most)),
            Self::SpotAngle => formatter.write_str("above 0, at most 180 degrees"),
            Self::FieldOfView => formatter.write_str("between 0 and 180 degrees"),
        }
    }
}

impl fmt::Display for RangeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "must be {}, not {}", self.requirement(), Figure(self.value))
    }
}

/// A display wrapper that prints a number of any magnitude in few characters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Figure(pub(crate) f64);

impl fmt::Display for Figure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        // `Debug` writes an exponent where `Display` would write hundreds of digits.
        let digits = format!("{:?}", self.0);
        formatter.write_str(digits.strip_suffix(".0").unwrap_or(&digits))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_few_digits() {
        let shown =
            [1.0, 0.25, -3e-61, 1e300, f64::NAN, f64::NEG_INFINITY].map(|figure| Figure(figure).to_string());
        assert_eq!(shown, ["1", "0.25", "-3e-61", "1e300", "NaN", "-inf"]);
    }

    #[test]
    fn angles_are_checked_in_degrees_as_exactly_as_in_radians() {
        let spot = |angle: f64| ValidRange::SpotAngle.check(angle.to_degrees()).is_ok();
        assert_eq!([PI.next_down(), PI, PI.next_up(), 0.0].map(spot), [true, true, false, false]);
        let view = |angle: f64| ValidRange::FieldOfView.check(angle.to_degrees()).is_ok();
        assert_eq!([PI.next_down(), PI, f64::MIN_POSITIVE, 0.0].map(view), [true, false, true, false]);
    }
}
