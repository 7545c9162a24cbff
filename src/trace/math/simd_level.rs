//! Which of the processor's instructions are used.

use fearless_simd::Level;

/// The vector instructions that pictures are made with. They change how long that takes, and not a bit of the picture.
#[derive(Clone, Copy, Debug)]
pub struct SimdLevel(Level);

impl SimdLevel {
    /// Returns the best that this processor has.
    #[must_use]
    pub fn best() -> Self {
        Self(Level::new())
    }

    /// Returns it as the vector library has it.
    pub(crate) fn level(self) -> Level {
        self.0
    }

    /// Returns all that this processor has, each with its name, the plainest first.
    #[must_use]
    pub fn all() -> Vec<(&'static str, Self)> {
        let mut all = vec![("baseline", Level::baseline())];
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            let best = Level::new();
            all.extend(best.as_avx2().map(|level| ("AVX2", Level::Avx2(level))));
            all.extend(best.as_avx512().map(|level| ("AVX-512", Level::Avx512(level))));
        }
        all.into_iter().map(|(name, level)| (name, Self(level))).collect()
    }
}

impl Default for SimdLevel {
    fn default() -> Self {
        Self::best()
    }
}
