//! Tests of the keys below the timeline.

use std::fs;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::json;

use crate::browser::Browser;
use crate::{AT_MOST, Preview, SCENE, open, page_state, until};

#[test]
fn keys_are_dragged_eased_added_and_removed() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    let file = || fs::read_to_string(preview.folder.path().join("ball.ron")).unwrap();
    let becomes = |keys: &str| {
        let wanted = SCENE.replace("(0, (0, 0, 0)), (2, (0, 0.5, 0))", keys);
        let start = Instant::now();
        while file() != wanted {
            assert!(start.elapsed() < AT_MOST, "{keys}: {}\n{}", file(), page_state(&browser));
            sleep(Duration::from_millis(10));
        }
        until(&browser, "trying === null && moving === null && state.edits.tried.length === 0");
    };
    let keys =
        |count: usize| until(&browser, &format!("document.querySelectorAll('.key').length === {count}"));
    let run = |script: &str| browser.evaluate(&format!("(() => {{ {script}; return true; }})()"));
    keys(2);
    // A drag by 8 of 19 frames.
    let right = browser.evaluate("Math.round(8 / 19 * document.querySelector('.lane').clientWidth)");
    browser.drag(".key", (serde_json::from_value(right).unwrap(), 0));
    becomes("(0.8, (0, 0, 0)), (2, (0, 0.5, 0))");
    // The key that was dragged is in the panel, and its entity is selected.
    until(&browser, "document.querySelector('#key input')?.value === '0.8'");
    until(&browser, "JSON.stringify(view.selected) === JSON.stringify({ entity: 'ball' })");
    run(
        "const easing = document.querySelector('#key select'); easing.value = 'EaseInOut'; easing.onchange()",
    );
    becomes("(0.8, (0, 0, 0), EaseInOut), (2, (0, 0.5, 0))");
    run("addKey(tracks.tracks[0], 14)");
    becomes("(0.8, (0, 0, 0), EaseInOut), (1.4, (0, 0.25, 0), EaseInOut), (2, (0, 0.5, 0))");
    keys(3);
    // With the keyboard.
    run("document.querySelectorAll('.key')[1].focus()");
    browser.press('\u{e012}');
    becomes("(0.8, (0, 0, 0), EaseInOut), (1.3, (0, 0.25, 0), EaseInOut), (2, (0, 0.5, 0))");
    until(&browser, "document.activeElement.dataset.key === 'animate.0.track.0.1' && view.frame === 13");
    browser.press('\u{e017}');
    becomes("(0.8, (0, 0, 0), EaseInOut), (2, (0, 0.5, 0))");
    keys(2);
    assert_eq!(browser.console(), json!([]));
    // A key cannot pass its neighbour, and a value that the scene refuses is not written.
    run("moveKey(tracks.tracks[0], 0, 50); dropKey()");
    becomes("(1.9, (0, 0, 0), EaseInOut), (2, (0, 0.5, 0))");
    run("attempt(['animate.0.track.0.0.0=3']).then(dropKey)");
    until(&browser, "document.getElementById('refused').textContent !== ''");
    becomes("(1.9, (0, 0, 0), EaseInOut), (2, (0, 0.5, 0))");
    // Everything is undone, step by step.
    for _ in 0..6 {
        let before = file();
        until(&browser, "!document.getElementById('undo').disabled");
        run("undo()");
        let start = Instant::now();
        while file() == before {
            assert!(start.elapsed() < AT_MOST);
            sleep(Duration::from_millis(10));
        }
    }
    assert_eq!(file(), SCENE);
    // Playback stays within the range.
    run("setRange('first', 5); setRange('last', 8); play()");
    until(&browser, "playing !== null && view.frame > 5");
    run(
        "window.seen = []; const draw = drawTransport; drawTransport = () => { seen.push(view.frame); draw(); }",
    );
    until(&browser, "seen.length > 8");
    until(&browser, "seen.every(frame => frame >= 5 && frame <= 8)");
}

/// Presses the mouse button at the middle of an element, and moves right by some pixels.
fn pull(browser: &Browser, selector: &str, right: f64) {
    let place = format!(
        "(({{ left, top, width, height }}) => [left + width / 2, top + height / 2])(document.querySelector('{selector}').getBoundingClientRect())"
    );
    let [x, y]: [f64; 2] = serde_json::from_value(browser.evaluate(&place)).unwrap();
    let to = |right: f64| json!({ "type": "pointerMove", "duration": 50, "x": (x + right).round(), "y": y.round() });
    browser.point(&[to(0.0), json!({ "type": "pointerDown", "button": 0 }), to(0.5 * right), to(right)]);
}

#[test]
fn dragged_keys_show_their_time_and_new_keys_are_selected() {
    let looping = "repeat: Loop, track: Keys([(0, (0, 0, 0), EaseIn), (0.5, (0, 0.5, 0))])";
    let preview = Preview::of(&SCENE.replace("track: Keys([(0, (0, 0, 0)), (2, (0, 0.5, 0))])", looping));
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && document.querySelectorAll('.key').length === 2");
    let frame =
        browser.evaluate("document.querySelector('.lane').clientWidth / lastFrame()").as_f64().unwrap();
    // The repeats at frames 10 and 15; a loop ends where it begins.
    let marks = "[...document.querySelectorAll('.passes i')].map(mark => Math.round(parseFloat(mark.style.left) / 100 * lastFrame()))";
    assert_eq!(browser.evaluate(marks), json!([10, 15]));
    assert_eq!(browser.evaluate("document.querySelectorAll('.passes svg').length"), json!(0));
    // The picture is that of the key's time while it is dragged, and the repeats follow.
    pull(&browser, "[data-key$=\".1\"]", 4.0 * frame);
    until(&browser, "at('key-time').textContent === '0.90 s · frame 9' && !at('key-time').hidden");
    until(&browser, "view.frame === 9 && shown.frame === 9 && state.edits.tried.length === 1");
    assert_eq!(browser.evaluate(marks), json!([18]));
    browser.point(&[json!({ "type": "pointerUp", "button": 0 })]);
    until(
        &browser,
        "at('key-time').hidden && trying === null && moving === null && tracks.of === reload() && tracks.tracks[0].keys[1].time === 0.9",
    );
    // The lane of the selected key shows the easing: half of the time is a quarter of the way.
    until(&browser, "picked?.index === 1 && document.querySelectorAll('.passes path').length === 3");
    let points = "document.querySelector('.passes path').getAttribute('d').slice(1).split('L').map(point => point.split(' ').map(Number))";
    let points: Vec<[f64; 2]> = serde_json::from_value(browser.evaluate(points)).unwrap();
    assert!(
        points.len() > 20 && points[0] == [0.0, 1.0] && points[points.len() - 1] == [9.0, 0.0],
        "{points:?}"
    );
    assert_eq!(points[points.len() / 2], [4.5, 0.75]);
    // A double click within a repeat adds a key to the first pass, and selects it.
    let place = "(({ left, top, height }) => [left, top + height / 2])(document.querySelector('.lane').getBoundingClientRect())";
    let [left, top]: [f64; 2] = serde_json::from_value(browser.evaluate(place)).unwrap();
    let (press, release) =
        (json!({ "type": "pointerDown", "button": 0 }), json!({ "type": "pointerUp", "button": 0 }));
    let there =
        json!({ "type": "pointerMove", "duration": 0, "x": (left + 13.0 * frame).round(), "y": top.round() });
    browser.point(&[there, press.clone(), release.clone(), press, release]);
    until(&browser, "picked?.index === 1 && tracks.tracks[0].keys.length === 3 && view.frame === 4");
    until(&browser, "document.activeElement.dataset.key === 'animate.0.track.0.1'");
    until(&browser, "document.querySelector('#key input')?.value === '0.4'");
    // A selected key comes into view in a panel that is too small for all.
    let below = "(panel => (panel.style.height = '200px', panel.scrollTop = 0, at('key').getBoundingClientRect().top > panel.getBoundingClientRect().bottom))(at('key').parentElement)";
    assert_eq!(browser.evaluate(below), json!(true));
    browser.click("[data-key=\"animate.0.track.0.0\"]");
    until(
        &browser,
        "picked.index === 0 && at('key').getBoundingClientRect().top < at('key').parentElement.getBoundingClientRect().bottom",
    );
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn alternating_tracks_show_mirrored_passes() {
    let keys = "repeat: PingPong, offset: 0.2, track: Keys([(0, (0, 0, 0)), (0.1, (0, 0.1, 0)), (0.6, (0, 0.5, 0))])";
    let preview = Preview::of(&SCENE.replace("track: Keys([(0, (0, 0, 0)), (2, (0, 0.5, 0))])", keys));
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && document.querySelectorAll('.key').length === 3");
    // Passes of 6 frames, from frame 2 on: backwards before it and from frame 8, forwards from frame 14.
    let marks = "[...document.querySelectorAll('.passes i')].map(mark => Math.round(parseFloat(mark.style.left) / 100 * lastFrame())).sort((a, b) => a - b)";
    assert_eq!(browser.evaluate(marks), json!([1, 13, 14, 15]));
    assert_eq!(
        browser.evaluate(
            "[0.1, 0.6, 0.7, 1.15, 1.3].map(time => Number(folded(tracks.tracks[0], time).toFixed(6)))"
        ),
        json!([0.1, 0.6, 0.5, 0.05, 0.1])
    );
    // The time of the key is named apart from that of the timeline.
    let frame =
        browser.evaluate("document.querySelector('.lane').clientWidth / lastFrame()").as_f64().unwrap();
    pull(&browser, "[data-key$=\".1\"]", 2.0 * frame);
    until(&browser, "at('key-time').textContent === '0.50 s · frame 5 · key at 0.3 s'");
    browser.point(&[json!({ "type": "pointerUp", "button": 0 })]);
    until(&browser, "trying === null && moving === null && state.edits.tried.length === 0");
    assert_eq!(browser.console(), json!([]));
}

/// The texts of the ruler, with the ends of each in pixels, and the place of the scrubber's frame.
const RULER: &str = "[...document.querySelectorAll('#ruler span')].map(label => [label.textContent, label.getBoundingClientRect().left, label.getBoundingClientRect().right]).sort((one, other) => one[1] - other[1])";

#[test]
fn ruler_has_seconds_and_near_frames() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && document.querySelectorAll('.key').length === 2");
    let labels = || serde_json::from_value::<Vec<(String, f64, f64)>>(browser.evaluate(RULER)).unwrap();
    let apart = |labels: &[(String, f64, f64)]| labels.windows(2).all(|pair| pair[0].2 + 2.0 < pair[1].1);
    let near = labels();
    assert!(apart(&near), "{near:?}");
    let texts: Vec<&str> = near.iter().map(|(text, ..)| text.as_str()).collect();
    assert!(texts.starts_with(&["0 s", "2"]) && texts.contains(&"1 s"), "{texts:?}");
    // The label of the first second is above frame 10 of the lanes.
    let place = browser.evaluate("(box => box.left + box.width * 10 / lastFrame())(document.querySelector('.lane').getBoundingClientRect())").as_f64().unwrap();
    let (_, left, right) = near.iter().find(|(text, ..)| text == "1 s").unwrap();
    assert!((0.5 * (left + right) - place).abs() < 1.5, "{left} {right} {place}");
    // A press shows the frame, and a drag follows.
    let from = browser.evaluate(
        "(box => [box.left + box.width * 7 / lastFrame(), box.top + 5])(at('ruler').getBoundingClientRect())",
    );
    let [x, y]: [f64; 2] = serde_json::from_value(from).unwrap();
    let to = |right: f64| json!({ "type": "pointerMove", "duration": 50, "x": (x + right).round(), "y": y.round() });
    browser.point(&[to(0.0), json!({ "type": "pointerDown", "button": 0 })]);
    until(&browser, "view.frame === 7");
    browser.point(&[to(-100.0), json!({ "type": "pointerUp", "button": 0 })]);
    until(&browser, "view.frame < 7 && shown.frame === view.frame");
    // The buttons of the range.
    browser.evaluate("(seek(5), true)");
    assert_eq!(browser.evaluate("at('range-clear').disabled"), json!(true));
    browser.click("#range-first");
    assert_eq!(browser.evaluate("view.range"), json!([5, 19]));
    browser.evaluate("(seek(12), true)");
    browser.click("#range-last");
    assert_eq!(browser.evaluate("[view.range, at('range').hidden]"), json!([[5, 12], false]));
    browser.click("#range-clear");
    assert_eq!(browser.evaluate("[view.range, at('range').hidden]"), json!([null, true]));
    // A long film has minutes, and narrow rulers fewer labels.
    preview.save(&SCENE.replace("duration: 2", "duration: 300"));
    until(&browser, "state.frames === 3000 && at('ruler').innerText.includes('1:00')");
    for width in [1600, 600, 360] {
        let screen = json!({ "width": width, "height": 700, "deviceScaleFactor": 1, "mobile": false });
        browser.emulate("Emulation.setDeviceMetricsOverride", &screen);
        until(
            &browser,
            &format!(
                "innerWidth === {width} && ruled === `${{state.frames}} ${{state.rate}} ${{at('ruler').clientWidth}}`"
            ),
        );
        let labels = labels();
        assert!(apart(&labels) && labels.len() > 2, "{width}: {labels:?}");
    }
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn long_names_of_lanes_are_whole() {
    let name = "the second lantern of the harbour";
    let preview = Preview::of(&SCENE.replace("\"ball\"", &format!("\"{name}\"")));
    let Some(browser) = open(&preview) else { return };
    let whole = "[...document.querySelectorAll('.lane > span')].map(name => name.scrollWidth <= name.clientWidth && name.scrollHeight <= name.clientHeight + 1)";
    until(&browser, "shown !== null && document.querySelectorAll('.key').length === 2");
    assert_eq!(browser.evaluate(whole), json!([true]));
    let screen = json!({ "width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": true });
    browser.emulate("Emulation.setDeviceMetricsOverride", &screen);
    until(&browser, "innerWidth === 390");
    browser.evaluate("(showsLanes() || at('keyed').click(), true)");
    until(&browser, "document.querySelectorAll('.key').length === 2 && at('lanes').offsetHeight > 0");
    assert_eq!(browser.evaluate(whole), json!([true]));
    // The scrubber begins where the lanes do.
    let starts = "document.querySelector('.lane').getBoundingClientRect().left - at('ruler').getBoundingClientRect().left";
    assert!(browser.evaluate(starts).as_f64().unwrap().abs() < 1.0);
    assert_eq!(browser.console(), json!([]));
}
