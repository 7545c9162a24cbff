//! `rayreel explain --path`: the camera's path as a drawing.
//!
//! [`view`] draws the path from above and from the side, and [`chart`] draws speeds over time.

mod chart;
mod view;

use std::path::Path;

use rayreel::Engine;
use rayreel::time::FrameList;

use super::super::exit::Failure;
use super::super::print;
use super::super::write_file::{ensure_not_the_scene, write_file};
use rayreel::drawing::{Area, CameraPath, Svg, TextAnchor, VIEW_STYLE};

/// Style sheet of the path, in addition to that of the views.
const STYLE: &str = "
.moment { fill: #3b7dd8 }
.target { stroke: #d98324; stroke-width: 1.2; stroke-opacity: 0.7 }
.target-dot { fill: #d98324; fill-opacity: 0.8 }
.view { stroke: #2f9e6e; stroke-width: 1.2; stroke-opacity: 0.85 }
.eye { stroke: #3b7dd8; stroke-width: 1.6 }
.ticks { stroke: #3b7dd8; stroke-width: 1 }
.eye-dot { fill: #3b7dd8 }
.value { stroke: #3b7dd8; stroke-width: 1.4 }
";

/// Draws the camera's path over these frames to a file and prints its length and speed.
pub(super) fn draw(
    engine: &mut Engine,
    frames: &FrameList,
    scene: &Path,
    file: &Path,
) -> Result<(), Failure> {
    ensure_not_the_scene(file, scene)?;
    let path = CameraPath::of(engine, frames)?;
    let name = scene.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    write_file(file, drawing(&path, &name).as_bytes())?;
    print::result_line(&format!("{}: {}", file.display(), path.describe()))?;
    Ok(())
}

/// Draws two square views and two charts below them.
fn drawing(path: &CameraPath, name: &str) -> String {
    let mut svg = Svg::standalone(
        [960.0, 860.0],
        &format!("The camera's path in {name}"),
        &[VIEW_STYLE, STYLE].concat(),
    );
    svg.text("title", [20.0, 28.0], TextAnchor::Start, name);
    svg.text("", [20.0, 48.0], TextAnchor::Start, &path.describe());
    let frames = [
        Area { left: 56.0, top: 76.0, width: 410.0, height: 410.0 },
        Area { left: 526.0, top: 76.0, width: 410.0, height: 410.0 },
    ];
    view::draw(&mut svg, path, frames);
    chart::draw(
        &mut svg,
        &path.speeds(),
        Area { left: 56.0, top: 586.0, width: 880.0, height: 90.0 },
        "speed, units per second",
    );
    chart::draw(
        &mut svg,
        &path.turn_rates(),
        Area { left: 56.0, top: 736.0, width: 880.0, height: 90.0 },
        "turning, degrees per second",
    );
    svg.finish()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use rayreel::drawing::CameraSample;

    fn sample(seconds: f64, eye: DVec3, camera: &str) -> CameraSample {
        CameraSample {
            frame: 0,
            seconds,
            eye,
            axes: [DVec3::X, DVec3::Y, DVec3::Z],
            half_size: [0.5; 2],
            is_orthographic: false,
            target: Some(DVec3::ZERO),
            camera: Some(camera.to_owned()),
        }
    }

    /// Returns a path of two shots: one second along a line, then one second along another line.
    fn with_a_cut(size: f64) -> CameraPath {
        let at = |index: u32, from: DVec3, camera| {
            let along = size * f64::from(index) * DVec3::new(0.1, 0.0, 0.05);
            sample(f64::from(index) / 10.0, size * from + along, camera)
        };
        let first = (0..10).map(|index| at(index, DVec3::ZERO, "wide"));
        let second = (10..20).map(|index| at(index, DVec3::new(-3.0, 2.0, 4.0), "close & low"));
        CameraPath { samples: first.chain(second).collect(), spread_over: None, shapes: Vec::new() }
    }

    /// Returns the number of points of each line of a class, path element by path element.
    fn lines(drawing: &str, class: &str) -> Vec<Vec<usize>> {
        let start = format!("<path class=\"{class}\" d=\"");
        let paths = drawing.split(&start).skip(1).filter_map(|rest| rest.split('"').next());
        let points = |line: &str| line.matches('L').count() + 1;
        paths.map(|path| path.split('M').skip(1).map(points).collect()).collect()
    }

    #[test]
    fn cuts_are_gaps_in_path_and_charts() {
        let drawing = drawing(&with_a_cut(1.0), "two.ron");
        // Two views with two lines each, one point per frame, and the legend.
        assert_eq!(lines(&drawing, "eye"), [[10], [10], [10], [10], [2]]);
        assert_eq!(lines(&drawing, "value"), [[9, 9], [9, 9]]);
        assert!(
            drawing.contains("20 frames in 2 shots, a path of 2.01 units at 1.12 units a second"),
            "{drawing}"
        );
        assert!(drawing.contains(">wide, 0 s<") && drawing.contains(">close &amp; low, 1 s<"), "{drawing}");
    }

    #[test]
    fn ticks_are_thinned_when_too_close() {
        let many = |count: u32, length: f64| {
            let at = |index: u32| {
                let u = f64::from(index) / f64::from(count - 1);
                sample(f64::from(index) / 24.0, DVec3::new(length * u, 0.0, 0.0), "camera")
            };
            // The distant target fixes the scale of the views.
            let mut samples: Vec<_> = (0..count).map(at).collect();
            samples[0].target = Some(DVec3::new(0.0, 0.0, 100.0));
            drawing(&CameraPath { samples, spread_over: None, shapes: Vec::new() }, "many.ron")
        };
        for (count, length, stride) in [(50, 100.0, 1), (150, 100.0, 2), (2000, 100.0, 50), (50, 10.0, 10)] {
            let drawing = many(count, length);
            // In the side view the path runs along the line of sight and has no ticks.
            let ticks: usize = lines(&drawing, "ticks").iter().map(Vec::len).sum();
            assert_eq!(ticks, count.div_ceil(stride) as usize, "{count} frames over {length}");
            let said = if stride == 1 { "every frame".to_owned() } else { format!("every {stride} frames") };
            assert!(drawing.contains(&said), "{count} frames over {length}");
        }
    }

    #[test]
    fn any_camera_path_draws_finite_numbers() {
        let still = |count: u32| {
            let samples = (0..count).map(|index| sample(f64::from(index), DVec3::ZERO, "camera")).collect();
            CameraPath { samples, spread_over: None, shapes: Vec::new() }
        };
        for path in [with_a_cut(1e60), with_a_cut(1e-60), with_a_cut(0.0), still(0), still(1), still(30)] {
            let drawing = drawing(&path, "<odd> \"name\"");
            assert!(!drawing.contains("NaN") && !drawing.contains("inf"), "{drawing}");
            assert!(drawing.starts_with("<svg ") && drawing.ends_with("</svg>\n"));
            assert!(drawing.contains("&lt;odd&gt; &quot;name&quot;"));
        }
    }
}
