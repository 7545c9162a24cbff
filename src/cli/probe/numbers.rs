//! Formatting of numbers and vectors that parse back to the same bits.

use std::fmt::{Display, Formatter, LowerExp, Result};

use rayreel::Rgb;

/// Formats a number with 17 significant digits, which distinguish all `f64` values. Zero is formatted as `0` or `-0`.
pub(super) fn exact(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let scientific = format!("{value:.16e}");
    let exponent = scientific.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok());
    match exponent {
        Some(exponent @ -5..17) => {
            let decimals = usize::try_from(16 - exponent).unwrap_or(0);
            format!("{value:.decimals$}")
        }
        _ => scientific,
    }
}

/// A number displayed with the fewest digits that distinguish it from all other values of its type.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shortest<T>(pub(super) T);

impl<T: Copy + Display + LowerExp + Into<f64>> Display for Shortest<T> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> Result {
        let magnitude = self.0.into().abs();
        if magnitude == 0.0 || (1e-5..1e17).contains(&magnitude) {
            Display::fmt(&self.0, formatter)
        } else {
            LowerExp::fmt(&self.0, formatter)
        }
    }
}

/// Pads a number so that signs and decimal points align in columns, with a space after it.
pub(super) fn column_of(number: &str) -> String {
    let sign = if number.starts_with('-') { "" } else { " " };
    format!("{:<22}", format!("{sign}{number} "))
}

/// Formats a number for a column.
pub(super) fn number(value: f64) -> String {
    column_of(&exact(value))
}

/// Formats a vector in three columns.
pub(super) fn vector(value: impl Into<[f64; 3]>) -> String {
    value.into().map(number).concat()
}

/// Formats a colour in three columns.
pub(super) fn color(value: Rgb) -> String {
    value.to_array().map(|channel| column_of(&Shortest(channel).to_string())).concat()
}

/// Formats a contribution to the light of a surface.
pub(super) fn adds(value: Rgb) -> String {
    let channels = value.to_array().map(|channel| format!("{:<13}", format!("{} ", Shortest(channel))));
    format!("adds {}", channels.concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns numbers of many magnitudes, of both signs and with pseudo-random bits.
    fn values() -> Vec<f64> {
        let mut values =
            vec![0.0, f64::MAX, f64::MIN_POSITIVE, 5e-324, 0.1, 1.0 / 3.0, 9.999_999_999_999_999e16];
        values.extend(
            (-330..309).map(|exponent| format!("9.99999999999999999e{exponent}").parse::<f64>().unwrap()),
        );
        let mut bits = 1_u64;
        for _ in 0..20_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            // The whole range of `f64`, and the range from 0 to 2.
            values.push(f64::from_bits(bits));
            values.push((bits >> 11) as f64 / 4_503_599_627_370_496.0);
        }
        values.retain(|value| value.is_finite());
        values.extend(values.clone().iter().map(|value| -value));
        values
    }

    #[test]
    #[expect(clippy::cast_possible_truncation, reason = "any f32 will do")]
    fn every_written_number_reads_back_to_the_same_bits() {
        for value in values() {
            for text in [exact(value), Shortest(value).to_string()] {
                assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{text}");
            }
            let single = value as f32;
            if single.is_finite() {
                let text = Shortest(single).to_string();
                assert_eq!(text.parse::<f32>().unwrap().to_bits(), single.to_bits(), "{text}");
            }
        }
    }

    #[test]
    fn numbers_use_fixed_notation_in_a_readable_range() {
        for (value, text) in [
            (0.1, "0.10000000000000001"),
            (-8.5, "-8.5000000000000000"),
            (1e-5, "0.000010000000000000001"),
            (9.9e-6, "9.9000000000000001e-6"),
            (12_345_678_901_234_568.0, "12345678901234568"),
            (1e16, "10000000000000000"),
            (1e17, "1.0000000000000000e17"),
            (0.0, "0"),
            (-0.0, "-0"),
        ] {
            assert_eq!(exact(value), text);
        }
        for (value, text) in
            [(1.0, "1"), (1e300, "1e300"), (2.5e-7, "2.5e-7"), (-0.0, "-0"), (1e16, "10000000000000000")]
        {
            assert_eq!(Shortest(value).to_string(), text);
        }
    }
}
