//! Round numbers along an axis.

/// Steps of 1, 2 or 5 times a power of ten.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    size: f64,
    /// Number of decimals that distinguish the multiples of the step.
    decimals: usize,
}

impl Steps {
    /// Creates steps that divide a length into at most `most` parts. The step is 1 if the length is not above 0.
    pub(super) fn over(length: f64, most: f64) -> Self {
        let least = length / most;
        if !(least > 0.0 && least.is_finite()) {
            return Self { size: 1.0, decimals: 0 };
        }
        let exponent = libm::floor(libm::log10(least));
        let power = libm::exp10(exponent);
        let size =
            [1.0, 2.0, 5.0].map(|digit| digit * power).into_iter().find(|size| *size >= least * (1.0 - 1e-9));
        let (size, exponent) = size.map_or((10.0 * power, exponent + 1.0), |size| (size, exponent));
        let decimals = (-exponent).clamp(0.0, 12.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 12")]
        Self { size, decimals: decimals as usize }
    }

    pub(super) fn size(self) -> f64 {
        self.size
    }

    /// Returns the multiples of the step from one number to another, with their labels.
    pub(super) fn within(self, from: f64, to: f64) -> impl Iterator<Item = (f64, String)> {
        /// Maximum number of multiples on an axis.
        const MOST: usize = 100;
        let first = (from / self.size - 1e-9).ceil();
        let multiples = (0..MOST).map(move |index| (first + index as f64) * self.size);
        multiples
            .take_while(move |value| *value <= to + 1e-9 * self.size)
            .map(move |value| (value, self.write(value)))
    }

    fn write(self, value: f64) -> String {
        let shown = if value.abs() < 0.5 * self.size { 0.0 } else { value };
        if shown.abs() >= 1e6 || shown != 0.0 && self.size < 1e-6 {
            let digits = libm::log10(shown.abs() / self.size).ceil().clamp(0.0, 12.0);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 12")]
            let digits = digits as usize;
            format!("{shown:.digits$e}")
        } else {
            format!("{shown:.*}", self.decimals)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(from: f64, to: f64, most: f64) -> Vec<String> {
        Steps::over(to - from, most).within(from, to).map(|(_, text)| text).collect()
    }

    #[test]
    fn steps_are_round_and_few() {
        assert_eq!(written(0.0, 4.0, 5.0), ["0", "1", "2", "3", "4"]);
        assert_eq!(written(-0.3, 0.31, 4.0), ["-0.2", "0.0", "0.2"]);
        assert_eq!(written(17.0, 64.0, 5.0), ["20", "30", "40", "50", "60"]);
        assert_eq!(written(0.0, 6e7, 3.0), ["0", "2e7", "4.0e7", "6.0e7"]);
        assert_eq!(written(1.0, 1.0, 5.0), ["1"]);
    }
}
