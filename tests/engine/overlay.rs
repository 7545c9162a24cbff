//! Tests of texts, scale bars and legends over the picture.

use std::fs;
use std::path::Path;

use rayreel::clouds::ColorMap;
use rayreel::color::Transfer;
use rayreel::components::Sampling;
use rayreel::scene::Reader;
use rayreel::{Engine, Film, RenderRequest, RenderSettings, Rgb, Scene, Time};

/// Two frames with times, and three elements, of which the filter of the scene keeps two.
const DATA: &str = "3
Properties=species:S:1:pos:R:3:speed:R:1 Time=0.5
O 0 0 0 0
H 1 0 0 2
C 2 0 0 4
3
Properties=species:S:1:pos:R:3:speed:R:1 Time=1.75
O 0 0 0 0
H 1 0 0 2
C 2 0 0 4
";

/// Returns a folder with a scene of particles far below the picture, black but for the overlay.
fn folder(overlay: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("gas.extxyz"), DATA).unwrap();
    write(folder.path(), overlay);
    folder
}

fn write(folder: &Path, overlay: &str) {
    let text = format!(
        "(
    timeline: (fps: 10, duration: 2), film: (width: 200, height: 100, transfer: Classic), space: RightHanded,
    camera: (position: (0, 0, 10), target: (0, 0, 0), orthographic: 10),
    clouds: [
        (name: \"gas\", source: \"gas.extxyz\", color_by: Map(column: \"speed\", range: (0, 3)), transform: (translation: (0, 99, 0)),
         frames: (fps: 1)),
        (name: \"kinds\", source: \"gas.extxyz\", color_by: Element, filter: \"element != 'H'\", transform: (translation: (0, 99, 0))),
    ],
    overlay: [{overlay}],
)"
    );
    fs::write(folder.join("scene.ron"), text).unwrap();
}

fn load(folder: &Path) -> Engine {
    Engine::load(folder.join("scene.ron")).unwrap()
}

fn film(overlay: &str, time: &str) -> Film {
    load(folder(overlay).path()).render(time.parse::<Time>().unwrap()).unwrap().film
}

/// Returns the first and the last column and row of the pixels that are brighter than black.
fn bounds(film: &Film) -> Option<[u32; 4]> {
    let lit = |(i, j): &(u32, u32)| film.pixel(*i, *j) != Rgb::ZERO;
    let places = (0..film.height()).flat_map(|j| (0..film.width()).map(move |i| (i, j)));
    let lit: Vec<(u32, u32)> = places.filter(lit).collect();
    let [least, most] = [u32::min, u32::max]
        .map(|of| (lit.iter().map(|(i, _)| *i).reduce(of), lit.iter().map(|(_, j)| *j).reduce(of)));
    Some([least.0?, most.0?, least.1?, most.1?])
}

const ALL: &str = "Text(text: \"t = {time:1} ps,\\nframe {frame}\", cloud: \"gas\"), Legend(cloud: \"gas\", anchor: BottomRight, size: 0.08),
    ScaleBar(length: 5, label: \"half\", anchor: BottomLeft, color: (255, 0, 0)), Legend(cloud: \"kinds\", title: \"\", anchor: TopRight)";

#[test]
fn all_paths_give_the_same_bits() {
    // One of them is half transparent at the moment.
    let folder = self::folder(&format!(
        "{ALL}, Text(text: \"late\", anchor: Center, size: 0.9, times: (-1, 1), fade: 2)"
    ));
    for (samples, max_error, alpha) in [(1, 0.0, false), (1, 0.0, true), (3, 0.0, true), (16, 1.0, false)] {
        let mut engine = load(folder.path());
        for sampling in engine.world_mut().query_mut::<&mut Sampling>() {
            *sampling = Sampling { samples, max_error, ..*sampling };
        }
        for size in [(200, 100), (37, 23)] {
            let settings = RenderSettings { size: Some(size), ..engine.settings };
            let request =
                || RenderRequest { alpha, settings: Some(settings), ..RenderRequest::at(Time::ZERO) };
            let image = engine.render(request()).unwrap();
            let expected = engine.render(RenderRequest { reference: true, ..request() }).unwrap();
            assert!(image == expected, "{samples} samples, alpha: {alpha}, {size:?}");
            let encoding = Transfer::Classic;
            let encoded = RenderRequest {
                alpha,
                settings: Some(settings),
                ..RenderRequest::encoded(Time::ZERO, encoding)
            };
            assert!(engine.render(encoded).unwrap().film == image.film.encoded(encoding));
            let covered = image.alpha.iter().flat_map(Film::pixels);
            let covers =
                covered.zip(image.film.pixels()).all(|(alpha, light)| *alpha == 0.0 || *light != Rgb::ZERO);
            assert!(covers);
        }
    }
}

#[test]
fn a_scale_bar_has_its_length() {
    let bar = |settings: &str| {
        let film = film(&format!("ScaleBar(length: 5, label: \"\", {settings})"), "0");
        bounds(&film).map(|[left, right, top, _]| (left, right - left + 1, top))
    };
    // The picture is 10 units and 100 pixels high, with a margin of 2.5 pixels.
    assert_eq!(bar("anchor: TopLeft"), Some((3, 50, 3)));
    assert_eq!(bar("anchor: BottomRight"), Some((147, 50, 96)));
    assert_eq!(bar("anchor: Top, at: (0, 0, 5)"), Some((75, 50, 3)));
    let endless = film("ScaleBar(length: 1e60, label: \"\", size: 1)", "0");
    assert_eq!(bounds(&endless).map(|[left, right, ..]| (left, right)), Some((3, 199)));
    let folder = folder("ScaleBar(length: 5, label: \"\", at: (1, 2, 6))");
    let path = folder.path().join("scene.ron");
    let text = fs::read_to_string(&path).unwrap();
    // Half as high at 4 units from the eye: 2 * 4 * tan(45 degrees) = 8 units are 100 pixels.
    fs::write(&path, text.replace("orthographic: 10", "fov: 90")).unwrap();
    let found = bounds(&load(folder.path()).render_frame(0).unwrap()).unwrap();
    assert_eq!(found[1] - found[0] + 1, 63);
    // Behind the camera there is no length.
    fs::write(&path, text.replace("orthographic: 10", "fov: 90").replace("(1, 2, 6)", "(0, 0, 11)")).unwrap();
    assert_eq!(bounds(&load(folder.path()).render_frame(0).unwrap()), None);
}

#[test]
fn texts_follow_the_film_and_the_data() {
    let text = |text: &str, time: &str| film(&format!("Text(text: \"{text}\", size: 0.2)"), time);
    assert!(text("t = {time:1}", "0.7") == text("t = 0.7", "0"));
    assert!(text("{time}", "1") == text("1.00", "0"));
    assert!(text("{time}", "1") != text("1.01", "0"));
    let of_data =
        |text: &str, time: &str| film(&format!("Text(text: \"{text}\", cloud: \"gas\", size: 0.2)"), time);
    assert!(of_data("{time} {frame}", "0.9") == text("0.50 0", "0"));
    assert!(of_data("{time} {frame}", "1") == text("1.75 1", "0"));
    // Two lines, right-aligned, at the bottom.
    let film = film("Text(text: \"i\\niiiii\", anchor: BottomRight, size: 0.2)", "0");
    let [left, right, top, bottom] = bounds(&film).unwrap();
    assert!(right > 190 && bottom > 85 && top > 55 && left > 160, "{left} {right} {top} {bottom}");
    let lit = |i: u32, rows: std::ops::Range<u32>| rows.into_iter().any(|j| film.pixel(i, j) != Rgb::ZERO);
    assert!(!lit(left, 55..77) && lit(left, 77..100));
}

#[test]
fn titles_are_shown_between_their_times() {
    let title = |times: &str| {
        let folder = folder(&format!("Text(text: \"{{{{title}}\", anchor: Center, size: 0.5{times})"));
        move |time: &str| load(folder.path()).render(time.parse::<Time>().unwrap()).unwrap().film
    };
    let always = title("")("0");
    let [left, right, top, bottom] = bounds(&always).unwrap();
    assert!(
        left.abs_diff(199 - right) < 8 && (top + bottom).abs_diff(99) < 16,
        "{left} {right} {top} {bottom}"
    );
    let cut = title(", times: (0.5, 1.5)");
    for (time, is_shown) in [("0.4", false), ("0.5", true), ("1.4", true), ("1.5", false)] {
        assert!(cut(time) == if is_shown { always.clone() } else { film("", "0") }, "{time}");
    }
    let faded = title(", times: (0.5, 1.5), fade: 0.4");
    assert!(bounds(&faded("0.5")).is_none() && faded("1") == always);
    for (time, opacity) in [("0.6", 0.25), ("0.7", 0.5), ("1.4", 0.25)] {
        for (found, full) in faded(time).pixels().iter().zip(always.pixels()) {
            assert!((*found - *full * opacity).abs().max_element() < 1e-6, "{time}: {found} of {full}");
        }
    }
}

#[test]
fn legends_show_the_colours_that_they_explain() {
    let overlay = "Legend(cloud: \"gas\", size: 0.1)";
    let film = film(overlay, "0");
    // A bar of 9 lines of 10 pixels. Each pixel has the colour of the map at its centre.
    let film = film.encoded(Transfer::Classic);
    let map = ColorMap::Viridis.colors();
    let colors: Vec<[f64; 3]> = (0..90).map(|column| map[(2 * column + 1) * 256 / 180]).collect();
    let row = |j: u32| (0..200).map(|i| film.pixel(i, j).map(f64::from)).collect::<Vec<_>>();
    let has_bar = |j: &u32| row(*j).windows(90).any(|colors_here| colors_here == colors);
    assert_eq!((0..100).filter(has_bar).count(), 6);
    let kinds = self::film("Legend(cloud: \"kinds\", size: 0.1)", "0").encoded(Transfer::Classic);
    let has = |color: [u8; 3]| kinds.pixels().contains(&color);
    assert!(has([255, 13, 13]) && has([144, 144, 144]), "oxygen and carbon");
}

#[test]
fn edits_of_the_overlay_are_shown_and_known_by_the_fingerprint() {
    let folder = folder("Text(text: \"one\")");
    let mut reader = Reader::new();
    let mut engine = Engine::from_scene(reader.load(&folder.path().join("scene.ron")).unwrap().0);
    let mut seen = Vec::new();
    for overlay in ["Text(text: \"one\")", "Text(text: \"two\")", ALL, "", "Legend(cloud: \"gas\")"] {
        write(folder.path(), overlay);
        engine.reload(reader.load(&folder.path().join("scene.ron")).unwrap().0);
        let film = engine.render(Time::ZERO).unwrap().film;
        assert!(film == load(folder.path()).render(Time::ZERO).unwrap().film, "{overlay}");
        let fingerprint = engine.report().fingerprint.unwrap();
        assert!(!seen.contains(&fingerprint), "{overlay}");
        assert_eq!(engine.plan(Time::ZERO).unwrap().fingerprint, Some(fingerprint));
        seen.push(fingerprint);
    }
    // A time in the text makes the frames of a still scene differ.
    write(folder.path(), "Text(text: \"{time:9}\")");
    let mut engine = load(folder.path());
    let fingerprints = [0, 1].map(|frame| {
        engine.render_frame(frame).unwrap();
        engine.report().fingerprint
    });
    assert_ne!(fingerprints[0], fingerprints[1]);
}

#[test]
fn mistakes_are_reported() {
    let message = |overlay: &str| {
        let folder = folder(overlay);
        Scene::load(&folder.path().join("scene.ron")).err().unwrap().to_string()
    };
    for (overlay, expected) in [
        ("Text(text: \"{date}\")", "`{date}` stands for nothing"),
        ("Text(text: \"{frame}\")", "`{frame}` is the frame of a data file"),
        ("Text(text: \"\", size: 2)", "a share of the picture's height"),
        ("Legend(cloud: \"nobody\")", "there is no entity \"nobody\""),
        ("Legend(cloud: \"gas/1\")", "\"gas/1\" is no cloud"),
        ("ScaleBar(length: 0, label: \"\")", "length"),
        ("Text(text: \"\", times: (2, 2))", "the first of the `times` is not before the second"),
        ("Text(text: \"\", times: (0, inf))", "this number is too large"),
        ("Text(text: \"\", times: (0, 2), fade: -1)", "`fade` is a duration"),
        ("Text(text: \"\", fade: 1)", "an item that is always shown does not fade"),
    ] {
        let found = message(overlay);
        assert!(found.contains(expected), "{overlay}: {found}");
    }
}
