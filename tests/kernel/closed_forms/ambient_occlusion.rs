//! Tests of ambient occlusion. With k_a, I_a and the colour 1, a surface shows exactly the share of ambient light that is not occluded.

use std::f64::consts::PI;

use super::{assert_near, exponent, film, root_mean_square};

/// The error of 4096 samples: an occluder is a region of the unit disc, and points of a low-discrepancy sequence count its area with an
/// error of about n^-3/4.
const ERROR: f64 = 2e-3;

/// Returns the light of the point (x, 0, z) of a floor, which is seen from a little above it. The scene's axes are rotated by `turn`
/// (degrees about all three axes).
fn share_at([x, z]: [f64; 2], occlusion: &str, turn: f64, entities: &str) -> [f64; 3] {
    let film = film(&format!(
        r#"film: (width: 1, height: 1, transfer: Classic), quality: (depth: 1), ambient: (1, 1, 1), ambient_occlusion: ({occlusion}),
        camera: (position: ({x:?}, 1e-3, {z:?}), view: (0, -1, 0), up: (0, 0, 1), parent: "room"),
        materials: {{ "floor": (k_a: 1, color: (255, 255, 255)), "wall": (k_d: 1) }},
        entities: [
            (name: "room", transform: (rotation: Euler({turn:?}, {turn:?}, {turn:?}))),
            (shape: Plane(normal: (0, 1, 0)), parent: "room", material: "floor"), {entities}]"#
    ));
    film.pixel(0, 0).to_array().map(f64::from)
}

/// Returns the light of the point (x, 0, z) with 4096 samples and no limit of the distance.
fn share([x, z]: [f64; 2], turn: f64, entities: &str) -> f64 {
    let [red, green, blue] = share_at([x, z], "samples: 4096, distance: 1e6", turn, entities);
    assert!(red == green && green == blue);
    red
}

/// Returns the share of a disc beyond a chord at a distance from its centre, in radii.
fn beyond_chord(distance: f64) -> f64 {
    (libm::acos(distance) - distance * (1.0 - distance * distance).sqrt()) / PI
}

const WALL: &str = r#"(shape: Plane(normal: (1, 0, 0)), parent: "room", material: "wall"),"#;
const OTHER_WALL: &str = r#"(shape: Plane(normal: (0, 0, -1)), parent: "room", material: "wall"),"#;

/// Checks corners. A wall without end occludes the half of all directions that point to it, however far it is, and a second wall across it
/// half of the rest. Directions of the density of the cosine are points of a disc, of which the walls occlude a half and a quarter.
#[test]
fn in_a_corner_half_or_a_quarter_of_the_ambient_light_is_left() {
    for samples in [4, 8, 64, 1024] {
        let occlusion = format!("samples: {samples}, distance: 1e6");
        let open = share_at([0.3, -0.7], &occlusion, 0.0, "");
        let [two, three] = [WALL.to_owned(), [WALL, OTHER_WALL].concat()]
            .map(|walls| share_at([0.3, -0.7], &occlusion, 0.0, &walls));
        // The quarters of the disc are quarters of the unit square, and have the same number of samples.
        assert_eq!((open, two, three), ([1.0; 3], [0.5; 3], [0.25; 3]), "{samples}");
    }
    for turn in [20.0, 75.0] {
        for place in [[1e-3, -1e-3], [0.5, -3.0], [4.0, -0.25]] {
            assert_near(share(place, turn, WALL), 0.5, ERROR);
            assert_near(share(place, turn, &[WALL, OTHER_WALL].concat()), 0.25, ERROR);
        }
    }
}

/// Checks the limit of the distance d: a wall at a distance of a occludes the directions of which more than a/d points to it, a part of the
/// disc beyond a chord.
#[test]
fn walls_occlude_up_to_the_distance() {
    for (away, distance) in [(1.0, 4.0), (1.0, 1.25), (0.02, 0.1), (3.0, 3.01)] {
        let occlusion = format!("samples: 4096, distance: {distance:?}");
        let [found, ..] = share_at([away, 0.0], &occlusion, 30.0, WALL);
        assert_near(found, 1.0 - beyond_chord(away / distance), ERROR);
    }
    let [found, ..] = share_at([1.0, 0.0], "samples: 4096, distance: 0.99", 30.0, WALL);
    assert_eq!(found, 1.0);
}

fn ball(radius: f64, height: f64, material: &str) -> String {
    format!(
        r#"(shape: Sphere(radius: {radius:?}), parent: "room", material: {material}, transform: (translation: (0, {height:?}, 0)))"#
    )
}

/// Checks balls above the floor. Seen from a point at a distance of D to its centre, a ball of radius r that is above the horizon covers
/// the cosine of the angle to the normal times (r/D)^2 of the ambient light: (r/h)^2 from the point below.
#[test]
fn below_and_beside_a_ball_its_form_factor_is_missing() {
    for (radius, height) in [(1.0, 1.25_f64), (1.0, 1.5), (0.5, 3.0), (2.0, 2.25)] {
        for beside in [0.0, 0.1, 1.0, 2.5, 10.0] {
            let covered = height * radius * radius / libm::pow(libm::hypot(beside, height), 3.0);
            for turn in [0.0, 40.0] {
                let found = share([0.6 * beside, 0.8 * beside], turn, &ball(radius, height, "\"wall\""));
                assert_near(found, 1.0 - covered, ERROR);
            }
        }
    }
    // Less than the distance to the ball, and more than the length of the tangents to it.
    let at = |distance: f64| {
        share_at([0.0; 2], &format!("samples: 256, distance: {distance:?}"), 0.0, &ball(1.0, 2.0, "\"wall\""))
    };
    assert_eq!(at(0.999), [1.0; 3]);
    assert_eq!(at(1.733), at(1e6));
    assert!(at(1.4)[0] > at(1e6)[0] && at(1.4)[0] < 1.0);
}

/// Checks a flat ellipsoid, which is a disc of radius r at a height of h: it covers r^2 / (r^2 + h^2).
#[test]
fn below_a_disc_its_form_factor_is_missing() {
    for (radius, height) in [(1.0, 1.0), (3.0, 0.5), (0.5, 2.0)] {
        let disc = format!(
            r#"(shape: Sphere(radius: 1), parent: "room", material: "wall",
                transform: (translation: (0, {height:?}, 0), scale: ({radius:?}, 1e-6, {radius:?})))"#
        );
        let covered = radius * radius / (radius * radius + height * height);
        assert_near(share([0.0; 2], 10.0, &disc), 1.0 - covered, ERROR);
    }
}

/// Checks that clear shapes transmit k_t at both crossings, and multiply, and that shapes without a shadow do not count.
#[test]
fn transparent_shapes_occlude_by_their_transmittance() {
    let occlusion = "samples: 4096, distance: 1e6";
    let glass = |transmitted: f64| format!("(refractive: (k_t: {transmitted:?}, ior: 1.5))");
    for transmitted in [0.0, 0.5, 0.9, 1.0] {
        let [found, ..] = share_at([0.0; 2], occlusion, 15.0, &ball(1.0, 2.0, &glass(transmitted)));
        assert_near(found, 1.0 - 0.25 * (1.0 - transmitted * transmitted), ERROR);
    }
    let two = [ball(1.0, 2.0, &glass(0.8)), ball(0.5, 2.0, &glass(0.5))].join(", ");
    let [found, ..] = share_at([0.0; 2], occlusion, 15.0, &two);
    let (outer, both) = (0.64, 0.64 * 0.25);
    assert_near(found, 1.0 - 0.25 * (1.0 - outer) - 0.0625 * (outer - both), ERROR);
    // An absorbing ball above the point: on the way of the angle a to the normal, its chord is 2 (r^2 - h^2 sin^2 a)^(1/2).
    let tinted = ball(1.0, 2.0, "(refractive: (k_t: 1, ior: 1.5, absorption: (0.5, 0, 2)))");
    let found = share_at([0.0; 2], occlusion, 0.0, &tinted);
    for (found, absorption) in found.into_iter().zip([0.5, 0.0, 2.0]) {
        const STEPS: u32 = 10_000;
        // Over s = sin^2 a, whose density is 1.
        let covered = (0..STEPS).map(|step| 0.25 * (f64::from(step) + 0.5) / f64::from(STEPS));
        let lost = covered.map(|s| 1.0 - libm::exp(-absorption * 2.0 * (1.0 - 4.0 * s).sqrt())).sum::<f64>();
        assert_near(found, 1.0 - 0.25 * lost / f64::from(STEPS), ERROR);
    }
    let hidden = ball(1.0, 2.0, "\"wall\"").replace("material", "casts_shadow: false, material");
    assert_eq!(share_at([0.0; 2], occlusion, 0.0, &hidden), [1.0; 3]);
}

/// Checks the rate at which the error falls: about n^-3/4, as for the regions of an area light.
#[test]
fn errors_fall_like_those_of_low_discrepancy_points() {
    let places = (0..24).map(|index| 0.1 + 0.15 * f64::from(index));
    let errors: Vec<(u32, f64)> = [16, 64, 256, 1024]
        .into_iter()
        .map(|samples| {
            let errors: Vec<f64> = places
                .clone()
                .map(|x| {
                    let occlusion = format!("samples: {samples}, distance: 1e6");
                    let [found, ..] = share_at([x, 0.0], &occlusion, 25.0, &ball(1.0, 1.25, "\"wall\""));
                    found - (1.0 - 1.25 / libm::pow(libm::hypot(x, 1.25), 3.0))
                })
                .collect();
            (samples, root_mean_square(&errors))
        })
        .collect();
    println!("{errors:?}");
    let slope = exponent(&errors);
    assert!((-1.0..-0.6).contains(&slope), "n^{slope}: {errors:?}");
    assert!(errors[0].1 < 0.06 && errors[3].1 < 4e-3, "{errors:?}");
}
