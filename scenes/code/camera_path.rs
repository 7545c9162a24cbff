//! A camera that code moves through a scene file: it backs away from the temple of `scenes/fly_around.ron` and zooms in at the same rate, so
//! that the temple keeps its size while its columns draw together. `cargo run --release --example camera_path` makes the movie
//! `out/camera_path.mp4`, or the file that it is given, as `temple.gif`.

use std::error::Error;

use rayreel::components::{Camera, Projection, View};
use rayreel::glam::DVec3;
use rayreel::time::Timeline;
use rayreel::{Context, Engine, EngineError};

/// The point that the camera backs away from.
const SUBJECT: DVec3 = DVec3::new(0.0, 2.5, 0.0);

/// Places the camera. As a pure system, it depends on the time alone, and writes over the animations of the scene.
fn dolly_zoom(context: &mut Context<'_>) {
    let distance = 10.0 + 12.0 * context.time.seconds();
    for camera in context.world.query_mut::<&mut Camera>() {
        camera.position = SUBJECT + distance * DVec3::new(0.4, 0.1, -1.0).normalize();
        camera.view = View::Target(SUBJECT);
        // The screen stands at the subject, which therefore has the same size from every distance.
        camera.projection = Projection::Screen { distance, width: None, height: 8.0 };
    }
    // No shape has changed: only cameras, lights and settings are read again.
    context.changes.mark_settings();
}

pub(crate) fn engine() -> Result<Engine, EngineError> {
    let mut engine = Engine::load("scenes/fly_around.ron")?;
    engine.timeline = Timeline::new(24, 4.0);
    engine.add_system(dolly_zoom);
    Ok(engine)
}

#[allow(clippy::print_stdout, reason = "a program prints its report")]
fn main() -> Result<(), Box<dyn Error>> {
    let movie = std::env::args().nth(1).unwrap_or("out/camera_path.mp4".to_owned());
    let report = engine()?.render_movie(&movie)?;
    println!("{movie}: {report}");
    Ok(())
}
