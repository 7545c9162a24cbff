//! FLIP: the perceived difference of two pictures for an observer who alternates between them.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference Evaluator for Alternating Images", Proceedings
//! of the ACM on Computer Graphics and Interactive Techniques 3(2), 2020, for pictures of low dynamic range. Details that the paper leaves
//! open, such as the normalization of filters, follow its reference implementation.
//!
//! ```text
//! for both pictures:
//!     decode sRGB, convert to YCxCz, filter by the eye's contrast sensitivity, convert to L*a*b*, adjust for brightness   (section 4.1)
//!     find edges and points in the luminance                                                                              (section 4.2)
//! for each pixel:
//!     color = the distance of both colours (HyAB), compressed and mapped to 0..1                                          (section 4.1)
//!     feature = the root of the larger difference of edges and of points                                                  (section 4.2)
//!     result = color ^ (1 - feature)                                                                                      (section 4.3)
//! ```
//!
//! All filters are sums of separable filters: products of a function of the column and a function of the row. Pictures are processed in
//! bands of rows, each with the surrounding rows that the filters reach, so that little memory is needed.

use std::f64::consts::PI;
use std::ops::Range;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::OutputValues;
use crate::color::Transfer;

/// Pixels per degree of the visual field, for a screen of 3840 pixels at a distance equal to its width (section 3).
const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;
/// Rows per band.
const BAND: usize = 32;

/// The FLIP difference of two pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Flip {
    /// The mean of all pixels, from 0 for equal pictures to 1.
    pub mean: f64,
    /// The difference of each pixel, from 0 to 1, row by row from the top.
    pub pixels: Vec<f64>,
}

/// Compares two pictures, whose output values are interpreted as sRGB. The result does not depend on the number of threads, nor on the
/// order of the pictures.
///
/// # Panics
///
/// If the pictures have different sizes.
///
/// ```
/// use rayreel::accuracy::{OutputValues, flip};
///
/// let flat = |values| OutputValues::new((2, 1), vec![values; 2]);
/// let (green, blue) = (flat([0.0, 255.0, 0.0]), flat([0.0, 0.0, 255.0]));
/// assert_eq!(flip(&green, &green).mean, 0.0);
/// assert!((flip(&green, &blue).mean - 1.0).abs() < 1e-6); // no colours are further apart
/// ```
#[must_use]
pub fn flip(picture: &OutputValues, reference: &OutputValues) -> Flip {
    assert_eq!(picture.size(), reference.size(), "films of different sizes cannot be compared");
    let (width, height) = picture.size();
    let (width, height) = (width as usize, height as usize);
    let filters = Filters::new();
    let furthest = HyAb::furthest();
    let of_band = |first: usize| -> Vec<f64> {
        let rows = first..(first + BAND).min(height);
        let [one, other] =
            [picture, reference].map(|picture| Perceived::of(picture, width, rows.clone(), &filters));
        let pairs = one.colors.iter().zip(&other.colors).zip(one.features.iter().zip(&other.features));
        pairs
            .map(|((one, other), (features, others))| {
                let color = furthest.redistributed(hyab(*one, *other));
                libm::pow(color, 1.0 - features.difference(others))
            })
            .collect()
    };
    let starts: Vec<usize> = (0..if width == 0 { 0 } else { height }).step_by(BAND).collect();
    let bands: Vec<Vec<f64>> = starts.into_par_iter().map(of_band).collect();
    // The sum is taken band by band, so that it does not depend on threads.
    let sum: f64 = bands.iter().map(|band| band.iter().sum::<f64>()).sum();
    let pixels = bands.concat();
    Flip { mean: sum / pixels.len().max(1) as f64, pixels }
}

/// A band of a picture as perceived by the observer.
struct Perceived {
    /// L*a*b*, adjusted for brightness.
    colors: Vec<DVec3>,
    features: Vec<Features>,
}

impl Perceived {
    fn of(picture: &OutputValues, width: usize, rows: Range<usize>, filters: &Filters) -> Self {
        let height = picture.size().1 as usize;
        let around = rows.start.saturating_sub(filters.radius())..height.min(rows.end + filters.radius());
        let opponent: Vec<DVec3> = picture.pixels()[around.start * width..around.end * width]
            .iter()
            .map(|values| opponent_of_xyz(XYZ * linear(*values)))
            .collect();
        let plane = |channel: usize| ChannelRows {
            values: opponent.iter().map(|color| color[channel]).collect(),
            width,
            first: around.start,
        };
        let [luma, red_green, blue_yellow] = [plane(0), plane(1), plane(2)];
        let filtered = [
            luma.filtered(&filters.achromatic, rows.clone()),
            red_green.filtered(&filters.red_green, rows.clone()),
            blue_yellow.filtered(&filters.blue_yellow, rows.clone()),
        ];
        let color = |at: usize| {
            let seen = DVec3::new(filtered[0][at], filtered[1][at], filtered[2][at]);
            let shown = (XYZ.inverse() * xyz_of_opponent(seen)).clamp(DVec3::ZERO, DVec3::ONE);
            brightness_adjusted(lab(XYZ * shown))
        };
        let luminance =
            ChannelRows { values: luma.values.iter().map(|y| (y + 16.0) / 116.0).collect(), ..luma };
        let [edge_x, edge_y, point_x, point_y] =
            filters.features.each_ref().map(|filter| luminance.filtered(filter, rows.clone()));
        let features = |at: usize| Features {
            edge: libm::hypot(edge_x[at], edge_y[at]),
            point: libm::hypot(point_x[at], point_y[at]),
        };
        let count = rows.len() * width;
        Self { colors: (0..count).map(color).collect(), features: (0..count).map(features).collect() }
    }
}

/// A range of rows of one channel.
struct ChannelRows {
    values: Vec<f64>,
    width: usize,
    /// The row of the first value.
    first: usize,
}

impl ChannelRows {
    /// Filters a range of rows. Beyond the edges of the picture, its outermost pixels are repeated.
    fn filtered(&self, filter: &[Product], rows: Range<usize>) -> Vec<f64> {
        let (width, last) = (self.width, self.values.len() / self.width - 1);
        let mut filtered = vec![0.0; rows.len() * width];
        for Product { columns, rows: down } in filter {
            let radius = columns.len() / 2;
            let across: Vec<f64> = self
                .values
                .chunks(width)
                .flat_map(|row| {
                    (0..width).map(move |column| {
                        let at = |tap: usize| row[(column + tap).saturating_sub(radius).min(width - 1)];
                        columns.iter().enumerate().map(|(tap, weight)| weight * at(tap)).sum::<f64>()
                    })
                })
                .collect();
            for (filtered, row) in filtered.chunks_mut(width).zip(rows.clone()) {
                for (tap, weight) in down.iter().enumerate() {
                    let row = (row + tap).saturating_sub(radius).max(self.first) - self.first;
                    let across = &across[row.min(last) * width..][..width];
                    filtered.iter_mut().zip(across).for_each(|(sum, value)| *sum += weight * value);
                }
            }
        }
        filtered
    }
}

/// A separable filter: the weight of a pixel is the product of a column weight and a row weight.
struct Product {
    columns: Vec<f64>,
    rows: Vec<f64>,
}

/// The filters for a viewing distance.
struct Filters {
    achromatic: Vec<Product>,
    red_green: Vec<Product>,
    blue_yellow: Vec<Product>,
    /// Edge detectors along columns and rows, then point detectors along both.
    features: [Vec<Product>; 4],
}

impl Filters {
    /// Builds contrast sensitivity filters (section 4.1, table 1) and feature detectors (section 4.2).
    fn new() -> Self {
        /// The largest b of all sensitivity filters, which determines their radius.
        const WIDEST: f64 = 0.04;
        /// The width of the most visible features, in degrees.
        const FEATURE_WIDTH: f64 = 0.082;
        let radius = 3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE;
        let sensitivity = |terms: &[(f64, f64)]| {
            let gaussian = |b: f64| {
                taps(radius, |x| libm::exp(-PI * PI * x * x / (b * PIXELS_PER_DEGREE * PIXELS_PER_DEGREE)))
            };
            let terms: Vec<(f64, Vec<f64>)> =
                terms.iter().map(|(a, b)| (a * (PI / b).sqrt(), gaussian(*b))).collect();
            let sum = |taps: &[f64]| taps.iter().sum::<f64>();
            let total: f64 = terms.iter().map(|(factor, taps)| factor * sum(taps) * sum(taps)).sum();
            let product = |(factor, taps): (f64, Vec<f64>)| Product {
                columns: scaled(&taps, factor / total),
                rows: taps,
            };
            terms.into_iter().map(product).collect()
        };
        let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
        let bell = |x: f64| libm::exp(-x * x / (2.0 * deviation * deviation));
        let smooth = taps(3.0 * deviation, bell);
        let smooth = scaled(&smooth, 1.0 / smooth.iter().sum::<f64>());
        let edge = balanced(taps(3.0 * deviation, |x| -x * bell(x)));
        let point = balanced(taps(3.0 * deviation, |x| (x * x / (deviation * deviation) - 1.0) * bell(x)));
        let product = |columns: &Vec<f64>, rows: &Vec<f64>| {
            vec![Product { columns: columns.clone(), rows: rows.clone() }]
        };
        Self {
            achromatic: sensitivity(&[(1.0, 0.0047)]),
            red_green: sensitivity(&[(1.0, 0.0053)]),
            blue_yellow: sensitivity(&[(34.1, WIDEST), (13.5, 0.025)]),
            features: [
                product(&edge, &smooth),
                product(&smooth, &edge),
                product(&point, &smooth),
                product(&smooth, &point),
            ],
        }
    }

    /// Returns the radius of the largest filter, in rows.
    fn radius(&self) -> usize {
        let of = |filter: &[Product]| filter.iter().map(|product| product.rows.len() / 2).max().unwrap_or(0);
        of(&self.blue_yellow).max(of(&self.features[0]))
    }
}

/// Returns the values of a function at the integers within `radius` of 0.
fn taps(radius: f64, function: impl Fn(f64) -> f64) -> Vec<f64> {
    #[expect(clippy::cast_possible_truncation, reason = "few pixels")]
    let radius = radius.ceil() as i32;
    (-radius..=radius).map(|x| function(f64::from(x))).collect()
}

fn scaled(taps: &[f64], factor: f64) -> Vec<f64> {
    taps.iter().map(|tap| factor * tap).collect()
}

/// Scales positive weights to a sum of 1, and negative ones to -1.
fn balanced(taps: Vec<f64>) -> Vec<f64> {
    let sum = |sign: f64| taps.iter().map(|tap| (sign * tap).max(0.0)).sum::<f64>();
    let (positive, negative) = (sum(1.0), sum(-1.0));
    taps.into_iter().map(|tap| tap / if tap > 0.0 { positive } else { negative }).collect()
}

/// The strength of edges and points in a pixel.
struct Features {
    edge: f64,
    point: f64,
}

impl Features {
    /// Returns the difference of features, from 0 to 1 (section 4.2).
    fn difference(&self, other: &Self) -> f64 {
        let largest = (self.edge - other.edge).abs().max((self.point - other.point).abs());
        (std::f64::consts::FRAC_1_SQRT_2 * largest).sqrt().clamp(0.0, 1.0)
    }
}

/// Returns the distance of two colours: the difference of lightness plus the Euclidean distance of chroma (section 4.1).
fn hyab(one: DVec3, other: DVec3) -> f64 {
    let apart = one - other;
    apart.x.abs() + libm::hypot(apart.y, apart.z)
}

/// The mapping of colour distances to 0..1.
struct HyAb {
    /// The largest compressed distance, between green and blue.
    furthest: f64,
}

impl HyAb {
    /// The exponent that compresses large distances.
    const EXPONENT: f64 = 0.7;
    /// The fraction of the largest compressed distance that is mapped to all but the last twentieth of the range.
    const KNEE: f64 = 0.4;
    const KNEE_VALUE: f64 = 0.95;

    fn furthest() -> Self {
        let color = |linear| brightness_adjusted(lab(XYZ * linear));
        Self { furthest: libm::pow(hyab(color(DVec3::Y), color(DVec3::Z)), Self::EXPONENT) }
    }

    /// Maps a distance to 0..1 (section 4.1).
    fn redistributed(&self, distance: f64) -> f64 {
        let (compressed, knee) = (libm::pow(distance, Self::EXPONENT), Self::KNEE * self.furthest);
        if compressed < knee {
            Self::KNEE_VALUE / knee * compressed
        } else {
            Self::KNEE_VALUE + (compressed - knee) / (self.furthest - knee) * (1.0 - Self::KNEE_VALUE)
        }
    }
}

/// The matrix from linear sRGB to CIE XYZ (IEC 61966-2-1).
const XYZ: DMat3 = DMat3::from_cols(
    DVec3::new(10_135_552.0 / 24_577_794.0, 2_613_072.0 / 12_288_897.0, 1_425_312.0 / 73_733_382.0),
    DVec3::new(8_788_810.0 / 24_577_794.0, 8_788_810.0 / 12_288_897.0, 8_788_810.0 / 73_733_382.0),
    DVec3::new(4_435_075.0 / 24_577_794.0, 887_015.0 / 12_288_897.0, 70_074_185.0 / 73_733_382.0),
);

/// Returns the white of a screen, in CIE XYZ.
fn white() -> DVec3 {
    XYZ * DVec3::ONE
}

fn linear(values: [f64; 3]) -> DVec3 {
    Transfer::Srgb.decode(values).as_dvec3()
}

/// Converts CIE XYZ to YCxCz, in which contrast sensitivity is known (section 4.1).
fn opponent_of_xyz(xyz: DVec3) -> DVec3 {
    let relative = xyz / white();
    DVec3::new(
        116.0 * relative.y - 16.0,
        500.0 * (relative.x - relative.y),
        200.0 * (relative.y - relative.z),
    )
}

fn xyz_of_opponent(opponent: DVec3) -> DVec3 {
    let y = (opponent.x + 16.0) / 116.0;
    DVec3::new(y + opponent.y / 500.0, y, y - opponent.z / 200.0) * white()
}

/// Converts CIE XYZ to CIE L*a*b*.
fn lab(xyz: DVec3) -> DVec3 {
    /// The cube root is replaced by a line below the cube of this value.
    const DARK: f64 = 6.0 / 29.0;
    let root = |value: f64| {
        if value > DARK * DARK * DARK { libm::cbrt(value) } else { value / (3.0 * DARK * DARK) + 4.0 / 29.0 }
    };
    let [x, y, z] = (xyz / white()).to_array().map(root);
    DVec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}

/// Reduces the chroma of dark colours (Hunt effect, section 4.1).
fn brightness_adjusted(lab: DVec3) -> DVec3 {
    DVec3::new(lab.x, 0.01 * lab.x * lab.y, 0.01 * lab.x * lab.z)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn flat(size: (u32, u32), values: [f64; 3]) -> OutputValues {
        OutputValues::new(size, vec![values; (size.0 * size.1) as usize])
    }

    /// Checks pictures without features, whose difference is the distance of two colours.
    #[test]
    fn flat_pictures_have_a_closed_form() {
        let furthest = HyAb::furthest().furthest;
        for size in [(1, 1), (5, 70), (40, 3)] {
            let (black, white) = (flat(size, [0.0; 3]), flat(size, [255.0; 3]));
            // White has a lightness of 100; neither colour has chroma.
            let (compressed, knee) = (libm::pow(100.0, 0.7), 0.4 * furthest);
            let expected = 0.95 + 0.05 * (compressed - knee) / (furthest - knee);
            let found = flip(&black, &white);
            assert!((found.mean - expected).abs() < 1e-6, "{} {expected}", found.mean);
            assert!(found.pixels.iter().all(|pixel| (pixel - expected).abs() < 1e-6));
            assert_eq!(flip(&white, &white), Flip { mean: 0.0, pixels: vec![0.0; found.pixels.len()] });
            let (green, blue) = (flat(size, [0.0, 255.0, 0.0]), flat(size, [0.0, 0.0, 255.0]));
            assert!((flip(&green, &blue).mean - 1.0).abs() < 1e-6);
        }
        let empty = OutputValues::new((0, 3), Vec::new());
        assert_eq!(flip(&empty, &empty), Flip { mean: 0.0, pixels: Vec::new() });
    }

    /// Compares with means of the authors' reference implementation, version 1.7, at 67.0206 pixels per degree.
    #[test]
    fn means_match_the_reference_implementation() {
        let size = (48, 40);
        let picture = |value: fn(u32, u32) -> [u32; 3]| {
            let pixels =
                (0..size.1).flat_map(|row| (0..size.0).map(move |column| value(column, row).map(f64::from)));
            OutputValues::new(size, pixels.collect())
        };
        let ramp = picture(|column, row| [5 * column, 6 * row, 128]);
        let noise = picture(|column, row| {
            [column * 37 + row * 101, column * 11 + row * 59, column * 73 + row * 7].map(|value| value % 256)
        });
        let checker = picture(|column, row| [255 * ((column / 8 + row / 8) % 2); 3]);
        for (one, other, expected) in
            [(&ramp, &noise, RAMP_NOISE), (&ramp, &checker, RAMP_CHECKER), (&noise, &checker, NOISE_CHECKER)]
        {
            let found = flip(one, other).mean;
            assert!((found - expected).abs() < 1e-4, "{found} {expected}");
            assert_eq!(found, flip(other, one).mean);
        }
    }

    const RAMP_NOISE: f64 = 0.793_442_1;
    const RAMP_CHECKER: f64 = 0.928_093_3;
    const NOISE_CHECKER: f64 = 0.849_910_5;

    /// Evaluates the paper's formulas in order, with two-dimensional filters over the whole picture.
    fn by_definition(one: &OutputValues, other: &OutputValues) -> Vec<f64> {
        let ppd = PIXELS_PER_DEGREE;
        let (width, height) = (i32::try_from(one.size().0).unwrap(), i32::try_from(one.size().1).unwrap());
        let filtered =
            |values: &dyn Fn(usize) -> f64, radius: i32, weight: &dyn Fn(f64, f64) -> f64, at: (i32, i32)| {
                let (mut positive, mut negative, mut sums) = (0.0, 0.0, [0.0; 2]);
                for (y, x) in (-radius..=radius).flat_map(|y| (-radius..=radius).map(move |x| (y, x))) {
                    let weight = weight(f64::from(x), f64::from(y));
                    let (column, row) = ((at.0 + x).clamp(0, width - 1), (at.1 + y).clamp(0, height - 1));
                    let value = values(usize::try_from(row * width + column).unwrap());
                    if weight > 0.0 {
                        (positive, sums[0]) = (positive + weight, sums[0] + weight * value);
                    } else {
                        (negative, sums[1]) = (negative - weight, sums[1] + weight * value);
                    }
                }
                sums[0] / positive + if negative > 0.0 { sums[1] / negative } else { 0.0 }
            };
        let perceived = |picture: &OutputValues, at: (i32, i32)| {
            let opponent: Vec<DVec3> =
                picture.pixels().iter().map(|values| opponent_of_xyz(XYZ * linear(*values))).collect();
            let seen = |channel: usize, [a1, b1, a2, b2]: [f64; 4]| {
                let weight = |x: f64, y: f64| {
                    let square = (x * x + y * y) / (ppd * ppd);
                    let term = |a: f64, b: f64| a * (PI / b).sqrt() * libm::exp(-PI * PI * square / b);
                    term(a1, b1) + term(a2, b2)
                };
                filtered(&|pixel| opponent[pixel][channel], 10, &weight, at)
            };
            let seen = DVec3::new(
                seen(0, [1.0, 0.0047, 0.0, 1e-5]),
                seen(1, [1.0, 0.0053, 0.0, 1e-5]),
                seen(2, [34.1, 0.04, 13.5, 0.025]),
            );
            let shown = (XYZ.inverse() * xyz_of_opponent(seen)).clamp(DVec3::ZERO, DVec3::ONE);
            let deviation = 0.5 * 0.082 * ppd;
            let bell = |x: f64, y: f64| libm::exp(-(x * x + y * y) / (2.0 * deviation * deviation));
            let second = |x: f64| x * x / (deviation * deviation) - 1.0;
            let found = |weight: &dyn Fn(f64, f64) -> f64| {
                filtered(&|pixel| (opponent[pixel].x + 16.0) / 116.0, 9, weight, at)
            };
            let edges = libm::hypot(found(&|x, y| -x * bell(x, y)), found(&|x, y| -y * bell(x, y)));
            let points =
                libm::hypot(found(&|x, y| second(x) * bell(x, y)), found(&|x, y| second(y) * bell(x, y)));
            (brightness_adjusted(lab(XYZ * shown)), edges, points)
        };
        let of_pixel = |at: (i32, i32)| {
            let ((color, edge, point), (other_color, other_edge, other_point)) =
                (perceived(one, at), perceived(other, at));
            let color = HyAb::furthest().redistributed(hyab(color, other_color));
            let feature = (edge - other_edge).abs().max((point - other_point).abs()) / f64::sqrt(2.0);
            libm::pow(color, 1.0 - feature.sqrt())
        };
        (0..height).flat_map(|row| (0..width).map(move |column| of_pixel((column, row)))).collect()
    }

    fn pictures() -> impl Strategy<Value = [OutputValues; 2]> {
        (1_u32..12, 1_u32..40).prop_flat_map(|size| {
            let values = prop::array::uniform3(prop_oneof![Just(0.0), Just(255.0), 0.0..=255.0_f64]);
            let picture = prop::collection::vec(values, (size.0 * size.1) as usize);
            (picture.clone(), picture)
                .prop_map(move |(one, other)| [one, other].map(|values| OutputValues::new(size, values)))
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]

        #[test]
        fn differences_match_the_definition([one, other] in pictures()) {
            let (found, expected) = (flip(&one, &other), by_definition(&one, &other));
            for (found, expected) in found.pixels.iter().zip(&expected) {
                prop_assert!((found - expected).abs() < 1e-6, "{} {}", found, expected);
            }
            let mean = expected.iter().sum::<f64>() / expected.len() as f64;
            prop_assert!((found.mean - mean).abs() < 1e-6);
        }
    }

    proptest! {
        #[test]
        fn differences_are_symmetric_from_0_to_1_and_0_for_equal_pictures([one, other] in pictures()) {
            let found = flip(&one, &other);
            prop_assert!(found.pixels.iter().all(|pixel| (0.0..=1.0 + 1e-9).contains(pixel)));
            prop_assert_eq!(&found, &flip(&other, &one));
            prop_assert_eq!(flip(&one, &one).mean, 0.0);
        }
    }
}
