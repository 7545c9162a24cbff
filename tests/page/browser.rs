//! Headless Chromium, controlled through chromedriver and the WebDriver protocol.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStdout, Command, Stdio};

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};

use super::http::request;

pub(crate) struct Browser {
    driver: Child,
    /// Keeps the pipe open, because the driver may continue to print.
    _output: BufReader<ChildStdout>,
    port: u16,
    session: String,
}

impl Browser {
    /// Starts a browser with a window of this size in pixels, as in `1000,700`. Returns `None` without chromedriver.
    pub(crate) fn start(size: &str) -> Option<Self> {
        let command = Command::new("chromedriver").arg("--port=0").stdout(Stdio::piped()).spawn();
        let mut driver = command.ok()?;
        let mut output = BufReader::new(driver.stdout.take().unwrap());
        let mut lines = output.by_ref().lines().map_while(Result::ok);
        let port = lines
            .find_map(|line| line.split_once("successfully on port ")?.1.trim_end_matches('.').parse().ok())
            .unwrap();
        let mut browser = Self { driver, _output: output, port, session: String::new() };
        // Tests may run as root, in containers with little shared memory.
        let size = format!("--window-size={size}");
        let arguments = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu", &size];
        let options = json!({ "args": arguments });
        let logged = json!({ "browser": "ALL" });
        let wanted = json!({ "alwaysMatch": { "goog:chromeOptions": options, "goog:loggingPrefs": logged } });
        let session = browser.ask("/session", &json!({ "capabilities": wanted }));
        browser.session = session["sessionId"].as_str().unwrap().to_owned();
        Some(browser)
    }

    fn ask(&self, path: &str, body: &Value) -> Value {
        let host = format!("127.0.0.1:{}", self.port);
        let headers = [("Host", host.as_str()), ("Content-Type", "application/json")];
        let answer = request(self.port, "POST", path, &headers, &body.to_string());
        assert_eq!(answer.status, 200, "{path}: {}", answer.body);
        serde_json::from_str::<Value>(&answer.body).unwrap()["value"].take()
    }

    fn ask_session(&self, path: &str, body: &Value) -> Value {
        self.ask(&format!("/session/{}/{path}", self.session), body)
    }

    pub(crate) fn go(&self, url: &str) {
        self.ask_session("url", &json!({ "url": url }));
    }

    /// Opens another `tab` or `window`, and switches to it.
    pub(crate) fn open_another(&self, kind: &str) -> String {
        let opened = self.ask_session("window/new", &json!({ "type": kind }));
        let handle = opened["handle"].as_str().unwrap().to_owned();
        self.switch_to(&handle);
        handle
    }

    pub(crate) fn switch_to(&self, handle: &str) {
        self.ask_session("window", &json!({ "handle": handle }));
        self.emulate("Page.bringToFront", &json!({}));
    }

    /// Returns the value of an expression in the page.
    pub(crate) fn evaluate(&self, expression: &str) -> Value {
        self.ask_session("execute/sync", &json!({ "script": format!("return {expression}"), "args": [] }))
    }

    /// Emulates another device or other preferences, by a command of the browser's own protocol.
    pub(crate) fn emulate(&self, command: &str, parameters: &Value) {
        self.ask_session("goog/cdp/execute", &json!({ "cmd": command, "params": parameters }));
    }

    /// Returns the messages in the console since the last call.
    pub(crate) fn console(&self) -> Value {
        self.ask_session("se/log", &json!({ "type": "browser" }))
    }

    fn element(&self, selector: &str) -> String {
        let found = self.ask_session("element", &json!({ "using": "css selector", "value": selector }));
        found.as_object().unwrap().values().next().unwrap().as_str().unwrap().to_owned()
    }

    /// Clicks the middle of an element.
    pub(crate) fn click(&self, selector: &str) {
        let element = self.element(selector);
        self.ask_session(&format!("element/{element}/click"), &json!({}));
    }

    /// Drags the middle of an element by some pixels to the right and down.
    pub(crate) fn drag(&self, selector: &str, (right, down): (i32, i32)) {
        // The element may follow the pointer.
        let middle = format!(
            "(({{ left, top, width, height }}) => [left + width / 2, top + height / 2].map(Math.round))(document.querySelector('{selector}').getBoundingClientRect())"
        );
        let [left, top]: [i32; 2] = serde_json::from_value(self.evaluate(&middle)).unwrap();
        let to =
            |x: i32, y: i32| json!({ "type": "pointerMove", "duration": 50, "x": left + x, "y": top + y });
        let (press, release) =
            (json!({ "type": "pointerDown", "button": 0 }), json!({ "type": "pointerUp", "button": 0 }));
        // The view is asked for at the first movement, and follows the next ones.
        let pause = json!({ "type": "pause", "duration": 200 });
        self.point(&[to(0, 0), press, to(right / 2, down / 2), pause, to(right, down), release]);
    }

    /// Lets the mouse pointer act.
    pub(crate) fn point(&self, actions: &[Value]) {
        let pointer = json!({ "type": "pointer", "id": "mouse", "parameters": { "pointerType": "mouse" }, "actions": actions });
        self.ask_session("actions", &json!({ "actions": [pointer] }));
    }

    /// Returns a picture of the page, as PNG file.
    pub(crate) fn screenshot(&self) -> Vec<u8> {
        let command = json!({ "cmd": "Page.captureScreenshot", "params": {} });
        let taken = self.ask_session("goog/cdp/execute", &command);
        BASE64_STANDARD.decode(taken["data"].as_str().unwrap()).unwrap()
    }

    /// Presses a key. Special keys are characters in WebDriver's private use area.
    pub(crate) fn press(&self, key: char) {
        let keys = json!([{ "type": "keyDown", "value": key }, { "type": "keyUp", "value": key }]);
        let actions = json!([{ "type": "key", "id": "keyboard", "actions": keys }]);
        self.ask_session("actions", &json!({ "actions": actions }));
    }

    /// Presses a key down, or releases it.
    pub(crate) fn hold(&self, key: char, down: bool) {
        let kind = if down { "keyDown" } else { "keyUp" };
        let actions =
            json!([{ "type": "key", "id": "keyboard", "actions": [{ "type": kind, "value": key }] }]);
        self.ask_session("actions", &json!({ "actions": actions }));
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if !self.session.is_empty() {
            let host = format!("127.0.0.1:{}", self.port);
            request(self.port, "DELETE", &format!("/session/{}", self.session), &[("Host", &host)], "");
        }
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
