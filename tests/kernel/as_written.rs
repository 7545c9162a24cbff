//! Tests that boxes written as flush are flush, and that quarter turns are exact, to the last bit, in the world and in the picture.

use glam::{DAffine3, DVec3};
use rayreel::components::{Name, WorldTransform};
use rayreel::{Engine, Ray, Time};

fn engine(scene: &str) -> Engine {
    let mut engine = crate::engine(scene);
    engine.seek(Time::ZERO).unwrap();
    engine
}

fn placed(engine: &Engine, name: &str) -> DAffine3 {
    let world = engine.world();
    let mut placed = world.query::<(&Name, &WorldTransform)>();
    placed.iter().find(|(found, _)| found.0 == name).unwrap().1.affine
}

/// Returns the name of the entity that a ray hits.
fn seen(engine: &Engine, origin: DVec3, direction: DVec3) -> String {
    let hit = engine.cast(Ray { origin, direction }).unwrap();
    engine.world().get::<&Name>(hit.entity).unwrap().0.clone()
}

/// Formats tenths as a decimal number.
fn tenths(count: u32) -> String {
    format!("{}.{}", count / 10, count % 10)
}

/// Formats twentieths as a decimal number.
fn twentieths(count: u32) -> String {
    format!("{}.{:02}", count / 20, count % 20 * 5)
}

/// Returns a glass cube on a table, in either document order, in one group. The table's thickness, the height of its middle, and the size
/// of the cube are in tenths.
fn stack(glass_first: bool, [table, place, glass]: [u32; 3], group: &str, turn: &str) -> String {
    let (middle, above) = (tenths(place), twentieths(2 * place + table + glass));
    let (table, glass) = (tenths(table), tenths(glass));
    let wood = format!(
        r#"(name: "wood", parent: "group", material: "wood", shape: Box(size: (1.7, {table}, 1.3)), transform: (translation: (0.1, {middle}, 0.2)))"#
    );
    let cube = format!(
        r#"(name: "glass", parent: "group", material: "glass", shape: Box(size: ({glass}, {glass}, {glass})),
            transform: (translation: (0.3, {above}, 0.1), rotation: {turn}))"#
    );
    let (first, second) = if glass_first { (cube, wood) } else { (wood, cube) };
    format!(
        r#"Scene(camera: (position: (0, 2, -8), target: (0, 0, 0)), materials: {{
            "wood": (k_d: 0.8), "glass": (refractive: (k_t: 0.9, ior: 1.5)) }}, entities: [
            (name: "group", transform: ({group})), {first}, {second}])"#
    )
}

/// Checks that the cube and the table touch exactly. A ray down through the glass must hit the table even if the glass comes first: there
/// is no gap. A ray up through the table must hit the table if it comes first: there is no overlap.
fn assert_flush(sizes: [u32; 3], group: &str, turn: &str) {
    let [table, _, glass] = sizes.map(f64::from);
    let apart = (table + glass) / 20.0;
    for glass_first in [true, false] {
        let engine = engine(&stack(glass_first, sizes, group, turn));
        let down = placed(&engine, "group").matrix3 * DVec3::NEG_Y;
        let glass = placed(&engine, "glass").translation;
        for aside in [DVec3::ZERO, DVec3::new(1e-2, 0.0, 2e-2), DVec3::new(-2e-2, 0.0, 1e-2)] {
            let (origin, along) = if glass_first { (glass, down) } else { (glass + down * apart, -down) };
            assert_eq!(
                seen(&engine, origin, along + aside),
                "wood",
                "{sizes:?} {group} {turn} {glass_first}"
            );
        }
    }
}

/// Checks that every stack of decimal sizes has neither a gap nor an overlap.
#[test]
fn decimal_stacks_are_flush() {
    for table in 1..=9 {
        for place in 1..=9 {
            for glass in 1..=9 {
                assert_flush([table, place, glass], "", "Euler(0, 0, 0)");
            }
        }
    }
}

/// Checks stacks whose cube is rotated on the table, in groups that are translated, rotated, tilted or scaled, separately or combined.
#[test]
fn moved_stacks_stay_flush() {
    let groups = [
        "translation: (0.1, 0.7, 3.3)",
        "translation: (1000.1, -77.7, 3.3), scale: 0.3",
        "rotation: Euler(0, 33, 0), translation: (0.1, 0.2, 0.3)",
        "rotation: Euler(90, 0, 0), translation: (0.1, 0.2, 0.3)",
        "rotation: Euler(180, 0, 90), scale: (1, 0.7, -1.1)",
        "rotation: Euler(10, 20, 30)",
        "rotation: Euler(10, 20, 30), translation: (12.3, -4.5, 6.7), scale: (0.7, 1.1, 2.3)",
        "rotation: AxisAngle((1, 2, 3), 77), translation: (100.1, 200.2, 300.3)",
        "rotation: Quat(0.1, 0.2, 0.3, 0.4), translation: (0.3, 0.3, 0.3)",
    ];
    let turns =
        ["Euler(0, 0, 0)", "Euler(0, 90, 0)", "Euler(0, 30, 0)", "Euler(0, 180, 180)", "Euler(90, 45, 0)"];
    let mut sizes = (0..).map(|step: u32| [1 + step % 9, 1 + step / 2 % 9, 1 + step / 3 % 9]);
    for group in groups {
        for turn in turns {
            // Some cubes are sheared, by a non-uniform scale and a rotation about another axis than the group's.
            for _ in 0..20 {
                assert_flush(sizes.next().unwrap(), group, turn);
            }
        }
    }
}

/// Checks that a gap between faces stays, however small it is.
#[test]
fn separate_faces_stay_separate() {
    for apart in ["1e-15", "3e-16", "1e-12"] {
        let place = 1.0 + apart.parse::<f64>().unwrap();
        assert!(place > 1.0);
        let engine = engine(&format!(
            r#"Scene(camera: (position: (0, 2, -8), target: (0, 0, 0)), materials: {{
                "wood": (k_d: 0.8), "glass": (refractive: (k_t: 0.9, ior: 1.5)) }}, entities: [
                (name: "glass", material: "glass", shape: Box(size: (1, 1, 1)), transform: (translation: (0, {place}, 0))),
                (name: "wood", material: "wood", shape: Box(size: (1, 1, 1)))])"#
        ));
        assert_eq!(seen(&engine, DVec3::new(0.1, 1.0, 0.1), DVec3::NEG_Y), "glass", "{apart}");
    }
}

/// Renders a box, a cube and a plane with the same rotation.
fn picture(rotation: &str, size: [&str; 3], normal: [i32; 3]) -> Vec<[f32; 3]> {
    let ([a, b, c], [x, y, z]) = (size, normal);
    let mut engine = engine(&format!(
        r#"Scene(film: (width: 48, height: 30), camera: (position: (3, 4, -7), target: (0, 0, 0), fov: 40), ambient: (0.3, 0.3, 0.3),
            quality: (depth: 4), materials: {{ "m": (k_a: 0.5, k_d: 0.7, color: (200, 90, 40)), "g": (reflective: (k_r: 0.3), refractive: (k_t: 0.6, ior: 1.4)) }},
            entities: [
                (material: "m", shape: Box(size: ({a}, {b}, {c})), transform: (rotation: {rotation})),
                (material: "g", shape: Box(size: (1.3, 1.3, 1.3)), transform: (translation: (1.7, 0.4, -1.2), rotation: {rotation})),
                (material: "m", shape: Plane(normal: ({x}, {y}, {z})), transform: (translation: (0.5, -3, 5), rotation: {rotation})),
                (light: Point(intensity: (1, 1, 1)), transform: (translation: (4, 6, -5))),
            ])"#
    ));
    let film = engine.render_frame(0).unwrap();
    film.pixels().iter().map(glam::Vec3::to_array).collect()
}

/// Checks that shapes rotated by quarter turns are bit for bit equal to shapes written in the rotated positions.
#[test]
fn quarter_and_half_turns_are_exact() {
    const SIZES: [&str; 3] = ["1.1", "0.7", "2.3"];
    let quarter = |axis: usize, [x, y, z]: [i32; 3]| match axis {
        0 => [x, -z, y],
        1 => [z, y, -x],
        _ => [-y, x, z],
    };
    let turned = |angles: [i32; 3], vector: [i32; 3]| {
        (0..3).fold(vector, |vector, axis| {
            (0..angles[axis].rem_euclid(4)).fold(vector, |v, _| quarter(axis, v))
        })
    };
    for angles in (0..64).map(|index| [index % 4 - 1, index / 4 % 4 + 3, index / 16 - 2]) {
        let [x, y, z] = angles.map(|quarters| 90 * quarters);
        let images = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|axis| turned(angles, axis));
        let along = |world: usize| SIZES[images.iter().position(|image| image[world] != 0).unwrap()];
        let expected = picture("Euler(0, 0, 0)", [along(0), along(1), along(2)], turned(angles, [0, 0, -1]));
        assert!(
            picture(&format!("Euler({x}, {y}, {z})"), SIZES, [0, 0, -1]) == expected,
            "Euler({x}, {y}, {z})"
        );
        let one = angles.iter().filter(|quarters| **quarters % 4 != 0).count() == 1;
        if let Some(axis) = angles.iter().position(|quarters| quarters % 4 != 0).filter(|_| one) {
            let direction = ["(3.3, 0, 0)", "(0, 49, 0)", "(0, 0, 1e-7)"][axis];
            let rotation = format!("AxisAngle({direction}, {})", 90 * angles[axis]);
            assert!(picture(&rotation, SIZES, [0, 0, -1]) == expected, "{rotation}");
        }
    }
}

/// Checks that rotations are exact at keys of quarter turns, after the last key, and in the middle of half a turn.
#[test]
fn keys_of_quarter_turns_are_exact() {
    let mut engine = engine(
        r#"Scene(timeline: (fps: 1, duration: 9), camera: (position: (0, 2, -8), target: (0, 0, 0)), materials: { "m": () },
            entities: [(name: "box", material: "m", shape: Box(size: (1.1, 0.7, 2.3)))],
            animate: [(target: "box", channel: Rotation, track: Keys([
                (0, Euler(0, 0, 0)), (1, Euler(0, 90, 0)), (2, Euler(0, 180, 0)), (3, Euler(90, 180, 0)), (4, AxisAngle((0, 0, 7), -90)),
                (5, Euler(0, 0, 0)), (7, Euler(180, 0, 0))]))])"#,
    );
    for frame in 0..9 {
        engine.seek(Time::from_ratio(frame, 1).unwrap()).unwrap();
        let affine = placed(&engine, "box");
        let whole = affine.matrix3.to_cols_array().iter().all(|part| [-1.0, 0.0, 1.0].contains(part));
        assert!(whole, "frame {frame}: {affine}");
    }
}
