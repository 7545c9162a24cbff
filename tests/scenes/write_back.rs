//! Random changes of values and keys in the texts of the shipped scenes and of random ones. `RAYREEL_CASES` sets their number.

use std::fs;
use std::path::{Path, PathBuf};

use rayreel::color::Transfer;
use rayreel::scene::format::RonValue;
use rayreel::scene::{
    KeyChange, Override, TextChange, WrittenKind, WrittenTrack, WrittenTracks, WrittenValue,
};
use rayreel::{Engine, RenderRequest, Scene, Time};

use crate::model::Model;
use crate::splitmix::Random;

/// Share of the changes that are also compared as worlds.
const COMPARED: usize = 10;
/// Number of random scenes.
const GENERATED: usize = 200;
/// Maximum number of parts of a scene whose values are changed.
const MOST_PARTS: usize = 30;

fn unit(random: &mut Random) -> f64 {
    (random.bits() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Copies the shipped scenes with their data, and writes random ones. Returns those that are whole films.
fn copied(folder: &Path) -> Vec<PathBuf> {
    fn copy(from: &Path, to: &Path) {
        fs::create_dir_all(to).unwrap();
        for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
            let target = to.join(entry.file_name());
            if entry.file_type().unwrap().is_dir() {
                copy(&entry.path(), &target);
            } else {
                fs::copy(entry.path(), target).unwrap();
            }
        }
    }
    copy(Path::new("scenes"), folder);
    let random = &mut Random(42);
    for index in 0..GENERATED {
        let own = folder.join("random").join(index.to_string());
        fs::create_dir_all(&own).unwrap();
        let mut model = Model::new(random);
        (0..6).for_each(|_| model.edit(random));
        let (text, files) = model.files();
        fs::write(own.join("scene.ron"), text).unwrap();
        for (name, text) in files {
            fs::write(own.join(name), text).unwrap();
        }
    }
    let mut scenes: Vec<PathBuf> = ["", "lesson"]
        .iter()
        .flat_map(|part| fs::read_dir(folder.join(part)).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "ron"))
        .collect();
    scenes.sort();
    scenes.extend((0..GENERATED).map(|index| folder.join(format!("random/{index}/scene.ron"))));
    scenes
}

/// Returns the paths of the parts of a scene that have values.
fn parts(text: &str) -> Vec<Vec<String>> {
    let Some(RonValue::Named(fields)) = RonValue::parse(text) else { return Vec::new() };
    let mut parts = Vec::new();
    for (field, value) in fields {
        match value {
            RonValue::Named(members) if ["materials", "cameras"].contains(&field.as_str()) => {
                parts.extend(members.into_iter().map(|(name, _)| vec![field.clone(), name]));
            }
            RonValue::Values(members) if field == "entities" => {
                parts.extend((0..members.len()).map(|index| vec![field.clone(), index.to_string()]));
            }
            RonValue::Named(_) => parts.push(vec![field]),
            _ => {}
        }
    }
    parts
}

/// Returns the text of another value of the same kind.
fn other(value: &WrittenValue, random: &mut Random) -> String {
    let (least, most) = (value.least.unwrap_or(-20.0), value.most.unwrap_or(20.0));
    let most = most.min(least + 100.0);
    let number = least + (0.01 + 0.98 * unit(random)) * (most - least);
    match value.kind {
        WrittenKind::Number => format!("{number:?}"),
        WrittenKind::Whole => format!("{}", number.ceil()),
        WrittenKind::Flag => (value.text != "true").to_string(),
        WrittenKind::Color if value.text.starts_with('"') => format!("\"#{:06x}\"", random.index(1 << 24)),
        WrittenKind::Color => {
            format!("({}, {}, {})", random.index(256), random.index(256), random.index(256))
        }
        WrittenKind::Vector => {
            let count = value.text.matches(',').count()
                - usize::from(value.text.trim_end_matches([')', ' ']).ends_with(','))
                + 1;
            let numbers: Vec<String> =
                (0..count).map(|_| format!("{:?}", 0.1 + 5.0 * unit(random))).collect();
            let word = &value.text[..value.text.find('(').unwrap()];
            format!("{word}({})", numbers.join(", "))
        }
    }
}

#[test]
fn changes_touch_only_the_value() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = copied(folder.path());
    let mut random = Random(40);
    let all: Vec<(PathBuf, String, Vec<WrittenValue>)> = scenes
        .into_iter()
        .map(|scene| {
            let text = fs::read_to_string(&scene).unwrap();
            let files = [scene.clone()];
            let parts = parts(&text);
            // Scenes of hundreds of entities repeat themselves.
            let every = parts.len().div_ceil(MOST_PARTS).max(1);
            let values =
                parts.iter().step_by(every).flat_map(|path| WrittenValue::all(path, &files)).collect();
            (scene, text, values)
        })
        .filter(|(_, _, values): &(_, _, Vec<WrittenValue>)| !values.is_empty())
        .collect();
    assert!(all.len() > 25, "{}", all.len());
    let mut accepted = 0;
    let changes = std::env::var("RAYREEL_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(1000);
    for change in 0..changes {
        let (scene, text, values) = &all[random.index(all.len())];
        let value = &values[random.index(values.len())];
        let new = other(value, &mut random);
        let set: Override = format!("{}={new}", value.path).parse().unwrap();
        let files = [scene.clone()];
        let made = TextChange::setting(std::slice::from_ref(&set), &files).unwrap();
        let [TextChange { before, after, .. }] = &made[..] else {
            assert_eq!(new, value.text, "{}", value.path);
            continue;
        };
        assert_eq!(before, text);
        // The texts agree but for the value.
        let same = before.bytes().zip(after.bytes()).take_while(|(before, after)| before == after).count();
        let tail = |text: &str| text.len() - same;
        let rest = before
            .bytes()
            .rev()
            .zip(after.bytes().rev())
            .take_while(|(before, after)| before == after)
            .count();
        let rest = rest.min(tail(before)).min(tail(after));
        let (old_length, new_length) = (before.len() - same - rest, after.len() - same - rest);
        assert!(
            old_length <= value.text.len() && new_length <= new.len(),
            "{set}: {old_length} {new_length}"
        );
        assert!(RonValue::parse(after).is_some(), "{set}");
        if change % COMPARED == 0 {
            accepted += usize::from(equals_the_overridden(scene, &set, &made[0]));
        }
    }
    // Random values may contradict others, as the ends of a range; most do not.
    assert!(2 * accepted > changes / COMPARED, "{accepted}");
}

/// Returns the texts of comments, in order.
fn comments(text: &str) -> Vec<&str> {
    text.lines().filter_map(|line| Some(line.split_once("//")?.1)).collect()
}

/// Returns the times, values and easings of keys.
fn keys(track: &WrittenTrack) -> Vec<(f64, String, Option<String>)> {
    track.keys.iter().map(|key| (key.time, key.text.clone(), key.easing.clone())).collect()
}

#[test]
fn changes_of_keys_leave_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(41);
    let scenes = copied(folder.path());
    let all: Vec<(PathBuf, WrittenTracks)> = scenes
        .into_iter()
        // Not all random scenes are valid, and the page changes only keys of those that are.
        .filter(|scene| Scene::load(scene).is_ok())
        .map(|scene| (scene.clone(), WrittenTracks::of(&[scene])))
        .filter(|(_, tracks)| !tracks.tracks.is_empty())
        .collect();
    assert!(all.len() > 15, "{}", all.len());
    let changes = std::env::var("RAYREEL_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(1000);
    let (mut made, mut accepted) = ([0; 3], 0);
    for case in 0..changes {
        let (scene, tracks) = &all[random.index(all.len())];
        let track = &tracks.tracks[random.index(tracks.tracks.len())];
        let (path, index) = (track.path.clone(), random.index(track.keys.len()));
        let mut expected = keys(track);
        let time = (100.0 * (track.keys[index].time + 0.37 + unit(&mut random))).round() / 100.0;
        let change = match case % 3 {
            0 => KeyChange::Add(path, time),
            1 => KeyChange::Remove(path, track.keys[index].time),
            _ => KeyChange::Ease(path, track.keys[index].time, "EaseIn".to_owned()),
        };
        let files = [scene.clone()];
        let set = match change.to_override(&files, &[], Transfer::Srgb) {
            Ok(set) => set,
            Err(why) => {
                assert!(track.keys.len() == 1 && case % 3 == 1 || why.contains("already"), "{why}");
                continue;
            }
        };
        let changes = TextChange::setting(std::slice::from_ref(&set), &files).unwrap();
        let [TextChange { before, after, .. }] = &changes[..] else {
            assert!(expected[index].2.as_deref() == Some("EaseIn"), "{set}");
            continue;
        };
        assert_eq!(comments(before), comments(after), "{set}");
        fs::write(scene, after).unwrap();
        let changed = WrittenTracks::of(&files);
        fs::write(scene, before).unwrap();
        let found = keys(changed.tracks.iter().find(|other| other.path == track.path).unwrap());
        match case % 3 {
            0 => {
                let place = expected.partition_point(|key| key.0 < time);
                assert_eq!(found[place].0, time);
                expected.insert(place, found[place].clone());
            }
            1 => drop(expected.remove(index)),
            _ => expected[index].2 = Some("EaseIn".to_owned()),
        }
        assert_eq!(found, expected, "{set}");
        made[case % 3] += 1;
        // An easing is wrong for shots and for flags.
        if case % COMPARED == 0 {
            accepted += usize::from(equals_the_overridden(scene, &set, &changes[0]));
        }
    }
    assert!(made.iter().all(|made| 4 * made > changes / 3), "{made:?}");
    assert!(2 * accepted > changes / COMPARED, "{accepted}");
}

#[test]
fn added_keys_have_the_value_that_the_track_has() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.ron");
    let text = r##"(
        film: (transfer: Srgb),
        shots: [(0, "a"), (2, "b")],
        animate: [
            (target: "a", channel: Translation, track: Keys([
                (0, (0, 0, 1)), // start
                (2, (4, -2, 1), Hold),
                (3, (0, 0, 0)),
            ])),
            (target: "a", channel: Rotation, offset: 1, speed: 2, track: Keys([(0, Euler(0, 0, 0)), (2, Euler(0, 90, 0))])),
            (target: "a", channel: Color, track: Keys([(0, "#000000"), (1, (255, 255, 255))])),
            (target: "camera", channel: Fov, track: Keys([(0, 30), (1, 40)])),
            (target: "a", channel: Scale, track: Keys([(0, 1, EaseIn), (1, (3, 3, 1))])),
            (target: "a", channel: Visible, track: Keys([(0, true), (2, false)])),
            (target: "lamp", channel: Intensity, track: Keys([(0, (0, 0, 0)), (1, (2, 1, 0.5))])),
            (target: "a", channel: Radius, track: Script("1.0")),
        ],
    )"##;
    fs::write(&scene, text).unwrap();
    let files = [scene];
    let tracks = WrittenTracks::of(&files);
    assert_eq!(tracks.tracks.len(), 8, "{tracks:?}");
    for (track, time, key) in [
        ("shots", 3.0, ", (3, \"b\")]"),
        (
            "animate.0.track.0",
            1.0,
            "\n                (1, (2, -1, 1)),\n                (2, (4, -2, 1), Hold)",
        ),
        ("animate.0.track.0", 2.5, " (2.5, (4, -2, 1), Hold),\n                (3, (0, 0, 0))"),
        ("animate.1.track.0", 1.0, "(1, Euler(0, 45, 0)), (2, "),
        ("animate.2.track.0", 0.5, "(0.5, (187.52, 187.52, 187.52)), (1, "),
        ("animate.3.track.0", 0.25, "(0.25, 32.5), (1, 40)"),
        ("animate.4.track.0", 0.5, "(0.5, (1.5, 1.5, 1), EaseIn), (1, "),
        ("animate.5.track.0", 1.0, "(1, true), (2, "),
        ("animate.6.track.0", 4.0, "(1, (2, 1, 0.5)), (4, (2, 1, 0.5))]"),
    ] {
        let set = KeyChange::Add(track.to_owned(), time).to_override(&files, &[], Transfer::Srgb).unwrap();
        let after = &TextChange::setting(std::slice::from_ref(&set), &files).unwrap()[0].after;
        assert!(after.contains(key), "{key} in {set}");
    }
    // A key is set in the file, or in the override of its list.
    let set = |time: f64, tried: &[Override]| {
        let change = KeyChange::Set("animate.0.track.0".to_owned(), time, "(7, 7, 7)".to_owned());
        change.to_override(&files, tried, Transfer::Srgb).unwrap()
    };
    let first = set(2.0, &[]);
    assert!(first.value().contains("(2, (7, 7, 7), Hold),\n                (3, (0, 0, 0)"), "{first}");
    let second = set(31.0 / 24.0, std::slice::from_ref(&first));
    let keys = "// start\n                (1.291666, (7, 7, 7)),\n                (2, (7, 7, 7), Hold)";
    assert!(second.value().contains(keys), "{second}");
    assert_eq!(set(31.0 / 24.0, std::slice::from_ref(&second)), second);
    for (change, why) in [
        (KeyChange::Add("animate.0.track.0".to_owned(), 2.0), "there is a key at this time already"),
        (KeyChange::Set("animate.0.track.0".to_owned(), 2.0, "1, 2".to_owned()), "`1, 2` is no value"),
        (KeyChange::Remove("animate.7.track.0".to_owned(), 0.0), "the file has no such key any more"),
        (KeyChange::Remove("animate.0.track.0".to_owned(), 2.5), "the file has no such key any more"),
        (
            KeyChange::Ease("animate.0.track.0".to_owned(), 2.0, "Hold), (9, 1".to_owned()),
            "`Hold), (9, 1` is no easing",
        ),
    ] {
        assert_eq!(change.to_override(&files, &[], Transfer::Srgb).unwrap_err(), why);
    }
}

/// Compares the world of a changed text with that of an override. Returns whether the scene is valid.
fn equals_the_overridden(scene: &Path, set: &Override, change: &TextChange) -> bool {
    let overridden = Scene::load_overridden(scene, std::slice::from_ref(set));
    fs::write(&change.file, &change.after).unwrap();
    let edited = Scene::load(scene);
    fs::write(&change.file, &change.before).unwrap();
    let fingerprint = |scene| {
        let planned =
            Engine::from_scene(scene).plan(RenderRequest::at(Time::ZERO)).map(|report| report.fingerprint);
        planned.map_err(|error| error.to_string())
    };
    match (overridden, edited) {
        (Ok((overridden, _)), Ok(edited)) => {
            assert_eq!(fingerprint(overridden), fingerprint(edited), "{} {set}", scene.display());
            true
        }
        (Err(_), Err(_)) => false,
        (overridden, edited) => {
            panic!("{} {set}: {} {}", scene.display(), overridden.is_ok(), edited.is_ok())
        }
    }
}
