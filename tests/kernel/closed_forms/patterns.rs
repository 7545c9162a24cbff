//! Tests of patterns against closed forms, at the points that the pixels of a picture show.

use glam::{DAffine3, DQuat, DVec3, EulerRot};

use rayreel::trace::RayEnd;
use rayreel::{Film, Time};

use super::{engine, film};

/// A shape with its transform.
#[derive(Clone, Copy, Debug)]
struct Placed {
    shape: &'static str,
    translation: DVec3,
    /// In degrees, about x, then y, then z.
    rotation: DVec3,
    scale: DVec3,
}

/// A point of a pattern in the shape's own space.
#[derive(Clone, Copy, Debug)]
struct Shown {
    own: DVec3,
    /// The own axis across the surface, of planes along an axis and of boxes.
    across: usize,
    /// The fraction of the second colour.
    second: f64,
}

const BALL: &str = "Sphere(radius: 1.3)";
const CRATE: &str = "Box(size: (2, 1.5, 2.25))";
const HALF: DVec3 = DVec3::new(1.0, 0.75, 1.125);
const FLOOR: &str = "Plane(normal: (0, 1, 0))";

impl Placed {
    fn map(&self) -> DAffine3 {
        let [x, y, z] = self.rotation.to_array().map(f64::to_radians);
        DAffine3::from_scale_rotation_translation(
            self.scale,
            DQuat::from_euler(EulerRot::ZYX, z, y, x),
            self.translation,
        )
    }

    /// Renders a white shape with a black pattern from several sides. Returns the points that its pixels show.
    fn shown(&self, pattern: &str) -> Vec<Shown> {
        const SIDE: u32 = 24;
        let [translation, rotation, scale] = [self.translation, self.rotation, self.scale].map(super::triple);
        let back = self.map().inverse();
        let mut shown = Vec::new();
        for from in [DVec3::new(3.0, 4.0, -7.0), DVec3::new(-5.0, -6.0, 2.0), DVec3::new(1.0, 8.0, 6.0)] {
            let mut engine = engine(&format!(
                "film: (width: {SIDE}, height: {SIDE}, transfer: Classic), ambient: (1, 1, 1),
                camera: (position: {}, target: {translation}, fov: 30),
                entities: [(
                    shape: {}, material: (k_a: 1, color: (255, 255, 255), pattern: {pattern}),
                    transform: (translation: {translation}, rotation: Euler{rotation}, scale: {scale}),
                )]",
                super::triple(self.translation + from),
                self.shape,
            ));
            let film = engine.render_frame(0).unwrap();
            for (i, j) in (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (i, j))) {
                let tree = engine.probe(Time::ZERO, (i, j), 0).unwrap().unwrap();
                let RayEnd::Surface(lit) = &tree.rays[0].end else { continue };
                assert_eq!(tree.rays[0].end.light(), film.pixel(i, j), "the reference path");
                let own = back.transform_point3(lit.surface.point);
                let across = if self.shape == CRATE { (own / HALF).abs().max_position() } else { 1 };
                shown.push(Shown { own, across, second: 1.0 - f64::from(film.pixel(i, j).x) });
            }
        }
        shown
    }
}

/// Shapes that are turned, scaled and mirrored.
fn placed() -> Vec<Placed> {
    let at = DVec3::new(0.3, -0.7, 1.1);
    let transforms = [
        (DVec3::ZERO, DVec3::ONE),
        (DVec3::new(20.0, -130.0, 70.0), DVec3::ONE),
        (DVec3::new(90.0, 0.0, 180.0), DVec3::splat(1.5)),
        (DVec3::new(-40.0, 10.0, 0.0), DVec3::new(1.4, 0.6, 1.0)),
        (DVec3::new(0.0, 45.0, 0.0), DVec3::new(-1.0, 1.2, -0.8)),
    ];
    let shapes = [BALL, CRATE, FLOOR];
    let all =
        shapes.into_iter().flat_map(|shape| transforms.map(|(rotation, scale)| (shape, rotation, scale)));
    all.map(|(shape, rotation, scale)| Placed { shape, translation: at, rotation, scale }).collect()
}

/// Checks a pattern on all shapes against a closed form, which returns `None` near borders.
fn check(pattern: &str, expected: impl Fn(&str, &Shown) -> Option<f64>) {
    for placed in placed() {
        let (mut count, mut sum) = (0, 0.0);
        for shown in placed.shown(pattern) {
            let Some(expected) = expected(placed.shape, &shown) else { continue };
            assert!((shown.second - expected).abs() < 1e-5, "{pattern} {placed:?} {shown:?}, not {expected}");
            (count, sum) = (count + 1, sum + expected);
        }
        // Both colours are visible, so that the test can fail.
        assert!(count > 100, "{pattern} {placed:?}: {count}");
        assert!((0.02..0.98).contains(&(sum / f64::from(count))), "{pattern} {placed:?}: {sum} of {count}");
    }
}

/// Returns the number of the cell and the position in it; `None` near a border.
fn cell(place: f64) -> Option<(f64, f64)> {
    let within = place - place.floor();
    (0.001..0.999).contains(&within).then_some((place.floor(), within))
}

/// Returns the axes of two-dimensional patterns, and the own coordinates from which they start.
fn cells(shape: &str, shown: &Shown) -> (Vec<usize>, DVec3) {
    let axes = (0..3).filter(|axis| shape == BALL || *axis != shown.across).collect();
    (axes, if shape == CRATE { shown.own + HALF } else { shown.own })
}

#[test]
fn squares_are_counted_along_the_surface_and_cubes_in_spheres() {
    check("Checker(color: (0, 0, 0), size: 0.7)", |shape, shown| {
        let (axes, place) = cells(shape, shown);
        let cells = axes.into_iter().map(|axis| Some(cell(place[axis] / 0.7)?.0));
        Some(cells.sum::<Option<f64>>()?.rem_euclid(2.0))
    });
}

#[test]
fn stripes_have_a_size_a_ratio_a_direction_and_an_offset() {
    let stripes = |along: DVec3, size: f64, ratio: f64, offset: f64| {
        move |_: &str, shown: &Shown| {
            let (_, within) = cell((shown.own.dot(along.normalize()) - offset) / size)?;
            ((within - (1.0 - ratio)).abs() > 0.001).then(|| f64::from(u8::from(within > 1.0 - ratio)))
        }
    };
    check("Stripes(color: (0, 0, 0), size: 0.8)", stripes(DVec3::X, 0.8, 0.5, 0.0));
    check(
        "Stripes(color: (0, 0, 0), size: 0.5, ratio: 0.3, direction: (1, 2, -2), offset: 0.15)",
        stripes(DVec3::new(1.0, 2.0, -2.0), 0.5, 0.3, 0.15),
    );
}

/// Checks bricks in running bond. Rows follow each other along y, or along z on a surface across y.
#[test]
fn bricks_are_laid_in_running_bond_with_joints_around_them() {
    let size = DVec3::new(0.9, 0.4, 0.7);
    const MORTAR: f64 = 0.1;
    check("Bricks(color: (0, 0, 0), size: (0.9, 0.4, 0.7), mortar: 0.1)", |shape, shown| {
        let (axes, place) = cells(shape, shown);
        let row = if axes.contains(&1) { 1 } else { 2 };
        let number = (place[row] / size[row]).floor();
        let mut is_joint = false;
        for axis in axes {
            let shift = if axis != row && number.rem_euclid(2.0) == 1.0 { 0.5 } else { 0.0 };
            let (_, within) = cell(place[axis] / size[axis] + shift)?;
            let edge = within.min(1.0 - within) * size[axis];
            if (edge - MORTAR / 2.0).abs() < 0.001 {
                return None;
            }
            is_joint |= edge < MORTAR / 2.0;
        }
        Some(f64::from(u8::from(is_joint)))
    });
}

#[test]
fn gradients_blend_as_light_around_the_origin() {
    let blend = |along: DVec3, size: f64, offset: f64| {
        move |_: &str, shown: &Shown| {
            Some(((shown.own.dot(along.normalize()) - offset) / size + 0.5).clamp(0.0, 1.0))
        }
    };
    let along = DVec3::new(1.0, -2.0, 0.5);
    check("Gradient(color: (0, 0, 0), size: 3, direction: (1, -2, 0.5))", blend(along, 3.0, 0.0));
    let short = "Gradient(color: (0, 0, 0), size: 0.7, direction: (2, 0, 0), offset: 0.25)";
    check(short, blend(DVec3::X, 0.7, 0.25));
}

/// Checks that a gradient as high as a box has exactly its two colours at the ends, and one colour on each of the two faces.
#[test]
fn gradients_are_exact_at_their_ends() {
    let (translation, scale) = (DVec3::new(0.1, 0.2, 0.3), DVec3::ONE);
    for rotation in [DVec3::ZERO, DVec3::new(33.0, -50.0, 10.0)] {
        let placed = Placed { shape: CRATE, translation, rotation, scale };
        let top = |shown: &Shown| shown.across == 1;
        let [bottom, top] = colors_where(placed, "Gradient(color: (0, 0, 0), size: 1.5)", top);
        assert!(bottom > 0 && top > 0, "{rotation}");
    }
}

/// Checks that noise depends on the own point alone: a ball that is turned shows the same at the same own points.
#[test]
fn noise_is_solid() {
    const NOISE: &str = "Noise(color: (0, 0, 0), size: 0.6)";
    let (translation, scale) = (DVec3::new(0.1, 0.2, 0.3), DVec3::ONE);
    let turned = |shape, turn: f64| Placed { shape, translation, rotation: DVec3::splat(turn), scale };
    let (all, mut pairs) = (turned(BALL, 0.0).shown(NOISE), 0);
    for shown in turned(BALL, 35.0).shown(NOISE) {
        for other in &all {
            let apart = shown.own.distance(other.own);
            if apart < 0.06 {
                assert!((shown.second - other.second).abs() < 20.0 * apart, "{shown:?} {other:?}");
                pairs += 1;
            }
        }
    }
    assert!(pairs > 30, "{pairs}");
    let spread = all.iter().map(|shown| shown.second);
    assert!(spread.clone().fold(1.0, f64::min) < 0.3 && spread.fold(0.0, f64::max) > 0.7);
    for placed in placed() {
        let even = placed.shown("Noise(color: (0, 0, 0), size: 0.6, contrast: 0)");
        assert!(even.iter().all(|shown| (shown.second - 0.5).abs() < 1e-6));
        let spots = placed.shown("Noise(color: (0, 0, 0), size: 0.6, contrast: 1e9)");
        let [white, black] =
            [0.0, 1.0].map(|second| spots.iter().filter(|shown| shown.second == second).count());
        assert!(white > 50 && black > 50 && white + black == spots.len(), "{placed:?} {white} {black}");
    }
}

/// Counts the colours of all pixels that show a point for which the condition holds.
fn colors_where(placed: Placed, pattern: &str, condition: impl Fn(&Shown) -> bool) -> [usize; 2] {
    let mut counts = [0; 2];
    for shown in placed.shown(pattern).into_iter().filter(condition) {
        assert!(shown.second == 0.0 || shown.second == 1.0, "{shown:?}");
        counts[usize::from(shown.second == 1.0)] += 1;
    }
    counts
}

/// Checks faces that are exactly at a border of the pattern: the whole face has one colour, that of the inside.
#[test]
fn borders_in_a_face_show_no_speckles() {
    for turn in [0.0, 33.0, 77.7] {
        let translation = DVec3::new(0.1, 0.2, 0.3);
        let placed = |shape| Placed {
            shape,
            translation,
            rotation: DVec3::new(turn, 2.0 * turn, -turn),
            scale: DVec3::ONE,
        };
        // The sizes 0.4 and 0.1 are not exact: the quotients are rounded.
        for (size, offset) in [(1.0, 0.0), (0.4, 0.0), (0.1, 0.0), (0.25, 0.125), (0.1, 0.05)] {
            let pattern = format!("Stripes(color: (0, 0, 0), size: {size}, offset: {offset})");
            for side in [-1.0, 1.0] {
                let on_side = |shown: &Shown| shown.across == 0 && shown.own.x * side > 0.0;
                let inside = (side * (1.0 - 1e-6) - offset) / size;
                let expected = usize::from(inside - inside.floor() >= 0.5);
                let counts = colors_where(placed(CRATE), &pattern, on_side);
                assert!(counts[expected] > 0 && counts[1 - expected] == 0, "{pattern} {turn} {counts:?}");
            }
        }
        // The surface of a plane is at the border between the stripes at the origin; the inside is opposite to the normal.
        for (shape, direction, expected) in [
            (FLOOR, "(0, 1, 0)", 1),
            (FLOOR, "(0, -3, 0)", 0),
            ("Plane(normal: (1, 2, 3))", "(1, 2, 3)", 1),
            ("Plane(normal: (0.1, -0.7, 0.3))", "(-0.3, 2.1, -0.9)", 0),
        ] {
            let pattern = format!("Stripes(color: (0, 0, 0), size: 0.4, direction: {direction})");
            let counts = colors_where(placed(shape), &pattern, |_| true);
            assert!(counts[expected] > 100 && counts[1 - expected] == 0, "{shape} {direction} {counts:?}");
        }
    }
}

/// All patterns, with sizes that are not exact.
const PATTERNS: [&str; 6] = [
    "Checker(color: (0, 0, 0), size: 0.3)",
    "Stripes(color: (0, 0, 0), size: 0.4)",
    "Stripes(color: (0, 0, 0), size: 0.3, ratio: 0.2, direction: (3, 1, -2), offset: 0.7)",
    "Bricks(color: (0, 0, 0), size: (0.6, 0.2, 0.3), mortar: 0.04)",
    "Gradient(color: (0, 0, 0), size: 1.1, direction: (2, 1, 1))",
    "Noise(color: (0, 0, 0), size: 0.4)",
];

/// Renders a ball, a box and a floor, all turned and moved, from a camera that moves with them.
fn moved(pattern: &str, by: DVec3, turn: f64) -> Film {
    let at = |place: DVec3| super::triple(place + by);
    film(&format!(
        r#"film: (width: 64, height: 48, transfer: Classic), ambient: (1, 1, 1),
        camera: (position: {}, target: {}, fov: 40),
        materials: {{ "m": (k_a: 1, color: (255, 255, 255), pattern: {pattern}) }},
        entities: [
            (shape: {BALL}, material: "m", transform: (translation: {}, rotation: Euler(10, {turn:?}, 0))),
            (shape: {CRATE}, material: "m", transform: (translation: {}, rotation: Euler(5, {turn:?}, 3))),
            (shape: {FLOOR}, material: "m", transform: (translation: {}, rotation: Euler(0, {turn:?}, 0))),
        ]"#,
        at(DVec3::new(0.0, 5.0, -5.5)),
        at(DVec3::ZERO),
        at(DVec3::new(-1.6, 0.0, 0.0)),
        at(DVec3::new(1.6, 0.0, 0.5)),
        at(DVec3::new(0.0, -1.6, 0.0)),
    ))
}

/// Returns the number of pixels that change by more than a hundredth, and the sum of all changes.
fn change(one: &Film, other: &Film) -> (usize, f64) {
    let changes =
        one.pixels().iter().zip(other.pixels()).map(|(one, other)| f64::from((one.x - other.x).abs()));
    let all: Vec<f64> = changes.collect();
    (all.iter().filter(|change| **change > 0.01).count(), all.iter().sum())
}

#[test]
fn patterns_move_with_their_entities() {
    for pattern in PATTERNS {
        let still = moved(pattern, DVec3::ZERO, 30.0);
        for by in [DVec3::new(3.0, 0.0, 0.0), DVec3::new(-17.3, 4.9, 0.1), DVec3::new(1e3, -1e4, 1e5)] {
            let (count, _) = change(&still, &moved(pattern, by, 30.0));
            assert!(count <= 3, "{pattern}: {count} pixels differ after a motion by {by}");
        }
    }
}

/// Checks a slow rotation: each step changes few pixels, and small steps change fewer than large ones.
#[test]
fn patterns_never_jump() {
    for pattern in PATTERNS {
        let film = |step: u32, size: f64| moved(pattern, DVec3::ZERO, 44.9 + f64::from(step) * size);
        for step in 0..10 {
            let (_, changed) = change(&film(step, 0.005), &film(step + 1, 0.005));
            assert!(changed < 45.0, "{pattern}: {changed} of 3072 pixels change within 0.005 degrees");
        }
        let (_, changed) = change(&film(0, 5.0), &film(1, 5.0));
        assert!(changed > 20.0, "{pattern}: the pattern does not turn");
    }
}

/// Checks coordinates and sizes whose quotients are beyond all integers, or infinite.
#[test]
fn extreme_coordinates_show_one_of_the_colours() {
    for pattern in [
        "Checker(size: SIZE",
        "Stripes(size: SIZE, direction: (1, 1, 0), offset: 1e60",
        "Bricks(size: (SIZE, SIZE, SIZE), mortar: 1e60",
        "Gradient(size: SIZE, offset: -1e60",
        "Noise(size: SIZE, octaves: 16, contrast: 1e60",
    ] {
        for (place, size) in
            [("1e15", "1e-60"), ("1e15", "0.3"), ("1e60", "1e-60"), ("0", "1e-60"), ("1e15", "1e60")]
        {
            for shape in ["Sphere(radius: 1e14)", "Box(size: (1e14, 1, 1e14))", FLOOR] {
                let film = film(&format!(
                    r#"film: (width: 16, height: 12), ambient: (1, 1, 1),
                    camera: (position: ({place}, 3e14, -5e14), view: (0, -0.5, 1)),
                    materials: {{ "m": (k_a: 1, pattern: {}, color: (0, 0, 0))) }},
                    entities: [(shape: {shape}, material: "m", transform: (translation: ({place}, 0, 0)))]"#,
                    pattern.replace("SIZE", size)
                ));
                for pixel in film.pixels() {
                    assert!(
                        (0.0..=1.0).contains(&pixel.x),
                        "{pattern} {size} at {place} on {shape}: {pixel}"
                    );
                }
            }
        }
    }
}
