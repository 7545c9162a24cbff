//! The structural similarity of two pictures.
//!
//! Wang, Bovik, Sheikh and Simoncelli, "Image Quality Assessment: From Error Visibility to Structural Similarity" (2004), section
//! III.B: local means, variances and the covariance are weighted by a Gaussian of 11 by 11 pixels with a standard deviation of 1.5.

use rayon::prelude::*;

use super::OutputValues;

/// The radius of a window, in pixels.
const REACH: usize = 5;
const DEVIATION: f64 = 1.5;
/// (0.01 255)^2 and (0.03 255)^2, which keep quotients of dark and of flat regions finite.
const OF_MEANS: f64 = 6.5025;
const OF_VARIANCES: f64 = 58.5225;

/// Returns the structural similarity of two pictures, from -1 to 1: the mean over all pixels and channels. Only equal pictures have 1.
/// Windows that extend beyond the edge use only the pixels inside the picture.
///
/// # Panics
///
/// If the pictures have different sizes.
#[must_use]
pub fn structural_similarity(picture: &OutputValues, reference: &OutputValues) -> f64 {
    assert_eq!(picture.size(), reference.size(), "films of different sizes cannot be compared");
    if picture.pixels().is_empty() {
        return 1.0;
    }
    let width = picture.size().0 as usize;
    let channel = |channel| mean_similarity(&picture.channel(channel), &reference.channel(channel), width);
    (channel(0) + channel(1) + channel(2)) / 3.0
}

fn mean_similarity(one: &[f64], other: &[f64], width: usize) -> f64 {
    let products = |one: &[f64], other: &[f64]| -> Vec<f64> {
        one.par_iter().zip(other).map(|(one, other)| one * other).collect()
    };
    let mean_one = local_means(one, width);
    let mean_other = local_means(other, width);
    let square_one = local_means(&products(one, one), width);
    let square_other = local_means(&products(other, other), width);
    let product = local_means(&products(one, other), width);
    let similarity = |at: usize| {
        let (x, y) = (mean_one[at], mean_other[at]);
        let (variance_x, variance_y) = (square_one[at] - x * x, square_other[at] - y * y);
        let covariance = product[at] - x * y;
        let means = (2.0 * x * y + OF_MEANS) / (x * x + y * y + OF_MEANS);
        means * (2.0 * covariance + OF_VARIANCES) / (variance_x + variance_y + OF_VARIANCES)
    };
    // The sum is taken row by row, so that it does not depend on threads.
    let row = |row: usize| (row * width..(row + 1) * width).map(similarity).sum::<f64>();
    let rows: Vec<f64> = (0..one.len() / width).into_par_iter().map(row).collect();
    rows.iter().sum::<f64>() / one.len() as f64
}

/// Returns the weighted mean around each value: along rows, then along columns.
fn local_means(values: &[f64], width: usize) -> Vec<f64> {
    let (weights, height) = (weights(), values.len() / width);
    let mut along_rows = vec![0.0; values.len()];
    along_rows.par_chunks_mut(width).zip(values.par_chunks(width)).for_each(|(means, row)| {
        for (column, mean) in means.iter_mut().enumerate() {
            *mean = weighted(&weights, column, width, |column| row[column]);
        }
    });
    let mut means = vec![0.0; values.len()];
    means.par_chunks_mut(width).enumerate().for_each(|(row, means)| {
        for (column, mean) in means.iter_mut().enumerate() {
            *mean = weighted(&weights, row, height, |row| along_rows[row * width + column]);
        }
    });
    means
}

/// Returns the weighted mean of the values around index `place` of `count`.
fn weighted(weights: &[f64; REACH + 1], place: usize, count: usize, value: impl Fn(usize) -> f64) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for other in place.saturating_sub(REACH)..count.min(place + REACH + 1) {
        let weight = weights[place.abs_diff(other)];
        sum += weight * value(other);
        total += weight;
    }
    sum / total
}

/// Returns the Gaussian weights by distance.
fn weights() -> [f64; REACH + 1] {
    std::array::from_fn(|distance| {
        let distance = distance as f64 / DEVIATION;
        libm::exp(-0.5 * distance * distance)
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn picture(width: u32, values: &[f32]) -> OutputValues {
        let height = u32::try_from(values.len()).unwrap() / width;
        let pixel = |value: &f32| [255.0, 127.5, 0.0].map(|scale| f64::from(*value) * scale);
        let pixels = values.iter().map(pixel).map(|[red, green, _]| [red, green, 63.75]);
        OutputValues::new((width, height), pixels.collect())
    }

    #[test]
    fn only_equal_pictures_have_similarity_1() {
        let values: Vec<f32> = (0..600_u16).map(|index| f32::from(index * 37 % 256) / 255.0).collect();
        let one = picture(30, &values);
        assert_eq!(structural_similarity(&one, &one), 1.0);
        let turned: Vec<f32> = values.iter().map(|value| 1.0 - value).collect();
        assert!(structural_similarity(&one, &picture(30, &turned)) < 0.5);
        let empty = OutputValues::new((0, 0), Vec::new());
        assert_eq!(structural_similarity(&empty, &empty), 1.0);
    }

    /// Checks pictures without variance, whose similarity depends only on the means.
    #[test]
    fn flat_pictures_have_a_closed_form() {
        let flat = |value: f64| OutputValues::new((13, 7), vec![[value; 3]; 91]);
        let (x, y) = (0.25 * 255.0, 0.5 * 255.0);
        let expected = (2.0 * x * y + OF_MEANS) / (x * x + y * y + OF_MEANS);
        let found = structural_similarity(&flat(x), &flat(y));
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]

        /// Compares with the definition: whole windows, with variances about their means.
        #[test]
        fn similarity_matches_the_definition(
            (width, values, others) in (1_u32..14, 1_usize..14).prop_flat_map(|(width, height)| {
                let values = prop::collection::vec(0.0_f32..1.0, width as usize * height);
                (Just(width), values.clone(), values)
            }),
        ) {
            let found = structural_similarity(&picture(width, &values), &picture(width, &others));
            let (columns, rows) = (width as usize, values.len() / width as usize);
            let mut sum = 0.0;
            for scale in [255.0, 127.5, 0.0] {
                let [one, other] = [&values, &others].map(|values| -> Vec<f64> {
                    let offset = if scale == 0.0 { 63.75 } else { 0.0 };
                    values.iter().map(|value| f64::from(*value) * scale + offset).collect()
                });
                for place in 0..values.len() {
                    let (row, column) = (place / columns, place % columns);
                    let window: Vec<(f64, usize)> = (0..values.len())
                        .filter_map(|other| {
                            let (down, right) = ((other / columns).abs_diff(row), (other % columns).abs_diff(column));
                            let square = (down * down + right * right) as f64 / (DEVIATION * DEVIATION);
                            (down <= REACH && right <= REACH).then(|| (libm::exp(-0.5 * square), other))
                        })
                        .collect();
                    let total: f64 = window.iter().map(|(weight, _)| weight).sum();
                    let mean = |value: &dyn Fn(usize) -> f64| {
                        window.iter().map(|(weight, place)| weight * value(*place)).sum::<f64>() / total
                    };
                    let (x, y) = (mean(&|place| one[place]), mean(&|place| other[place]));
                    let variance_x = mean(&|place| (one[place] - x) * (one[place] - x));
                    let variance_y = mean(&|place| (other[place] - y) * (other[place] - y));
                    let covariance = mean(&|place| (one[place] - x) * (other[place] - y));
                    sum += (2.0 * x * y + OF_MEANS) * (2.0 * covariance + OF_VARIANCES)
                        / ((x * x + y * y + OF_MEANS) * (variance_x + variance_y + OF_VARIANCES));
                }
            }
            let expected = sum / (3 * columns * rows) as f64;
            prop_assert!((found - expected).abs() < 1e-6, "{} {}", found, expected);
        }
    }
}
