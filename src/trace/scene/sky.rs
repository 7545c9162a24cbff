//! The sun and the stars. They add to the background of rays that hit nothing, and light no surface.

use std::f64::consts::FRAC_PI_4;

use glam::DVec3;

use crate::color::{Rgb, to_f32};
use crate::trace::math::{Bytes, mixed, uniform};

/// The lights in the sky. Without any, rays that hit nothing see the background alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PreparedSky {
    pub sun: Option<PreparedSun>,
    pub stars: Option<PreparedStars>,
}

/// The light of the sun or the stars in a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkyLight {
    /// The radiance of the sun's disc or of the centre of the brightest star.
    pub intensity: Rgb,
    /// The share of the intensity in the direction.
    pub share: f32,
}

impl SkyLight {
    /// Returns the radiance in the direction.
    #[must_use]
    #[inline]
    pub fn color(&self) -> Rgb {
        self.intensity * self.share
    }
}

/// A disc with a soft edge and a halo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PreparedSun {
    /// Unit vector towards the sun.
    pub direction: DVec3,
    /// The radiance of the disc.
    pub intensity: Rgb,
    /// The angular radius of the disc in radians, greater than 0.
    pub radius: f64,
    /// The radiance of the halo at the edge of the disc, as a share of the intensity, 0 to 1.
    pub glow: f64,
    /// The angle from the edge over which the halo falls to 1/e, in radians, greater than 0.
    pub glow_size: f64,
}

/// Stars on a sphere around the scene.
///
/// The sphere is divided like the faces of a cube, each into rows of cells of about equal angles. A cell has one star at most, at a
/// distance from its borders that exceeds the star's radius. So a direction sees the star of its own cell or none, and nothing jumps where
/// cells meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PreparedStars {
    /// The radiance of the centre of the brightest star.
    intensity: Rgb,
    /// The angular radius of a star in radians, greater than 0.
    radius: f64,
    /// The number of rows of each face, and of cells in a row.
    rows: f64,
    /// The share of the cells that have a star.
    filled: f64,
    seed: u64,
}

impl PreparedSky {
    /// Returns whether there is neither a sun nor a star.
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.sun.is_none() && self.stars.is_none()
    }

    /// Returns the radiance in a unit direction.
    pub(super) fn towards(&self, unit: DVec3) -> Rgb {
        let [sun, stars] = self.lights(unit);
        let color = |light: Option<SkyLight>| light.map_or(Rgb::ZERO, |light| light.color());
        color(sun) + color(stars)
    }

    /// Returns the sun and the stars in a unit direction.
    #[inline]
    pub(super) fn lights(&self, unit: DVec3) -> [Option<SkyLight>; 2] {
        let light = |intensity, share| SkyLight { intensity, share: to_f32(share) };
        [
            self.sun.map(|sun| light(sun.intensity, sun.share(unit))),
            self.stars.map(|stars| light(stars.intensity, stars.share(unit))),
        ]
    }

    /// Returns an upper bound of each channel over all directions.
    pub(super) fn radiance_bound(&self) -> Rgb {
        let sun = self.sun.map_or(Rgb::ZERO, |sun| sun.intensity);
        sun + self.stars.map_or(Rgb::ZERO, |stars| stars.intensity)
    }

    /// Writes the bytes of everything that pictures depend on.
    pub(super) fn write(&self, bytes: &mut Bytes) {
        if self.is_empty() {
            return;
        }
        // Other numbers than those of fog, which is written before.
        bytes.count(4 * u32::from(self.sun.is_some()) + 8 * u32::from(self.stars.is_some()));
        if let Some(PreparedSun { direction, intensity, radius, glow, glow_size }) = self.sun {
            bytes.vectors([direction]);
            bytes.colors([intensity]);
            [radius, glow, glow_size].into_iter().for_each(|number| bytes.number(number));
        }
        if let Some(PreparedStars { intensity, radius, rows, filled, seed }) = self.stars {
            bytes.colors([intensity]);
            [radius, rows, filled].into_iter().for_each(|number| bytes.number(number));
            bytes.count(seed);
        }
    }
}

impl PreparedSun {
    /// The part of the radius over which the disc fades at its edge: wide enough for a smooth edge with one sample per pixel once the disc
    /// is 20 pixels wide, and too narrow to look blurred.
    const EDGE: f64 = 0.1;

    /// Returns the share of the intensity in a unit direction.
    fn share(&self, unit: DVec3) -> f64 {
        let angle = self.angle(unit);
        let inside = ((self.radius - angle) / (Self::EDGE * self.radius)).clamp(0.0, 1.0);
        let disc = inside * inside * (3.0 - 2.0 * inside);
        if self.glow == 0.0 {
            return disc;
        }
        let halo = self.glow * libm::exp((self.radius - angle).min(0.0) / self.glow_size);
        disc + (1.0 - disc) * halo
    }

    /// Returns the angle between a unit direction and the direction of the sun, in radians.
    pub(crate) fn angle(&self, unit: DVec3) -> f64 {
        // By the chord, which is exact for small angles, unlike the cosine.
        2.0 * libm::asin(((unit - self.direction).length() / 2.0).min(1.0))
    }
}

impl PreparedStars {
    /// A lower bound of the factor by which cells are narrower than those in the middle of a face, which are (π/2)/rows wide. It is
    /// 1/√2 in the middle of an edge, and a little less covers the difference between chords and angles.
    const NARROWEST: f64 = 0.69;

    /// Creates about `count` stars, at least one. Stars that would not fit into their cells are made smaller.
    pub(crate) fn new(intensity: Rgb, radius: f64, count: u32, seed: u64) -> Self {
        // Half of the cells are empty, so that the rows do not show.
        let rows = libm::ceil(libm::sqrt(f64::from(count) / 3.0)).max(1.0);
        let filled = f64::from(count) / (6.0 * rows * rows);
        Self { intensity, radius: radius.min(Self::NARROWEST * FRAC_PI_4 / rows), rows, filled, seed }
    }

    /// Returns the radiance of the brightest star, and the angular radius of all stars in radians.
    pub(crate) fn extent(&self) -> (Rgb, f64) {
        (self.intensity, self.radius)
    }

    /// Returns the random key of a cell, given by its indices on a face.
    fn key(&self, face: CubeFace, cell: [f64; 2]) -> u64 {
        mixed(mixed(mixed(self.seed, face.number()), cell[0].to_bits()), cell[1].to_bits())
    }

    /// Returns the direction of a cell's star, and its brightness as a share of the intensity.
    fn star(&self, face: CubeFace, cell: [f64; 2]) -> Option<(DVec3, f64)> {
        let key = self.key(face, cell);
        if uniform(key, 0) >= self.filled {
            return None;
        }
        let margin = self.radius * self.rows / (Self::NARROWEST * FRAC_PI_4 * 2.0);
        let place = |axis: usize, number: u64| {
            let within = margin + (1.0 - 2.0 * margin) * uniform(key, number);
            (cell[axis] + within) / self.rows * 2.0 - 1.0
        };
        // The number of stars above a brightness falls with its power -3/2, as for equal stars that are spread evenly in space. The
        // faintest have 13 % of the intensity.
        let distance = libm::cbrt(1.0 + 20.0 * uniform(key, 3));
        Some((face.direction([place(0, 1), place(1, 2)]), 1.0 / (distance * distance)))
    }

    /// Returns the index of the cells at a place on a face along one axis: of the nearest cells if it is beyond the face.
    fn index(&self, place: f64) -> f64 {
        libm::floor((0.5 * place + 0.5) * self.rows).clamp(0.0, self.rows - 1.0)
    }

    /// Returns the share of the intensity in a unit direction.
    fn share(&self, unit: DVec3) -> f64 {
        let (face, place) = CubeFace::hit(unit);
        let Some((star, brightness)) = self.star(face, place.map(|place| self.index(place))) else {
            return 0.0;
        };
        let fading = 1.0 - (unit - star).length_squared() / (self.radius * self.radius);
        if fading > 0.0 { fading * fading * brightness } else { 0.0 }
    }

    /// Returns whether a star may show within an angle from a unit direction. If it returns false, none does.
    pub(crate) fn may_show(&self, unit: DVec3, angle: f64) -> bool {
        /// The widest search, as a share of 45 degrees. Wider angles are rare, and likely to see a star.
        const WIDEST: f64 = 0.25;
        /// A lower bound of the change of the angle with the place, relative to the middle of a face, up to `WIDEST` beyond its border.
        const NARROWEST: f64 = 0.5;
        let reach = angle / (NARROWEST * FRAC_PI_4);
        if reach > WIDEST || reach * self.rows > 4.0 {
            return true;
        }
        CubeFace::ALL.into_iter().any(|face| {
            let Some(place) =
                face.place(unit).filter(|place| place.iter().all(|place| place.abs() <= 1.0 + reach))
            else {
                return false;
            };
            let [rows, columns] = place.map(|place| (self.index(place - reach), self.index(place + reach)));
            let is_near = |star: DVec3| (unit - star).length() <= angle + self.radius;
            let mut row = rows.0;
            while row <= rows.1 {
                let mut column = columns.0;
                while column <= columns.1 {
                    if self.star(face, [row, column]).is_some_and(|(star, _)| is_near(star)) {
                        return true;
                    }
                    column += 1.0;
                }
                row += 1.0;
            }
            false
        })
    }
}

/// A face of a cube around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CubeFace {
    /// The index of the axis across the face.
    axis: usize,
    /// The direction of the face along its axis, 1 or -1.
    sign: f64,
}

impl CubeFace {
    const ALL: [Self; 6] = [
        Self { axis: 0, sign: 1.0 },
        Self { axis: 0, sign: -1.0 },
        Self { axis: 1, sign: 1.0 },
        Self { axis: 1, sign: -1.0 },
        Self { axis: 2, sign: 1.0 },
        Self { axis: 2, sign: -1.0 },
    ];

    /// Returns the face that a direction passes through, and the place on it: angles from the middle of the face, as shares of 45 degrees.
    fn hit(unit: DVec3) -> (Self, [f64; 2]) {
        let size = unit.abs();
        let axis = match size {
            _ if size.x >= size.y && size.x >= size.z => 0,
            _ if size.y >= size.z => 1,
            _ => 2,
        };
        let face = Self { axis, sign: if unit[axis] < 0.0 { -1.0 } else { 1.0 } };
        (face, face.at(unit))
    }

    /// Returns the place of a direction that passes through the face or not far beside it.
    fn place(self, unit: DVec3) -> Option<[f64; 2]> {
        /// Less than the cosine between the middle of a face and all directions that pass less than 10 degrees beside it.
        const BESIDE: f64 = 0.4;
        (unit[self.axis] * self.sign > BESIDE).then(|| self.at(unit))
    }

    fn at(self, unit: DVec3) -> [f64; 2] {
        let across = unit[self.axis] * self.sign;
        [1, 2].map(|next| libm::atan(unit[(self.axis + next) % 3] / across) / FRAC_PI_4)
    }

    /// Returns the unit direction through a place on the face: the inverse of [`hit`](Self::hit).
    fn direction(self, place: [f64; 2]) -> DVec3 {
        let mut through = DVec3::ZERO;
        through[self.axis] = self.sign;
        for (next, place) in (1..).zip(place) {
            through[(self.axis + next) % 3] = libm::tan(place * FRAC_PI_4);
        }
        through.normalize()
    }

    /// Returns a number that no other face has.
    fn number(self) -> u64 {
        (self.sign * [1.0, 2.0, 3.0][self.axis % 3]).to_bits()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn sun() -> PreparedSun {
        let (radius, glow_size) = (0.1, 0.3);
        PreparedSun { direction: DVec3::Z, intensity: Rgb::splat(9.0), radius, glow: 0.0, glow_size }
    }

    /// Returns a unit direction at an angle from +z, around it by another angle.
    fn tilted(angle: f64, around: f64) -> DVec3 {
        let ((sine, cosine), (up, right)) = (libm::sincos(angle), libm::sincos(around));
        DVec3::new(right * sine, up * sine, cosine)
    }

    #[test]
    fn sun_is_a_disc_with_a_soft_edge() {
        for around in [0.0, 1.0, 4.0] {
            let share = |angle| sun().share(tilted(angle, around));
            assert_eq!([0.0, 0.0899, 0.1001, 3.0].map(share), [1.0, 1.0, 0.0, 0.0]);
            assert!((share(0.095) - 0.5).abs() < 1e-9, "{}", share(0.095));
        }
        let tiny = PreparedSun { radius: 1e-9, ..sun() };
        assert_eq!([0.0, 8.9e-10, 1.01e-9].map(|angle| tiny.share(tilted(angle, 2.0))), [1.0, 1.0, 0.0]);
    }

    #[test]
    fn halo_falls_from_the_edge_of_the_sun() {
        let sun = PreparedSun { glow: 0.5, ..sun() };
        for (angle, expected) in [
            (0.0, 1.0),
            (0.1, 0.5),
            (0.4, 0.5 * libm::exp(-1.0)),
            (0.095, 0.75),
            (2.0, 0.5 * libm::exp(-1.9 / 0.3)),
        ] {
            let found = sun.share(tilted(angle, 1.0));
            assert!((found - expected).abs() < 1e-9, "{angle}: {found} {expected}");
        }
    }

    #[test]
    fn stars_have_the_number_that_is_asked_for() {
        for count in [1, 7, 600, 5000] {
            let stars: usize =
                (0..20).map(|seed| number(&PreparedStars::new(Rgb::ONE, 1e-3, count, seed))).sum();
            let (found, expected) = (stars as f64, 20.0 * f64::from(count));
            assert!((found - expected).abs() < 4.0 * expected.sqrt(), "{found} {expected}");
        }
    }

    /// Returns the number of cells with a star.
    fn number(stars: &PreparedStars) -> usize {
        let rows = || (0..1000).map(f64::from).take_while(|row| *row < stars.rows);
        let cells = || rows().flat_map(|row| rows().map(move |column| [row, column]));
        let has_star = |face, cell: &[f64; 2]| uniform(stars.key(face, *cell), 0) < stars.filled;
        CubeFace::ALL.into_iter().map(|face| cells().filter(|cell| has_star(face, cell)).count()).sum()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]

        #[test]
        fn places_on_the_cube_and_on_the_sphere_correspond(x in -1.0..1.0_f64, y in -1.0..1.0_f64, face in 0..6_usize) {
            let face = CubeFace::ALL[face];
            let (found, place) = CubeFace::hit(face.direction([x, y]));
            prop_assert_eq!(found, face);
            prop_assert!((place[0] - x).abs() < 1e-12 && (place[1] - y).abs() < 1e-12);
        }

        /// Checks that the light of stars changes gradually everywhere, also where cells and faces meet.
        #[test]
        fn stars_are_continuous(
            (x, y, z) in (-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64),
            on_border in any::<bool>(),
            size in prop_oneof![Just(0.002), Just(0.05), Just(9.0)],
            count in prop_oneof![Just(2), Just(40), Just(3000)],
            step in prop::array::uniform3(-1.0..1.0_f64),
        ) {
            let stars = PreparedStars::new(Rgb::ONE, size, count, 3);
            let mut direction = DVec3::new(x, y, z);
            if on_border {
                // The border of two faces.
                direction.y = direction.x;
            }
            let (from, step) = (direction.normalize_or(DVec3::Z), 1e-6 * stars.radius * DVec3::from(step));
            let change = (stars.share((from + step).normalize()) - stars.share(from)).abs();
            // The profile changes by 1.6 at most over its radius.
            prop_assert!(change < 4e-6, "{change:e}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]

        /// Checks that a search finds every star that a direction within its angle sees.
        #[test]
        fn stars_that_show_are_found(
            (x, y, z) in (-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64),
            count in prop_oneof![Just(2), Just(40), Just(3000)],
            angle in prop_oneof![0.0..0.01, 0.0..0.2_f64],
        ) {
            let stars = PreparedStars::new(Rgb::ONE, 0.01, count, 3);
            let unit = DVec3::new(x, y, z).normalize_or(DVec3::Z);
            let (right, up) = unit.any_orthonormal_pair();
            let shows = (0..64).any(|at| {
                let (sine, cosine) = libm::sincos(2.399_963 * f64::from(at));
                let (across, along) = libm::sincos(angle * (f64::from(at) / 63.0).sqrt());
                stars.share((unit * along + (right * cosine + up * sine) * across).normalize()) > 0.0
            });
            prop_assert!(!shows || stars.may_show(unit, angle));
        }
    }

    #[test]
    fn search_for_stars_finds_none_where_there_are_none() {
        let stars = PreparedStars::new(Rgb::ONE, 0.002, 500, 1);
        let found = (0..10_000).filter(|at| {
            let y = 1.0 - (f64::from(*at) + 0.5) / 5000.0;
            let (sine, cosine) = libm::sincos(2.399_963 * f64::from(*at));
            let across = (1.0 - y * y).sqrt();
            stars.may_show(DVec3::new(across * cosine, y, across * sine), 0.008)
        });
        // Discs of radius 0.01 around 500 stars cover 1.25 % of the sphere.
        let count = found.count();
        assert!((100..150).contains(&count), "{count}");
    }

    #[test]
    fn stars_are_seen_and_bounded() {
        let stars = PreparedStars::new(Rgb::ONE, 0.04, 500, 1);
        let mut brightest = 0.0_f64;
        for at in 0..200_000 {
            let y = 1.0 - (f64::from(at) + 0.5) / 100_000.0;
            let (sine, cosine) = libm::sincos(2.399_963 * f64::from(at));
            let across = (1.0 - y * y).sqrt();
            brightest = brightest.max(stars.share(DVec3::new(across * cosine, y, across * sine)));
        }
        assert!(brightest > 0.9 && brightest <= 1.0, "{brightest}");
    }
}
