//! Tests of cameras that are attached to entities, that roll, and that alternate in shots; and of undefined views and up vectors.

use glam::{DMat3, DVec3};

use rayreel::components::{Camera, FilmSettings, FocusOn, Parent, Transform, View};
use rayreel::systems::{Fault, FaultCause, Preparation, animate, propagate};
use rayreel::{Changes, Effect, Engine, Entity, Film, Scene, Time, World, trace};

/// Returns a scene with these cameras and animations, and 3 x 3 pixels, so that one pixel is in the middle.
fn text(cameras: &str, animate: &str) -> String {
    format!(
        "Scene(
            timeline: (fps: 10, duration: 2),
            film: (width: 3, height: 3),
            sampling: (samples: 4, instants: 4),
            {cameras}
            ambient: (1, 1, 1),
            background: (bottom: (250, 20, 10), top: (10, 90, 250)),
            materials: {{ \"clay\": (k_a: 1, color: (200, 120, 60)) }},
            entities: [
                (name: \"ball\", shape: Sphere(radius: 1), material: \"clay\", transform: (translation: (0, 0, 1))),
                (name: \"car\", transform: (translation: (4, 0, -2), rotation: Euler(0, 90, 0), scale: 2)),
                (name: \"wagon\", parent: \"car\", transform: (translation: (0, 1, 0))),
            ],
            animate: [{animate}],
        )"
    )
}

fn read(text: &str) -> Scene {
    Scene::from_text("cameras.ron", text.to_owned()).unwrap_or_else(|error| panic!("{error}"))
}

fn time(tenths: u64) -> Time {
    Time::from_ratio(tenths, 10).unwrap()
}

/// The position and the axes of a camera: right, up and forward.
#[derive(Clone, Copy, Debug)]
struct CameraPose {
    eye: DVec3,
    axes: DMat3,
}

impl CameraPose {
    fn of(camera: &trace::PreparedCamera) -> Self {
        let middle = camera.towards(1, 1);
        let right = (camera.towards(2, 1) - middle).normalize();
        let up = (camera.towards(1, 0) - middle).normalize();
        let eye = camera.ray(1, 1).unwrap().origin();
        Self { eye, axes: DMat3::from_cols(right, up, middle.normalize()) }
    }

    fn at(world: &mut World, moment: Time) -> Self {
        animate(world, moment, &mut Changes::default());
        propagate(world, &Changes::all());
        Self::of(Preparation::of(world, moment).camera())
    }

    fn is_upright_frame(self) -> bool {
        let square = self.axes.transpose() * self.axes;
        self.eye.is_finite() && square.abs_diff_eq(DMat3::IDENTITY, 1e-14)
    }

    /// Returns the angle of the rotation between two cameras.
    fn turned(self, other: Self) -> f64 {
        let turn = self.axes.transpose() * other.axes;
        let trace = turn.x_axis.x + turn.y_axis.y + turn.z_axis.z;
        libm::acos(((trace - 1.0) / 2.0).clamp(-1.0, 1.0))
    }
}

fn pose(camera: &str, animate: &str, moment: Time) -> CameraPose {
    CameraPose::at(&mut read(&text(&format!("camera: ({camera}),"), animate)).world, moment)
}

fn close(found: DVec3, expected: DVec3) {
    assert!((found - expected).length() < 1e-14, "{found}, not {expected}");
}

#[test]
fn camera_with_a_parent_is_in_its_space() {
    // A rotation by +90 degrees about y takes z to x; the scale doubles lengths.
    let found =
        pose("position: (0, 0, -1), target: (0, 0, 3), up: (1, 1, 0), parent: \"wagon\"", "", time(0));
    close(found.eye, DVec3::new(2.0, 2.0, -2.0));
    close(found.axes.z_axis, DVec3::X);
    close(found.axes.y_axis, DVec3::new(0.0, 1.0, -1.0).normalize());
    let view = pose("position: (0, 0, -1), view: (0, 0, 4), up: (1, 1, 0), parent: \"wagon\"", "", time(0));
    assert_eq!((found.eye, found.axes), (view.eye, view.axes));
    // The camera moves with its parent.
    let drive = "(target: \"car\", channel: Translation, track: Keys([(0, (4, 0, -2)), (1, (14, 0, -2))]))";
    let later = pose("position: (0, 0, -1), view: (0, 0, 1), parent: \"wagon\"", drive, time(5));
    close(later.eye, DVec3::new(7.0, 2.0, -2.0));
}

#[test]
fn a_camera_follows_without_turning() {
    let found = pose("position: (0, 3, -1), target: (0, 0, 1), follow: \"wagon\"", "", time(0));
    let still = pose("position: (4, 5, -3), target: (4, 2, -1)", "", time(0));
    close(found.eye, still.eye);
    assert_eq!(found.axes, still.axes);
}

#[test]
fn a_camera_looks_at_an_entity() {
    let turn = "(target: \"ball\", channel: Translation, track: Keys([(0, (0, 0, 1)), (1, (10, 0, 1))]))";
    let found = pose("position: (0, 0, -4), look_at: \"ball\"", turn, time(5));
    close(found.axes.z_axis, DVec3::ONE.with_y(0.0).normalize());
    close(found.axes.y_axis, DVec3::Y);
}

#[test]
fn a_lens_focuses_on_an_entity() {
    let rolling = "(target: \"ball\", channel: Translation, track: Keys([(0, (0, 0, 1)), (1, (3, 0, 5))]))";
    let film = |lens: &str, moment: Time| {
        let camera = format!("camera: (position: (0, 0, -4), view: (0, 0, 1), {lens}),");
        Engine::from_scene(read(&text(&camera, rolling))).render(moment).unwrap().film
    };
    // Half-way, the ball is 7 units in front of the camera, and to its right.
    for (moment, depth) in [(time(0), 5), (time(5), 7)] {
        let focused = film("lens: (aperture: 2, focus: 1), focus_on: \"ball\"", moment);
        assert!(focused == film(&format!("lens: (aperture: 2, focus: {depth})"), moment));
        assert!(focused == film("lens: (aperture: 2), focus_on: \"ball\"", moment));
        assert!(focused != film("lens: (aperture: 2, focus: 1)", moment));
    }
    // An entity behind the camera is not in focus.
    let camera = |focus: &str| {
        let camera =
            format!("camera: (position: (0, 0, 9), view: (0, 0, 1), lens: (aperture: 2, focus: 3){focus}),");
        Engine::from_scene(read(&text(&camera, rolling))).render(time(0)).unwrap().film
    };
    assert!(camera(", focus_on: \"ball\"") == camera(""));
    for (camera, expected) in [
        ("focus_on: \"ball\"", "without a `lens` everything is in focus"),
        ("lens: (aperture: 2)", "the lens has no distance in focus"),
        ("lens: (aperture: 2, focus: 3), focus_on: \"bell\"", "there is no entity \"bell\""),
    ] {
        let camera = format!("camera: (position: (0, 0, 9), view: (0, 0, 1), {camera}),");
        let error = Scene::from_text("cameras.ron", text(&camera, "")).err().unwrap().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let pull = "(target: \"camera\", channel: Focus, track: Keys([(0, 3), (1, 5)]))";
    let camera =
        "camera: (position: (0, 0, 9), view: (0, 0, 1), lens: (aperture: 2, focus: 3), focus_on: \"ball\"),";
    let error = Scene::from_text("cameras.ron", text(camera, pull)).err().unwrap().to_string();
    assert!(error.contains("a camera with `focus_on`"), "{error}");
}

#[test]
fn focus_of_an_undefined_view_or_on_a_missing_entity_is_defined() {
    let start = |focus: &str| {
        let camera =
            format!("camera: (position: (0, 0, -4), view: (0, 0, 1), lens: (aperture: 2, focus: 1){focus}),");
        let engine = Engine::from_scene(read(&text(&camera, "")));
        let camera = engine.world().query::<(Entity, &Camera)>().iter().next().unwrap().0;
        (engine, camera)
    };
    // A camera at its own target looks along z.
    let film = |focus: &str, is_at_target: bool| {
        let (mut engine, camera) = start(focus);
        if is_at_target {
            let camera = engine.world_mut().query_one_mut::<&mut Camera>(camera).unwrap();
            camera.view = View::Target(camera.position);
        }
        engine.render(time(0)).unwrap().film
    };
    assert!(film(", focus_on: \"ball\"", true) == film(", focus_on: \"ball\"", false));
    assert!(film("", true) == film("", false) && film("", true) != film(", focus_on: \"ball\"", true));
    let (mut engine, camera) = start("");
    engine.world_mut().insert_one(camera, FocusOn(Entity::DANGLING)).unwrap();
    assert!(engine.render(time(0)).unwrap().film == film("", false));
    let is_missing = |fault: &Fault| fault.cause == FaultCause::Missing("focuses on");
    assert_eq!(engine.faults().iter().filter(|fault| is_missing(fault)).count(), 1);
}

#[test]
fn roll_turns_the_camera_to_its_left() {
    let found = pose("position: (0, 0, 0), view: (0, 0, 1), roll: 90", "", time(0));
    // As +90 degrees about z take x to y and y to -x.
    close(found.axes.x_axis, DVec3::Y);
    close(found.axes.y_axis, DVec3::NEG_X);
    let turned = pose("position: (1, 2, 3), target: (0, 1, -1), roll: 30", "", time(0));
    let straight = pose("position: (1, 2, 3), target: (0, 1, -1)", "", time(0));
    assert!(turned.is_upright_frame() && (turned.turned(straight) - 30f64.to_radians()).abs() < 1e-14);
}

const CAMERAS: &str = "camera: (position: (0, 0, -5), target: (0, 0, 0), shutter: 1),
    cameras: {
        \"side\": (position: (-6, 1, 1), look_at: \"ball\"),
        \"top\": (position: (0, 7, 1), target: (0, 0, 1), up: (0, 0, 1), shutter: 0.5),
    },";
const ROLLING: &str =
    "(target: \"ball\", channel: Translation, track: Keys([(0, (0, 0, 1)), (2, (3, 1, 1))]))";

fn alone(cameras: &str, name: &str, moment: Time) -> Film {
    let text = text(&format!("{cameras} shots: [(0, \"{name}\")],"), ROLLING);
    Engine::from_scene(read(&text)).render(moment).unwrap().film
}

#[test]
fn a_cut_belongs_to_the_frame_at_its_time_and_to_all_of_its_instants() {
    // 0.3 and 0.7 are not exact in binary, but the frames at 3/10 and 7/10 belong to their shots.
    let shots = "shots: [(0.3, \"side\"), (0.7, \"top\"), (1.15, \"camera\")],";
    let mut engine = Engine::from_scene(read(&text(&format!("{CAMERAS} {shots}"), ROLLING)));
    // The frames are out of order, to show that no state is left over from the frame before.
    for frame in [6, 7, 2, 3, 0, 11, 12, 15, 1] {
        let name = match frame {
            ..7 => "side",
            7..12 => "top",
            _ => "camera",
        };
        let moment = time(frame);
        assert!(engine.render(moment).unwrap().film == alone(CAMERAS, name, moment), "frame {frame}");
        assert!(alone(CAMERAS, "top", moment) != alone(CAMERAS, "camera", moment), "frame {frame}");
        let blurs = engine.report().plan.as_ref().unwrap().needs(Effect::MotionBlur);
        assert_eq!(blurs, name != "side", "frame {frame}");
    }
}

#[test]
fn first_camera_renders_without_shots() {
    let film =
        |cameras: &str| Engine::from_scene(read(&text(cameras, ROLLING))).render(time(4)).unwrap().film;
    assert!(film(CAMERAS) == alone(CAMERAS, "camera", time(4)));
    let more = CAMERAS.split_once('\n').unwrap().1;
    assert!(film(more) == alone(CAMERAS, "side", time(4)));
}

/// Checks the angle between the outer borders of the pixels, which are square, and that the same view can be written either way.
#[test]
fn fields_of_view_span_the_borders_of_the_pixels() {
    for (width, height) in [(3, 3), (8, 3), (3, 8), (1, 5)] {
        let camera = |projection: &str| {
            let text = format!(
                "(film: (width: {width}, height: {height}), camera: (position: (0, 0, 0), view: (0, 0, 1), {projection}))"
            );
            *Preparation::of(&mut read(&text).world, time(0)).camera()
        };
        let wide = camera("horizontal_fov: 80");
        let steps =
            [wide.towards(width.min(2) - 1, 1) - wide.towards(0, 1), wide.towards(0, 0) - wide.towards(0, 1)];
        let pitch = steps[1].y;
        assert!(width == 1 || (steps[0].x - pitch).abs() < 1e-15);
        let right = wide.towards(width - 1, 0).x + 0.5 * pitch;
        assert!((libm::atan(right).to_degrees() - 40.0).abs() < 1e-13, "{right}");
        // The vertical angle of the same view.
        let vertical = 2.0 * libm::atan(f64::from(height) / f64::from(width) * libm::tan(40f64.to_radians()));
        let high = camera(&format!("fov: {:?}", vertical.to_degrees()));
        for (i, j) in [(0, 0), (width - 1, height - 1)] {
            assert!(high.towards(i, j).distance(wide.towards(i, j)) < 1e-14);
        }
    }
}

#[test]
fn undefined_views_and_up_directions_have_fixed_fallbacks() {
    let at = |camera: Camera| {
        let mut world = World::new();
        world.spawn((camera,));
        world.spawn((FilmSettings::new(3, 3),));
        let pose = CameraPose::at(&mut world, time(0));
        assert!(pose.is_upright_frame(), "{camera:?}: {pose:?}");
        pose
    };
    let here = DVec3::new(3.0, -1e9, 0.1);
    let looking = |view, up| at(Camera { position: here, view, up, ..Camera::default() });
    let lost = looking(View::Target(here), DVec3::Y);
    assert_eq!((lost.axes.z_axis, lost.axes.y_axis), (DVec3::Z, DVec3::Y));
    let none = looking(View::Direction(DVec3::ZERO), DVec3::ZERO);
    assert_eq!((none.axes.z_axis, none.axes.y_axis), (DVec3::Z, DVec3::Y));
    let down = looking(View::Direction(DVec3::NEG_Y), DVec3::Y);
    assert_eq!((down.axes.z_axis, down.axes.y_axis), (DVec3::NEG_Y, DVec3::Z));
    let up = looking(View::Direction(DVec3::Y * 1e-200), DVec3::Y * 1e200);
    assert_eq!((up.axes.z_axis, up.axes.y_axis), (DVec3::Y, DVec3::Z));
    let along = looking(View::Direction(DVec3::X), DVec3::NEG_X);
    assert_eq!((along.axes.z_axis, along.axes.y_axis), (DVec3::X, DVec3::Y));
    for tiny in [1e-300, 1e-30, 1e-13, 1e-12, 1e-11, 1e-9] {
        looking(View::Direction(DVec3::new(tiny, -1.0, 0.0)), DVec3::Y);
        looking(View::Target(here + DVec3::new(tiny, 0.0, tiny)), DVec3::Y);
    }
}

#[test]
fn missing_and_cyclic_parents_still_render() {
    let mut world = World::new();
    let camera = Camera { position: DVec3::X, view: View::Direction(DVec3::Z), ..Camera::default() };
    world.spawn((FilmSettings::new(3, 3),));
    let entity = world.spawn((camera,));
    let other = world.spawn((Transform::from_translation(DVec3::Y), Parent(entity)));
    for parent in [other, Entity::DANGLING, entity] {
        world.insert_one(entity, Parent(parent)).unwrap();
        let pose = CameraPose::at(&mut world, time(0));
        assert!(pose.is_upright_frame());
        close(pose.eye, DVec3::X);
    }
}

/// Checks the rotation of the camera between frames. Away from the axis of `up`, it is little more than the rotation of the view. Over the
/// top, the camera turns by half a turn at once, unless `up` is an axis that the path does not cross.
#[test]
fn neighbouring_frames_turn_with_the_path() {
    let steps = |up: DVec3, place: &dyn Fn(f64) -> DVec3| -> Vec<(f64, f64)> {
        let stances: Vec<CameraPose> = (0..=400)
            .map(|step| {
                let mut world = World::new();
                let position = place(f64::from(step) / 400.0 * 2.0 - 1.0);
                world.spawn((Camera { position, view: View::Target(DVec3::ZERO), up, ..Camera::default() },));
                world.spawn((FilmSettings::new(3, 3),));
                CameraPose::at(&mut world, time(0))
            })
            .collect();
        assert!(stances.iter().all(|pose| pose.is_upright_frame()));
        let turns = stances.windows(2).map(|pair| {
            let view = pair[0].axes.z_axis.angle_between(pair[1].axes.z_axis);
            (view, pair[0].turned(pair[1]))
        });
        turns.collect()
    };
    // A round flight through the target's height, at most 45 degrees from the horizon.
    let round = |s: f64| DVec3::new(libm::cos(3.1 * s), 0.7 * libm::sin(6.2 * s), libm::sin(3.1 * s)) * 5.0;
    for (view, turn) in steps(DVec3::Y, &round) {
        assert!(turn < 1.5 * view + 1e-6, "{turn} of {view}");
    }
    // A path straight over the target, with its highest point in one of the frames.
    let over = |s: f64| DVec3::new(0.0, libm::cos(2.0 * s), libm::sin(2.0 * s)) * 5.0;
    let jumps = |up| steps(up, &over).into_iter().filter(|(view, turn)| *turn > 1.5 * view + 1e-6).count();
    assert_eq!(jumps(DVec3::Y), 1);
    assert_eq!(jumps(DVec3::X), 0);
    // A path through the target, where the view itself makes half a turn.
    let through = |s: f64| DVec3::new(5.0 * s, 0.0, 0.0);
    let turned = steps(DVec3::Y, &through).into_iter().filter(|(_, turn)| *turn > 1e-6).count();
    assert_eq!(turned, 2);
}
