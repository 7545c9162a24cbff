//! Heat maps of one number per pixel.

use rayreel::color::{Rgb, Transfer};
use rayreel::output::encode_quickly;
use rayreel::trace::Film;

/// Returns a heat map of one number per pixel, row by row from the top, as PNG. Colours range from black for 0 through red and yellow to
/// white for the largest number.
pub(super) fn heat_map((width, height): (u32, u32), numbers: &[f64]) -> anyhow::Result<Vec<u8>> {
    let most = numbers.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let pixels = numbers.iter().map(|number| heat(number / most));
    Ok(encode_quickly(&Film::from_pixels(width, height, pixels), Transfer::Classic)?)
}

/// Returns the heat colour of a share from 0 to 1. Every share above 0 is brighter than black.
fn heat(share: f64) -> Rgb {
    /// Position in the colour range of the darkest colour that is visible on black.
    const FAINT: f64 = 0.1;
    if share <= 0.0 {
        return Rgb::ZERO;
    }
    #[expect(clippy::cast_possible_truncation, reason = "it becomes a byte")]
    let heat = 3.0 * (FAINT + (1.0 - FAINT) * share.min(1.0)) as f32;
    Rgb::new(heat, heat - 1.0, heat - 2.0).clamp(Rgb::ZERO, Rgb::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_get_brighter_from_black_to_white() {
        assert_eq!((heat(0.0), heat(1.0)), (Rgb::ZERO, Rgb::ONE));
        let sums: Vec<f32> =
            (0..=100_u8).map(|percent| heat(f64::from(percent) / 100.0).element_sum()).collect();
        assert!(sums.windows(2).all(|pair| pair[0] < pair[1]), "{sums:?}");
        assert!(heat(1e-9).element_sum() > 0.2);
    }
}
