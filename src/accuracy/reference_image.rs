//! References: highly converged pictures with an estimate of their error.

use rayon::prelude::*;

use crate::color::{Rgb, Transfer};
use crate::trace::Film;

/// The mean of pictures that differ only in their samples.
///
/// Each picture is a randomized quasi-Monte Carlo estimate, independent of the others. The variance between them therefore gives the error
/// of their mean: Owen, "Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences" (1995).
#[derive(Clone, Debug)]
pub struct ReferenceImage {
    /// The mean, in linear light.
    pub film: Film,
    /// The bound of the RMS error over all pixels, in output values: two standard errors.
    pub rms: f64,
    /// The bound of the error of any channel of any pixel, in output values: two standard errors of the most uncertain one.
    pub max: f64,
}

impl ReferenceImage {
    /// Returns the mean of two or more films.
    ///
    /// # Panics
    ///
    /// If the films have different sizes, or are fewer than two.
    #[must_use]
    pub fn mean(films: &[Film], transfer: Transfer) -> Self {
        assert!(films.len() > 1, "a single film has no error estimate");
        let size = |film: &Film| (film.width(), film.height());
        let are_alike = films.iter().all(|film| size(film) == size(&films[0]));
        assert!(are_alike, "films of different sizes have no mean");
        let count = films.len() as f64;
        let pixels = films[0].pixels().len();
        let means: Vec<(Rgb, [f64; 3])> = (0..pixels)
            .into_par_iter()
            .map(|pixel| {
                let light =
                    films.iter().map(|film| film.pixels()[pixel].as_dvec3()).sum::<glam::DVec3>() / count;
                let values = films.iter().map(|film| transfer.encode_unrounded(film.pixels()[pixel]));
                let variance = |channel: usize| {
                    let mean = values.clone().map(|values| values[channel]).sum::<f64>() / count;
                    let squares =
                        values.clone().map(|values| (values[channel] - mean) * (values[channel] - mean));
                    squares.sum::<f64>() / (count * (count - 1.0))
                };
                (light.as_vec3(), [variance(0), variance(1), variance(2)])
            })
            .collect();
        let variances = means.iter().flat_map(|(_, variances)| variances);
        let sum: f64 = variances.clone().sum();
        Self {
            rms: 2.0 * (sum / (3 * pixels.max(1)) as f64).sqrt(),
            max: 2.0 * variances.fold(0.0, |most: f64, variance| most.max(*variance)).sqrt(),
            film: Film::from_pixels(
                films[0].width(),
                films[0].height(),
                means.iter().map(|(light, _)| *light).collect::<Vec<_>>().into_iter(),
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::FilmError;
    use super::*;

    /// Checks noise that decreases from left to right around a known reference.
    #[test]
    fn the_stated_uncertainty_covers_the_error() {
        let exact = Film::from_pixels(64, 64, (0..4096).map(|_| Rgb::splat(0.5)));
        let mut state = 1_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f32::from(u16::try_from(state >> 48).unwrap()) / 65_536.0 - 0.5
        };
        let mut covered = 0;
        for _ in 0..50 {
            let films: Vec<Film> = (0..4)
                .map(|_| {
                    let noise = |pixel: u16| 0.1 * random() * f32::from(pixel % 64) / 64.0;
                    let pixels: Vec<Rgb> =
                        (0..4096).map(noise).map(|noise| Rgb::splat(0.5 + noise)).collect();
                    Film::from_pixels(64, 64, pixels.into_iter())
                })
                .collect();
            let mean = ReferenceImage::mean(&films, Transfer::Classic);
            let error = FilmError::between(&mean.film, &exact, Transfer::Classic);
            assert!(error.rms < mean.rms && error.rms > mean.rms / 3.0, "{} {}", error.rms, mean.rms);
            covered += i32::from(error.max < mean.max);
        }
        assert!(covered >= 45, "{covered}");
    }
}
