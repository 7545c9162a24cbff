//! Round numbers along a range.

/// Returns up to seven round numbers within a range, in either order, each with its share of the way from the first end, and as text:
/// multiples of 1, 2 or 5 times a power of ten. Without a range that can be divided, returns nothing.
pub(super) fn ticks([first, last]: [f64; 2]) -> Vec<(f64, String)> {
    /// The number of steps that a range has at least. It has fewer than 7 then: below 14 of 10^n, steps are 2, and 14 / 5 = 2.8.
    const STEPS: f64 = 2.8;
    let (least, most) = (first.min(last), first.max(last));
    let range = most - least;
    let is_divisible = range.is_finite() && range > 0.0 && range > 1e-12 * least.abs().max(most.abs());
    if !is_divisible {
        return Vec::new();
    }
    let exponent = libm::floor(libm::log10(range / STEPS));
    // Decimal steps are exact as quotients of whole numbers where they are not as products.
    let power = |exponent: f64| libm::exp10(exponent.abs());
    let scaled =
        |number: f64| if exponent < 0.0 { number / power(exponent) } else { number * power(exponent) };
    let fits = |step: &f64| range / scaled(*step) >= STEPS;
    let step = [5.0, 2.0, 1.0].into_iter().find(fits).unwrap_or(1.0);
    let count = |number: f64| number / scaled(step);
    // A tick at an end is not lost by rounding.
    let (start, end) = (libm::ceil(count(least) - 1e-9), libm::floor(count(most) + 1e-9));
    let mut numbers = Vec::new();
    let mut index = start;
    while index <= end {
        let number = scaled(index * step) + 0.0;
        numbers.push((((number - first) / (last - first)).clamp(0.0, 1.0), text(number, exponent)));
        index += 1.0;
    }
    numbers
}

/// Returns a multiple of a power of ten as text.
fn text(number: f64, exponent: f64) -> String {
    /// Beyond these powers of ten, numbers have an exponent.
    const PLAIN: std::ops::RangeInclusive<f64> = -5.0..=5.0;
    let written = if PLAIN.contains(&exponent) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 5")]
        let decimals = (-exponent).max(0.0) as usize;
        format!("{number:.decimals$}")
    } else {
        format!("{number:e}")
    };
    written.replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(range: [f64; 2]) -> Vec<String> {
        ticks(range).into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn ticks_are_round_and_within_the_range() {
        assert_eq!(texts([0.0, 2.4]), ["0.0", "0.5", "1.0", "1.5", "2.0"]);
        assert_eq!(texts([0.0, 3.0]), ["0", "1", "2", "3"]);
        assert_eq!(texts([0.0, 14.0]), ["0", "5", "10"]);
        assert_eq!(texts([0.0, 13.9]), ["0", "2", "4", "6", "8", "10", "12"]);
        assert_eq!(texts([-0.31, 0.3]), ["\u{2212}0.2", "0.0", "0.2"]);
        assert_eq!(texts([300.0, 1200.0]), ["400", "600", "800", "1000", "1200"]);
        assert_eq!(texts([0.0, 7e-9]), ["0e0", "2e\u{2212}9", "4e\u{2212}9", "6e\u{2212}9"]);
        assert_eq!(ticks([1.0, 0.0])[0], (1.0, "0.0".to_owned()));
        assert_eq!(ticks([0.0, 0.5])[1], (0.2, "0.1".to_owned()));
        for range in [[1.0, 1.0], [0.0, f64::INFINITY], [f64::NAN, 1.0], [1e20, 1e20 + 1e5]] {
            assert_eq!(texts(range), Vec::<String>::new(), "{range:?}");
        }
    }

    #[test]
    fn there_are_three_to_seven_of_them() {
        for tenths in 1..2000 {
            let last = f64::from(tenths) * 0.37;
            let found = ticks([0.0, last]);
            assert!((3..=7).contains(&found.len()), "{last}: {found:?}");
            assert!(found.iter().all(|(share, _)| (0.0..=1.0).contains(share)));
        }
    }
}
