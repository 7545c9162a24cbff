//! How a segment between two keys is walked.

/// How the value moves from one key to the next. It belongs to the key at which the segment starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Easing {
    /// Stay at this key's value until the next key.
    Hold,
    /// Straight and at constant speed.
    #[default]
    Linear,
    /// Straight, starting at rest: u^2.
    EaseIn,
    /// Straight, coming to rest: 1 - (1-u)^2.
    EaseOut,
    /// Straight, starting and coming to rest: 3u^2 - 2u^3.
    EaseInOut,
    /// A smooth curve through the keys: cubic Hermite with tangents from the neighbouring keys.
    Cubic,
}

impl Easing {
    /// Progress along the segment for elapsed fraction `u` in 0..=1. `Cubic` bends the path itself, at even progress.
    #[must_use]
    pub fn progress(self, u: f64) -> f64 {
        match self {
            Self::Hold => 0.0,
            Self::Linear | Self::Cubic => u,
            Self::EaseIn => u * u,
            Self::EaseOut => u * (2.0 - u),
            Self::EaseInOut => u * u * (3.0 - 2.0 * u),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Easing;

    #[test]
    fn every_easing_starts_at_0_and_all_but_hold_end_at_1() {
        for easing in [Easing::Linear, Easing::EaseIn, Easing::EaseOut, Easing::EaseInOut, Easing::Cubic] {
            assert_eq!(easing.progress(0.0), 0.0, "{easing:?}");
            assert_eq!(easing.progress(1.0), 1.0, "{easing:?}");
            let steps: Vec<f64> = (0..=100).map(|step| easing.progress(f64::from(step) / 100.0)).collect();
            assert!(steps.is_sorted(), "{easing:?} never goes back");
        }
        assert_eq!(Easing::Hold.progress(0.999), 0.0);
        assert_eq!(Easing::EaseInOut.progress(0.5), 0.5);
    }
}
