//! The list of the scene's parts, and their values.

use std::fmt::Write as _;
use std::fs;
use std::time::Instant;

use serde_json::json;

use crate::browser::Browser;
use crate::{Preview, SCENE, open, until};

/// A scene with a sky, fog, two materials, a group, and tracks.
const PARTS: &str = r#"Scene(
    timeline: (fps: 10, duration: 2),
    film: (width: 160, height: 90),
    camera: (position: (0, 0, -5), target: (0, 0, 0)),
    background: (bottom: (200, 180, 160), top: (60, 90, 160)),
    fog: (color: (200, 200, 200), density: 0.02),
    ambient: (0.4, 0.4, 0.4),
    materials: { "clay": (k_a: 1, k_d: 0.5, color: (255, 120, 60)), "chalk": (k_a: 1) },
    entities: [
        (name: "sled", transform: (translation: (0, 0, 0))),
        (name: "ball", parent: "sled", shape: Sphere(radius: 0.8), material: "clay"),
        (name: "crate", shape: Box(size: (1, 1, 1)), material: "chalk", transform: (translation: (2.5, 0, 0))),
        (name: "lamp", light: Point(intensity: (1, 1, 1)), transform: (translation: (4, 6, -4))),
    ],
    animate: [
        (target: "sled", channel: Translation, track: Keys([(0, (0, 0, 0)), (2, (-4, 0, 0))])),
        (target: "scene", channel: FogDensity, track: Keys([(0, 0.02), (2, 0.03)])),
    ],
)"#;

/// Returns the rows of the list: the level, the name, and the mark of the selected one.
fn rows(browser: &Browser) -> Vec<String> {
    let shown = "[...document.querySelectorAll('#outline-rows [role=treeitem]')].map(row => `${row.getAttribute('aria-level')} ${row.children[1].textContent}${row.getAttribute('aria-selected') === 'true' ? ' *' : ''}`)";
    serde_json::from_value(browser.evaluate(shown)).unwrap()
}

fn names(browser: &Browser, selector: &str) -> Vec<String> {
    let shown = format!(
        "[...document.querySelectorAll('#values {selector} > .value span')].map(name => name.firstChild.textContent)"
    );
    serde_json::from_value(browser.evaluate(&shown)).unwrap()
}

fn file(preview: &Preview) -> String {
    fs::read_to_string(preview.folder.path().join("ball.ron")).unwrap()
}

/// Changes the input of a value as by its slider.
fn set(browser: &Browser, path: &str, value: &str) {
    let input = format!("document.querySelector('#values input[aria-label=\"{path}\"]')");
    until(browser, &format!("{input} !== null"));
    let undoable = browser.evaluate("state.edits.undoable");
    browser.evaluate(&format!("(() => {{ const input = {input}; for (const event of ['input', 'change']) {{ input.value = '{value}'; input.dispatchEvent(new Event(event)); }} return true; }})()"));
    until(browser, &format!("state.edits.undoable === {undoable} + 1 && trying === null && shown.full"));
}

fn choose(browser: &Browser, name: &str) {
    browser.evaluate(&format!("([...document.querySelectorAll('#outline-rows .part')].find(row => row.children[1]?.textContent === '{name}').click(), true)"));
    let title = format!("at('values').innerText.includes('{name}')");
    until(browser, &title);
}

#[test]
fn parts_are_listed_and_chosen() {
    let preview = Preview::of(PARTS);
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && outline !== null");
    let all = [
        "1 camera",
        "1 timeline",
        "1 film",
        "1 background",
        "1 fog",
        "1 ambient",
        "1 sampling",
        "1 quality",
        "1 Lights",
        "2 lamp",
        "1 Materials",
        "2 clay",
        "2 chalk",
        "1 Entities",
        "2 sled",
        "2 crate",
    ];
    assert_eq!(rows(&browser), all);

    // Values of the sky, of fog and of a camera are those of the file; tracks are named, and changes are written.
    choose(&browser, "background");
    until(&browser, "document.querySelectorAll('#values input[type=color]').length === 2");
    set(&browser, "background.top", "#102030");
    let mut expected = PARTS.replace("(60, 90, 160)", "(16, 32, 48)");
    assert_eq!(file(&preview), expected);
    choose(&browser, "fog");
    until(&browser, "at('values').innerText.includes('animated')");
    assert_eq!(names(&browser, "section"), ["color", "density"]);
    let animated = browser.evaluate("[...document.querySelectorAll('#values .value')].filter(row => row.innerText.includes('animated')).map(row => row.querySelector('input').getAttribute('aria-label'))");
    assert_eq!(animated, json!(["fog.density"]));

    // A field that is not written is shown with its default, and written when it is changed.
    choose(&browser, "camera");
    until(&browser, "document.querySelector('#values details.defaults') !== null");
    assert_eq!(
        (names(&browser, "section"), names(&browser, "details")),
        (
            vec!["position".to_owned(), "target".to_owned()],
            vec!["up".to_owned(), "roll".to_owned(), "fov".to_owned()]
        )
    );
    set(&browser, "camera.fov", "30");
    expected = expected.replace("target: (0, 0, 0))", "target: (0, 0, 0), fov: 30)");
    assert_eq!(file(&preview), expected);
    until(&browser, "document.querySelectorAll('#values section > .value').length === 3");
    choose(&browser, "sampling");
    set(&browser, "sampling.samples", "2");
    assert!(file(&preview).contains("sampling: (samples: 2)"), "{}", file(&preview));
    browser.click("#undo");
    until(&browser, "state.edits.undoable === 2");

    // A click on the picture selects the entity, in its group. It stays selected in frames in which the pixel is another's.
    browser.evaluate("(probe([80, 45]), true)");
    until(
        &browser,
        "at('values').innerText.includes('entity ball') && document.querySelector('#outline-rows [aria-selected=true]') !== null",
    );
    assert!(
        rows(&browser).ends_with(&["2 sled", "3 ball *", "2 crate"].map(str::to_owned)),
        "{:?}",
        rows(&browser)
    );
    browser.evaluate("(seek(19), true)");
    until(&browser, "shown.frame === 19 && shown.full && at('spot').innerText.includes('background')");
    assert!(browser.evaluate("at('values').innerText").as_str().unwrap().contains("entity ball"));
    set(&browser, "entities.ball.shape.radius", "0.5");
    expected = expected.replace("radius: 0.8", "radius: 0.5");
    assert_eq!(file(&preview), expected);
    // Nothing is at the pixel now: a click selects the background.
    browser.evaluate("(probe([80, 45]), true)");
    until(
        &browser,
        "document.querySelector('#outline-rows [aria-selected=true]')?.innerText.includes('background')",
    );

    // Keys move along the rows, choose one, and close and open what has rows below.
    browser.evaluate("(rowOf('entity sled').click(), true)");
    until(
        &browser,
        "document.activeElement.dataset.key === 'entity sled' && at('values').innerText.includes('entity sled')",
    );
    browser.press('\u{e012}');
    until(
        &browser,
        "rowOf('entity ball') === undefined && document.activeElement.dataset.key === 'entity sled'",
    );
    browser.press('\u{e014}');
    until(&browser, "rowOf('entity ball') !== undefined");
    browser.press('\u{e015}');
    browser.press('\u{e015}');
    until(&browser, "document.activeElement.dataset.key === 'entity crate'");
    browser.press('\u{e007}');
    until(
        &browser,
        "at('values').innerText.includes('entity crate') && rowOf('entity crate').getAttribute('aria-selected') === 'true'",
    );
    assert_eq!(
        browser.evaluate("state.frame"),
        json!(19),
        "the keys of the list are not those of the timeline"
    );
    assert_eq!(
        browser.evaluate("document.querySelectorAll('#outline-rows [tabindex=\"0\"]').length"),
        json!(1)
    );
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn thousands_of_entities_are_filtered() {
    let mut many = String::new();
    for index in 0..20_000 {
        writeln!(many, "(name: \"stone {index}\", shape: Sphere(radius: 0.1), material: \"clay\", transform: (translation: ({index}, -9, 99))),").unwrap();
    }
    let preview = Preview::of(&SCENE.replace("entities: [", &format!("entities: [\n{many}")));
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && outline !== null");
    assert!(rows(&browser).len() < 300);
    until(&browser, "at('outline-rows').innerText.includes('and 19801 more')");
    let start = Instant::now();
    browser.evaluate("(at('outline-filter').value = 'STONE 19876', at('outline-filter').dispatchEvent(new Event('input')), true)");
    until(&browser, "rowOf('entity stone 19876') !== undefined");
    assert_eq!(rows(&browser), ["1 Entities", "2 stone 19876"]);
    assert!(start.elapsed().as_secs_f64() < 2.0, "{:?}", start.elapsed());
    choose(&browser, "stone 19876");
    // Without the filter, the selected one is listed all the same.
    browser.evaluate("(at('outline-filter').focus(), true)");
    browser.press('\u{e00c}');
    until(
        &browser,
        "outline.rows.length > 100 && rowOf('entity stone 19876')?.getAttribute('aria-selected') === 'true'",
    );
    set(&browser, "entities.stone 19876.shape.radius", "0.2");
    assert!(file(&preview).contains("\"stone 19876\", shape: Sphere(radius: 0.2)"));
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn changes_name_their_line_and_are_made_again() {
    let preview = Preview::of(PARTS);
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && outline !== null");
    choose(&browser, "clay");
    set(&browser, "materials.clay.k_d", "0.25");
    until(&browser, "at('written').innerText === 'Written: ball.ron:8'");
    browser.evaluate("(rowOf('entity crate').click(), true)");
    set(&browser, "entities.crate.shape.size x", "2");
    let both = PARTS.replace("k_d: 0.5", "k_d: 0.25").replace("size: (1, 1, 1)", "size: (2, 1, 1)");
    assert_eq!(file(&preview), both);
    until(&browser, "at('written').innerText === 'Written: ball.ron:12'");
    let press = |key: &str, shift: bool| {
        browser.evaluate(&format!("(document.activeElement.blur(), document.body.dispatchEvent(new KeyboardEvent('keydown', {{ key: '{key}', ctrlKey: true, shiftKey: {shift}, bubbles: true }})))"));
    };
    let rests = |undoable: u32, redoable: u32, text: &str| {
        until(
            &browser,
            &format!(
                "state.edits.undoable === {undoable} && state.edits.redoable === {redoable} && at('redo').disabled === ({redoable} === 0)"
            ),
        );
        assert_eq!(file(&preview), text);
    };
    press("z", false);
    rests(1, 1, &both.replace("size: (2, 1, 1)", "size: (1, 1, 1)"));
    until(&browser, "at('written').innerText === 'Taken back: ball.ron:12'");
    press("z", false);
    rests(0, 2, PARTS);
    press("Z", true);
    rests(1, 1, &both.replace("size: (2, 1, 1)", "size: (1, 1, 1)"));
    press("y", false);
    rests(2, 0, &both);
    until(&browser, "at('written').innerText === 'Written: ball.ron:12'");
    // A new change ends what can be made again.
    browser.click("#undo");
    rests(1, 1, &both.replace("size: (2, 1, 1)", "size: (1, 1, 1)"));
    set(&browser, "entities.crate.shape.size y", "3");
    let other = both.replace("size: (2, 1, 1)", "size: (1, 3, 1)");
    rests(2, 0, &other);
    // A file that was changed meanwhile stays.
    browser.click("#undo");
    rests(1, 1, &both.replace("size: (2, 1, 1)", "size: (1, 1, 1)"));
    let edited = both.replace("k_d: 0.25", "k_d: 0.75").replace("size: (2, 1, 1)", "size: (1, 1, 1)");
    preview.save(&edited);
    until(
        &browser,
        "state.edited?.part.material === 'clay' && shown.full && shown.reloads === state.reloads",
    );
    press("y", false);
    until(&browser, "at('refused').innerText.includes('was changed meanwhile: it stays as it is')");
    rests(1, 0, &edited);
}

#[test]
fn part_that_is_edited_in_the_file_is_selected() {
    let preview = Preview::of(PARTS);
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && outline !== null");
    let selected = |text: &str, part: &str, mark: &str| {
        preview.save(text);
        until(
            &browser,
            &format!(
                "JSON.stringify(view.selected) === JSON.stringify({part}) && at('values').innerText.length > 0"
            ),
        );
        until(
            &browser,
            &format!(
                "document.querySelector('#outline-rows [aria-selected=true]')?.children[1].textContent === '{mark}'"
            ),
        );
    };
    let text = PARTS.replace("radius: 0.8", "radius: 0.7");
    selected(&text, "{ entity: 'ball' }", "ball");
    let text = text.replace("k_d: 0.5", "k_d: 0.4");
    selected(&text, "{ material: 'clay' }", "clay");
    let text = text.replace("density: 0.02", "density: 0.03");
    selected(&text, "{ setting: 'fog' }", "fog");
    let text = text.replace("(2, (-4, 0, 0))", "(2, (-3, 0, 0))");
    selected(&text, "{ entity: 'sled' }", "sled");
    let text = text.replace("target: (0, 0, 0))", "target: (0, 0.1, 0))");
    selected(&text, "{ camera: 'camera' }", "camera");
    let text = text.replace(
        "        (name: \"lamp\"",
        "        (shape: Sphere(radius: 0.2), color: (0, 0, 255)),\n        (name: \"lamp\"",
    );
    selected(&text, "{ entity: '#3' }", "#3");
    // A comment is no part, and a change by the page is not that of a program.
    let text = text.replace("animate: [", "animate: [ // keys");
    let reloads = browser.evaluate("state.reloads");
    preview.save(&text);
    until(&browser, &format!("state.reloads > {reloads} && shown.full"));
    assert_eq!(browser.evaluate("view.selected"), json!({ "entity": "#3" }));
    browser.evaluate("(edit({ try: [['materials.chalk.k_a=0.5'], []] }).then(keepEdits), true)");
    until(&browser, "state.edits.undoable === 1 && shown.full && shown.reloads === state.reloads");
    assert_eq!(browser.evaluate("view.selected"), json!({ "entity": "#3" }));
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn animated_values_lead_to_their_keys_and_scripts() {
    let script = "(target: \"crate\", channel: Translation, track: Script(\"[2.5, t, 0]\")),\n        (target: \"sled\"";
    let keys = "Keys([(0, 0.02), (1, 0.025), (2, 0.03)])";
    let scene = PARTS.replace("(target: \"sled\"", script).replace("Keys([(0, 0.02), (2, 0.03)])", keys);
    let preview = Preview::of(&scene);
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && outline !== null && tracks !== null");
    // A field that a track sets is not changed where it has no effect; its word selects the key at the frame.
    choose(&browser, "fog");
    until(&browser, "document.querySelector('#values .animated') !== null");
    let disabled = "[...document.querySelectorAll('#values input')].filter(input => input.disabled).map(input => input.getAttribute('aria-label'))";
    assert_eq!(browser.evaluate(disabled), json!(["fog.density", "fog.density"]));
    browser.evaluate("(seek(14), true)");
    until(&browser, "shown.frame === 14 && shown.full");
    browser.click("#values .animated button");
    until(&browser, "picked?.path === 'animate.2.track.0' && picked.index === 1 && !at('key').hidden");
    assert_eq!(browser.evaluate("document.activeElement.dataset.key"), json!("animate.2.track.0.1"));
    assert_eq!(browser.evaluate("view.frame"), json!(14));
    // A script is named with its place.
    choose(&browser, "crate");
    until(&browser, "at('values').innerText.includes('entity crate')");
    let note = browser.evaluate("document.querySelector('#values .animated small').innerText");
    assert_eq!(note, json!("script ball.ron:16"));
    assert_eq!(file(&preview), scene);
    assert_eq!(browser.console(), json!([]));
}
