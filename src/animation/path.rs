//! A smooth path through points, traversed at a given pace.

use glam::DVec3;

use super::Pace;
use super::arc_length::{ArcLength, Segment};
use super::hermite::{Gap, Stretch, distance};

/// A smooth curve through waypoints. Its [`Pace`] gives the distance covered: at an even pace the speed is constant, however uneven the
/// waypoints are.
///
/// The curve is the centripetal Catmull-Rom spline, which has no loops and no cusps between two waypoints and stays close to the straight
/// segments (Yuksel, Schaefer, Keyser, Parameterization and Applications of Catmull-Rom Curves, Computer-Aided Design 43, 2011). The knots
/// of waypoints p_i are t_(i+1) = t_i + |p_(i+1) - p_i|^(1/2). The pyramid of Barry and Goldman (A Recursive Evaluation Algorithm for a
/// Class of Catmull-Rom Splines, SIGGRAPH 1988) over four waypoints is the cubic Hermite segment from p_i to p_(i+1). Its derivative at p_i
/// is the derivative of the parabola through p_(i-1), p_i and p_(i+1) at t_(i-1), t_i and t_(i+1), so that the curve has one tangent at
/// every waypoint. A closed curve passes through its first waypoint like any other. An open curve starts and ends along the straight
/// segment, with the derivative (p_1 - p_0) / (t_1 - t_0).
///
/// Its arc length s(u) = integral of |p'(u)| du is measured and inverted to about 1e-13 of its segments.
///
/// Special cases:
/// - Neighbouring waypoints closer to each other than 1e-12 of the extent of all are merged, and so are the first and the last of a closed
///   curve.
/// - One waypoint is a point at rest. Two waypoints are a straight line, or a line there and back if the path is closed.
/// - At waypoints where the path reverses, it turns on the spot, and the direction of its velocity jumps.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// The start point of each segment, and the end point of the last one if the curve is open.
    waypoints: Vec<DVec3>,
    closed: bool,
    /// Scene units per unit of `curve`: a power of two.
    scale: f64,
    /// `None` if all waypoints coincide.
    curve: Option<ArcLength>,
    pace: Pace,
}

/// The distance within which waypoints coincide, as a fraction of the extent of all waypoints.
const COINCIDENT: f64 = 1e-12;

impl Path {
    /// The largest magnitude of a waypoint's coordinates.
    pub const LARGEST: f64 = 1e300;

    /// Creates a path through `points` that takes one second. A closed path returns from the last point to the first. Returns `None` if
    /// there is no point, or if one is not finite or beyond [`Self::LARGEST`].
    #[must_use]
    pub fn new(points: &[DVec3], closed: bool) -> Option<Self> {
        let first = *points.first()?;
        if !points.iter().all(|point| point.abs().max_element() <= Self::LARGEST) {
            return None;
        }
        let extent = points.iter().map(|point| (*point - first).abs().max_element()).fold(0.0, f64::max);
        let scale = power_of_two(extent);
        let waypoints = apart(points, closed, COINCIDENT * extent);
        let curve = ArcLength::new(segments(&waypoints, closed, scale));
        Some(Self { waypoints, closed, scale, curve, pace: Pace::lasting(1.0) })
    }

    /// Returns the same path at another pace.
    #[must_use]
    pub fn paced(self, pace: Pace) -> Self {
        Self { pace, ..self }
    }

    /// Returns the time at which the point comes to rest, in seconds. `None` for a path that repeats.
    #[must_use]
    pub fn end(&self) -> Option<f64> {
        self.pace.end()
    }

    /// Returns the length from the start to the end, or once around a closed curve, in scene units.
    ///
    /// ```
    /// use glam::DVec3;
    /// use rayreel::animation::Path;
    /// let path = Path::new(&[DVec3::ZERO, DVec3::new(3.0, 0.0, 4.0)], false).unwrap();
    /// assert!((path.length() - 5.0).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn length(&self) -> f64 {
        self.curve.as_ref().map_or(0.0, |curve| self.scale * curve.length())
    }

    /// Returns the point at `seconds`. If an easing overshoots the ends, the point continues around a closed curve, and along the tangent
    /// of an open curve.
    ///
    /// ```
    /// use glam::DVec3;
    /// use rayreel::animation::{Pace, Path};
    /// let corners = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 0.0, 3.0), DVec3::new(0.0, 0.0, 3.0)];
    /// let path = Path::new(&corners, true).unwrap().paced(Pace::lasting(8.0));
    /// assert_eq!([path.at(0.0), path.at(8.0)], [corners[0]; 2]);
    /// let step = |time| path.at(time).distance(path.at(time + 1e-3)) * 1e3; // units per second
    /// assert!((step(0.5) / step(3.5) - 1.0).abs() < 1e-5);
    /// ```
    #[must_use]
    pub fn at(&self, seconds: f64) -> DVec3 {
        let Some(curve) = &self.curve else {
            return self.waypoints[0];
        };
        let (progress, (index, u)) = self.locate(curve, seconds);
        let point = self.waypoints[index] + self.scale * curve.segment(index).at(u);
        let beyond = (progress - progress.clamp(0.0, 1.0)) * curve.length();
        if beyond == 0.0 { point } else { point + self.scale * beyond * curve.segment(index).direction(u) }
    }

    /// Returns the direction of motion at `seconds`, as a unit vector: along the curve, and against it where it is played backwards.
    ///
    /// Before the start, after the end and wherever else the point rests, it is the direction of the curve there. An easing that moves back
    /// for a while does not change it. Zero if all waypoints coincide.
    ///
    /// ```
    /// use glam::DVec3;
    /// use rayreel::animation::Path;
    /// let path = Path::new(&[DVec3::ZERO, DVec3::X * 3.0], false).unwrap();
    /// assert_eq!([-1.0, 0.5, 9.0].map(|seconds| path.direction(seconds)), [DVec3::X; 3]);
    /// ```
    #[must_use]
    pub fn direction(&self, seconds: f64) -> DVec3 {
        let Some(curve) = &self.curve else { return DVec3::ZERO };
        let (_, (index, u)) = self.locate(curve, seconds);
        self.pace.sense(seconds) * curve.segment(index).direction(u)
    }

    /// Returns the progress at `seconds`, and the segment of the curve with the fraction of it that is covered.
    fn locate(&self, curve: &ArcLength, seconds: f64) -> (f64, (usize, f64)) {
        let progress = self.pace.progress(seconds);
        let progress = if self.closed { progress.rem_euclid(1.0) } else { progress };
        (progress, curve.locate(progress.clamp(0.0, 1.0) * curve.length()))
    }
}

/// Returns the waypoints, with neighbours at most `least` apart merged.
fn apart(points: &[DVec3], closed: bool, least: f64) -> Vec<DVec3> {
    let mut waypoints = points.to_vec();
    let near = |one: DVec3, other: DVec3| distance(one - other) <= least;
    waypoints.dedup_by(|next, kept| near(*next, *kept));
    while closed && waypoints.len() > 1 && near(waypoints[0], waypoints[waypoints.len() - 1]) {
        waypoints.pop();
    }
    waypoints
}

/// Returns the segments from each waypoint to the next, in units of `scale`.
fn segments(waypoints: &[DVec3], closed: bool, scale: f64) -> Vec<Segment> {
    let gap = |(start, end): (&DVec3, &DVec3)| {
        let difference = (*end - *start) / scale;
        Gap { difference, length: distance(difference).sqrt() }
    };
    let mut gaps: Vec<Gap> = waypoints.iter().zip(&waypoints[1..]).map(gap).collect();
    let (Some(first), Some(last)) = (waypoints.first(), waypoints.last()) else {
        return Vec::new();
    };
    if closed && !gaps.is_empty() {
        gaps.push(gap((last, first)));
    }
    let count = gaps.len();
    let segment = |(index, here): (usize, &Gap)| {
        let before = if closed {
            Some(gaps[(index + count - 1) % count])
        } else {
            index.checked_sub(1).map(|index| gaps[index])
        };
        let after = if closed { Some(gaps[(index + 1) % count]) } else { gaps.get(index + 1).copied() };
        let slopes = Stretch { before, here: *here, after }.parabolic();
        Segment { difference: here.difference, slopes }
    };
    gaps.iter().enumerate().map(segment).collect()
}

/// Returns the largest power of two that is not above a number > 0; 1 for 0.
fn power_of_two(number: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    if number > 0.0 { f64::from_bits(number.max(f64::MIN_POSITIVE).to_bits() & EXPONENT) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::animation::{Ease, Easing, Playback, Repeat};

    /// Checks directions against differences of points, and at rest, in all kinds of playback.
    #[test]
    fn directions_are_the_directions_of_motion() {
        for (closed, repeat, speed) in [
            (false, Repeat::Clamp, 1.0),
            (false, Repeat::PingPong, 1.0),
            (false, Repeat::PingPong, -2.0),
            (true, Repeat::Loop, -1.0),
            (true, Repeat::Loop, 0.5),
        ] {
            let playback = Playback { repeat, speed, ..Playback::default() };
            let path = path(&uneven(), closed, 1.0).paced(Pace { playback, ..Pace::lasting(20.0) });
            let mut compared = 0;
            for step in -3999..4000 {
                let time = f64::from(step) / 100.0 + 0.003;
                let velocity = velocity(&path, time, 1e-6);
                let direction = path.direction(time);
                assert!((direction.length() - 1.0).abs() < 1e-14);
                if velocity.length() > 1e-3 {
                    assert!(direction.distance(velocity.normalize()) < 1e-3, "{playback:?} {time}");
                    compared += 1;
                }
            }
            assert!(compared > 1900);
        }
        let first = (uneven()[1] - uneven()[0]).normalize();
        let last = (uneven()[7] - uneven()[6]).normalize();
        let open = path(&uneven(), false, 2.0);
        for (time, expected) in [(-1.0, first), (0.0, first), (2.0, last), (7.0, last)] {
            assert!(open.direction(time).distance(expected) < 1e-12, "{time}");
        }
        // There and back: the path reverses at both ends, where it has no velocity.
        let line = played(path(&[DVec3::ZERO, DVec3::X], true, 2.0), Repeat::Loop);
        let directions = [0.0, 0.5, 1.0, 1.5, 2.0].map(|time| line.direction(time).x);
        assert!(directions.iter().all(|x| x.abs() == 1.0) && directions[1] == 1.0 && directions[3] == -1.0);
        assert_eq!(directions[0], directions[4]);
        assert_eq!(path(&[DVec3::ONE], false, 1.0).direction(0.5), DVec3::ZERO);
    }

    /// Long and short segments, gentle and sharp turns.
    fn uneven() -> Vec<DVec3> {
        [
            (0.0, 0.0, 0.0),
            (100.0, 2.0, 0.0),
            (100.3, 2.0, 0.1),
            (100.31, 2.5, 0.1),
            (60.0, 40.0, -7.0),
            (59.0, 40.5, -7.0),
            (0.0, 45.0, 30.0),
            (-3.0, 5.0, 29.0),
        ]
        .map(|(x, y, z)| DVec3::new(x, y, z))
        .into()
    }

    fn path(points: &[DVec3], closed: bool, duration: f64) -> Path {
        Path::new(points, closed).unwrap().paced(Pace::lasting(duration))
    }

    fn played(path: Path, repeat: Repeat) -> Path {
        let playback = Playback { repeat, ..Playback::default() };
        let pace = Pace { playback, ..path.pace };
        path.paced(pace)
    }

    fn velocity(path: &Path, time: f64, h: f64) -> DVec3 {
        (path.at(time + h) - path.at(time - h)) / (2.0 * h)
    }

    #[test]
    fn speed_is_constant_however_uneven_the_waypoints_are() {
        for closed in [false, true] {
            let path = path(&uneven(), closed, 20.0);
            let expected = path.length() / 20.0;
            let polyline: f64 = uneven().windows(2).map(|pair| pair[0].distance(pair[1])).sum();
            assert!(path.length() > polyline && path.length() < 1.5 * polyline);
            for step in 1..20_000 {
                let time = f64::from(step) / 1000.0;
                let speed = velocity(&path, time, 1e-6).length();
                assert!((speed / expected - 1.0).abs() < 1e-5, "{closed} {time}: {speed}, not {expected}");
            }
        }
    }

    /// Returns the time at which a path is nearest to a point.
    fn time_near(path: &Path, point: DVec3, duration: f64) -> f64 {
        const STEPS: u32 = 4000;
        let apart = |time: f64| path.at(time).distance(point);
        let step = duration / f64::from(STEPS);
        let times = (0..=STEPS).map(|index| step * f64::from(index));
        let nearest = times.min_by(|one, other| apart(*one).total_cmp(&apart(*other))).unwrap();
        let (mut low, mut high) = (nearest - step, nearest + step);
        for _ in 0..100 {
            let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if apart(left) < apart(right) { high = right } else { low = left }
        }
        0.5 * (low + high)
    }

    /// Returns the largest change of velocity over `h` seconds on both sides.
    fn kink(path: &Path, time: f64, h: f64) -> f64 {
        let [before, at, after] = [time - h, time, time + h].map(|time| path.at(time));
        ((at - before) - (after - at)).length() / h
    }

    #[test]
    fn velocity_does_not_jump_at_waypoints_nor_across_the_seam() {
        for closed in [false, true] {
            let path =
                played(path(&uneven(), closed, 20.0), if closed { Repeat::Loop } else { Repeat::Clamp });
            let speed = path.length() / 20.0;
            let inner = if closed { &uneven()[..] } else { &uneven()[1..7] };
            for point in inner {
                let time = time_near(&path, *point, 20.0);
                assert!(path.at(time).distance(*point) < 1e-6, "{point} is passed by");
                let (wide, narrow) = (kink(&path, time, 1e-5), kink(&path, time, 1e-6));
                assert!(narrow < 1e-6 * speed + 0.2 * wide, "{closed}: a kink at {point}: {wide} {narrow}");
                assert!(wide < 0.1 * speed, "{closed}: {point}: {wide}");
            }
        }
        // The measure detects a kink: an open path that repeats jumps.
        assert!(kink(&played(path(&uneven(), false, 20.0), Repeat::Loop), 20.0, 1e-6) > 1.0);
    }

    #[test]
    fn a_closed_loop_has_no_doubled_frame() {
        for points in [uneven(), [uneven(), vec![uneven()[0]]].concat()] {
            for fps in [24.0, 25.0, 30_000.0 / 1001.0] {
                let frames = 97_u32;
                let path = played(path(&points, true, f64::from(frames) / fps), Repeat::Loop);
                let at: Vec<_> = (0..=2 * frames).map(|index| path.at(f64::from(index) / fps)).collect();
                let even = path.length() / f64::from(frames);
                for (index, pair) in at.windows(2).enumerate() {
                    let step = pair[0].distance(pair[1]);
                    assert!(step > 0.3 * even && step < 1.000_001 * even, "{index}: {step} of {even}");
                }
                assert!(at[0].distance(at[frames as usize]) < 1e-11);
            }
        }
    }

    #[test]
    fn distance_follows_the_easing() {
        let sine = |u: f64| 0.5 - 0.5 * libm::cos(std::f64::consts::PI * u);
        let even = path(&uneven(), false, 1.0);
        let pace = Pace { start: 2.0, ease: Easing::InOut(Ease::Sine), ..Pace::lasting(8.0) };
        let eased = path(&uneven(), false, 1.0).paced(pace);
        for step in 0..=800 {
            let u = f64::from(step) / 800.0;
            assert!(eased.at(2.0 + 8.0 * u).distance(even.at(sine(u))) < 1e-10, "{u}");
            // ds/dt = L (pi / 2 T) sin(pi u).
            let expected = eased.length() * std::f64::consts::PI / 16.0 * libm::sin(std::f64::consts::PI * u);
            let speed = velocity(&eased, 2.0 + 8.0 * u, 1e-5).length();
            assert!((speed - expected).abs() < 1e-4 * eased.length(), "{u}: {speed}, not {expected}");
        }
        assert_eq!([eased.at(0.0), eased.at(2.0)], [uneven()[0]; 2]);
    }

    #[test]
    fn swinging_easings_extend_open_paths_and_wrap_closed_ones() {
        let pace = Pace { ease: Easing::In(Ease::Back), ..Pace::lasting(1.0) };
        let back = Easing::In(Ease::Back).progress(0.3);
        assert!(back < -0.05);
        let open = path(&uneven(), false, 1.0).paced(pace);
        let expected = uneven()[0] + back * open.length() * (uneven()[1] - uneven()[0]).normalize();
        assert!(open.at(0.3).distance(expected) < 1e-10);
        let closed = path(&uneven(), true, 1.0);
        let around = closed.at(1.0 + back);
        assert!(closed.paced(pace).at(0.3).distance(around) < 1e-10);
    }

    #[test]
    fn zero_waypoints_are_no_path_and_one_is_constant() {
        assert_eq!(Path::new(&[], false), None);
        assert_eq!(Path::new(&[DVec3::ONE, DVec3::NAN], false), None);
        assert_eq!(Path::new(&[DVec3::ONE, DVec3::splat(f64::INFINITY)], false), None);
        for closed in [false, true] {
            for points in [vec![DVec3::ONE], vec![DVec3::ONE; 5]] {
                let path = path(&points, closed, 2.0);
                assert_eq!(path.length(), 0.0);
                assert_eq!([-1.0, 0.0, 1.0, 5.0].map(|time| path.at(time)), [DVec3::ONE; 4]);
            }
        }
    }

    #[test]
    fn two_waypoints_are_a_line_and_closed_a_round_trip() {
        let ends = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, -2.0, 15.0)];
        for (closed, duration) in [(false, 1.0), (true, 2.0)] {
            let path = path(&ends, closed, duration);
            assert!((path.length() - 13.0 * duration).abs() < 1e-12);
            for step in 0..=200 {
                let u = f64::from(step) / 100.0;
                let expected = ends[0].lerp(ends[1], if closed { 1.0 - (1.0 - u).abs() } else { u.min(1.0) });
                assert!(path.at(u).distance(expected) < 1e-12, "{closed} {u}: {}", path.at(u));
            }
        }
    }

    #[test]
    fn collinear_waypoints_are_passed_in_order() {
        let line = DVec3::new(1.0, 2.0, -2.0) / 3.0;
        let points = [0.0, 1.0, 1.5, 9.0, 4.0, 4.1].map(|at| at * line);
        let path = path(&points, false, 14.1);
        assert!((path.length() - 14.1).abs() < 1e-10, "{}", path.length());
        for (time, at) in [(0.5, 0.5), (3.0, 3.0), (9.0, 9.0), (9.5, 8.5), (13.0, 5.0), (14.05, 4.05)] {
            assert!(path.at(time).distance(at * line) < 1e-9, "{time}: {}", path.at(time));
        }
    }

    #[test]
    fn waypoints_that_coincide_are_one() {
        let doubled: Vec<_> = uneven().into_iter().flat_map(|point| [point, point, point + 1e-14]).collect();
        let back = [uneven(), vec![uneven()[0]]].concat();
        for (points, closed) in [(&doubled, false), (&doubled, true), (&back, true)] {
            let (one, other) = (path(points, closed, 7.0), path(&uneven(), closed, 7.0));
            for step in 0..=700 {
                let time = f64::from(step) / 100.0;
                assert!(one.at(time).distance(other.at(time)) < 1e-10, "{closed} {time}");
            }
        }
    }

    #[test]
    fn extreme_path_scales_are_exact() {
        let plain = path(&uneven(), true, 7.0);
        for size in [1e150, 1e-150, 1e297, 1e-290] {
            let points: Vec<_> = uneven().into_iter().map(|point| size * point).collect();
            let path = path(&points, true, 7.0);
            assert!((path.length() / size / plain.length() - 1.0).abs() < 1e-12, "{size}");
            for step in 0..=70 {
                let time = f64::from(step) / 10.0;
                assert!((path.at(time) / size).distance(plain.at(time)) < 1e-9, "{size} {time}");
            }
        }
        // A large and a small step, also far from the origin.
        for points in [[0.0, 1e150, 1e-150], [1e150, 1e-150, 1e149], [1e9, 1e9 + 1e-3, 1e9 + 1.0]] {
            let path = path(&points.map(|x| DVec3::new(x, 0.0, -x)), true, 1.0);
            assert!((0..=100).all(|step| path.at(f64::from(step) / 100.0).is_finite()));
            assert!(path.length().is_finite());
        }
    }
}
