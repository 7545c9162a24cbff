//! The camera and its rays.

mod packet;

use glam::DVec3;

pub(crate) use packet::{PixelCenters, PixelKeys, SIDE, Square};

use crate::trace::math::{
    Bytes, Dimension, Double, PixelSamples, PixelSampling, Real, add, disc, scaled, spread, subtract, times,
};
use crate::trace::rays::{PreparedRay, Rays};
use crate::trace::shapes::Bounds;

/// A camera: an eye, and a grid of pixels on a screen in front of it.
///
/// With n the unit view direction, u = (up x n)/|up x n| to the right and v = n x u upwards, pixel (i, j) is at
/// `eye + (-W/2 + W i/(columns-1)) u + (H/2 - H j/(rows-1)) v + d n`: i counts columns to the right, j counts rows downwards, and the
/// outermost pixels lie on the screen's edges. With a resolution of 1, the pixel lies in the middle. Coordinates are left-handed: x right,
/// y up, z forward; see [`right_handed`](Self::right_handed) for the other orientation.
///
/// The rays of an [orthographic](Self::orthographic) camera are parallel: they start at the pixels' points in the plane of the eye, at
/// `eye + (-W/2 + W i/(columns-1)) u + (H/2 - H j/(rows-1)) v`, and go along n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreparedCamera {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    width: f64,
    height: f64,
    distance: f64,
    columns: u32,
    rows: u32,
    is_orthographic: bool,
    lens: Option<PreparedLens>,
}

/// A thin lens at the eye, perpendicular to the view direction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PreparedLens {
    radius: f64,
    /// Distance of the plane of focus, in units of the screen's distance.
    focus: f64,
}

impl PreparedCamera {
    /// Creates a camera at `eye` that looks along `view` with `up` upwards. The screen at `distance` is `size` (W, H) wide and high and has
    /// `resolution` (columns, rows) pixels.
    ///
    /// Directions may have any length. Without a view direction the camera looks along +z; if `up` is parallel to the view, the world axis
    /// y, or else z, replaces it. Both occur legitimately while a camera moves.
    #[must_use]
    pub fn new(
        eye: DVec3,
        view: DVec3,
        up: DVec3,
        distance: f64,
        size: (f64, f64),
        resolution: (u32, u32),
    ) -> Self {
        let view = scaled(view).map_or(DVec3::Z, |(view, _)| view);
        let forward = view.normalize();
        let across = |up: DVec3| {
            let (up, _) = scaled(up)?;
            let right = cross(up, view);
            (right.length_squared() > 1e-24 * up.length_squared() * view.length_squared())
                .then(|| right.normalize())
        };
        let right = across(up).or_else(|| across(DVec3::Y)).or_else(|| across(DVec3::Z)).unwrap_or(DVec3::X);
        Self {
            eye,
            right,
            up: forward.cross(right),
            forward: forward * distance,
            width: size.0,
            height: size.1,
            distance,
            columns: resolution.0,
            rows: resolution.1,
            is_orthographic: false,
            lens: None,
        }
    }

    /// Returns the camera with parallel rays, for a screen at distance 1.
    #[must_use]
    pub fn orthographic(self) -> Self {
        Self { is_orthographic: true, ..self }
    }

    /// Returns the camera in a right-handed space, in which u = (n x up)/|n x up| is to the right: z points towards the viewer. Must precede
    /// a [rotation](Self::rolled).
    #[must_use]
    pub fn right_handed(self) -> Self {
        Self { right: -self.right, ..self }
    }

    /// Returns the camera rotated about its view direction by `angle`, in radians: a quarter turn moves its up direction to its former
    /// left.
    #[must_use]
    pub fn rolled(self, angle: f64) -> Self {
        if angle == 0.0 || !angle.is_finite() {
            return self;
        }
        let (sine, cosine) = libm::sincos(angle);
        let (right, up) = (self.right, self.up);
        Self { right: right * cosine + up * sine, up: up * cosine - right * sine, ..self }
    }

    /// Returns the camera with a thin lens of diameter `aperture` around the eye, or around the starts of all rays if they are parallel.
    /// Points at distance `focus` from the eye along the view direction are sharp; at distance z the blur is as large as a disc of diameter
    /// aperture |focus - z| / focus would appear there. Without an aperture, or with numbers that are not finite or not positive, there is no
    /// lens.
    ///
    /// A lens has an effect only with several samples per pixel: a single sample passes through its centre.
    #[must_use]
    pub fn with_lens(self, aperture: f64, focus: f64) -> Self {
        let lens = PreparedLens { radius: 0.5 * aperture, focus: focus / self.distance };
        let exists = [lens.radius, lens.focus].into_iter().all(|part| part > 0.0 && part.is_finite());
        Self { lens: exists.then_some(lens), ..self }
    }

    /// Returns the width and height of a pixel at distance 1 along the view or, with parallel rays, at any distance.
    #[cfg(feature = "live")]
    pub(crate) fn pixel_size(&self) -> [f64; 2] {
        let pitch =
            |size: f64, pixels: u32| size / f64::from(pixels.saturating_sub(1).max(1)) / self.distance;
        [pitch(self.width, self.columns), pitch(self.height, self.rows)]
    }

    /// Writes the bytes of everything that pictures depend on.
    pub(crate) fn write(&self, bytes: &mut Bytes) {
        let Self { eye, right, up, forward, width, height, columns, rows, lens, .. } = self;
        bytes.vectors([*eye, *right, *up, *forward]);
        // An orthographic view is the limit of perspective views from infinitely far.
        let distance = if self.is_orthographic { f64::INFINITY } else { self.distance };
        [*width, *height, distance].into_iter().for_each(|number| bytes.number(number));
        [columns, rows].into_iter().for_each(|count| bytes.count(*count));
        let PreparedLens { radius, focus } = lens.unwrap_or(PreparedLens { radius: 0.0, focus: 0.0 });
        [radius, focus].into_iter().for_each(|number| bytes.number(number));
    }

    /// Returns the camera with a pinhole.
    #[must_use]
    pub fn without_lens(self) -> Self {
        Self { lens: None, ..self }
    }

    /// Returns the vector from the eye to the centre of pixel (i, j): P1 - P0.
    #[must_use]
    #[inline]
    pub fn towards(&self, i: u32, j: u32) -> DVec3 {
        self.through(f64::from(i), f64::from(j))
    }

    /// Returns the vector from the eye to a point on the screen, given in columns and rows from the centre of the first pixel.
    #[inline]
    pub(crate) fn through(&self, column: f64, row: f64) -> DVec3 {
        DVec3::from(self.on_screen(column, row)) + self.forward
    }

    /// Returns the rays through points on the screen, given like those of [`PreparedCamera::through`], and through points on the lens, given
    /// on the unit disc, if there is a lens. Directions have any length.
    #[inline(always)]
    fn rays_through<R: Real>(&self, column: R, row: R, on_lens: Option<[R; 2]>) -> Rays<R> {
        let (eye, forward) = (spread(column, self.eye), spread(column, self.forward));
        let Rays { origin, direction } =
            pinhole(eye, self.on_screen(column, row), forward, self.is_orthographic);
        let (Some(PreparedLens { radius, focus }), Some([right, up])) = (self.lens, on_lens) else {
            return Rays { origin, direction };
        };
        let place = times(spread(column, self.right), right * radius);
        let place = add(place, times(spread(column, self.up), up * radius));
        Rays { origin: add(origin, place), direction: subtract(times(direction, column.of(focus)), place) }
    }

    /// Returns the vector from the middle of the screen to a point on it.
    #[inline(always)]
    fn on_screen<R: Real>(&self, column: R, row: R) -> [R; 3] {
        let right = times(spread(column, self.right), self.across(column));
        add(right, times(spread(column, self.up), self.upwards(row)))
    }

    #[inline(always)]
    fn across<R: Real>(&self, column: R) -> R {
        if self.columns > 1 {
            column * self.width / column.of(f64::from(self.columns - 1)) + -0.5 * self.width
        } else {
            column * self.width
        }
    }

    #[inline(always)]
    fn upwards<R: Real>(&self, row: R) -> R {
        if self.rows > 1 {
            row.of(0.5 * self.height) - row * self.height / row.of(f64::from(self.rows - 1))
        } else {
            row.of(0.0) - row * self.height
        }
    }

    /// Returns the ray through the centre of pixel (i, j). `None` only if the eye or the screen is not finite.
    #[must_use]
    #[inline(always)]
    pub fn ray(&self, i: u32, j: u32) -> Option<PreparedRay> {
        let Rays { origin, direction } = self.rays_through(f64::from(i), f64::from(j), None);
        PreparedRay::new(origin.into(), direction.into())
    }

    /// Returns the ray of sample `index` of pixel (i, j). A single sample is at the pixel's centre; several are spread evenly over the
    /// square of half a pitch around it. The pitch is W/(columns-1), or W if there is one column: pixels border on each other, and the
    /// outermost pixels extend beyond the screen's edges by half a pitch. With a lens, several samples start all over the lens, towards the
    /// points in the plane of focus that the eye sees through the samples' points on the screen.
    ///
    /// `None` only if the eye or the screen is not finite.
    #[must_use]
    #[inline]
    pub(crate) fn sample_ray(
        &self,
        sampling: PixelSampling,
        i: u32,
        j: u32,
        index: u32,
    ) -> Option<PreparedRay> {
        if sampling.samples <= 1 {
            return self.ray(i, j);
        }
        self.spread_ray(sampling, i, j, index)
    }

    /// Returns the ray of [`PreparedCamera::sample_ray`] for several samples per pixel.
    pub(crate) fn spread_ray(
        &self,
        sampling: PixelSampling,
        i: u32,
        j: u32,
        index: u32,
    ) -> Option<PreparedRay> {
        let samples = PixelSamples::new(sampling.seed, i, j);
        let [right, down] = from_center(&samples, index);
        let on_lens = self.lens.map(|_| disc(samples.pair(Dimension::Lens, index)));
        let Rays { origin, direction } =
            self.rays_through(f64::from(i) + right, f64::from(j) + down, on_lens);
        PreparedRay::new(origin.into(), direction.into())
    }

    /// Returns the place on the screen of sample `index` of pixel (i, j), as of `sample_ray`: alpha to the right and beta
    /// upwards from its middle. A lens does not change it.
    #[must_use]
    pub fn on_screen_at(&self, sampling: PixelSampling, (i, j): (u32, u32), index: u32) -> [f64; 2] {
        let [right, down] = match sampling.samples {
            0 | 1 => [0.0; 2],
            _ => from_center(&PixelSamples::new(sampling.seed, i, j), index),
        };
        [self.across(f64::from(i) + right), self.upwards(f64::from(j) + down)]
    }

    /// Returns the change of the direction from the eye from one column to the next, and from one row to the next.
    pub(crate) fn steps(&self) -> [DVec3; 2] {
        let pitch = |size: f64, pixels: u32| if pixels > 1 { size / f64::from(pixels - 1) } else { size };
        [self.right * pitch(self.width, self.columns), self.up * -pitch(self.height, self.rows)]
    }

    /// Returns the largest radius, in units of `pitch`, of the disc of the screen through which the lens sees a point, over a range of
    /// inverse depths in units of the screen's distance; 0 without a lens.
    pub(crate) fn confusion(&self, depths: [f64; 2], pitch: f64) -> f64 {
        let Some(PreparedLens { radius, focus }) = self.lens else { return 0.0 };
        let apart = depths.map(|depth| (depth - 1.0 / focus).abs());
        radius * apart[0].max(apart[1]) / pitch
    }

    /// Returns the eye, and the maximum distance from it at which rays start.
    pub(crate) fn eye(&self) -> (DVec3, f64) {
        let on_lens = self.lens.map_or(0.0, |lens| lens.radius);
        let [right, down] = self.steps().map(DVec3::length);
        // Samples extend beyond the screen's edges by half a pitch, and by less than another half through rounding.
        let on_screen = 0.5 * (self.width.abs() + self.height.abs()) + right + down;
        (self.eye, if self.is_orthographic { on_screen + on_lens } else { on_lens })
    }

    /// Returns the centre and upper bounds of the half-extents of a box that contains the starts of all rays of pixels, given by squares.
    pub(crate) fn starts(&self, squares: &[Option<Square>]) -> (DVec3, DVec3) {
        /// 2^-40, more than rounding shifts points by.
        const ROUNDING: f64 = f64::from_bits((1023 - 40) << 52);
        let radius = self.lens.map_or(0.0, |lens| lens.radius);
        let (mut middle, mut reach) = (self.eye, (self.right.abs() + self.up.abs()) * radius);
        if self.is_orthographic {
            let corners = squares.iter().flatten().flat_map(Square::corners);
            let starts = corners.map(|(column, row)| DVec3::from(self.on_screen(column, row)));
            let (low, high) = starts.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), start| {
                (low.min(start), high.max(start))
            });
            middle += 0.5 * (low + high);
            reach += 0.5 * (high - low) + (low.abs() + high.abs()) * ROUNDING;
        }
        (middle, reach + (reach + self.eye.abs()) * ROUNDING)
    }

    /// Returns whether all rays are parallel, unless they pass through a lens.
    #[must_use]
    pub fn is_orthographic(&self) -> bool {
        self.is_orthographic
    }

    /// Returns whether it has a lens, so that shapes out of focus may be blurred.
    #[must_use]
    pub fn has_lens(&self) -> bool {
        self.lens.is_some()
    }

    /// Returns whether a ray of the camera may hit something in the box. `false` only if none can.
    #[must_use]
    pub(crate) fn may_see(&self, bounds: &Bounds) -> bool {
        if self.lens.is_some() || self.distance.is_nan() || self.distance <= 0.0 {
            return true;
        }
        let pitch = |size: f64, pixels: u32| size / f64::from(pixels.saturating_sub(1).max(1));
        // From the middle to half a pitch beyond the outermost pixels, plus half a pitch as a safety margin.
        let (width, height) = (self.width.abs(), self.height.abs());
        let across = 0.5 * width + pitch(width, self.columns);
        let upwards = 0.5 * height + pitch(height, self.rows);
        let ahead = self.forward / self.distance;
        // The planes that bound the view: a normal, which points into it, and minus the height of the eye above the plane.
        let side = |across: f64, side: DVec3| match self.is_orthographic {
            true => (side, across),
            false => (ahead * across + side * self.distance, 0.0),
        };
        let planes = [
            (ahead, 0.0),
            side(across, self.right),
            side(across, -self.right),
            side(upwards, self.up),
            side(upwards, -self.up),
        ];
        let beyond = |(normal, eye): (DVec3, f64)| {
            let farthest = DVec3::select(normal.cmpgt(DVec3::ZERO), bounds.max, bounds.min) - self.eye;
            let height = farthest.dot(normal) + eye;
            height < -1e-9 * (normal.length() * (farthest.length() + self.eye.length()) + eye)
        };
        !planes.into_iter().any(beyond)
    }

    /// Returns the distance by which the images of shapes at a place are reduced: from the eye, or from the screen for parallel rays.
    pub(crate) fn reduction(&self, place: DVec3) -> f64 {
        if self.is_orthographic { self.distance } else { place.distance(self.eye) }
    }

    /// Returns the distance of a point from the plane of the eye, along the view direction, in scene units; negative behind the eye.
    pub(crate) fn depth_of(&self, point: DVec3) -> f64 {
        (point - self.eye).dot(self.forward) / self.distance
    }

    /// Returns the height of the picture in the world, in scene units, at the depth of a point. `None` unless the point is in front of the eye.
    #[must_use]
    pub fn height_at(&self, point: DVec3) -> Option<f64> {
        let whole = self.height * f64::from(self.rows) / f64::from(self.rows.saturating_sub(1).max(1));
        let height =
            if self.is_orthographic { whole } else { whole * (self.depth_of(point) / self.distance) };
        (height > 0.0 && height.is_finite()).then_some(height)
    }

    /// Returns the eye, P0.
    #[must_use]
    pub fn position(&self) -> DVec3 {
        self.eye
    }

    /// Returns the unit vectors u, v and n: to the right in the picture, up in it, and along the view.
    #[must_use]
    pub fn axes(&self) -> [DVec3; 3] {
        let across = self.right.cross(self.up);
        // In a right-handed space it points back.
        [self.right, self.up, if across.dot(self.forward) < 0.0 { -across } else { across }]
    }

    /// Returns the distance from the eye to the screen, d, in scene units.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// Returns the numbers of columns and rows.
    #[must_use]
    pub fn resolution(&self) -> (u32, u32) {
        (self.columns, self.rows)
    }
}

/// Returns the columns and rows from a pixel's centre to one of its samples.
#[inline]
fn from_center(samples: &PixelSamples, index: u32) -> [f64; 2] {
    samples.pair(Dimension::Pixel, index).map(|place| place - 0.5)
}

/// Returns the rays through points of the screen, given by their vectors from its middle: from the eye or, if orthographic, forward.
#[inline(always)]
fn pinhole<R: Real>(eye: [R; 3], on_screen: [R; 3], forward: [R; 3], is_orthographic: bool) -> Rays<R> {
    if is_orthographic {
        Rays { origin: add(eye, on_screen), direction: forward }
    } else {
        Rays { origin: eye, direction: add(on_screen, forward) }
    }
}

/// Returns a x b with each component rounded once. For nearly parallel vectors, intermediate rounding would leave little else.
fn cross(a: DVec3, b: DVec3) -> DVec3 {
    let component =
        |a: f64, b: f64, c: f64, d: f64| (Double::product(a, b) - Double::product(c, d)).rounded();
    DVec3::new(component(a.y, b.z, a.z, b.y), component(a.z, b.x, a.x, b.z), component(a.x, b.y, a.y, b.x))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> PreparedCamera {
        let eye = DVec3::new(-2.0, -2.0, 0.0);
        PreparedCamera::new(eye, DVec3::new(1.0, 1.0, 0.0), DVec3::Z, 1.0, (2.0, 2.0), (201, 201))
    }

    #[test]
    fn the_worked_example() {
        let root = 2.0_f64.sqrt();
        let expected = DVec3::new(1.9 / root, 0.1 / root, 0.8);
        assert!((example().towards(10, 20) - expected).length() < 1e-15);
    }

    #[test]
    fn columns_run_right_and_rows_run_down() {
        // 3 columns, 2 rows: if they were swapped, the corners would not be on the edges.
        let camera = PreparedCamera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 1.0, (4.0, 1.0), (3, 2));
        assert_eq!(camera.towards(0, 0), DVec3::new(-2.0, 0.5, 1.0));
        assert_eq!(camera.towards(2, 0), DVec3::new(2.0, 0.5, 1.0));
        assert_eq!(camera.towards(1, 1), DVec3::new(0.0, -0.5, 1.0));
    }

    #[test]
    fn a_resolution_of_one_is_the_middle() {
        let camera = PreparedCamera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 2.0, (4.0, 1.0), (1, 1));
        assert_eq!(camera.towards(0, 0), DVec3::new(0.0, 0.0, 2.0));
    }

    #[test]
    fn samples_cover_half_a_pitch_around_the_pixels() {
        for (resolution, pitch) in [((1, 1), (4.0, 1.0)), ((3, 2), (2.0, 1.0))] {
            let camera = PreparedCamera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 1.0, (4.0, 1.0), resolution);
            let (i, j) = (resolution.0 - 1, resolution.1 - 1);
            let centre = camera.towards(i, j);
            assert_eq!(camera.sample_ray(PixelSampling::default(), i, j, 0), camera.ray(i, j));
            let sampling = PixelSampling { samples: 1024, seed: 3 };
            let (mut least, mut most) = (DVec3::MAX, DVec3::MIN);
            for index in 0..sampling.samples {
                let direction = camera.sample_ray(sampling, i, j, index).unwrap().direction();
                let offset = direction / direction.z - centre;
                least = least.min(offset);
                most = most.max(offset);
            }
            // With one number in each n-th of the range, the outermost of n numbers are within an n-th of its ends.
            for (low, high, pitch) in [(least.x, most.x, pitch.0), (least.y, most.y, pitch.1)] {
                assert!((-0.5..-0.499).contains(&(low / pitch)) && (0.499..0.5).contains(&(high / pitch)));
            }
        }
    }

    #[test]
    fn degenerate_views_are_finite() {
        for (view, up) in [
            (DVec3::ZERO, DVec3::Y),
            (DVec3::Z, DVec3::Z),
            (DVec3::Y, DVec3::Y),
            (DVec3::Y, DVec3::ZERO),
            (DVec3::new(1e-300, 0.0, 0.0), DVec3::Y),
            (DVec3::X, DVec3::new(1.0, 1e-30, 0.0)),
        ] {
            let camera = PreparedCamera::new(DVec3::ZERO, view, up, 1.0, (2.0, 2.0), (3, 3));
            for (i, j) in [(0, 0), (1, 1), (2, 2)] {
                assert!(camera.towards(i, j).is_finite(), "{view} {up}");
            }
            assert!(
                (camera.right.length() - 1.0).abs() < 1e-12 && camera.right.dot(camera.forward).abs() < 1e-12
            );
        }
    }
}
