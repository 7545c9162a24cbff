//! Open Job Description, as AWS Deadline Cloud and others take it: a step of shards, and one that looks at what is there.
//!
//! The template is JSON, which is YAML, too.

use anyhow::bail;
use serde_json::{Value, json};

use super::Farm;

/// Returns the job template (specification of 2023-09).
pub(super) fn template(farm: &Farm) -> anyhow::Result<String> {
    let words = farm.render("").into_iter().chain(farm.verify());
    // What is in double braces the scheduler replaces.
    if let Some(word) = words.into_iter().find(|word| word.contains("{{")) {
        bail!("`{word}` has `{{{{` in it, which Open Job Description takes for a parameter");
    }
    let range = format!("0-{}", farm.shards - 1);
    let mut verify = step("Verify", &farm.verify());
    verify["dependencies"] = json!([{ "dependsOn": "Render" }]);
    let mut shards = step("Render", &farm.render("{{Task.Param.Shard}}"));
    shards["parameterSpace"] =
        json!({ "taskParameterDefinitions": [{ "name": "Shard", "type": "INT", "range": range }] });
    let template = json!({
        "specificationVersion": "jobtemplate-2023-09",
        "name": farm.name,
        "description": "Renders a sequence in shards, which share a folder, and then looks whether all frames are there.",
        "steps": [shards, verify],
    });
    Ok(format!("{}\n", serde_json::to_string_pretty(&template)?))
}

fn step(name: &str, words: &[String]) -> Value {
    let (command, arguments) = words.split_first().map_or(("", &[][..]), |(first, rest)| (first, rest));
    json!({ "name": name, "script": { "actions": { "onRun": { "command": command, "args": arguments } } } })
}
