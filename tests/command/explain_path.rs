//! Tests of `rayreel explain --path`: the drawing of a camera's path.

use std::fs;
use std::path::Path;

use crate::{rayreel, stdout_of, text};

/// A camera on a circle of radius 5 around a ball and a box on a floor, once in 4 seconds.
const AROUND: &str = r#"Scene(
    timeline: (fps: 24, duration: 4),
    camera: (position: (0, 2, -8), target: (0, 1, 0)),
    materials: { "clay": (k_a: 1) },
    entities: [
        (shape: Plane(normal: (0, 1, 0)), material: "clay"),
        (shape: Sphere(radius: 1), material: "clay", transform: (translation: (0, 1, 0), scale: (1, 1, 2))),
        (shape: Box(size: (1, 1, 1)), material: "clay", transform: (translation: (2, 0.5, 0))),
    ],
    animate: [ (target: "camera", channel: Position, track: Orbit(center: (0, 2, 0), radius: 5, duration: 4)) ],
)"#;

/// Returns standard output and the drawing.
fn explain(arguments: &[&str]) -> (String, String) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("around.ron"), AROUND).unwrap();
    let fixed = ["explain", "around.ron", "--path", "path.svg"];
    let stdout = stdout_of(folder.path(), [&fixed[..], arguments].concat());
    (stdout, fs::read_to_string(folder.path().join("path.svg")).unwrap())
}

/// An element with its unparsed attributes and its text.
struct Element {
    name: String,
    attributes: String,
    text: String,
}

impl Element {
    fn attribute(&self, name: &str) -> Option<&str> {
        let (_, value) = self.attributes.split_once(&format!(" {name}=\""))?;
        value.split('"').next()
    }

    fn number(&self, name: &str) -> f64 {
        self.attribute(name).unwrap().parse().unwrap()
    }

    fn is(&self, class: &str) -> bool {
        self.attribute("class") == Some(class)
    }
}

/// Parses XML without comments and the like. Panics if it is not well-formed.
fn elements(drawing: &str) -> Vec<Element> {
    let (mut found, mut open) = (Vec::new(), Vec::new());
    for part in drawing.split('<').skip(1) {
        let (tag, text) = part.split_once('>').unwrap();
        assert!(!text.contains('&') || text.contains(';'), "{text}");
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name));
            continue;
        }
        let (tag, closed) = tag.strip_suffix('/').map_or((tag, false), |tag| (tag, true));
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
        let (name, attributes) = tag.split_at(tag.find(' ').unwrap_or(tag.len()));
        found.push(Element {
            name: name.to_owned(),
            attributes: attributes.to_owned(),
            text: text.to_owned(),
        });
        if !closed {
            open.push(name.to_owned());
        }
    }
    assert!(open.is_empty(), "{open:?}");
    found
}

fn of<'a>(elements: &'a [Element], class: &str) -> Vec<&'a Element> {
    elements.iter().filter(|element| element.is(class)).collect()
}

#[test]
fn the_drawing_has_two_views_and_two_charts() {
    let (stdout, drawing) = explain(&[]);
    assert_eq!(
        stdout,
        "path.svg: 96 frames, a path of 31.1 units at 7.85 units a second, turning by up to 90.0 degrees a second\n"
    );
    let elements = elements(&drawing);
    assert_eq!(elements[0].name, "svg");
    assert!(!drawing.contains("NaN") && !drawing.contains("inf"));
    assert_eq!(of(&elements, "eye").len(), 2 + 1); // and one in the legend
    assert_eq!(of(&elements, "value").len(), 2);
    let ticks: Vec<_> =
        of(&elements, "ticks").iter().map(|path| path.attribute("d").unwrap().matches('M').count()).collect();
    assert_eq!(ticks, [96, 96]);
    // In the view from above, the ball is an ellipse twice as long as wide.
    let ball = elements.iter().find(|element| element.name == "ellipse").unwrap();
    assert!((ball.number("rx") / ball.number("ry") - 2.0).abs() < 1e-3);
}

#[test]
fn orbit_is_drawn_as_a_circle() {
    let (_, drawing) = explain(&[]);
    let elements = elements(&drawing);
    let way = of(&elements, "eye")[0].attribute("d").unwrap();
    let places: Vec<[f64; 2]> = way
        .split(['M', 'L'])
        .filter_map(|pair| {
            let (x, y) = pair.trim().split_once(' ')?;
            Some([x.parse().unwrap(), y.parse().unwrap()])
        })
        .collect();
    assert_eq!(places.len(), 96);
    let mean = |axis: usize| places.iter().map(|place| place[axis]).sum::<f64>() / 96.0;
    let middle = [mean(0), mean(1)];
    let radii = places.iter().map(|place| (place[0] - middle[0]).hypot(place[1] - middle[1]));
    let (least, most) =
        radii.fold((f64::MAX, 0.0_f64), |(least, most), radius| (least.min(radius), most.max(radius)));
    assert!(least > 100.0 && most - least < 0.05, "{least} {most}");
    // The path runs from +z, up the page, to +x, to the right.
    assert!(places[0][1] < middle[1] - 0.99 * least && places[24][0] > middle[0] + 0.99 * least);
}

#[test]
fn labels_do_not_overlap() {
    for arguments in [&[][..], &["--frames", "0-47"], &["--frames", "0-95x7"], &["--frames", "3"]] {
        let (_, drawing) = explain(arguments);
        let elements = elements(&drawing);
        let texts: Vec<_> =
            elements.iter().filter(|element| element.name == "text" && !element.is("title")).collect();
        // Left, right, top and bottom of a text in characters of 6 by 10 pixels.
        let extent = |text: &Element| {
            let (x, y, width) = (text.number("x"), text.number("y"), 6.0 * text.text.chars().count() as f64);
            let left = match text.attribute("text-anchor") {
                Some("start") => x,
                Some("middle") => x - 0.5 * width,
                _ => x - width,
            };
            [left, left + width, y - 10.0, y]
        };
        assert!(texts.len() > 20);
        for (index, one) in texts.iter().enumerate() {
            for other in &texts[index + 1..] {
                let ([a, b, c, d], [e, f, g, h]) = (extent(one), extent(other));
                assert!(a >= f || e >= b || c >= h || g >= d, "`{}` and `{}`", one.text, other.text);
            }
        }
    }
}

#[test]
fn only_selected_frames_are_drawn() {
    let (stdout, drawing) = explain(&["--frames", "0-48x2"]);
    assert!(stdout.starts_with("path.svg: 25 frames, "), "{stdout}");
    let elements = elements(&drawing);
    let ticks = of(&elements, "ticks")[0].attribute("d").unwrap().matches('M').count();
    assert_eq!(ticks, 25);
    let (stdout, _) = explain(&["--frames", "7"]);
    assert_eq!(stdout, "path.svg: 1 frame, the eye stands still\n");
}

#[test]
fn long_paths_are_sampled_with_the_last_frame() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("long.ron"), AROUND.replace("duration: 4)", "duration: 600)")).unwrap();
    let described = |frames: &[&str]| {
        let fixed = ["explain", "long.ron", "--path", "path.svg"];
        stdout_of(folder.path(), [&fixed[..], frames].concat())
    };
    // The camera goes around once at constant speed.
    let all = described(&[]);
    assert!(
        all.starts_with("path.svg: 4000 of 14400 frames, a path of 31.4 units at 0.05 units a second"),
        "{all}"
    );
    let drawing = fs::read_to_string(folder.path().join("path.svg")).unwrap();
    assert!(drawing.contains(" frames drawn<") || drawing.contains("every frame drawn<"), "{drawing}");
    assert!(described(&["--frames", "0-4000"]).starts_with("path.svg: 4000 of 4001 frames, "));
    assert!(described(&["--frames", "0-3999"]).starts_with("path.svg: 4000 frames, "));
}

/// Checks that the new drawing replaces the old file. A hard link to the old file keeps its content.
#[test]
fn failed_drawing_keeps_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let [scene, drawing, second_name] =
        ["around.ron", "path.svg", "old.svg"].map(|name| folder.path().join(name));
    fs::write(scene, AROUND).unwrap();
    fs::write(&drawing, "old").unwrap();
    fs::hard_link(&drawing, &second_name).unwrap();
    stdout_of(folder.path(), ["explain", "around.ron", "--path", "path.svg", "--frames", "0-3"]);
    assert!(fs::read_to_string(&drawing).unwrap().ends_with("</svg>\n"));
    assert_eq!(fs::read_to_string(&second_name).unwrap(), "old");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
}

#[test]
fn impossible_drawings_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("around.ron"), AROUND).unwrap();
    let refused = |arguments: &[&str], code: i32, words: &str| {
        let output = rayreel(folder.path(), [&["explain", "around.ron", "--path"], arguments].concat());
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{stderr}");
        assert!(stderr.contains(words), "{stderr}");
    };
    let missing = Path::new("no").join("such").join("folder.svg");
    refused(&[missing.to_str().unwrap()], 1, "cannot write");
    refused(&["around.ron"], 1, "`around.ron` is the scene itself: name another file");
    refused(&["./around.ron"], 1, "is the scene itself");
    assert_eq!(fs::read_to_string(folder.path().join("around.ron")).unwrap(), AROUND);
    refused(&["path.svg", "--measure"], 2, "cannot be used with");
    refused(&["path.svg", "--frames", "96"], 1, "there is no frame 96");
}
