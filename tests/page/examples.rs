//! Test of the example program that shows an engine.

use std::io::ErrorKind;
use std::net::TcpStream;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::AT_MOST;
use super::http::request;

#[path = "../../scenes/code/preview.rs"]
#[allow(dead_code, reason = "its `main` is not called")]
mod preview;

#[test]
fn preview_shows_an_engine_until_it_is_dropped() {
    let (server, session) = preview::serve(0).unwrap();
    let port = server.address().port();
    let host = format!("127.0.0.1:{port}");
    let send = |method, path: &str, body: &str| {
        let answer = request(port, method, path, &[("Host", &host)], body);
        assert!(matches!(answer.status, 200..300), "{path}: {} {}", answer.status, answer.body);
        answer
    };
    let shown = |frame: u32| {
        let start = Instant::now();
        loop {
            let state: Value = serde_json::from_str(&send("GET", "/state", "").body).unwrap();
            if state["picture"]["full"] == true && state["picture"]["frame"] == frame {
                return state;
            }
            assert!(start.elapsed() < AT_MOST, "{state}");
            sleep(Duration::from_millis(10));
        }
    };
    let mut engine = preview::engine().unwrap();
    for frame in [0, 76, 30] {
        send("POST", "/view", &format!("{{\"seek\": {{\"frame\": {frame}}}}}"));
        let state = shown(frame);
        assert_eq!((&state["scene"], &state["frames"]), (&"three suns".into(), &152.into()));
        let picture = session.handle().picture(state["picture"]["id"].as_u64().unwrap()).unwrap();
        let (film, transfer) =
            (engine.render_frame(frame).unwrap(), engine.effective_settings().film.transfer);
        let bytes = image::load_from_memory(&picture.png).unwrap().to_rgb8().into_raw();
        assert!(bytes == film.encoded(transfer).bytes(), "frame {frame}");
    }
    drop((server, session));
    assert_eq!(TcpStream::connect(("127.0.0.1", port)).unwrap_err().kind(), ErrorKind::ConnectionRefused);
}
