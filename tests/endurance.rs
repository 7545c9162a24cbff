//! Test of a long session with many edits, a tenth of them invalid: memory, threads and open files do not grow, and pictures stay right.
//!
//! `RAYREEL_CASES=2000` sets the number of edits; the default is 400.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

use std::fs;
use std::io::Read;
use std::net::TcpStream;
use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use rayreel::live::{DEFAULT_CACHE, Event, Picture, Server, Session, SessionSettings, Watching};
use rayreel::output::encode_quickly;
use rayreel::{EffectSet, Engine, Scene};

#[path = "page/http.rs"]
#[expect(dead_code, reason = "others look at more of an answer")]
mod http;
#[path = "engine/reload/model.rs"]
mod model;
#[path = "engine/reload/random.rs"]
mod random;
#[path = "random/splitmix.rs"]
mod splitmix;

use http::request;
use model::Model;
use random::Random;

/// Time limit for expected events, generous enough for a busy machine.
const AT_MOST: Duration = Duration::from_secs(60);
/// Number of scene versions, used in turns so that the resources they need stay the same.
const VERSIONS: usize = 30;

/// The names and texts of the files of a scene, except the main file.
type Included = Vec<(&'static str, String)>;

#[test]
fn long_sessions_do_not_leak_and_stay_correct() {
    let edits = std::env::var("RAYREEL_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(400);
    let folder = tempfile::tempdir().unwrap();
    let versions = versions(folder.path());
    let (text, files) = &versions[0];
    write(folder.path(), text, files);
    let (sender, events) = channel();
    let scene = folder.path().join("scene.ron");
    let session = Session::start(
        SessionSettings {
            scene: scene.clone(),
            overrides: Vec::new(),
            without: EffectSet::default(),
            allowed: Vec::new(),
            frame: 3,
            watching: Watching::Events,
            finish: false,
            cache: DEFAULT_CACHE,
            cache_folder: None,
            editor: None,
        },
        move |event| sender.send(event).unwrap(),
    );
    let server = Server::start(0, session.handle()).unwrap();
    let port = server.address().port();
    let listener = listen(port);
    assert!(is_read(&events));

    let mut held = Vec::new();
    let mut broken = 0;
    for edit in 1..=edits {
        let (text, files) = &versions[edit % VERSIONS];
        // A comment makes every text different from the previous one.
        let text = format!("{text}\n// edit {edit}");
        let breaks = edit % 10 == 5;
        write(folder.path(), if breaks { &text[..text.len() / 2] } else { &text }, files);
        assert_eq!(is_read(&events), !breaks, "edit {edit}");
        broken += u64::from(breaks);
        if edit % 10 == 0 {
            visit(port, &session);
        }
        if edit % 50 == 0 {
            let shown = last_full(&session);
            let mut cold = Engine::load(&scene).unwrap();
            let film = cold.render_frame(shown.info.frame).unwrap();
            let png = encode_quickly(&film, cold.effective_settings().film.transfer).unwrap();
            assert!(*shown.png == *png, "edit {edit}");
            held.extend(Held::now());
        }
    }
    let state = session.handle().state();
    println!("{} reloads, {broken} broken: {held:?}", state.reloads);
    drop((server, session));
    listener.join().unwrap();
    // By the middle of the run, every resource has been needed once.
    let Some((last, before)) = held.split_last() else { return };
    let Some(half) = before.get(held.len() / 2) else { return };
    assert!(last.threads <= half.threads && last.files <= half.files, "{held:?}");
    assert!(last.memory <= half.memory * 21 / 20, "{held:?}");
}

/// Returns random valid versions of a scene.
fn versions(folder: &Path) -> Vec<(String, Included)> {
    let random = &mut Random(6);
    let mut versions = Vec::new();
    let mut model = Model::new(random);
    while versions.len() < VERSIONS {
        let mut edited = model.clone();
        edited.edit(random);
        let (text, files) = edited.files();
        write(folder, &text, &files);
        let loaded = Scene::load(&folder.join("scene.ron"));
        if loaded.is_ok_and(|scene| Engine::from_scene(scene).render_frame(3).is_ok()) {
            versions.push((text, files));
            model = edited;
        }
    }
    versions
}

/// Replaces the files, each atomically.
fn write(folder: &Path, text: &str, files: &[(&'static str, String)]) {
    let all = files.iter().map(|(name, text)| (*name, text.as_str())).chain([("scene.ron", text)]);
    for (name, text) in all {
        fs::write(folder.join("new"), text).unwrap();
        fs::rename(folder.join("new"), folder.join(name)).unwrap();
    }
}

/// Waits until an edit is read, and returns true if it is valid.
fn is_read(events: &Receiver<Event>) -> bool {
    loop {
        match events.recv_timeout(AT_MOST).unwrap() {
            Event::Reloaded(_) => return true,
            Event::Broken(_) => return false,
            Event::Shown(_) => {}
            Event::Failed(error) => panic!("{error}"),
            Event::NotShown(mistakes) => panic!("{mistakes:?}"),
        }
    }
}

/// Returns the full picture after the last edit, which may be a kept one, without an event.
fn last_full(session: &Session) -> Picture {
    let (start, handle) = (Instant::now(), session.handle());
    loop {
        let state = handle.state();
        let full = state.picture.filter(|info| info.full && info.reloads == state.reloads);
        if let Some(picture) = full.and_then(|info| handle.picture(info.id)) {
            return picture;
        }
        assert!(start.elapsed() < AT_MOST, "{state:?}");
        thread::sleep(Duration::from_millis(5));
    }
}

/// Receives all events, as a page does, until the server ends.
fn listen(port: u16) -> thread::JoinHandle<()> {
    thread::spawn(move || {
        let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
        let head = format!("GET /events HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n");
        std::io::Write::write_all(&mut stream, head.as_bytes()).unwrap();
        let mut bytes = [0; 4096];
        while stream.read(&mut bytes).is_ok_and(|count| count > 0) {}
    })
}

/// Makes the requests of a page that is opened and closed.
fn visit(port: u16, session: &Session) {
    let host = format!("127.0.0.1:{port}");
    let headers = [("Host", host.as_str())];
    assert_eq!(request(port, "GET", "/", &headers, "").status, 200);
    assert_eq!(request(port, "POST", "/probe", &headers, "[3, 3]").status, 200);
    if let Some(picture) = session.handle().state().picture {
        request(port, "GET", &format!("/picture/{}", picture.id), &headers, "");
    }
    drop(TcpStream::connect(("127.0.0.1", port)).unwrap());
}

/// Resources held by this process, where the system reports them.
#[derive(Debug)]
struct Held {
    /// Resident memory in kB.
    memory: u64,
    threads: u64,
    /// Number of open files, including sockets.
    files: usize,
}

impl Held {
    fn now() -> Option<Self> {
        let status = fs::read_to_string("/proc/self/status").ok()?;
        let number = |name: &str| {
            let line = status.lines().find_map(|line| line.strip_prefix(name))?;
            line.split_whitespace().next()?.parse().ok()
        };
        Some(Self {
            memory: number("VmRSS:")?,
            threads: number("Threads:")?,
            files: fs::read_dir("/proc/self/fd").ok()?.count(),
        })
    }
}
