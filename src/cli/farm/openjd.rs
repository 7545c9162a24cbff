//! Open Job Description, as accepted by AWS Deadline Cloud and others: a step that renders the shards, and a step that verifies the frames.
//!
//! The template is JSON, which is also valid YAML.

use anyhow::{Context, ensure};
use serde_json::{Value, json};

use super::{Farm, document, one_line, path_text};

/// Returns the job template (specification of 2023-09).
pub(super) fn template(farm: &Farm) -> anyhow::Result<String> {
    let here = std::env::current_dir().context("the working directory is gone")?;
    let here = literal(&path_text(&here)?)?;
    let range = format!("0-{}", farm.shards - 1);
    let mut verify = step("Verify", &here, farm.verify(literal)?);
    verify["dependencies"] = json!([{ "dependsOn": "Render" }]);
    let shard = format!("--shard={{{{Task.Param.Shard}}}}/{}", farm.shards);
    let mut shards = step("Render", &here, farm.render(literal, shard)?);
    shards["parameterSpace"] =
        json!({ "taskParameterDefinitions": [{ "name": "Shard", "type": "INT", "range": range }] });
    document(&json!({
        "specificationVersion": "jobtemplate-2023-09",
        "name": farm.name,
        "description": "Renders a sequence in shards, which share a folder, and then verifies that all frames are there.",
        "steps": [shards, verify],
    }))
}

/// Returns a word in which the scheduler replaces nothing, or an error if it contains `{{`: the scheduler replaces text in double braces,
/// which cannot be escaped.
fn literal(word: &str) -> anyhow::Result<String> {
    ensure!(
        !word.contains("{{"),
        "`{word}` contains `{{{{`, which Open Job Description takes for a parameter: write it without"
    );
    Ok(one_line(word)?.to_owned())
}

/// Returns a step that runs a command in a folder, because sessions start in their own working directories.
fn step(name: &str, folder: &str, words: Vec<String>) -> Value {
    let fixed = ["-c", "cd -- \"$0\" && exec \"$@\"", folder].map(str::to_owned);
    let arguments: Vec<String> = fixed.into_iter().chain(words).collect();
    json!({ "name": name, "script": { "actions": { "onRun": { "command": "sh", "args": arguments } } } })
}
