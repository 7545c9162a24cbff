//! Tests of the camera, which is moved by the pointer and by keys, and of its keys in the file.

use std::fs;
use std::thread::sleep;
use std::time::Duration;

use rayreel::color::Transfer;
use rayreel::output::encode_quickly;
use rayreel::{Engine, Scene};
use serde_json::json;

use crate::browser::Browser;
use crate::{Preview, SCENE, open, settle, until};

const CAMERA: &str = "camera: (position: (0, 0, -5), target: (0, 0, 0))";
const ANIMATE: &str = "animate: [";

fn file(preview: &Preview) -> String {
    fs::read_to_string(preview.folder.path().join("ball.ron")).unwrap()
}

/// Waits until the view is tried and shown.
fn tried(browser: &Browser) {
    until(
        browser,
        "state.edits.tried.length > 0 && trying === null && shown.full && shown.reloads === state.reloads",
    );
}

fn keep(browser: &Browser) {
    tried(browser);
    let undoable = browser.evaluate("state.edits.undoable");
    browser.press('k');
    until(
        browser,
        &format!("state.edits.tried.length === 0 && state.edits.undoable === {undoable} + 1 && shown.full"),
    );
}

/// Shows a frame, and waits for its picture.
fn seek(browser: &Browser, frame: u32) {
    browser.evaluate(&format!("(seek({frame}), true)"));
    until(browser, &format!("shown.full && shown.frame === {frame} && requested === null"));
}

/// Returns the numbers of the vector after some text.
fn vector_after(text: &str, before: &str) -> [f64; 3] {
    let rest = text.split(before).nth(1).unwrap_or_else(|| panic!("{before} in {text}"));
    let numbers = rest.trim_start_matches('(').split(')').next().unwrap();
    let numbers: Vec<f64> = numbers.split(", ").map(|number| number.parse().unwrap()).collect();
    numbers.try_into().unwrap()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]) * (a[axis] - b[axis])).sum::<f64>().sqrt()
}

#[test]
fn view_of_an_animated_camera_becomes_keys() {
    let tracks = "animate: [
        (target: \"camera\", channel: Position, track: Keys([
            (0, (0, 0, -5)), // start
            (1, (0, 0, -6), Hold),
        ])),
        (target: \"camera\", channel: Target, track: Keys([(0, (0, 0, 0)), (1.5, (0, 0, 1))])),
        ";
    let scene = SCENE.replace(ANIMATE, tracks).replace("fps: 10", "fps: 24");
    let preview = Preview::of(&scene);
    let Some(browser) = open(&preview) else { return };
    settle(&browser);

    // A frame with a key of the position: its value changes. The target gets a key.
    seek(&browser, 24);
    let before = browser.evaluate("at('now').src");
    browser.drag("#film", (60, 0));
    tried(&browser);
    assert_ne!(browser.evaluate("at('now').src"), before);
    assert_eq!(file(&preview), scene);
    let view = browser.evaluate("currentView()");
    keep(&browser);
    let first = file(&preview);
    let position = vector_after(&first, "// start\n            (1, ");
    let text = |[x, y, z]: [f64; 3]| format!("({x}, {y}, {z})");
    let expected = scene.replace("(1, (0, 0, -6), Hold)", &format!("(1, {}, Hold)", text(position)));
    let target = "(0, (0, 0, 0)), (1, (0, 0, 0.6666667)), (1.5, (0, 0, 1))";
    let expected = expected.replace("(0, (0, 0, 0)), (1.5, (0, 0, 1))", target);
    assert_eq!(first, expected);
    assert!((distance(position, [0.0, 0.0, 2.0 / 3.0]) - 20.0 / 3.0).abs() < 1e-5 && position[0] < -0.5);
    // The picture was that of the view.
    let seen: [f64; 3] = serde_json::from_value(view["position"].clone()).unwrap();
    assert!(distance(seen, position) < 1e-6, "{seen:?} {position:?}");

    // A frame whose time has no exact decimal number, in two tries and after a look at another frame: a new key, which applies to this
    // frame though the value before is held.
    seek(&browser, 31);
    browser.drag("#film", (0, 40));
    tried(&browser);
    seek(&browser, 3);
    seek(&browser, 31);
    let reloads = browser.evaluate("state.reloads");
    browser.drag("#film", (0, 20));
    until(&browser, &format!("state.reloads > {reloads}"));
    tried(&browser);
    let view = browser.evaluate("currentView()");
    keep(&browser);
    let second = file(&preview);
    assert_eq!(second.matches("(1.291666, ").count(), 2, "{second}");
    let position = vector_after(&second, "Hold),\n            (1.291666, ");
    let seen: [f64; 3] = serde_json::from_value(view["position"].clone()).unwrap();
    assert!(distance(seen, position) < 1e-6 && position[1] > 1.0, "{seen:?} {position:?}");
    // One step takes back both keys.
    browser.click("#undo");
    until(&browser, "state.edits.undoable === 1 && shown.full");
    assert_eq!(file(&preview), first);
    browser.click("#undo");
    until(&browser, "state.edits.undoable === 0 && shown.full");
    assert_eq!(file(&preview), scene);
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn cameras_with_few_tracks_and_ties() {
    let animated = |camera: &str, tracks: &str| {
        SCENE.replace(CAMERA, camera).replace(ANIMATE, &format!("{ANIMATE}{tracks}"))
    };
    // A track of the position alone, of a camera with a direction.
    let keys = "(target: \"side\", channel: Position, offset: 0.5, speed: 2, track: Keys([(0, (0, 0, -5)), (2, (0, 0, -6))])), ";
    let scene = animated("cameras: { \"side\": (position: (0, 0, -5), view: (0, 0, 2)) }", keys);
    let preview = Preview::of(&scene);
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    seek(&browser, 10);
    browser.drag("#film", (0, -60));
    keep(&browser);
    let kept = file(&preview);
    let (position, view) = (vector_after(&kept, ", (1, ("), vector_after(&kept, "view: "));
    let [position, view] = [position, view].map(|[x, y, z]| format!("({x}, {y}, {z})"));
    let expected = scene.replace("view: (0, 0, 2)", &format!("view: {view}"));
    assert_eq!(kept, expected.replace(", (2, (0, 0, -6))", &format!(", (1, {position}), (2, (0, 0, -6))")));
    assert!(vector_after(&kept, "view: ")[1] > 0.5, "from below: {view}");

    // What cannot be moved is only looked at from elsewhere, and says why.
    let orbit =
        "(target: \"camera\", channel: Position, track: Orbit(center: (0, 0, 0), radius: 5, duration: 2)), ";
    let looped = "(target: \"camera\", channel: Position, repeat: Loop, track: Keys([(0.2, (0, 0, -5)), (0.5, (0, 0, -6))])), ";
    for (reload, (scene, reason)) in [
        (animated(CAMERA, orbit), "the Position of this camera is not animated by keys in the scene file"),
        (animated(CAMERA, looped), "the keys of Position repeat"),
        (
            animated("camera: (position: (0, 0, -5), look_at: \"ball\")", ""),
            "`look_at` ties this camera to `ball`",
        ),
        (
            animated("camera: (position: (0, 0, -5), target: (0, 0, 0), follow: \"ball\")", ""),
            "`follow` ties this camera to `ball`",
        ),
        (
            animated("camera: (position: (0, 0, -5), target: (0, 0, 0), parent: \"ball\")", ""),
            "`parent` ties this camera to `ball`",
        ),
    ]
    .into_iter()
    .enumerate()
    {
        let reloads = browser.evaluate("state.reloads");
        preview.save(&scene);
        until(
            &browser,
            &format!("state.reloads > {reloads} && shown.full && shown.reloads === state.reloads"),
        );
        browser.evaluate("(write(at('refused'), ''), true)");
        let eye = browser.evaluate("currentView().then(view => view.position)");
        browser.drag("#film", (40, 0));
        until(&browser, &format!("state.edits.look?.startsWith({reason:?}) && !at('unsaved').hidden"));
        until(&browser, "trying === null && shown.full && shown.reloads === state.reloads");
        assert_ne!(browser.evaluate("currentView().then(view => view.position)"), eye, "{reload}");
        browser.press('k');
        until(&browser, &format!("at('refused').textContent.startsWith({reason:?})"));
        assert_eq!((browser.evaluate("state.edits.tried"), file(&preview)), (json!([]), scene), "{reload}");
        browser.click("#drop");
        until(&browser, "state.edits.look === null && at('unsaved').hidden");
        assert_eq!(browser.evaluate("currentView().then(view => view.position)"), eye, "{reload}");
    }
}

#[test]
fn look_is_the_picture_of_a_camera_there() {
    let free = "camera: (position: (0, 1, -5), target: (0, 0, 0), up: (0.1, 1, 0), fov: 40, lens: (aperture: 0.05, focus: 5), shutter: 0.5), \
                sampling: (samples: 4), overlay: [ScaleBar(length: 1, label: \"one\")]";
    let scene = SCENE.replace(CAMERA, &free.replace("fov: 40", "fov: 40, follow: \"ball\""));
    let preview = Preview::of(&scene);
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    seek(&browser, 12);
    browser.drag("#film", (50, 20));
    until(
        &browser,
        "state.edits.look !== null && trying === null && shown.full && shown.reloads === state.reloads",
    );
    let before = browser.evaluate("state.reloads");
    browser.evaluate("(at('film').dispatchEvent(new WheelEvent('wheel', { deltaY: 200, bubbles: true, cancelable: true })), true)");
    until(&browser, &format!("state.reloads > {before}"));
    for frame in [12, 15] {
        // The view stays where it is while the camera moves.
        seek(&browser, frame);
        until(&browser, "trying === null && shown.full && shown.reloads === state.reloads");
        let view = browser.evaluate("currentView()");
        let vector = |name: &str| -> String {
            let [x, y, z]: [f64; 3] = serde_json::from_value(view[name].clone()).unwrap();
            format!("{name}: ({x:?}, {y:?}, {z:?})")
        };
        let moved = free
            .replace("position: (0, 1, -5)", &vector("position"))
            .replace("target: (0, 0, 0)", &vector("target"))
            .replace("up: (0.1, 1, 0)", &vector("up"));
        let text = SCENE.replace(CAMERA, &moved);
        let mut cold = Engine::from_scene(Scene::from_text("ball.ron", text).unwrap());
        let film = cold.render_frame(frame).unwrap();
        let png = encode_quickly(&film, cold.effective_settings().film.transfer).unwrap();
        let id = browser.evaluate("shown.id").as_u64().unwrap();
        let picture = preview.session.handle().picture(id).unwrap();
        assert!(picture.info.full && *picture.png == *png, "{moved}");
    }
    // Values are changed meanwhile, and written.
    browser.evaluate("(attempt(['materials.clay.k_d=0.25']).then(keepEdits), true)");
    until(&browser, "state.edits.undoable === 1 && state.edits.look !== null");
    assert_eq!(file(&preview), scene.replace("k_d: 0.5", "k_d: 0.25"));
    let before = browser.evaluate("state.reloads");
    browser.press('\u{e00c}');
    until(
        &browser,
        &format!(
            "state.edits.look === null && state.reloads > {before} && shown.full && shown.reloads === state.reloads"
        ),
    );
    let own =
        Engine::from_scene(Scene::from_text("ball.ron", file(&preview)).unwrap()).render_frame(15).unwrap();
    let id = browser.evaluate("shown.id").as_u64().unwrap();
    let png = encode_quickly(&own, Transfer::Srgb).unwrap();
    assert!(*preview.session.handle().picture(id).unwrap().png == *png);
    assert_eq!(browser.console(), json!([]));
}

/// Presses at a pixel, drags by some pixels of the film with `button`, and compares the point under the pointer before and after.
fn pan_keeps_the_point(browser: &Browser, pixel: [i32; 2], by: [i32; 2]) {
    let point = |[i, j]: [i32; 2]| -> [f64; 3] {
        serde_json::from_value(browser.evaluate(&format!("pointAt([{i}, {j}])"))).unwrap()
    };
    let place = |[i, j]: [i32; 2]| -> [i32; 2] {
        let script = format!(
            "(({{ left, top, width, height }}) => [left + width * ({i} + 0.5) / film()[0], top + height * ({j} + 0.5) / film()[1]].map(Math.round))(at('film').getBoundingClientRect())"
        );
        serde_json::from_value(browser.evaluate(&script)).unwrap()
    };
    let end = [pixel[0] + by[0], pixel[1] + by[1]];
    let ([x, y], [to_x, to_y]) = (place(pixel), place(end));
    let before = point(pixel);
    let to = |x: i32, y: i32| json!({ "type": "pointerMove", "duration": 30, "x": x, "y": y });
    browser.point(&[
        to(x, y),
        json!({ "type": "pointerDown", "button": 1 }),
        to((x + to_x) / 2, (y + to_y) / 2),
        json!({ "type": "pause", "duration": 200 }),
        to(to_x, to_y),
        json!({ "type": "pointerUp", "button": 1 }),
    ]);
    keep(browser);
    let (after, moved) = (point(end), distance(before, point(pixel)));
    // The pointer is at whole pixels of the screen.
    assert!(distance(before, after) < 0.03 * moved && moved > 0.3, "{before:?} {after:?} {moved}");
}

#[test]
fn panned_point_stays_under_the_pointer() {
    for camera in [
        "camera: (position: (0, 3, -5), target: (0, 0.2, 0), fov: 25)",
        "camera: (position: (0, 1, -3), target: (0, 0, 9), horizontal_fov: 70, roll: 30)",
        "camera: (position: (0, 3, -5), target: (0, 0, 0), orthographic: 4)",
        "camera: (position: (0, 3, -5), target: (0, 0, 0), screen: (distance: 2, width: 4, height: 3))",
    ] {
        // The point is not in the plane of the target.
        let floor =
            "(shape: Plane(normal: (0, 1, 0)), transform: (translation: (0, -1, 0)), material: \"clay\"),";
        let scene = SCENE.replace(CAMERA, camera).replace("entities: [", &format!("entities: [{floor}"));
        let preview = Preview::of(&scene);
        let Some(browser) = open(&preview) else { return };
        settle(&browser);
        pan_keeps_the_point(&browser, [20, 84], [25, -7]);
        pan_keeps_the_point(&browser, [84, 60], [-30, 12]);
        assert_eq!(browser.console(), json!([]), "{camera}");
    }
}

#[test]
fn keys_focus_and_look_from_the_sides() {
    let preview = Preview::of(&SCENE.replace(CAMERA, "camera: (position: (1, 2, -9), target: (3, 2, 0))"));
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    let read = |name: &str| vector_after(&file(&preview), &format!("{name}: "));
    let finds = "(() => { for (let i = 0; i < 160; i++) for (let j = 0; j < 90; j++) if (pixel(i / 160, j / 90) !== pixel(0, 0)) return [i + 2, j + 2]; })()";
    browser.evaluate(crate::PIXEL);
    let ball = browser.evaluate(finds);
    let point: [f64; 3] = serde_json::from_value(browser.evaluate(&format!("pointAt({ball})"))).unwrap();
    // The marked pixel is in the middle afterwards, and the direction is the same.
    browser.evaluate(&format!("(hovered = null, probe({ball}))"));
    browser.press('f');
    keep(&browser);
    let (position, target) = (read("position"), read("target"));
    assert!(distance(target, point) < 1e-5, "{target:?} {point:?}");
    let apart = distance(position, target);
    let ahead = [0, 1, 2].map(|axis| (target[axis] - position[axis]) / apart);
    let length = 85.0_f64.sqrt();
    assert!(distance(ahead, [2.0 / length, 0.0, 9.0 / length]) < 1e-5 && apart > 7.0, "{ahead:?}");
    let seen: [f64; 3] = serde_json::from_value(browser.evaluate("pointAt(centre())")).unwrap();
    assert!(distance(seen, point) < 0.1, "{seen:?}");
    assert_eq!(browser.evaluate("view.spot"), json!([80, 45]));

    // The numeric pad, and digits with shift.
    let offset =
        |x: f64, y: f64, z: f64| [target[0] + apart * x, target[1] + apart * y, target[2] + apart * z];
    let shift = |digit: char| {
        let script = format!(
            "document.body.dispatchEvent(new KeyboardEvent('keydown', {{ key: '#', code: 'Digit{digit}', shiftKey: true, bubbles: true }}))"
        );
        browser.evaluate(&script);
    };
    for (key, place) in [
        ('\u{e01d}', offset(1.0, 0.0, 0.0)),
        ('\u{e021}', offset(0.0, 1.0, 0.0)),
        ('\u{e023}', offset(0.0, -1.0, 0.0)),
        ('1', offset(0.0, 0.0, -1.0)),
        ('9', offset(0.0, 0.0, 1.0)),
    ] {
        if key.is_ascii_digit() {
            shift(key);
        } else {
            browser.press(key);
        }
        keep(&browser);
        assert!(distance(read("position"), place) < 1e-3, "{key:?} {:?} {place:?}", read("position"));
        assert!(distance(read("target"), target) < 1e-5);
    }
    // From straight above, a drag lowers the camera towards the front.
    browser.press('\u{e021}');
    tried(&browser);
    browser.drag("#film", (0, -80));
    keep(&browser);
    let lowered = read("position");
    assert!(lowered[2] < target[2] - 1.0 && lowered[1] > target[1] + 1.0, "{lowered:?}");
    assert!((lowered[0] - target[0]).abs() < 1e-3, "{lowered:?}");

    // The axes show the view, and a click on an end looks from there.
    assert_eq!(browser.evaluate("['−x', '−y', '−z', '+x', '+y', '+z'].every(name => ends.some(end => end.querySelector('title').textContent === 'View from ' + name))"), json!(true));
    browser.click("#gizmo [data-axis='2'][data-sign='1'] circle");
    keep(&browser);
    assert!(distance(read("position"), offset(0.0, 0.0, 1.0)) < 1e-4, "{:?}", read("position"));
    let x = browser.evaluate(
        "document.querySelector('#gizmo [data-axis=\"0\"][data-sign=\"1\"]').getAttribute('transform')",
    );
    assert_eq!(x, json!("translate(-34.00 0.00)"), "from behind, x is to the left");
    // A double click centres the view on what is there.
    browser.press('\u{e01b}');
    keep(&browser);
    let (x, y) = (json!({ "type": "pointerDown", "button": 0 }), json!({ "type": "pointerUp", "button": 0 }));
    let place = "(({ left, top, width, height }) => [left + width / 2 + 20, top + height / 2].map(Math.round))(at('film').getBoundingClientRect())";
    let place = browser.evaluate(place);
    let there = json!({ "type": "pointerMove", "duration": 0, "x": place[0], "y": place[1] });
    let point: [f64; 3] = serde_json::from_value(
        browser.evaluate(&format!("pointAt(pixelOf({{ clientX: {}, clientY: {} }}))", place[0], place[1])),
    )
    .unwrap();
    browser.point(&[there, x.clone(), y.clone(), x, y]);
    keep(&browser);
    assert!(distance(read("target"), point) < 1e-5, "{:?} {point:?}", read("target"));
    assert!(distance(read("position"), [point[0], point[1], read("position")[2]]) < 1e-4);
    let target = read("target");
    let offset = |x: f64, y: f64, z: f64| {
        let apart = distance(read("position"), target);
        [target[0] + apart * x, target[1] + apart * y, target[2] + apart * z]
    };
    // With the keyboard.
    browser.evaluate("(document.querySelector('#gizmo [data-axis=\"1\"][data-sign=\"1\"]').focus(), true)");
    browser.press('\u{e007}');
    keep(&browser);
    assert!(distance(read("position"), offset(0.0, 1.0, 0.0)) < 1e-3, "{:?}", read("position"));
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn sides_are_those_of_the_space() {
    let camera = "space: RightHanded, camera: (position: (3, -4, 2), target: (0, 0, 0), up: (0, 0, 1), orthographic: 4)";
    let preview = Preview::of(&SCENE.replace(CAMERA, camera));
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    let read = |name: &str| vector_after(&file(&preview), &format!("{name}: "));
    let apart = 29.0_f64.sqrt();
    // In front, x is to the right and z is up; from above, y is up.
    for (key, side, x, y, z) in [
        ('\u{e01b}', [0.0, -1.0, 0.0], "34.00 0.00", "0.00 0.00", "0.00 -34.00"),
        ('\u{e01d}', [1.0, 0.0, 0.0], "0.00 0.00", "34.00 0.00", "0.00 -34.00"),
        ('\u{e021}', [0.0, 0.0, 1.0], "34.00 0.00", "0.00 -34.00", "0.00 0.00"),
    ] {
        browser.press(key);
        keep(&browser);
        let place = side.map(|axis| apart * axis);
        assert!(distance(read("position"), place) < 1e-3, "{key:?} {:?}", read("position"));
        let shown = browser.evaluate("[0, 1, 2].map(axis => ends.find(end => end.dataset.axis == axis && end.dataset.sign == 1).getAttribute('transform').replaceAll('-0.00', '0.00'))");
        assert_eq!(shown, json!([x, y, z].map(|place| format!("translate({place})"))));
    }
    // The wheel changes the height of a view with parallel rays.
    browser.evaluate("(at('film').dispatchEvent(new WheelEvent('wheel', { deltaY: 100, bubbles: true, cancelable: true })), true)");
    keep(&browser);
    assert!(file(&preview).contains("orthographic: 4.647337"), "{}", file(&preview));
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn camera_flies_by_keys_and_pointer() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    let read = |name: &str| vector_after(&file(&preview), &format!("{name}: "));
    let hold = |key: char, milliseconds: u64| {
        browser.hold(key, true);
        sleep(Duration::from_millis(milliseconds));
        browser.hold(key, false);
    };
    browser.press('F');
    until(&browser, "flying !== null && flying.view !== null && !at('flying').hidden");
    hold('w', 300);
    hold('d', 300);
    // The wipe, whose key is W, is not set.
    assert_eq!(browser.evaluate("view.wipe"), json!(null));
    let speed = browser.evaluate("flying.speed").as_f64().unwrap();
    browser.evaluate("(at('film').dispatchEvent(new WheelEvent('wheel', { deltaY: -400, bubbles: true, cancelable: true })), true)");
    assert!(browser.evaluate("flying.speed").as_f64().unwrap() > 1.5 * speed);
    browser.press('\u{e00c}');
    until(&browser, "flying === null && at('flying').hidden");
    keep(&browser);
    let (position, target) = (read("position"), read("target"));
    assert!(position[0] > 0.2 && position[2] > -4.8 && position[1] == 0.0, "{position:?}");
    assert!(distance(target, [position[0], 0.0, position[2] + 5.0]) < 1e-4, "{target:?}");

    // The right button turns the view in place while it is down.
    let middle = "(({ left, top, width, height }) => [left + width / 2, top + height / 2].map(Math.round))(at('film').getBoundingClientRect())";
    let [x, y]: [i32; 2] = serde_json::from_value(browser.evaluate(middle)).unwrap();
    let to = |x: i32, y: i32| json!({ "type": "pointerMove", "duration": 30, "x": x, "y": y });
    let (press, release) =
        (json!({ "type": "pointerDown", "button": 2 }), json!({ "type": "pointerUp", "button": 2 }));
    let pause = json!({ "type": "pause", "duration": 600 });
    browser.point(&[to(x, y), press, to(x + 10, y), pause, to(x + 60, y), release]);
    until(&browser, "flying === null && dragged === null");
    keep(&browser);
    assert!(distance(read("position"), position) < 1e-5, "{:?}", read("position"));
    let turned = read("target");
    assert!(turned[0] > target[0] + 0.5 && turned[1] == 0.0, "{turned:?}");

    // With less motion, each press is a step.
    browser.emulate(
        "Emulation.setEmulatedMedia",
        &json!({ "features": [{ "name": "prefers-reduced-motion", "value": "reduce" }] }),
    );
    browser.press('F');
    until(&browser, "flying !== null && flying.view !== null");
    browser.press('e');
    browser.press('e');
    browser.press('\u{e00c}');
    keep(&browser);
    assert!((read("position")[1] - 2.0 * 0.2 * 2.5).abs() < 1e-4, "{:?}", read("position"));
    assert_eq!(browser.console(), json!([]));
}
