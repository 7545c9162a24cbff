//! Random changes of values in the texts of the shipped scenes. `RAYREEL_CASES` sets their number.

use std::fs;
use std::path::{Path, PathBuf};

use rayreel::scene::format::RonValue;
use rayreel::scene::{Override, TextChange, WrittenKind, WrittenValue};
use rayreel::{Engine, RenderRequest, Scene, Time};

use crate::splitmix::Random;

/// Share of the changes that are also compared as worlds.
const COMPARED: usize = 10;
/// Maximum number of parts of a scene whose values are changed.
const MOST_PARTS: usize = 30;

fn unit(random: &mut Random) -> f64 {
    (random.bits() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Copies the scenes with their data, and returns those that are whole films.
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
    let mut scenes: Vec<PathBuf> = ["", "lesson"]
        .iter()
        .flat_map(|part| fs::read_dir(folder.join(part)).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "ron"))
        .collect();
    scenes.sort();
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
            format!("({})", numbers.join(", "))
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
