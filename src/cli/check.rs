//! `rayreel check`

use serde_json::{Value, json};

use rayreel::Scene;
use rayreel::scene::LoadError;

use super::args::CheckArguments;
use super::exit::Failure;
use super::print;

pub(super) fn run(arguments: &CheckArguments) -> Result<(), Failure> {
    let mut results = Vec::new();
    let mut good = true;
    for path in &arguments.scenes {
        let file = path.display().to_string();
        let loaded = Scene::load(path);
        good &= loaded.is_ok();
        match loaded {
            Ok(scene) if arguments.json => results.push(
                json!({ "scene": file, "ok": true, "mistakes": [], "frames": scene.timeline.frame_count() }),
            ),
            Ok(scene) => {
                print::result_line(&format!("{file}: ok, {}", frames(scene.timeline.frame_count())))?;
            }
            Err(error) if arguments.json => results.push(mistakes(&error)),
            Err(error) => {
                print::error_line(&format!("{}\n", error.render(print::is_colorful())));
                let count = error.mistakes().count() + error.unlisted();
                print::error_line(&format!(
                    "{file}: {count} {}",
                    if count == 1 { "mistake" } else { "mistakes" }
                ));
            }
        }
    }
    if arguments.json {
        print::result_line(&format!("{:#}", Value::Array(results)))?;
    }
    if good { Ok(()) } else { Err(Failure::Reported) }
}

fn frames(count: u32) -> String {
    if count == 1 { "1 frame".to_owned() } else { format!("{count} frames") }
}

fn mistakes(error: &LoadError) -> Value {
    let mistakes: Vec<Value> = error
        .mistakes()
        .map(|mistake| {
            json!({
                "file": mistake.file,
                "line": mistake.place.map(|place| place.line),
                "column": mistake.place.map(|place| place.column),
                "message": mistake.diagnostic.message,
                "label": mistake.diagnostic.label,
                "help": mistake.diagnostic.help,
                "included_from": mistake.included_from.iter().map(ToString::to_string).collect::<Vec<_>>(),
            })
        })
        .collect();
    json!({ "scene": error.file(), "ok": false, "mistakes": mistakes, "unlisted": error.unlisted() })
}
