//! Tests that films of output bytes equal encoded linear films.

use std::sync::atomic::AtomicBool;

use rayreel::color::Transfer;
use rayreel::trace::Signals;
use rayreel::{Engine, EngineError, Film, RenderRequest, Scene, Time};

/// Returns a scene with these film and sampling settings, whose light ranges from none to more than a film can hold.
fn engine(film: &str, sampling: &str) -> Engine {
    let text = format!(
        r#"Scene(
            timeline: (fps: 10, duration: 1),
            film: ({film}),
            {sampling}
            camera: (position: (0, 0, -4), target: (0, 0, 0), shutter: 0.5),
            ambient: (0.1, 0.1, 0.1),
            background: (bottom: (0, 0, 0), top: (250, 120, 60)),
            materials: {{
                "clay": (k_a: 0.5, k_d: 0.9, color: (200, 120, 60), specular: (k_s: 0.8, shininess: 20)),
                "tiles": (k_d: 1, color: (250, 250, 250), pattern: Checker(color: (0, 40, 0), size: 0.3)),
            }},
            entities: [
                (name: "ball", shape: Sphere(radius: 1), material: "clay", transform: (translation: (0, 0, 1))),
                (shape: Plane(normal: (0, 1, 0)), material: "tiles", transform: (translation: (0, -1, 0))),
                (light: Point(intensity: (1e30, 3, 0.3), falloff: (1e-30, 0, 0.1)), transform: (translation: (1, 0.5, -1))),
                (light: Point(intensity: (0.2, 0.4, 0.6)), transform: (translation: (-3, 4, -3))),
            ],
            animate: [
                (target: "ball", channel: Translation, track: Keys([(0, (0, 0, 1)), (1, (2, 0, 1))])),
            ],
        )"#
    );
    let scene = Scene::from_text("bytes.ron", text).unwrap_or_else(|error| panic!("{error}"));
    Engine::from_scene(scene)
}

fn bytes(film: &Film, transfer: Transfer) -> Vec<u8> {
    film.pixels().iter().flat_map(|pixel| transfer.encode(*pixel)).collect()
}

#[test]
fn encoded_films_equal_encoded_linear_films() {
    let blurred = "sampling: (samples: 4, instants: 2),";
    for (transfer, name) in [(Transfer::Classic, "Classic"), (Transfer::Srgb, "Srgb")] {
        for size in ["width: 1, height: 1", "width: 37, height: 22", "width: 130, height: 67"] {
            for sampling in ["", "sampling: (samples: 3),", blurred] {
                let film = format!("{size}, transfer: {name}");
                let mut engines = [engine(&film, sampling), engine(&film, sampling)];
                for time in ["0", "0.5", "0.3"] {
                    let time: Time = time.parse().unwrap();
                    let [linear, encoded] = &mut engines;
                    let linear = linear.render(time).unwrap().film;
                    let encoded = encoded.render(RenderRequest::encoded(time, transfer)).unwrap().film;
                    assert_eq!((encoded.width(), encoded.height()), (linear.width(), linear.height()));
                    let plain = bytes(&linear, transfer);
                    let ranges = plain.contains(&255) && plain.iter().any(|byte| (1..255).contains(byte));
                    assert!(ranges || plain.len() == 3, "{film}, {sampling} at {time} shows little");
                    assert!(encoded.bytes() == plain, "{film}, {sampling} at {time}");
                    assert_eq!(linear.encoded(transfer), encoded);
                }
            }
        }
    }
}

#[test]
fn cancelled_frames_return_no_bytes() {
    let cancelled = AtomicBool::new(true);
    let mut engine = engine("width: 64, height: 48", "");
    let transfer = engine.effective_settings().film.transfer;
    let request_all = || RenderRequest::encoded(Time::ZERO, transfer);
    let request = RenderRequest { signals: Signals::unless(&cancelled), ..request_all() };
    assert!(matches!(engine.render(request), Err(EngineError::Cancelled)));
    let film = engine.render(Time::ZERO).unwrap().film;
    let encoded = engine.render(request_all()).unwrap().film;
    assert!(encoded.bytes() == bytes(&film, transfer));
}
