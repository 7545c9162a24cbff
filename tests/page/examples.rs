//! Tests of the example program that shows an engine, and of its controls on the page.

use std::io::ErrorKind;
use std::net::TcpStream;
use std::thread::sleep;
use std::time::{Duration, Instant};

use rayreel::Engine;
use rayreel::components::Control;
use rayreel::live::{Server, Session};
use serde_json::{Value, json};

use super::browser::Browser;
use super::http::request;
use super::{AT_MOST, open_at, until};

#[path = "../../scenes/code/preview.rs"]
#[allow(dead_code, reason = "its `main` is not called")]
mod preview;

/// A session of the example with its server.
struct Shown {
    server: Server,
    session: Session,
}

impl Shown {
    fn new() -> Self {
        let (server, session) = preview::serve(0).unwrap();
        Self { server, session }
    }

    fn port(&self) -> u16 {
        self.server.address().port()
    }

    fn send(&self, method: &str, path: &str, body: &str) -> String {
        let host = format!("127.0.0.1:{}", self.port());
        let answer = request(self.port(), method, path, &[("Host", &host)], body);
        assert!(matches!(answer.status, 200..300), "{path}: {} {}", answer.status, answer.body);
        answer.body
    }

    /// Waits for the full picture of a frame after a number of changes, and returns the state.
    fn full(&self, frame: u32, reloads: u64) -> Value {
        let start = Instant::now();
        loop {
            let state: Value = serde_json::from_str(&self.send("GET", "/state", "")).unwrap();
            let picture = &state["picture"];
            if picture["full"] == true && picture["frame"] == frame && picture["reloads"] == reloads {
                return state;
            }
            assert!(start.elapsed() < AT_MOST, "{state}");
            sleep(Duration::from_millis(10));
        }
    }

    /// Checks that a picture has the bytes of an engine's frame.
    #[track_caller]
    fn assert_shows(&self, picture: &Value, engine: &mut Engine, frame: u32) {
        let picture = self.session.handle().picture(picture["id"].as_u64().unwrap()).unwrap();
        let film = engine.render_frame(frame).unwrap();
        let transfer = engine.effective_settings().film.transfer;
        let bytes = image::load_from_memory(&picture.png).unwrap().to_rgb8().into_raw();
        assert!(bytes == film.encoded(transfer).bytes(), "frame {frame}");
    }
}

#[test]
fn preview_shows_an_engine_until_it_is_dropped() {
    let shown = Shown::new();
    let mut engine = preview::engine().unwrap();
    for frame in [0, 76, 30] {
        shown.send("POST", "/view", &format!("{{\"seek\": {{\"frame\": {frame}}}}}"));
        let state = shown.full(frame, 1);
        assert_eq!((&state["scene"], &state["frames"]), (&"three suns".into(), &152.into()));
        shown.assert_shows(&state["picture"], &mut engine, frame);
    }
    let port = shown.port();
    drop(shown);
    assert_eq!(TcpStream::connect(("127.0.0.1", port)).unwrap_err().kind(), ErrorKind::ConnectionRefused);
}

/// Returns an engine that was built with these values.
fn engine_with(gravity: f64, sky: &str) -> Engine {
    let mut engine = preview::engine().unwrap();
    preview::GRAVITY.set(engine.world_mut(), gravity);
    if !sky.is_empty() {
        preview::SKY.set(engine.world_mut(), rayreel::color::hex(sky).unwrap());
    }
    engine
}

/// Changes an input of the panel in steps, as a drag does, and releases it.
fn drag(browser: &Browser, label: &str, kind: &str, values: &[&str]) {
    let input = format!(
        "[...document.querySelectorAll('#values input[type={kind}]')].find(input => input.getAttribute('aria-label') === '{label}')"
    );
    let change = |value: &str, event: &str| {
        until(
            browser,
            &format!(
                "(() => {{ const input = {input}; if (!input) return false; input.value = '{value}'; input.dispatchEvent(new Event('{event}')); return true; }})()"
            ),
        );
    };
    let undoable: Value = browser.evaluate("state.edits.undoable + 1");
    values.iter().for_each(|value| change(value, "input"));
    change(values.last().unwrap(), "change");
    until(
        browser,
        &format!("state.edits.undoable === {undoable} && state.edits.tried.length === 0 && trying === null"),
    );
}

/// Waits until the panel has these names, numbers and notes, and these buttons are enabled.
fn until_panel(browser: &Browser, rows: &Value, buttons: &Value) {
    until(
        browser,
        &format!(
            "JSON.stringify([
                [...document.querySelectorAll('#values .value')].map(row => [row.firstChild.innerText, [...row.querySelectorAll('input')].at(-1).value]),
                [...document.querySelectorAll('#values button:enabled')].map(button => button.title),
            ]) === JSON.stringify([{rows}, {buttons}])"
        ),
    );
}

const SETTLED: &str = "shown !== null && shown.full && shown.reloads === state.reloads && trying === null";

#[test]
fn controls_change_the_picture_as_if_the_program_had_been_built_so() {
    let shown = Shown::new();
    let Some(browser) = open_at(shown.port()) else { return };
    shown.send("POST", "/view", r#"{"seek": {"frame": 40}}"#);
    until(&browser, &format!("{SETTLED} && shown.frame === 40"));
    let picture =
        || serde_json::from_str::<Value>(&shown.send("GET", "/state", "")).unwrap()["picture"].clone();
    // The history is published before the picture.
    let click = |selector: &str, condition: &str| {
        let reloads = browser.evaluate("state.reloads");
        browser.click(selector);
        until(&browser, &format!("{SETTLED} && shown.reloads > {reloads} && {condition}"));
    };
    let initial = json!([["sky", "#05060c"], ["gravity", "1"]]);
    until_panel(&browser, &initial, &json!([]));
    assert_eq!(browser.evaluate("[at('undo').hidden, at('unsaved').hidden]"), json!([true, true]));
    shown.assert_shows(&picture(), &mut engine_with(1.0, ""), 40);

    drag(&browser, "gravity", "range", &["1.2", "0.9", "0.75"]);
    until(&browser, SETTLED);
    let changed = json!([["sky", "#05060c"], ["gravity\ninitially 1", "0.75"]]);
    until_panel(&browser, &changed, &json!(["All initial values", "Back to 1"]));
    let late = &mut engine_with(0.75, "");
    shown.assert_shows(&picture(), late, 40);
    // Frames on both sides, also from the cache.
    for frame in [90, 3] {
        browser.evaluate(&format!("(seek({frame}), true)"));
        until(&browser, &format!("shown.full && shown.frame === {frame}"));
        shown.assert_shows(&picture(), late, frame);
    }

    drag(&browser, "sky", "color", &["#ff0000", "#204060"]);
    until(&browser, SETTLED);
    shown.assert_shows(&picture(), &mut engine_with(0.75, "#204060"), 3);

    // Taken back, made again, and back to the start.
    click("#undo", "state.edits.redoable === 1");
    shown.assert_shows(&picture(), late, 3);
    click("#redo", "state.edits.redoable === 0");
    shown.assert_shows(&picture(), &mut engine_with(0.75, "#204060"), 3);
    let both = json!([["sky\ninitially #05060c", "#204060"], ["gravity\ninitially 1", "0.75"]]);
    until_panel(&browser, &both, &json!(["All initial values", "Back to #05060c", "Back to 1"]));
    click("#values .value:last-child button", "state.edits.undoable === 3");
    shown.assert_shows(&picture(), &mut engine_with(1.0, "#204060"), 3);
    let one = json!([["sky\ninitially #05060c", "#204060"], ["gravity", "1"]]);
    until_panel(&browser, &one, &json!(["All initial values", "Back to #05060c"]));
    click("#values h3 button", "state.edits.undoable === 4");
    shown.assert_shows(&picture(), &mut engine_with(1.0, ""), 3);
    until_panel(&browser, &initial, &json!([]));
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn values_out_of_range_are_refused_on_the_page() {
    let shown = Shown::new();
    let Some(browser) = open_at(shown.port()) else { return };
    until(&browser, SETTLED);
    let host = format!("127.0.0.1:{}", shown.port());
    let answer =
        request(shown.port(), "POST", "/edit", &[("Host", &host)], r#"{"try": [["gravity=7"], []]}"#);
    assert_eq!((answer.status, &*answer.body), (409, "`gravity` must be between 0.5 and 1.5, found 7"));
    browser.evaluate("(attempt(['gravity=7']), true)");
    until(&browser, "at('refused').innerText === '`gravity` must be between 0.5 and 1.5, found 7'");
    assert_eq!(browser.evaluate("[state.reloads, state.edits.undoable]"), json!([1, 0]));
}

#[test]
fn session_refuses_controls_with_the_same_name() {
    let mut engine = preview::engine().unwrap();
    engine.world_mut().spawn((Control::switch("sky", true),));
    let error = Session::of_engine("suns", engine, |_| {}).unwrap_err();
    assert_eq!(error.to_string(), "two controls are named `sky`: give each its own name");
}
