//! Tests of area lights.

use std::f64::consts::PI;

use super::{assert_near, exponent, film, root_mean_square};

/// Number of pixels in a row along x, on a floor at y = 0 that is seen from straight above.
const COLUMNS: u32 = 256;

/// Returns the x coordinates and values of the pixels at their centres. The row extends by `half` to either side.
fn row(half: f64, floor: &str, entities: &str) -> Vec<(f64, f64)> {
    let film = film(&format!(
        r#"film: (width: {COLUMNS}, height: 1, transfer: Classic), quality: (depth: 1),
        camera: (position: (0, 1, 0), view: (0, -1, 0), up: (0, 0, 1), screen: (distance: 1, width: {:?}, height: 1)),
        materials: {{ "floor": ({floor}), "wall": (k_a: 0) }},
        entities: [(shape: Plane(normal: (0, 1, 0)), material: "floor"), {entities}]"#,
        2.0 * half
    ));
    let place = |i: u32| -half + 2.0 * half * f64::from(i) / f64::from(COLUMNS - 1);
    (0..COLUMNS).map(|i| (place(i), f64::from(film.pixel(i, 0).x))).collect()
}

/// Returns the share of a disc beyond a chord at a distance from its centre, in radii; 1 at a distance of -1, 0 at 1.
fn beyond_chord(distance: f64) -> f64 {
    if distance.abs() >= 1.0 {
        return if distance < 0.0 { 1.0 } else { 0.0 };
    }
    (libm::acos(distance) - distance * (1.0 - distance * distance).sqrt()) / PI
}

/// Checks a penumbra. From (x, 0, 0), a ball at (0, 10, 0) of radius 2 is a disc that faces the point. A wall that ends at x = 0, two above
/// the floor, occludes the left of its edge: the disc is cut at its distance times the tangent of the angle between edge and centre. With
/// k_s 1 and shininess 0, a surface shows exactly the visible share of the light.
#[test]
fn the_penumbra_of_a_ball_has_the_width_and_the_profile_of_a_covered_disc() {
    const HEIGHT: f64 = 10.0;
    const RADIUS: f64 = 2.0;
    const EDGE: f64 = 2.0;
    let expected = |x: f64| {
        // The directions are (-x, 10) to the centre and (-x, 2) to the edge. The tangent is cross over dot.
        let tangent = x * (HEIGHT - EDGE) / (x * x + HEIGHT * EDGE);
        beyond_chord(-libm::hypot(x, HEIGHT) * tangent / RADIUS)
    };
    let mut errors = Vec::new();
    for samples in [4, 16, 64, 256, 1024] {
        let row = row(
            0.8,
            "specular: (k_s: 1, shininess: 0)",
            &format!(
                r#"(shape: Box(size: (50, 1e-9, 50)), material: "wall", transform: (translation: (-25, {EDGE:?}, 0))),
                (light: Area(shape: Sphere(radius: {RADIUS:?}), intensity: (1, 1, 1), samples: {samples}),
                    transform: (translation: (0, {HEIGHT:?}, 0)))"#
            ),
        );
        let mut within = Vec::new();
        for (x, found) in row {
            let expected = expected(x);
            if expected == 0.0 || expected == 1.0 {
                assert_eq!(found, expected, "beside the penumbra, at {x}");
            } else {
                within.push(found - expected);
            }
        }
        // Without the rotation of the disc, the tangents from the edge to it would be 2 r / (8/2) apart on the floor.
        assert!((120..240).contains(&within.len()), "{}", within.len());
        errors.push((samples, root_mean_square(&within)));
    }
    println!("{errors:?}");
    let slope = exponent(&errors);
    assert!((-0.9..-0.65).contains(&slope), "n^{slope}: {errors:?}");
    assert!(errors[1].1 < 0.06 && errors[4].1 < 0.003, "{errors:?}");
}

/// Checks the exact ends of the penumbra, which are given by the tangents from the edge to the disc.
#[test]
fn a_penumbra_ends_where_the_tangents_to_the_light_do() {
    let shares = |x: f64| {
        let lit = format!(
            r#"film: (width: 1, height: 1, transfer: Classic), quality: (depth: 1),
            camera: (position: ({x:?}, 1, 0), view: (0, -1, 0), up: (0, 0, 1)),
            materials: {{ "floor": (specular: (k_s: 1, shininess: 0)), "wall": (k_a: 0) }},
            entities: [(shape: Plane(normal: (0, 1, 0)), material: "floor"),
                (shape: Box(size: (50, 1e-9, 50)), material: "wall", transform: (translation: (-25, 2, 0))),
                (light: Area(shape: Sphere(radius: 2), intensity: (1, 1, 1), samples: 4096),
                    transform: (translation: (0, 10, 0)))]"#
        );
        film(&lit).pixel(0, 0).x
    };
    // The condition |x| (x^2 + 100)^(1/2) 8 / (x^2 + 20) = 2, solved by bisection.
    let (mut low, mut high) = (0.0_f64, 2.0_f64);
    for _ in 0..60 {
        let x = 0.5 * (low + high);
        if x * libm::hypot(x, 10.0) * 8.0 < 2.0 * (x * x + 20.0) { low = x } else { high = x }
    }
    // A chord that cuts off a part d of the radius cuts off about 0.6 d^(3/2) of the disc: 2 samples in 4096 for a hundredth.
    let (inner, outer) = (0.98 * low, 1.0001 * low);
    assert_eq!([shares(outer), shares(-outer)], [1.0, 0.0]);
    assert!(shares(inner) < 1.0 && shares(inner) > 0.99);
    assert!(shares(-inner) > 0.0 && shares(-inner) < 0.01);
}

/// Checks that a ball is a disc of its radius from every direction, as wide as it is high. A wall half-way to it, across the view, covers
/// the part beyond a chord, above or to one side.
#[test]
fn sphere_light_is_symmetric() {
    let (distance, radius) = (10.0, 1.5);
    for degrees in [15.0, 40.0, 65.0, 90.0] {
        let (sine, cosine) = libm::sincos(f64::to_radians(degrees));
        for (chord, sideways) in [-0.8, -0.3, 0.0, 0.5, 0.9].into_iter().flat_map(|c| [(c, false), (c, true)])
        {
            // The wall is 40 high and wide. In its own axes, x points to the light, y up, and z to the side.
            let edge = 0.5 * radius * chord + 20.0;
            let (up, aside) = if sideways { (0.0, edge) } else { (edge, 0.0) };
            let (x, y) = (0.5 * distance * cosine - up * sine, 0.5 * distance * sine + up * cosine);
            let film = film(&format!(
                r#"film: (width: 1, height: 1, transfer: Classic), quality: (depth: 1),
                camera: (position: (0, 1e-3, -1e-2), target: (0, 0, 0)),
                materials: {{ "floor": (specular: (k_s: 1, shininess: 0)), "wall": (k_a: 0) }},
                entities: [(shape: Plane(normal: (0, 1, 0)), material: "floor"),
                    (shape: Box(size: (1e-9, 40, 40)), material: "wall",
                        transform: (translation: ({x:?}, {y:?}, {aside:?}), rotation: Euler(0, 0, {degrees:?}))),
                    (light: Area(shape: Sphere(radius: {radius:?}), intensity: (1, 1, 1), samples: 4096),
                        transform: (translation: ({:?}, {:?}, 0)))]"#,
                distance * cosine,
                distance * sine
            ));
            assert_near(f64::from(film.pixel(0, 0).x), 1.0 - beyond_chord(chord), 2e-3);
        }
    }
}

/// Returns the integral of 1/sqrt(x^2 + y^2 + h^2) over 0..a and 0..b, odd in a and b: the potential of an evenly charged rectangle above
/// its corner.
fn potential(a: f64, b: f64, h: f64) -> f64 {
    let diagonal = (a * a + b * b + h * h).sqrt();
    let part = |a: f64, b: f64| b * libm::asinh(a / libm::hypot(b, h));
    part(a, b) + part(b, a) - h * libm::atan2(a * b, h * diagonal)
}

/// Checks that the light at a point (x, 0, 0) is the mean of N.L = h / distance over the rectangle.
#[test]
fn a_rectangle_lights_by_the_mean_of_the_cosine() {
    let (width, depth, height) = (3.0, 2.0, 1.5);
    let expected = |x: f64| {
        let corner = |right: f64, forward: f64| potential(right - x, forward, height);
        let (right, forward) = (0.5 * width, 0.5 * depth);
        let integral = corner(right, forward) - corner(-right, forward) - corner(right, -forward)
            + corner(-right, -forward);
        height * integral / (width * depth)
    };
    // The midpoint rule, over many small rectangles, confirms the closed form.
    for x in [0.0, 0.4, 2.5] {
        const PARTS: u32 = 400;
        let place = |index: u32, size: f64| ((f64::from(index) + 0.5) / f64::from(PARTS) - 0.5) * size;
        let cosine = |i: u32, j: u32| {
            let (right, forward) = (place(i, width) - x, place(j, depth));
            height / (right * right + forward * forward + height * height).sqrt()
        };
        let sum: f64 =
            (0..PARTS).flat_map(|i| (0..PARTS).map(move |j| (i, j))).map(|(i, j)| cosine(i, j)).sum();
        assert_near(sum / f64::from(PARTS * PARTS), expected(x), 1e-6);
    }
    let mut errors = Vec::new();
    for samples in [4, 16, 64, 256] {
        // A rectangle in the xy-plane of its entity, rotated to lie above the floor.
        let row = row(
            2.0,
            "k_d: 1",
            &format!(
                "(light: Area(shape: Rectangle(width: {width:?}, height: {depth:?}), intensity: (1, 1, 1), samples: {samples}),
                transform: (translation: (0, {height:?}, 0), rotation: Euler(90, 0, 0)))"
            ),
        );
        let differences: Vec<f64> = row.iter().map(|(x, found)| found - expected(*x)).collect();
        errors.push((samples, root_mean_square(&differences)));
    }
    println!("{errors:?}");
    let slope = exponent(&errors);
    assert!((-1.8..-1.3).contains(&slope), "n^{slope}: {errors:?}");
    assert!(errors[3].1 < 2e-4, "{errors:?}");
}

/// Checks that the size of a light does not change its intensity: a distant area light is a point light.
#[test]
fn distant_area_light_equals_a_point_light() {
    let shown = |light: &str| {
        row(0.5, "k_d: 1", &format!("(light: {light}, transform: (translation: (0, 3000, 4000)))"))
    };
    let point = shown("Point(intensity: (0.5, 0.5, 0.5))");
    assert_near(point[0].1, 0.5 * 0.6, 1e-4);
    for shape in ["Sphere(radius: 1)", "Rectangle(width: 1, height: 2)"] {
        let found = shown(&format!("Area(shape: {shape}, intensity: (0.5, 0.5, 0.5), samples: 16)"));
        for ((_, found), (_, point)) in found.iter().zip(&point) {
            assert_near(*found, *point, 2e-5);
        }
    }
}

#[test]
fn ceiling_does_not_occlude_its_light() {
    // The light is flush with the ceiling, also when rotated, so that no coordinate is a round number.
    for turn in [0.0, -7.0] {
        let room = |ceiling: &str| {
            film(&format!(
                r#"film: (width: 32, height: 18, transfer: Classic), camera: (position: (0, 0, -6), target: (0, 0, 0), fov: 16),
                materials: {{ "m": (k_d: 1) }}, entities: [
                (name: "room", transform: (translation: (0.3, 0.1, -0.7), rotation: Euler({turn:?}, 11, 5))),
                (shape: Sphere(radius: 0.8), material: "m"), {ceiling}
                (parent: "room", light: Area(shape: Rectangle(width: 1.3, height: 1.1), intensity: (1, 1, 1), samples: 5),
                    transform: (translation: (0, 1.7, 0), rotation: Euler(90, 0, 0)))]"#
            ))
        };
        let ceiling = r#"(parent: "room", shape: Plane(normal: (0, 1, 0)), material: "m", transform: (translation: (0, 1.7, 0))),"#;
        let (without, with) = (room(""), room(ceiling));
        let lit = without.pixels().iter().filter(|pixel| pixel.max_element() > 0.0).count();
        assert!(lit > 20, "{lit}");
        for (without, with) in without.pixels().iter().zip(with.pixels()) {
            assert!(without.max_element() == 0.0 || without == with, "{without} {with}");
        }
    }
}
