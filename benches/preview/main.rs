//! Latency from a save to the picture in a browser.
//!
//! `cargo bench --bench preview` edits a scene 50 times by renaming another file over it, and prints the milliseconds until headless
//! Chromium had decoded the coarse and the full picture. It needs chromedriver. `-- SCENE` measures another scene; each edit then changes a
//! comment at its end.
//!
//! Divan is not used, unlike in other benches. It times calls in one process and reports medians; here a browser reports the times of
//! several events after one edit, and the slowest edits matter, by the 95th percentile.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a bench prints its table, and may fail loudly")]

use std::fs;
use std::thread::sleep;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use serde_json::Value;

use rayreel::EffectSet;
use rayreel::live::{Server, Session, SessionSettings, Watching};

#[path = "../../tests/page/browser.rs"]
#[expect(dead_code, reason = "tests do more with it")]
mod browser;
#[path = "../../tests/page/http.rs"]
#[expect(dead_code, reason = "tests look at more of it")]
mod http;

use browser::Browser;

const EDITS: u64 = 50;
const CLASSIC: &str = include_str!("classic.ron");

fn main() {
    let own = std::env::args().skip(1).find(|argument| !argument.starts_with("--"));
    let text = own.map_or_else(|| CLASSIC.to_owned(), |path| fs::read_to_string(path).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let (scene, other) = (folder.path().join("scene.ron"), folder.path().join("other"));
    fs::write(&scene, &text).unwrap();
    let settings = SessionSettings {
        scene: scene.clone(),
        overrides: Vec::new(),
        without: EffectSet::default(),
        allowed: Vec::new(),
        frame: 0,
        watching: Watching::Events,
        finish: false,
        cache: 0,
        editor: None,
    };
    let session = Session::start(settings, |_| ());
    let server = Server::start(0, session.handle()).unwrap();
    let browser = Browser::start("1500,1000").expect("chromedriver is needed");
    browser.go(&format!("http://{}/", server.address()));
    wait_for_full(&browser, 1);

    let mut times: [Vec<f64>; 8] = Default::default();
    for edit in 1..=EDITS {
        fs::write(&other, edited(&text, edit)).unwrap();
        sleep(Duration::from_millis(100));
        let start = SystemTime::now();
        fs::rename(&other, &scene).unwrap();
        let start = 1e3 * start.duration_since(UNIX_EPOCH).unwrap().as_secs_f64();
        wait_for_full(&browser, edit + 1);
        let decoded = |full: bool| {
            let found = browser.evaluate(&format!(
                "performance.getEntriesByName('picture').filter(mark => mark.detail.reloads === {} && mark.detail.full === {full})
                .map(mark => performance.timeOrigin + mark.startTime)[0]",
                edit + 1
            ));
            found.as_f64().unwrap() - start
        };
        let state = session.handle().state();
        let (coarse, full, own) = (decoded(false), decoded(true), state.times);
        let all = [coarse, full, full - own.trace, own.read, own.build, own.prepare, own.trace, own.encode];
        for (times, time) in times.iter_mut().zip(all) {
            times.push(time);
        }
    }
    println!("| milliseconds | median | 95th percentile |\n|---|---|---|");
    let names = [
        "coarse picture",
        "full picture",
        "full picture but for tracing",
        "read",
        "build",
        "prepare",
        "trace",
        "encode",
    ];
    for (name, mut times) in names.into_iter().zip(times) {
        times.sort_by(f64::total_cmp);
        println!("| {name} | {:.1} | {:.1} |", times[times.len() / 2], times[times.len() * 95 / 100]);
    }
}

/// Moves a ball and changes a colour; in any other scene, changes only a comment.
fn edited(text: &str, edit: u64) -> String {
    let moved = text.replacen("3.52823968", &format!("3.{edit:02}"), 1);
    moved.replacen("229.5", &format!("{}", 200 + edit), 1) + format!("// edit {edit}\n").as_str()
}

/// Waits until the full picture after `reloads` reloads is shown. Polls rarely, because each poll takes time too.
fn wait_for_full(browser: &Browser, reloads: u64) {
    loop {
        sleep(Duration::from_millis(150));
        if browser.evaluate(&format!("shown !== null && shown.full && shown.reloads === {reloads}"))
            == Value::Bool(true)
        {
            return;
        }
    }
}
