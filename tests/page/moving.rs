//! Tests of the outline of the selected entity, and of its moves by hand.

use std::fs;

use serde_json::{Value, json};

use crate::browser::Browser;
use crate::{Preview, open, settle, until};

const ESCAPE: char = '\u{e00c}';
const RIGHT: char = '\u{e014}';
const DOWN: char = '\u{e015}';
const SHIFT: char = '\u{e008}';

/// A ball on a floor, a bar and a lamp. The numbers and the comments are as a person would write them.
const YARD: &str = r#"Scene(
    timeline: (fps: 10, duration: 2),
    film: (width: 160, height: 90),
    camera: (position: (0, 3, -5), target: (0, 0.2, 0)),
    ambient: (0.4, 0.4, 0.4),
    materials: { "clay": (k_a: 1, k_d: 0.5, color: (255, 120, 60)), "chalk": (color: (200, 200, 200)) },
    entities: [
        (name: "floor", shape: Plane(normal: (0, 1, 0)), material: "chalk"),
        (name: "ball", shape: Sphere(radius: 0.3), transform: (translation: (0.50, /* on the floor */ 0.3, -0.25)), material: "clay"),
        (name: "bar", shape: Capsule(radius: 0.25, from: (-1, 0.3, 0), to: (-1, 0.8, 0.5)), material: "clay"),
        (name: "lamp", light: Point(intensity: (1, 1, 1)), transform: (translation: (4, 6, -4))),
    ],
)"#;
const BALL: &str = "(0.50, /* on the floor */ 0.3, -0.25)";

fn file(preview: &Preview) -> String {
    fs::read_to_string(preview.folder.path().join("ball.ron")).unwrap()
}

/// Selects an entity, and waits until its place in the shown picture is known.
fn select(browser: &Browser, name: &str) {
    browser.evaluate(&format!("(select({{ entity: '{name}' }}), true)"));
    rested(browser, name);
}

/// Waits until the place of the selected entity is that in the file and in the full picture.
pub(crate) fn rested(browser: &Browser, name: &str) {
    until(
        browser,
        &format!(
            "shown?.full && requested === null && trying === null && grip === null && writing === 0 && !placing \
             && placement?.of === `${{reload()}} ${{state.frame}} {name}` && shown.reloads === state.reloads && shown.frame === state.frame"
        ),
    );
}

/// Returns the pixel of the screen at which a handle is taken.
pub(crate) fn grip_of(browser: &Browser, handle: &str) -> [i32; 2] {
    let place = format!(
        "((touch, box) => {{ const {{ x, y }} = touch.getPointAtLength(touch.getTotalLength()); return [box.left + x, box.top + y].map(Math.round); }})\
         (document.querySelector('.handle.{handle} .touch'), at('film').getBoundingClientRect())"
    );
    serde_json::from_value(browser.evaluate(&place)).unwrap()
}

fn to([x, y]: [i32; 2]) -> Value {
    json!({ "type": "pointerMove", "duration": 30, "x": x, "y": y })
}

/// Presses on a handle, and moves the pointer by some pixels of the screen. Returns where it is.
fn pull(browser: &Browser, handle: &str, by: [i32; 2]) -> [[i32; 2]; 2] {
    let [x, y] = grip_of(browser, handle);
    let end = [x + by[0], y + by[1]];
    let middle = [x + by[0] / 2, y + by[1] / 2];
    let press = json!({ "type": "pointerDown", "button": 0 });
    browser.point(&[to([x, y]), press, to(middle), json!({ "type": "pause", "duration": 100 }), to(end)]);
    [[x, y], end]
}

fn release(browser: &Browser) {
    browser.point(&[json!({ "type": "pointerUp", "button": 0 })]);
}

/// Drags a handle, and waits until the move of the entity is written as one step.
fn drag(browser: &Browser, handle: &str, by: [i32; 2], name: &str) -> [[i32; 2]; 2] {
    let undoable = browser.evaluate("state.edits.undoable");
    let places = pull(browser, handle, by);
    release(browser);
    until(
        browser,
        &format!("state.edits.undoable === {undoable} + 1 && state.edits.tried.length === 0 && shown.full"),
    );
    rested(browser, name);
    places
}

fn undo(browser: &Browser, name: &str) {
    let [undoable, reloads] = ["state.edits.undoable", "state.reloads"].map(|count| browser.evaluate(count));
    browser.click("#undo");
    // The change of the file is known before it is read again.
    until(browser, &format!("state.edits.undoable === {undoable} - 1 && state.reloads > {reloads}"));
    rested(browser, name);
}

/// Returns the position in the world.
fn position(browser: &Browser) -> [f64; 3] {
    serde_json::from_value(browser.evaluate("placement.position")).unwrap()
}

/// Returns the number in place of one in a text, of which nothing else may differ.
pub(crate) fn number_in_place_of(old: &str, number: &str, text: &str) -> f64 {
    let (before, after) = old.split_once(number).unwrap();
    let rest = text.strip_prefix(before).and_then(|rest| rest.strip_suffix(after));
    rest.unwrap_or_else(|| panic!("{text}")).parse().unwrap()
}

#[test]
fn ball_is_dragged_along_an_axis_and_only_its_number_changes() {
    let preview = Preview::of(YARD);
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && at('selection').hasAttribute('hidden')");
    // A click on the picture selects the ball and outlines it.
    let pixel = browser.evaluate(
        "(select({ entity: 'ball' }), new Promise(done => { const wait = () => placement?.camera ? \
         done(onFilm(placement.camera, placement.position).map((at, axis) => Math.floor(at / filmScale(placement.camera).size[axis] * film()[axis]))) : setTimeout(wait, 10); wait(); }))",
    );
    browser.evaluate("(select({ setting: 'background' }), true)");
    until(&browser, "at('selection').hasAttribute('hidden')");
    browser.evaluate(&format!("(markPixel({pixel}), true)"));
    rested(&browser, "ball");
    until(&browser, "!at('selection').hasAttribute('hidden') && at('spot').innerText.includes('ball')");

    // While it is dragged, its move is tried and shown, and not written. What is behind the handle is not selected.
    let (before, eye) = (position(&browser), browser.evaluate("placement.camera.position"));
    let src = browser.evaluate("at('now').src");
    let reloads = browser.evaluate("state.reloads");
    pull(&browser, "x", [50, 7]);
    until(&browser, &format!("state.reloads > {reloads} && trying === null && shown.full"));
    assert_ne!(browser.evaluate("at('now').src"), src);
    assert_eq!(file(&preview), YARD);
    assert_eq!(browser.evaluate("at('unsaved').hidden"), json!(true));
    release(&browser);
    until(&browser, "state.edits.undoable === 1 && state.edits.tried.length === 0");
    rested(&browser, "ball");
    let kept = file(&preview);
    let x = number_in_place_of(YARD, "0.50", &kept);
    let now = position(&browser);
    assert!((now[0] - x).abs() < 1e-12 && x > 0.7 && now[1..] == before[1..], "{now:?} {x}");
    assert!(x.to_string().len() <= 6, "{x} is rounded to what can be seen");
    assert_eq!(browser.evaluate("placement.camera.position"), eye);
    assert_eq!(browser.evaluate("[view.selected.entity, view.spot, playing]"), json!(["ball", pixel, null]));

    // On the ground, two numbers change.
    let places = drag(&browser, "ground", [-60, -20], "ball");
    let moved = position(&browser);
    let expected = YARD.replace(BALL, &format!("({}, /* on the floor */ 0.3, {})", moved[0], moved[2]));
    assert_eq!(file(&preview), expected, "{places:?}");
    // A press without a movement changes nothing.
    pull(&browser, "y", [1, 1]);
    release(&browser);
    assert_eq!((browser.evaluate("state.edits.undoable"), file(&preview)), (json!(2), expected));
    undo(&browser, "ball");
    assert_eq!(file(&preview), kept);
    undo(&browser, "ball");
    assert_eq!((file(&preview), position(&browser)), (YARD.to_owned(), before));
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn outline_and_handles_are_where_the_entity_is_for_all_cameras() {
    for camera in [
        "camera: (position: (0, 3, -5), target: (0, 0.2, 0))",
        "camera: (position: (4, 2, -3), target: (0, 0.5, 0), horizontal_fov: 70, roll: 30)",
        "camera: (position: (1, 3, -5), target: (0, 0, 0), orthographic: 4)",
        "space: RightHanded, camera: (position: (1, 3, 5), target: (0, 0, 0), screen: (distance: 2, width: 2.4, height: 1.35))",
    ] {
        let preview =
            Preview::of(&YARD.replace("camera: (position: (0, 3, -5), target: (0, 0.2, 0))", camera));
        let Some(browser) = open(&preview) else { return };
        settle(&browser);
        for name in ["ball", "bar"] {
            select(&browser, name);
            // Probed points are drawn at their pixels.
            let apart = "Promise.all([[20, 80], [80, 60], [130, 85]].map(async pixel => { \
                const point = await pointAt(pixel), place = onFilm(placement.camera, point), { size } = filmScale(placement.camera); \
                return Math.hypot(...place.map((at, axis) => at / size[axis] * film()[axis] - pixel[axis] - 0.5)); })).then(all => Math.max(...all))";
            let apart = browser.evaluate(apart).as_f64().unwrap();
            assert!(apart < 1e-6, "{camera}: {apart} pixels");
            // The pixels just within the outline show the entity, and those just outside do not. Pixels are about 4 of the screen.
            let wrong = "(async () => { const path = document.querySelector('#selection .outlined').getAttribute('d'), places = path.slice(1, -1).split('L').map(place => place.split(' ').map(Number)); \
                const { size } = filmScale(placement.camera), wrong = []; \
                for (let index = 0; index < places.length; index += 6) for (const by of [-8, 8]) { \
                    const [x, y] = add(places[(index + 1) % places.length], places.at(index - 1), -1), away = unit([y, -x]); \
                    const pixel = add(places[index], away, by).map((at, axis) => Math.floor(at / size[axis] * film()[axis])); \
                    const spot = await (await post('probe', pixel)).json(); \
                    if ((spot?.surface?.entity === view.selected.entity) !== by < 0) wrong.push([pixel, by]); } \
                return [places.length, wrong]; })()";
            let [count, wrong]: [Value; 2] = serde_json::from_value(browser.evaluate(wrong)).unwrap();
            assert!(count.as_u64().unwrap() > 20, "{count}");
            assert_eq!(wrong, json!([]), "{camera}: {name}");
        }
        // The point of the plane that was taken stays under the pointer.
        select(&browser, "ball");
        let before = position(&browser);
        let places = drag(&browser, "ground", [-50, 16], "ball");
        let after = position(&browser);
        let apart = format!(
            "(box => {{ const [from, to] = {}.map(([x, y]) => [x - box.left, y - box.top]), on = place => {{ const {{ origin, direction }} = rayThrough(placement.camera, place); return add(origin, direction, (placement.position[1] - origin[1]) / direction[1]); }}; \
             return add(on(to), on(from), -1); }})(at('film').getBoundingClientRect())",
            json!(places)
        );
        let expected: [f64; 3] = serde_json::from_value(browser.evaluate(&apart)).unwrap();
        let size = expected[0].hypot(expected[2]);
        for axis in 0..3 {
            let moved = after[axis] - before[axis];
            assert!(
                (moved - expected[axis]).abs() < 0.01 * size && size > 0.2,
                "{camera}: {moved} {expected:?}"
            );
        }
        // Along an axis, what is taken at the end of an arrow stays there.
        drag(&browser, "y", [9, -40], "ball");
        let up = position(&browser);
        assert!(up[1] > 0.1 && [up[0], up[2]] == [after[0], after[2]], "{camera}: {up:?}");
        assert_eq!(browser.console(), json!([]), "{camera}");
    }
}

#[test]
fn moves_of_animated_entities_become_keys() {
    let track = "animate: [(target: \"ball\", channel: Translation, track: Keys([(0, (0.50, 0, -0.25)), (2, (0.5, 0.0, 1))]))],\n)";
    let scene = format!("{}{track}", YARD.strip_suffix(')').unwrap());
    let preview = Preview::of(&scene);
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    select(&browser, "ball");
    let outline = browser.evaluate("document.querySelector('#selection .outlined').getAttribute('d')");
    // The outline follows the frame.
    browser.evaluate("(seek(10), true)");
    until(&browser, "shown.full && shown.frame === 10 && requested === null");
    rested(&browser, "ball");
    assert_ne!(browser.evaluate("document.querySelector('#selection .outlined').getAttribute('d')"), outline);
    drag(&browser, "y", [0, -40], "ball");
    let [x, y, z] = position(&browser);
    assert!(x == 0.5 && y > 0.2 && z == 0.375, "{x} {y} {z}");
    let expected = scene.replace("-0.25)), (2,", &format!("-0.25)), (1, (0.5, {y}, 0.375)), (2,"));
    assert_eq!(file(&preview), expected);
    // There is a key now, which changes.
    drag(&browser, "x", [30, 0], "ball");
    let [x, ..] = position(&browser);
    let again = expected.replace("(1, (0.5,", &format!("(1, ({x},"));
    assert_eq!(file(&preview), again);
    undo(&browser, "ball");
    undo(&browser, "ball");
    assert_eq!(file(&preview), scene);
    // Nothing is drawn over a film that plays.
    browser.press(' ');
    until(&browser, "playing !== null && at('selection').hasAttribute('hidden')");
    browser.press(' ');
    until(&browser, "playing === null && !at('selection').hasAttribute('hidden')");
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn moves_below_a_parent_are_in_its_space() {
    let group = "(name: \"arm\", transform: (translation: (0, 0.2, 0), rotation: Euler(0, 90, 0), scale: (2, 1, 1))),";
    let scene = YARD
        .replace("(name: \"ball\",", &format!("{group}\n        (name: \"ball\", parent: \"arm\","))
        .replace(BALL, "(0.25, 0, 0.45)");
    let preview = Preview::of(&scene);
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    select(&browser, "ball");
    let before = position(&browser);
    drag(&browser, "x", [40, 0], "ball");
    let now = position(&browser);
    let z = number_in_place_of(&scene, "0.45", &file(&preview));
    assert!(
        now[0] - before[0] > 0.2 && (now[0] - before[0] - (z - 0.45)).abs() < 1e-9,
        "{before:?} {now:?} {z}"
    );
    assert!((now[1] - before[1]).abs() < 1e-9 && (now[2] - before[2]).abs() < 1e-9, "{before:?} {now:?}");
    undo(&browser, "ball");
    // The scale of the parent counts along the other axis.
    drag(&browser, "z", [0, -20], "ball");
    let now = position(&browser);
    let x = number_in_place_of(&scene, "0.25", &file(&preview));
    assert!((now[2] - before[2] + 2.0 * (x - 0.25)).abs() < 1e-9 && now[2] - before[2] > 0.1, "{now:?} {x}");
    assert!((now[0] - before[0]).abs() < 1e-9);
    // The group itself has no shape, and moves with what is below it.
    select(&browser, "arm");
    drag(&browser, "y", [0, -30], "arm");
    assert!(file(&preview).contains(&format!("translation: (0, {}, 0), rotation", position(&browser)[1])));
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn escape_takes_a_move_back_and_keeps_what_else_is_tried() {
    let preview = Preview::of(YARD);
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    select(&browser, "ball");
    // A view that is not written yet.
    browser.evaluate("(attempt(['camera.position=(0, 3.5, -5)']), true)");
    until(&browser, "state.edits.tried.length === 1");
    rested(&browser, "ball");
    let before = position(&browser);
    pull(&browser, "z", [10, -40]);
    until(&browser, "state.edits.tried.length === 2 && trying === null");
    browser.press(ESCAPE);
    until(&browser, "state.edits.tried.length === 1");
    rested(&browser, "ball");
    assert_eq!(browser.evaluate("state.edits.tried"), json!(["camera.position=(0, 3.5, -5)"]));
    release(&browser);
    assert_eq!((position(&browser), file(&preview)), (before, YARD.to_owned()));
    assert_eq!(browser.evaluate("at('unsaved').hidden"), json!(false));
    browser.press(ESCAPE);
    until(&browser, "state.edits.tried.length === 0 && at('unsaved').hidden");
    assert_eq!((browser.evaluate("state.edits.undoable"), file(&preview)), (json!(0), YARD.to_owned()));
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn arrow_keys_move_by_small_steps() {
    let preview = Preview::of(YARD);
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    select(&browser, "ball");
    let label = "document.querySelector('.handle.x').getAttribute('aria-label')";
    assert_eq!(browser.evaluate(label), json!("Move ball along x"));
    let step = |handle: &str, key: char, undoable: u32| {
        browser.evaluate(&format!("(document.querySelector('.handle.{handle}').focus(), true)"));
        browser.press(key);
        until(&browser, &format!("state.edits.undoable === {undoable} && state.edits.tried.length === 0"));
        rested(&browser, "ball");
    };
    // The camera is 5.5 away: a hundredth, rounded, is 0.05.
    step("x", RIGHT, 1);
    assert_eq!(file(&preview), YARD.replace("(0.50,", "(0.55,"));
    assert_eq!(browser.evaluate("view.frame"), json!(0));
    browser.hold(SHIFT, true);
    step("x", RIGHT, 2);
    browser.hold(SHIFT, false);
    assert_eq!(file(&preview), YARD.replace("(0.50,", "(0.555,"));
    // On the ground, keys follow the picture: down is nearer.
    step("ground", DOWN, 3);
    assert_eq!(file(&preview), YARD.replace(BALL, "(0.555, /* on the floor */ 0.3, -0.3)"));
    assert_eq!(
        browser.evaluate("document.querySelector('.handle.z').getAttribute('aria-valuenow')"),
        json!("-0.3")
    );

    // A capsule is moved by both of its ends.
    select(&browser, "bar");
    browser.evaluate("(document.querySelector('.handle.x').focus(), true)");
    browser.press(RIGHT);
    until(&browser, "state.edits.undoable === 4 && state.edits.tried.length === 0");
    rested(&browser, "bar");
    let kept = file(&preview);
    assert!(kept.contains("from: (-0.94, 0.3, 0), to: (-0.94, 0.8, 0.5)"), "{kept}");
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn what_cannot_be_moved_says_why() {
    let part = r#"(entities: [(name: "pin", shape: Sphere(radius: 0.3), transform: (translation: (0, 0.3, 0)), color: (0, 0, 255))])"#;
    let preview = Preview::of(YARD);
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    fs::write(preview.folder.path().join("part.ron"), part).unwrap();
    let orbit = "animate: [(target: \"ball\", channel: Translation, track: Orbit(center: (0, 0, 0), radius: 1, duration: 2))],\n";
    let spawn = "spawn: [Script(\"spawn(#{ name: \\\"made\\\", shape: sphere(0.2), translation: [1, 1, 0], material: \\\"clay\\\" });\")],\n";
    let sun = "(name: \"sun\", light: Directional(intensity: (0.2, 0.2, 0.2), direction: (0, -1, 0.1))),\n";
    let scene = YARD.replacen(
        "Scene(",
        &format!("Scene(include: [(file: \"part.ron\", name: \"front\")], {orbit}{spawn}"),
        1,
    );
    let scene = scene.replace("entities: [", &format!("entities: [{sun}"));
    preview.save(&scene);
    until(&browser, "state.reloads >= 2 && shown.full && shown.reloads === state.reloads");
    for (name, reason, is_outlined) in [
        ("made", "a script makes it: it is moved there", true),
        ("ball", "the Translation of this entity is not animated by keys in the scene file", true),
        ("front/pin", "it is written in another file, at `part.ron:1`", true),
        ("sun", "its light is parallel: it has a direction and no place", false),
    ] {
        select(&browser, name);
        until(&browser, &format!("at('fixed').innerText.includes({reason:?})"));
        let drawn = "[...document.querySelectorAll('#selection .handle')].filter(handle => !handle.hasAttribute('hidden')).length";
        assert_eq!(browser.evaluate(drawn), json!(0), "{name}");
        let path = browser.evaluate("document.querySelector('#selection .outlined').getAttribute('d')");
        assert!(!is_outlined || path.as_str().unwrap().len() > 100, "{name}: {path}");
    }
    // The instance as a whole is moved.
    select(&browser, "front");
    drag(&browser, "y", [0, -30], "front");
    let height = position(&browser)[1];
    let moved = format!("name: \"front\", transform: (translation: (0, {height}, 0)))");
    assert_eq!(file(&preview), scene.replace("name: \"front\")", &moved));
    assert_eq!(browser.evaluate("at('fixed').hidden"), json!(true));
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn large_shapes_are_moved_at_the_marked_point() {
    let walls = "(name: \"room\", shape: Box(size: (20, 20, 20)), transform: (translation: (0, 8, -4)), material: \"chalk\"), (name: \"floor\"";
    let scene = YARD.replace("(name: \"floor\"", walls);
    let floor = scene.replace(
        "Plane(normal: (0, 1, 0))",
        "Plane(normal: (0, 1, 0)), transform: (translation: (0, -0.3, 50))",
    );
    let preview = Preview::of(&floor);
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    // A plane whose position is far away, and a box around the camera.
    for (pixel, name) in [([20, 80], "floor"), ([3, 3], "room")] {
        browser.evaluate(&format!("(markPixel({}), true)", json!(pixel)));
        rested(&browser, name);
        let apart = format!(
            "Math.hypot(...onFilm(placement.camera, placement.anchor).map((at, axis) => at / filmScale(placement.camera).size[axis] * film()[axis] - {}[axis] - 0.5))",
            json!(pixel)
        );
        assert!(browser.evaluate(&apart).as_f64().unwrap() < 1e-6, "{name}");
    }
    browser.evaluate("(markPixel([20, 80]), true)");
    rested(&browser, "floor");
    drag(&browser, "y", [0, -24], "floor");
    let height = position(&browser)[1];
    assert!(height > -0.25, "{height}");
    assert_eq!(file(&preview), floor.replace("(0, -0.3, 50)", &format!("(0, {height}, 50)")));
    assert_eq!(browser.console(), json!([]));
}
