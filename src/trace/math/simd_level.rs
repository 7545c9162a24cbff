//! Selection of the SIMD instruction set.

use fearless_simd::Level;

/// A SIMD instruction set. It affects the speed of rendering, and no bit of the image.
#[derive(Clone, Copy, Debug)]
pub struct SimdLevel(Level);

impl PartialEq for SimdLevel {
    fn eq(&self, other: &Self) -> bool {
        std::mem::discriminant(&self.0) == std::mem::discriminant(&other.0)
    }
}

impl SimdLevel {
    /// Returns the best level that this processor supports.
    #[must_use]
    pub fn best() -> Self {
        Self(Level::new())
    }

    /// Returns the level as a type of the SIMD library.
    pub(crate) fn level(self) -> Level {
        self.0
    }

    /// Returns all levels that this processor supports, with their names, in ascending order of capability.
    #[must_use]
    pub fn all() -> Vec<(&'static str, Self)> {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        let wider = {
            let best = Level::new();
            let avx2 = best.as_avx2().map(|level| ("AVX2", Level::Avx2(level)));
            [avx2, best.as_avx512().map(|level| ("AVX-512", Level::Avx512(level)))]
        };
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        let wider = [];
        let all = [Some(("baseline", Level::baseline()))].into_iter().chain(wider).flatten();
        all.map(|(name, level)| (name, Self(level))).collect()
    }
}

impl Default for SimdLevel {
    fn default() -> Self {
        Self::best()
    }
}
