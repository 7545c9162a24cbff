//! Tests of fog, checkers and gradient backgrounds.

use glam::{DQuat, DVec3};

use super::{assert_near, film, seen, tilted, triple};

const FOG: [f64; 3] = [0.2, 0.4, 0.8];

/// Fog of these channels, as a colour in a file, and a density of 0.3.
const FOG_TEXT: &str = "fog: (color: (51, 102, 204), density: 0.3)";

/// Returns exp(-density l) of the light, and fog for the rest.
fn through_fog(light: [f64; 3], length: f64) -> [f64; 3] {
    let share = libm::exp(-0.3 * length);
    [0, 1, 2].map(|channel| share * light[channel] + (1.0 - share) * FOG[channel])
}

fn assert_color(found: glam::Vec3, expected: [f64; 3]) {
    for (found, expected) in found.to_array().into_iter().zip(expected) {
        assert_near(f64::from(found), expected, 1e-6);
    }
}

#[test]
fn fog_dims_camera_rays_and_not_lights() {
    for degrees in [0.0, 40.0, 85.0] {
        let angle = f64::to_radians(degrees);
        let wall = seen(
            DVec3::new(0.0, 0.0, -2.0),
            tilted(angle),
            &format!(
                r#"{FOG_TEXT}, ambient: (0.5, 0.5, 0.5), materials: {{ "m": (k_a: 1, k_d: 0.5) }},
                entities: [(shape: Plane(normal: (0, 0, 1)), material: "m"), (light: Directional(intensity: (0.2, 0.4, 0.6)))]"#
            ),
        );
        assert_color(wall, through_fog([0.6, 0.7, 0.8], 2.0 / libm::cos(angle)));
    }
    let nothing = format!("{FOG_TEXT}, background: (255, 0, 0)");
    assert_color(seen(DVec3::ZERO, DVec3::Z, &nothing), FOG);
    let clear = "fog: (color: (51, 102, 204), density: 0), background: (255, 0, 0)";
    assert_color(seen(DVec3::ZERO, DVec3::Z, clear), [1.0, 0.0, 0.0]);
}

/// Checks fog in mirrors: fog in front of the mirror affects all light from it, fog on the reflected path only the reflected light.
#[test]
fn fog_applies_to_reflections() {
    let shown = |behind: &str| {
        seen(
            DVec3::ZERO,
            DVec3::Z,
            &format!(
                r#"{FOG_TEXT}, background: (255, 0, 0), ambient: (1, 1, 1), quality: (cutoff: 0),
                materials: {{ "mirror": (k_a: 1, color: (51, 51, 51), reflective: (k_r: 0.5)), "m": (k_a: 1, color: (0, 255, 102)) }},
                entities: [(shape: Plane(normal: (0, 0, 1)), material: "mirror", transform: (translation: (0, 0, 2))), {behind}]"#
            ),
        )
    };
    let mirrored = |light: [f64; 3]| through_fog(light.map(|light| 0.2 + 0.5 * light), 2.0);
    let wall = r#"(shape: Plane(normal: (0, 0, 1)), material: "m", transform: (translation: (0, 0, -1)))"#;
    assert_color(shown(wall), mirrored(through_fog([0.0, 1.0, 0.4], 3.0)));
    assert_color(shown(""), mirrored(FOG));
}

/// Returns the integral of 0.3 exp(-(y - 0.5) / 1.25) along a ray from a height `y`, by the midpoint rule.
fn optical_depth(y: f64, slope: f64, length: f64) -> f64 {
    const STEPS: u32 = 100_000;
    let step = length / f64::from(STEPS);
    let height = |at: u32| y + slope * step * (f64::from(at) + 0.5);
    (0..STEPS).map(|at| 0.3 * step * libm::exp(-(height(at) - 0.5) / 1.25)).sum()
}

/// Checks fog that thins out upwards along rays to a wall, which rise, fall, and are level or nearly so, also by way of a mirror.
#[test]
fn fog_with_height_dims_by_its_integral() {
    let fog = "fog: (color: (51, 102, 204), density: 0.3, height: 1.25, level: 0.5), quality: (cutoff: 0)";
    let lit = r#"ambient: (1, 1, 1), materials: { "m": (k_a: 1, color: (0, 255, 102)), "mirror": (reflective: (k_r: 0.5)) }"#;
    let behind = |light: [f64; 3], depth: f64| through_fog(light, depth / 0.3);
    for degrees in [90.0, 70.0, 20.0, 1e-7, 0.0, -1e-3, -35.0, -90.0_f64] {
        let (slope, along) = libm::sincos(degrees.to_radians());
        // A quarter turn in radians is rounded.
        let towards = DVec3::new(0.0, slope, if degrees.abs() == 90.0 { 0.0 } else { along });
        for y in [-1.0, 0.5, 4.0] {
            let center = DVec3::new(0.0, y, 0.0) + 3.0 * towards;
            let wall = |normal: DVec3| {
                let (normal, center) = (triple(normal), triple(center));
                format!(r#"shape: Plane(normal: {normal}), transform: (translation: {center})"#)
            };
            let from = DVec3::new(0.0, y, 0.0);
            let depth = optical_depth(y, slope, 3.0);
            let shown = format!(r#"{fog}, {lit}, entities: [({}, material: "m")]"#, wall(towards));
            assert_color(seen(from, towards, &shown), behind([0.0, 1.0, 0.4], depth));
            // The mirror faces the ray, which goes back the same way and on to a second wall.
            let second = format!(
                r#"(shape: Plane(normal: {}), material: "m", transform: (translation: {}))"#,
                triple(towards),
                triple(from - 2.0 * towards)
            );
            let shown =
                format!(r#"{fog}, {lit}, entities: [({}, material: "mirror"), {second}]"#, wall(towards));
            let returning = behind([0.0, 1.0, 0.4], optical_depth(y + 3.0 * slope, -slope, 5.0));
            let expected = behind(returning.map(|light| 0.5 * light), depth);
            assert_color(seen(from, towards, &shown), expected);
        }
    }
}

/// Checks rays that hit nothing: rising rays leave fog with height, others do not, and fog may spare the background.
#[test]
fn background_shows_through_fog_where_rays_leave_it() {
    let red = [1.0, 0.0, 0.0];
    let shown = |rest: &str, y: f64, towards: DVec3| {
        let fog = format!("fog: (color: (51, 102, 204), density: 0.3{rest})");
        seen(DVec3::new(0.0, y, 0.0), towards, &format!("{fog}, background: (255, 0, 0)"))
    };
    let layer = ", height: 1.25, level: 0.5";
    for (y, towards) in
        [(0.5, DVec3::Y), (3.0, DVec3::new(0.0, 3.0, 4.0)), (-1.0, DVec3::new(2.0, 0.5, -1.0))]
    {
        let slope = towards.normalize().y;
        let length = 1.25 * libm::exp(-(y - 0.5) / 1.25) / slope;
        assert_color(shown(layer, y, towards), through_fog(red, length));
    }
    for towards in [DVec3::Z, DVec3::new(0.0, -1e-9, 1.0), DVec3::NEG_Y] {
        assert_color(shown(layer, 9.0, towards), FOG);
        assert_color(shown(&format!("{layer}, hides_background: false"), 9.0, towards), red);
        assert_color(shown(", hides_background: false", 0.0, towards), red);
    }
    // Fog that spares the background still dims surfaces.
    let wall = r#"fog: (color: (51, 102, 204), density: 0.3, hides_background: false), background: (255, 0, 0), ambient: (1, 1, 1),
        materials: { "m": (k_a: 1, color: (0, 255, 102)) },
        entities: [(shape: Plane(normal: (0, 0, 1)), material: "m", transform: (translation: (0, 0, 2)))]"#;
    assert_color(seen(DVec3::ZERO, DVec3::Z, wall), through_fog([0.0, 1.0, 0.4], 2.0));
}

/// Checks fog in front of glass, in it and behind it. Inside, glass absorbs as well.
#[test]
fn fog_applies_behind_transparent_surfaces() {
    let absorption = [0.0, 0.5, 1.0];
    for degrees in [0.0, 50.0] {
        let angle = f64::to_radians(degrees);
        let shown = |behind: &str| {
            seen(
                DVec3::new(0.0, 0.0, -2.0),
                tilted(angle),
                &format!(
                    r#"{FOG_TEXT}, background: (255, 0, 0), ambient: (1, 1, 1), quality: (cutoff: 0),
                    materials: {{ "glass": (refractive: (k_t: 0.8, ior: 1.5, absorption: (0, 0.5, 1))), "m": (k_a: 1, color: (0, 255, 102)) }},
                    entities: [(shape: Box(size: (99, 99, 1)), material: "glass", transform: (translation: (0, 0, 0.5))), {behind}]"#
                ),
            )
        };
        let (outside, inside) = (libm::cos(angle), libm::cos(libm::asin(libm::sin(angle) / 1.5)));
        let before = |behind: [f64; 3]| {
            let leaving = through_fog(behind.map(|light| 0.8 * light), 1.0 / inside);
            let absorbed: Vec<f64> = leaving
                .iter()
                .zip(absorption)
                .map(|(light, absorption)| 0.8 * light * libm::exp(-absorption / inside))
                .collect();
            through_fog([absorbed[0], absorbed[1], absorbed[2]], 2.0 / outside)
        };
        let wall = r#"(shape: Plane(normal: (0, 0, 1)), material: "m", transform: (translation: (0, 0, 3)))"#;
        assert_color(shown(wall), before(through_fog([0.0, 1.0, 0.4], 2.0 / outside)));
        assert_color(shown(""), before(FOG));
    }
}

/// Checks fog in front of a plate, in it and behind it. Inside, absorption dims fog and the light from behind alike.
#[test]
fn fog_applies_inside_transparent_solids() {
    let (density, thickness, absorption) = (0.3, 1.5, [0.0, 0.4, 2.0]);
    let found = seen(
        DVec3::new(0.0, 0.0, -4.0),
        DVec3::Z,
        &format!(
            r#"quality: (cutoff: 0), fog: (color: (51, 102, 204), density: {density:?}),
            materials: {{ "glass": (refractive: (k_t: 0.8, ior: 1.5, absorption: (0, 0.4, 2))) }},
            entities: [(shape: Box(size: (9, 9, {thickness:?})), material: "glass", transform: (translation: (0, 0, {:?})))]"#,
            0.5 * thickness
        ),
    );
    let expected = [0, 1, 2].map(|channel| {
        let fog = [51.0, 102.0, 204.0][channel] / 255.0;
        let (before, inside) = (libm::exp(-density * 4.0), libm::exp(-density * thickness));
        let absorbed = libm::exp(-absorption[channel] * thickness);
        let from_inside = absorbed * (fog * (1.0 - inside) + inside * 0.8 * fog);
        fog * (1.0 - before) + before * 0.8 * from_inside
    });
    assert_color(found, expected);
}

/// Checks gradients from 0, straight down, to 1, straight up, (1 + y)/2 in between, for camera rays and in mirrors.
#[test]
fn gradient_depends_on_the_height_of_the_direction() {
    let sky = "background: (bottom: (255, 0, 51), top: (0, 255, 51)), quality: (cutoff: 0)";
    for direction in
        [DVec3::new(0.0, 1.0, 1e-9), DVec3::new(3.0, -4.0, 12.0), DVec3::X, DVec3::new(-1.0, 9.0, 1.0)]
    {
        let share = 0.5 * (1.0 + direction.normalize().y);
        assert_color(seen(DVec3::ZERO, direction, sky), [1.0 - share, share, 0.2]);
        // A puddle below mirrors y.
        if direction.y < 0.0 {
            let puddle = format!(
                r#"{sky}, materials: {{ "m": (reflective: (k_r: 0.5)) }},
                entities: [(shape: Plane(normal: (0, 1, 0)), material: "m", transform: (translation: (0, -1, 0)))]"#
            );
            let seen = seen(DVec3::ZERO, direction, &puddle);
            assert_color(seen, [0.5 * share, 0.5 * (1.0 - share), 0.1]);
        }
    }
}

/// Checks gradients with a horizon: |y| of the colour straight up or down, and the rest of the horizon's colour.
#[test]
fn gradient_with_a_horizon_blends_on_each_side_of_it() {
    let sky =
        "background: (bottom: (255, 0, 51), horizon: (0, 0, 255), top: (0, 255, 51)), quality: (cutoff: 0)";
    for direction in
        [DVec3::new(0.0, 1.0, 1e-9), DVec3::new(3.0, -4.0, 12.0), DVec3::X, DVec3::new(-1.0, 9.0, 1.0)]
    {
        let y = direction.normalize().y;
        let blue = 0.2 * y.abs() + (1.0 - y.abs());
        assert_color(seen(DVec3::ZERO, direction, sky), [(-y).max(0.0), y.max(0.0), blue]);
        if y < 0.0 {
            let puddle = format!(
                r#"{sky}, materials: {{ "m": (reflective: (k_r: 0.5)) }},
                entities: [(shape: Plane(normal: (0, 1, 0)), material: "m", transform: (translation: (0, -1, 0)))]"#
            );
            assert_color(seen(DVec3::ZERO, direction, &puddle), [0.0, 0.5 * -y, 0.5 * blue]);
        }
    }
}

/// Checks the sun's disc, edge and halo in front of the background, along camera rays and in a mirror.
#[test]
fn sun_is_a_disc_with_a_halo() {
    let sky = "background: (0, 0, 255), quality: (cutoff: 0),
        sun: (direction: (0, 3, 4), intensity: (2, 1, 0), size: 10, glow: 0.5, glow_size: 20)";
    for away in [0.0, 4.4, -4.6, 4.8, -5.0, 5.5, 20.0, -90.0_f64] {
        let (up, along) = libm::sincos(libm::asin(0.6) + away.to_radians());
        let inside = ((5.0 - away.abs()) / 0.5).clamp(0.0, 1.0);
        let disc = inside * inside * (3.0 - 2.0 * inside);
        let share = disc + (1.0 - disc) * 0.5 * libm::exp((5.0 - away.abs()).min(0.0) / 20.0);
        assert_color(seen(DVec3::ZERO, DVec3::new(0.0, up, along), sky), [2.0 * share, share, 1.0]);
        let puddle = format!(
            r#"{sky}, materials: {{ "m": (reflective: (k_r: 0.5)) }},
            entities: [(shape: Plane(normal: (0, 1, 0)), material: "m", transform: (translation: (0, -1, 0)))]"#
        );
        if up > 0.0 {
            let mirrored = seen(DVec3::ZERO, DVec3::new(0.0, -up, along), &puddle);
            assert_color(mirrored, [share, 0.5 * share, 0.5]);
        }
    }
}

/// Checks the sum of the light of all stars, and that a rotated camera sees the same stars.
#[test]
fn stars_keep_their_places_and_their_light() {
    const SIDE: u32 = 300;
    let shown = |up: &str| {
        film(&format!(
            "film: (width: {SIDE}, height: {SIDE}, transfer: Classic), stars: (count: 4000, size: 1),
            camera: (position: (0, 0, 0), view: (0, 0, 1), up: {up}, screen: (distance: 1, width: 2, height: 2))"
        ))
    };
    let plain = shown("(0, 1, 0)");
    // A pixel of a unit square of the screen at a distance d is seen under the solid angle d^-3.
    let pitch = 2.0 / f64::from(SIDE - 1);
    let place = |index: u32| pitch * f64::from(index) - 1.0;
    let pixels = (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (i, j)));
    let light: f64 = pixels
        .clone()
        .map(|(i, j)| {
            let distance = (1.0 + place(i) * place(i) + place(j) * place(j)).sqrt();
            f64::from(plain.pixel(i, j).x) * pitch * pitch / (distance * distance * distance)
        })
        .sum();
    // A sixth of all stars. The profile holds a third of the light of a disc; the mean of the brightness is 3 (21^(1/3) - 1) / 20.
    let radius = 0.5_f64.to_radians();
    let expected =
        4000.0 / 6.0 * std::f64::consts::PI * radius * radius / 3.0 * 0.15 * (libm::cbrt(21.0) - 1.0);
    assert_near(light / expected, 1.0, 0.15);
    let turned = shown("(1, 0, 0)");
    for (i, j) in pixels {
        assert_near(turned.pixel(j, SIDE - 1 - i).x.into(), plain.pixel(i, j).x.into(), 1e-4);
    }
}

/// Transforms a point to the local space of an entity.
fn own(point: DVec3, translation: DVec3, rotation: DQuat, scale: DVec3) -> DVec3 {
    rotation.inverse() * (point - translation) / scale
}

fn is_second(x: f64, y: f64, size: f64) -> bool {
    ((x / size).floor() + (y / size).floor()).rem_euclid(2.0) == 1.0
}

/// Returns true in the middle of a square, and false near its edges.
fn is_clear_of_edges(x: f64, y: f64, size: f64) -> bool {
    [x, y].into_iter().all(|place| (0.01..0.99).contains(&(place / size).rem_euclid(1.0)))
}

/// Renders white and black squares from straight above (0.1, 0, 0.2), ten units wide. Returns points of the plane y = `height`, with true
/// for black.
fn squares_from_above(height: f64, shape: &str, size: f64, transform: &str) -> Vec<(DVec3, bool)> {
    const SIDE: u32 = 40;
    let film = film(&format!(
        r#"film: (width: {SIDE}, height: {SIDE}, transfer: Classic), ambient: (1, 1, 1),
        camera: (position: (0.1, {:?}, 0.2), view: (0, -1, 0), up: (0, 0, 1), screen: (distance: 100, width: 10, height: 10)),
        materials: {{ "m": (k_a: 1, pattern: Checker(color: (0, 0, 0), size: {size:?})) }},
        entities: [(shape: {shape}, material: "m", transform: ({transform}))]"#,
        height + 100.0
    ));
    let step = |index: u32| -5.0 + 10.0 * f64::from(index) / f64::from(SIDE - 1);
    let pixels = (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (i, j)));
    pixels
        .map(|(i, j)| (DVec3::new(0.1 + step(i), height, 0.2 - step(j)), film.pixel(i, j).x == 0.0))
        .collect()
}

/// Checks that squares are counted from the entity's origin, in its own units: floor(x / size) + floor(z / size) is even or odd.
#[test]
fn squares_on_a_plane_are_counted_from_its_origin() {
    let turned = DQuat::from_rotation_y(30_f64.to_radians());
    let place = DVec3::new(0.3, -0.7, 1.1);
    for (size, transform, rotation, scale) in [
        (0.5, "translation: (0.3, -0.7, 1.1)", DQuat::IDENTITY, DVec3::ONE),
        (0.8, "translation: (0.3, -0.7, 1.1), rotation: Euler(0, 30, 0)", turned, DVec3::ONE),
        (0.4, "translation: (0.3, -0.7, 1.1), scale: (2, 1, 3)", DQuat::IDENTITY, DVec3::new(2.0, 1.0, 3.0)),
        (
            0.4,
            "translation: (0.3, -0.7, 1.1), scale: (-2, 1, 3)",
            DQuat::IDENTITY,
            DVec3::new(-2.0, 1.0, 3.0),
        ),
        (
            1.0,
            "translation: (0.3, -0.7, 1.1), rotation: Euler(0, 30, 0), scale: (1, 5, 0.5)",
            turned,
            DVec3::new(1.0, 5.0, 0.5),
        ),
    ] {
        let mut counts = [0; 2];
        for (point, black) in squares_from_above(-0.7, "Plane(normal: (0, 1, 0))", size, transform) {
            let own = own(point, place, rotation, scale);
            if is_clear_of_edges(own.x, own.z, size) {
                assert_eq!(black, is_second(own.x, own.z, size), "{transform} at {point}");
                counts[usize::from(black)] += 1;
            }
        }
        assert!(counts.iter().all(|count| *count > 400), "{counts:?}");
    }
}

/// Checks that squares are counted from the lower corner of each face. The picture shows the top of a box, which is one of its sides if the
/// box is rotated.
#[test]
fn squares_on_a_box_are_counted_from_the_lower_corners_of_its_faces() {
    let half = DVec3::new(2.1, 1.5, 1.8);
    let size = 0.7;
    // Rotations that point the box's own x, y or z up, and the height and the axes of the face on top.
    for (euler, rotation, height, across) in [
        ("0, 0, 0", DQuat::IDENTITY, half.y, [0, 2]),
        ("0, 30, 0", DQuat::from_rotation_y(30_f64.to_radians()), half.y, [0, 2]),
        ("180, 0, 0", DQuat::from_rotation_x(180_f64.to_radians()), half.y, [0, 2]),
        ("0, 0, 90", DQuat::from_rotation_z(90_f64.to_radians()), half.x, [1, 2]),
        ("90, 0, 0", DQuat::from_rotation_x(90_f64.to_radians()), half.z, [0, 1]),
        ("-90, 0, 0", DQuat::from_rotation_x(-90_f64.to_radians()), half.z, [0, 1]),
    ] {
        let place = DVec3::new(0.4, 3.0, -0.3);
        let transform = format!("translation: (0.4, 3, -0.3), rotation: Euler({euler})");
        let shape = "Box(size: (4.2, 3, 3.6))";
        let mut counts = [0; 2];
        for (point, black) in squares_from_above(3.0 + height, shape, size, &transform) {
            let own = own(point, place, rotation, DVec3::ONE);
            let from_corner = own + half;
            let [x, y] = across.map(|axis| from_corner[axis]);
            let on_face = across.iter().all(|axis| own[*axis].abs() < 0.99 * half[*axis]);
            if on_face && is_clear_of_edges(x, y, size) {
                assert_eq!(black, is_second(x, y, size), "{transform} at {point}");
                counts[usize::from(black)] += 1;
            }
        }
        assert!(counts.iter().all(|count| *count > 50), "{counts:?}");
    }
}

/// Checks that a small change of the normal moves the squares a little, also where it is as near to one axis as to another.
#[test]
fn squares_follow_a_plane_whose_normal_moves() {
    const SIDE: u32 = 64;
    let squares = |normal: DVec3| {
        let body = format!(
            r#"film: (width: {SIDE}, height: {SIDE}), ambient: (1, 1, 1),
            camera: (position: (0, 9, 9), target: (0, 0, 0), up: (0, 1, 0), fov: 30),
            materials: {{ "m": (k_a: 1, pattern: Checker(color: (0, 0, 0), size: 0.6)) }},
            entities: [(shape: Plane(normal: {}), material: "m")]"#,
            triple(normal)
        );
        film(&body).pixels().iter().map(|pixel| pixel.x == 0.0).collect::<Vec<bool>>()
    };
    let from_to = [
        (DVec3::new(0.0, 1.0, 0.9), DVec3::new(0.0, 1.0, 1.1)),
        (DVec3::new(0.3, 1.0, 0.9), DVec3::new(0.3, 1.0, 1.1)),
        (DVec3::new(-0.9, 1.0, 1.2), DVec3::new(-1.1, 1.0, 1.2)),
        (DVec3::new(0.9, 0.2, 1.0), DVec3::new(1.1, 0.2, 1.0)),
    ];
    for (from, to) in from_to {
        let normals = (0..=40).map(|step| from.lerp(to, f64::from(step) / 40.0));
        let pictures: Vec<_> = normals.map(squares).collect();
        for pair in pictures.windows(2) {
            let changed = pair[0].iter().zip(&pair[1]).filter(|(one, other)| one != other).count();
            let share = changed as f64 / f64::from(SIDE * SIDE);
            assert!(share < 0.15, "{share} of all pixels change at once on the way from {from} to {to}");
        }
    }
}
