//! Tests of the keys below the timeline.

use std::fs;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::json;

use crate::{AT_MOST, Preview, SCENE, open, until};

#[test]
fn keys_are_dragged_eased_added_and_removed() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    let file = || fs::read_to_string(preview.folder.path().join("ball.ron")).unwrap();
    let becomes = |keys: &str| {
        let wanted = SCENE.replace("(0, (0, 0, 0)), (2, (0, 0.5, 0))", keys);
        let start = Instant::now();
        while file() != wanted {
            assert!(start.elapsed() < AT_MOST, "{keys}: {}", file());
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
    // The key that was dragged is in the panel.
    until(&browser, "document.querySelector('#key input').value === '0.8'");
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
    until(&browser, "document.activeElement.dataset.key === 'animate.0.track.0.1'");
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
