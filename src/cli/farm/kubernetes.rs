//! Kubernetes: an indexed job that renders the shards, and a job that verifies the frames.
//!
//! Jobs cannot depend on each other, so the second job repeats the verification until it succeeds or until its time limit.

use serde_json::{Value, json};

use super::{Farm, document, one_line};

/// Returns both jobs as JSON documents, which are also valid YAML.
pub(super) fn manifests(farm: &Farm, image: &str, claim: &str) -> anyhow::Result<String> {
    /// Time limit of the verifying job in seconds: one day.
    const LONGEST_WAIT: u32 = 86_400;
    let shard = format!("--shard=$(JOB_COMPLETION_INDEX)/{}", farm.shards);
    let render = farm.render(literal, shard)?;
    let mut verify = vec!["sh".to_owned(), "-c".to_owned()];
    verify.push(literal("until \"$@\"; do sleep 30; done")?);
    verify.push("sh".to_owned());
    verify.extend(farm.verify(literal)?);
    let (image, claim) = (one_line(image)?, one_line(claim)?);
    let (render, verify) = (pod(image, claim, &render), pod(image, claim, &verify));
    let shards = json!({
        "apiVersion": "batch/v1",
        "kind": "Job",
        "metadata": { "name": farm.name },
        "spec": {
            "completionMode": "Indexed",
            "completions": farm.shards,
            "parallelism": farm.shards,
            // A restarted shard renders only the remaining frames.
            "backoffLimitPerIndex": 6,
            "template": render,
        },
    });
    let verdict = json!({
        "apiVersion": "batch/v1",
        "kind": "Job",
        "metadata": { "name": format!("{}-verify", farm.name) },
        "spec": { "backoffLimit": 0, "activeDeadlineSeconds": LONGEST_WAIT, "template": verify },
    });
    Ok(format!(
        "# Renders in shards, which share the claim's folder, and waits until all frames are there: kubectl apply -f\n{}---\n{}",
        document(&shards)?,
        document(&verdict)?
    ))
}

/// Escapes a word of a command: Kubernetes replaces `$(NAME)` and reads `$$` as `$`.
fn literal(word: &str) -> anyhow::Result<String> {
    Ok(one_line(word)?.replace('$', "$$"))
}

/// Returns a pod that runs a command in the folder of the volume claim.
fn pod(image: &str, claim: &str, command: &[String]) -> Value {
    const FOLDER: &str = "/frames";
    json!({
        "spec": {
            "restartPolicy": "Never",
            "containers": [{
                "name": "rayreel",
                "image": image,
                "command": command,
                "workingDir": FOLDER,
                "volumeMounts": [{ "name": "frames", "mountPath": FOLDER }],
            }],
            "volumes": [{ "name": "frames", "persistentVolumeClaim": { "claimName": claim } }],
        },
    })
}
