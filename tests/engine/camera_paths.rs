//! Tests of cameras on paths and orbits, from the text of a scene to its frames.

use glam::DVec3;

use rayreel::components::WorldTransform;
use rayreel::{Engine, Scene, Time};

/// Returns an engine with a moving camera, at 24 frames per second.
fn engine(duration: f64, animate: &str) -> Engine {
    let text = format!(
        "Scene(
            timeline: (fps: 24, duration: {duration}),
            film: (width: 16, height: 9),
            camera: (position: (0, 2, -8), target: (0, 1, 0)),
            animate: [ {animate} ],
        )"
    );
    Engine::from_scene(Scene::from_text("moving.ron", text).unwrap())
}

/// Returns the position of the camera in each frame.
fn eyes(engine: &mut Engine) -> Vec<DVec3> {
    let timeline = engine.timeline;
    let eye = |frame| {
        engine.seek(timeline.time_of(frame)).unwrap();
        engine.prepared().unwrap().camera().position()
    };
    (0..timeline.frame_count()).map(eye).collect()
}

const UNEVEN: &str = "(0, 2, -8), (9, 2.5, -7), (9.2, 2.5, -6.9), (9, 3, 4), (-2, 8, 6), (-2.5, 7, 5)";

#[test]
fn frames_of_a_path_are_equally_far_apart() {
    let path =
        format!("(target: \"camera\", channel: Position, track: Path(points: [{UNEVEN}], duration: 400))");
    let eyes = eyes(&mut engine(400.0, &path));
    assert_eq!(eyes.len(), 9600);
    let steps: Vec<f64> = eyes.windows(2).map(|pair| pair[0].distance(pair[1])).collect();
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    for (frame, step) in steps.iter().enumerate() {
        assert!((step / mean - 1.0).abs() < 1e-3, "frame {frame}: {step} of {mean}");
    }
    assert_eq!(eyes[0], DVec3::new(0.0, 2.0, -8.0));
}

#[test]
fn a_speed_is_in_units_per_second() {
    let path =
        format!("(target: \"camera\", channel: Position, track: Path(points: [{UNEVEN}], speed: 0.125))");
    let eyes = eyes(&mut engine(100.0, &path));
    for pair in eyes.windows(2) {
        let speed = 24.0 * pair[0].distance(pair[1]);
        assert!((speed / 0.125 - 1.0).abs() < 1e-3, "{speed}");
    }
}

#[test]
fn a_closed_path_loops_without_a_doubled_frame_and_without_a_kink() {
    let path = format!(
        "(target: \"camera\", channel: Position, repeat: Loop, track: Path(points: [{UNEVEN}], closed: true, duration: 20))"
    );
    let mut engine = engine(60.0, &path);
    let eyes = eyes(&mut engine);
    let mean = eyes.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f64>() / (eyes.len() - 1) as f64;
    for (frame, eye) in eyes.iter().enumerate().skip(480) {
        assert!(eye.distance(eyes[frame - 480]) < 1e-9, "frame {frame}");
    }
    for seam in [480, 960_usize] {
        let [before, at, after] = [seam - 1, seam, seam + 1].map(|frame| eyes[frame]);
        assert!(
            (at.distance(before) / mean - 1.0).abs() < 0.01 && (after.distance(at) / mean - 1.0).abs() < 0.01
        );
        // There the path turns by less than ten degrees, as between the frames around it.
        assert!((at - before).angle_between(after - at) < 10_f64.to_radians());
    }
}

#[test]
fn an_eased_path_starts_and_comes_to_rest() {
    let path = "(target: \"camera\", channel: Position,
        track: Path(points: [(0, 0, 0), (6, 0, 8)], start: 1, duration: 4, ease: InOutSine))";
    for (frame, eye) in eyes(&mut engine(6.0, path)).into_iter().enumerate() {
        let u = ((frame as f64 / 24.0 - 1.0) / 4.0).clamp(0.0, 1.0);
        let expected = 10.0 * (0.5 - 0.5 * libm::cos(std::f64::consts::PI * u));
        assert!((eye.length() - expected).abs() < 1e-11, "frame {frame}: {}", eye.length());
    }
}

#[test]
fn an_orbit_ends_where_it_began_to_the_last_bit() {
    let orbit = "(target: \"camera\", channel: Position,
        track: Orbit(center: (1, 2, 3), radius: 5, axis: (0.1, 2, 0.3), from: 33, turns: -2, start: 0.5, duration: 3, height: 1))";
    let eyes = eyes(&mut engine(5.0, orbit));
    assert_eq!(eyes[12], eyes[12 + 72]);
    assert_eq!(eyes[0], eyes[119]);
    assert!(eyes[12].distance(eyes[13]) > 0.1 && eyes[30].distance(eyes[48]) > 1.0);
    for eye in eyes {
        assert!(((eye - DVec3::new(1.0, 2.0, 3.0)).length() - 26_f64.sqrt()).abs() < 1e-13);
    }
}

#[test]
fn orbits_turn_from_z_to_x_about_y() {
    let orbit = "(target: \"camera\", channel: Position, track: Orbit(center: (0, 1, 0), radius: 8, from: 180, duration: 4))";
    let eyes = eyes(&mut engine(4.0, orbit));
    let expected = [(0.0, -8.0), (-8.0, 0.0), (0.0, 8.0), (8.0, 0.0)];
    for (second, (x, z)) in expected.into_iter().enumerate() {
        assert_eq!(eyes[24 * second], DVec3::new(x, 1.0, z));
    }
}

/// Checks that `repeat`, `offset` and `speed` apply to paths, too.
#[test]
fn paths_repeat_like_keys() {
    let keys = "track: Keys([(1, (0, 0, 0)), (3, (4, 0, 0))])";
    let path = "track: Path(points: [(0, 0, 0), (4, 0, 0)], start: 1, duration: 2)";
    for played in
        ["", "repeat: Loop", "repeat: PingPong, offset: 0.5", "repeat: PingPong, speed: -0.75, offset: 2"]
    {
        let with = |track| format!("(target: \"camera\", channel: Position, {track}, {played})");
        let [keyed, way] = [keys, path].map(|track| eyes(&mut engine(9.0, &with(track))));
        for (frame, (keyed, way)) in keyed.iter().zip(way).enumerate() {
            assert!(keyed.distance(way) < 1e-14, "{played}, frame {frame}: {keyed} {way}");
        }
    }
}

#[test]
fn entities_and_targets_follow_paths() {
    let text = "Scene(
        timeline: (fps: 24, duration: 4),
        film: (width: 16, height: 9),
        camera: (position: (0, 0, -8), target: (0, 0, 0)),
        materials: { \"clay\": (k_a: 1) },
        entities: [ (name: \"ball\", shape: Sphere(radius: 1), material: \"clay\") ],
        animate: [
            (target: \"ball\", channel: Translation, track: Orbit(center: (0, 0, 0), radius: 3, duration: 4)),
            (target: \"camera\", channel: Target, track: Path(points: [(0, 0, 3), (0, 3, 0)], duration: 4)),
        ],
    )";
    let mut engine = Engine::from_scene(Scene::from_text("ways.ron", text.to_owned()).unwrap());
    engine.seek("1".parse().unwrap()).unwrap();
    let ray = rayreel::Ray { origin: DVec3::new(9.0, 0.0, 0.0), direction: DVec3::NEG_X };
    assert!((engine.cast(ray).unwrap().distance - 5.0).abs() < 1e-14);
    let expected = (DVec3::new(0.0, 0.75, 2.25) - DVec3::new(0.0, 0.0, -8.0)).normalize();
    assert!(engine.prepared().unwrap().camera().axes()[2].distance(expected) < 1e-14);
}

/// Checks that targets stay at the end of their tracks, and that the view of a camera at rest then turns no further.
#[test]
fn targets_stay_at_the_end_of_their_paths() {
    for track in [
        "Path(points: [(0, 1, 0), (3, 1, 2), (6, 1, 1)], duration: 2)",
        "Path(points: [(0, 1, 0), (3, 1, 2), (6, 1, 1)], duration: 2, ease: InOutSine)",
        "Path(points: [(0, 1, 0), (3, 1, 2), (6, 1, 1)], speed: 3.3)",
        "Orbit(center: (0, 1, 0), radius: 2, turns: 0.3, duration: 2)",
        "Keys([(0, (0, 1, 0), Cubic), (1, (3, 1, 2), Cubic), (2, (6, 1, 1))])",
    ] {
        let mut engine = engine(6.0, &format!("(target: \"camera\", channel: Target, track: {track})"));
        let timeline = engine.timeline;
        let mut view = |frame| {
            engine.seek(timeline.time_of(frame)).unwrap();
            engine.prepared().unwrap().camera().axes()[2]
        };
        let views: Vec<DVec3> = (0..timeline.frame_count()).map(&mut view).collect();
        let held = views[143];
        let turning: Vec<usize> = (0..144).filter(|frame| views[*frame] != held).collect();
        let last = turning.last().copied().unwrap();
        assert!((20..72).contains(&last), "{track}: {last}");
        // The last step is about as large as the step before, or smaller.
        let turn = |frame: usize| views[frame].angle_between(views[frame + 1]);
        assert!(turn(last) <= 1.5 * turn(last - 1), "{track}: {} {}", turn(last), turn(last - 1));
    }
}

/// Checks views along paths and orbits against constant views, and that entities turn alike.
#[test]
fn cameras_and_entities_look_along_their_ways() {
    let scene = |track: &str| {
        let text = format!(
            "(timeline: (fps: 10, duration: 4), camera: (position: (0, 0, 0), view: (0, 0, 1)),
            entities: [(name: \"car\"), (name: \"wheel\", parent: \"car\", transform: (translation: (0, 0, 1)))],
            animate: [
                (target: \"camera\", channel: View, track: Along),
                (target: \"camera\", channel: Position, track: {track}),
                (target: \"car\", channel: Translation, track: {track}),
                (target: \"car\", channel: Rotation, track: Along),
            ])"
        );
        Engine::from_scene(Scene::from_text("along.ron", text).unwrap_or_else(|error| panic!("{error}")))
    };
    let directions = |engine: &mut Engine, tenths: u64| {
        engine.seek(Time::from_ratio(tenths, 10).unwrap()).unwrap();
        let axes = engine.prepared().unwrap().camera().axes();
        let car = crate::named(engine, "car");
        let car = engine.world().get::<&WorldTransform>(car).unwrap().affine.matrix3;
        for (own, axis) in axes.into_iter().zip([car.x_axis, car.y_axis, car.z_axis]) {
            assert!(own.distance(axis) < 1e-14, "{own} {axis}");
        }
        axes[2]
    };
    let mut square = scene("Path(points: [(0, 0, 0), (2, 0, 0)], start: 1, duration: 2), repeat: PingPong");
    for (tenths, expected) in [(10, DVec3::X), (20, DVec3::X), (30, DVec3::NEG_X), (40, DVec3::NEG_X)] {
        assert!(directions(&mut square, tenths).distance(expected) < 1e-14, "{tenths}");
    }
    let mut round = scene("Orbit(center: (1, 2, 3), radius: 2, turns: -1, duration: 4)");
    for (tenths, expected) in [(0, DVec3::NEG_X), (10, DVec3::NEG_Z), (20, DVec3::X), (30, DVec3::Z)] {
        assert!(directions(&mut round, tenths).distance(expected) < 1e-14, "{tenths}");
    }
    let mut still = scene("Path(points: [(0, 1, 0)], duration: 2)");
    assert_eq!(directions(&mut still, 10), DVec3::Z);
    // Any frame alone has the value of the sequence.
    let mut curve = scene("Path(points: [(0, 0, 0), (2, 1, 0), (3, 0, 5), (0, 2, 7)], duration: 3)");
    let all: Vec<DVec3> = (0..40).map(|tenths| directions(&mut curve, tenths)).collect();
    assert!(
        (0..40).rev().all(|tenths| directions(&mut curve, tenths) == all[usize::try_from(tenths).unwrap()])
    );
    assert!(all[30] == all[39] && all[0] != all[15]);
}
