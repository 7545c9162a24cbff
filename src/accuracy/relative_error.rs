//! The relative error of linear light, which gives dark and bright regions the same weight.

use crate::color::Rgb;

/// Added to squares, so that errors of black pixels are finite.
const DARK: f64 = 0.01;

/// Returns the relative mean square error of linear light: the mean over all pixels and channels of (x - r)^2 / (r^2 + 0.01), with x of the
/// picture and r of the reference (Rousselle, Knaus and Zwicker, "Adaptive Sampling and Reconstruction using Greedy Error Minimization",
/// SIGGRAPH Asia 2011, section 6). It is not symmetric.
///
/// # Panics
///
/// If there are not as many pixels in both.
///
/// ```
/// use rayreel::Rgb;
/// use rayreel::accuracy::relative_mse;
///
/// let (picture, reference) = ([Rgb::splat(0.5), Rgb::splat(0.25)], [Rgb::splat(1.0), Rgb::splat(0.25)]);
/// assert_eq!(relative_mse(&picture, &reference), 0.5 * 0.25 / 1.01);
/// ```
#[must_use]
pub fn relative_mse(picture: &[Rgb], reference: &[Rgb]) -> f64 {
    assert_eq!(picture.len(), reference.len(), "pictures of different sizes cannot be compared");
    let pairs = picture.iter().zip(reference);
    let of_pixel = |(pixel, other): (&Rgb, &Rgb)| {
        let (pixel, other) = (pixel.as_dvec3(), other.as_dvec3());
        let (square, apart) = (other * other, pixel - other);
        (apart * apart / (square + DARK)).element_sum()
    };
    pairs.map(of_pixel).sum::<f64>() / (3 * picture.len().max(1)) as f64
}
