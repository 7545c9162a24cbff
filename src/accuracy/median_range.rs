//! The median and the range of repeated measurements.

/// The median of measurements, and their range.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MedianRange {
    /// The median.
    pub median: f64,
    /// The smallest.
    pub low: f64,
    /// The largest.
    pub high: f64,
}

impl MedianRange {
    /// Returns the median and the range multiplied by a factor above 0.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self { median: self.median * factor, low: self.low * factor, high: self.high * factor }
    }

    /// Returns the spread of measurements; zeros for none.
    #[must_use]
    pub fn of(measured: &[f64]) -> Self {
        let mut sorted = measured.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (Some(low), Some(high)) = (sorted.first(), sorted.last()) else { return Self::default() };
        let half = sorted.len() / 2;
        let median =
            if sorted.len() % 2 == 1 { sorted[half] } else { f64::midpoint(sorted[half - 1], sorted[half]) };
        Self { median, low: *low, high: *high }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(MedianRange::of(&[]), MedianRange::default());
        assert_eq!(MedianRange::of(&[3.0]), MedianRange { median: 3.0, low: 3.0, high: 3.0 });
        assert_eq!(MedianRange::of(&[4.0, 1.0, 2.0]), MedianRange { median: 2.0, low: 1.0, high: 4.0 });
        assert_eq!(MedianRange::of(&[4.0, 1.0, 2.0, 3.0]), MedianRange { median: 2.5, low: 1.0, high: 4.0 });
    }
}
