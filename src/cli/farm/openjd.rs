//! Open Job Description, as AWS Deadline Cloud and others take it: a step of shards, and one that looks at what is there.
//!
//! The template is JSON, which is YAML, too.

use anyhow::{Context, bail};
use serde_json::{Value, json};

use super::{Farm, in_words};

/// Returns the job template (specification of 2023-09).
pub(super) fn template(farm: &Farm) -> anyhow::Result<String> {
    let here = std::env::current_dir().context("the working directory is gone")?;
    let here = in_words(&here)?;
    let words = farm.render("").into_iter().chain(farm.verify()).chain([here.clone()]);
    // What is in double braces the scheduler replaces.
    if let Some(word) = words.into_iter().find(|word| word.contains("{{")) {
        bail!("`{word}` has `{{{{` in it, which Open Job Description takes for a parameter");
    }
    let range = format!("0-{}", farm.shards - 1);
    let mut verify = step("Verify", &here, farm.verify());
    verify["dependencies"] = json!([{ "dependsOn": "Render" }]);
    let mut shards = step("Render", &here, farm.render("{{Task.Param.Shard}}"));
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

/// Returns a step that runs a command in a folder: sessions have working directories of their own.
fn step(name: &str, folder: &str, words: Vec<String>) -> Value {
    let fixed = ["-c", "cd -- \"$0\" && exec \"$@\"", folder].map(str::to_owned);
    let arguments: Vec<String> = fixed.into_iter().chain(words).collect();
    json!({ "name": name, "script": { "actions": { "onRun": { "command": "sh", "args": arguments } } } })
}
