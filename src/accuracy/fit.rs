//! Orders of convergence.

/// A power law of an error: e = c n^exponent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    /// The exponent; negative if the error falls.
    pub exponent: f64,
    /// The standard error of the exponent.
    pub uncertainty: f64,
    /// The error at n = 1.
    pub factor: f64,
}

impl PowerLaw {
    /// Returns the error at n.
    #[must_use]
    pub fn at(&self, n: f64) -> f64 {
        self.factor * libm::pow(n, self.exponent)
    }

    /// Fits pairs of n and e, all greater than 0, by least squares of the logarithms. Returns `None` for fewer than three pairs.
    #[must_use]
    pub fn fit(pairs: &[(f64, f64)]) -> Option<Self> {
        if pairs.len() < 3 {
            return None;
        }
        let count = pairs.len() as f64;
        let logs: Vec<(f64, f64)> = pairs.iter().map(|(n, e)| (libm::log(*n), libm::log(*e))).collect();
        let mean_x = logs.iter().map(|(x, _)| x).sum::<f64>() / count;
        let mean_y = logs.iter().map(|(_, y)| y).sum::<f64>() / count;
        let spread: f64 = logs.iter().map(|(x, _)| (x - mean_x) * (x - mean_x)).sum();
        let rise: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
        let exponent = rise / spread;
        let residual = |(x, y): &(f64, f64)| {
            let off = y - mean_y - exponent * (x - mean_x);
            off * off
        };
        let variance = logs.iter().map(residual).sum::<f64>() / (count - 2.0);
        let fitted = Self {
            exponent,
            uncertainty: (variance / spread).sqrt(),
            factor: libm::exp(mean_y - exponent * mean_x),
        };
        fitted.exponent.is_finite().then_some(fitted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_laws_are_recovered() {
        let pairs = [1.0, 2.0, 4.0, 8.0, 16.0].map(|n| (n, 3.0 * libm::pow(n, -0.75)));
        let law = PowerLaw::fit(&pairs).unwrap();
        assert!(
            (law.exponent + 0.75).abs() < 1e-12 && law.uncertainty < 1e-7 && (law.factor - 3.0).abs() < 1e-12
        );
        assert_eq!(PowerLaw::fit(&pairs[..2]), None);
        assert_eq!(PowerLaw::fit(&[(2.0, 1.0); 4]), None);
    }

    #[test]
    fn scatter_is_reported() {
        let pairs = [(1.0, 1.0), (2.0, 0.9), (4.0, 0.4), (8.0, 0.3)];
        let law = PowerLaw::fit(&pairs).unwrap();
        assert!((-0.8..-0.5).contains(&law.exponent) && (0.05..0.2).contains(&law.uncertainty), "{law:?}");
    }
}
