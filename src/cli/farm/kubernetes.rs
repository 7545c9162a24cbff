//! Kubernetes: an indexed job, and one that looks at what is there.
//!
//! Jobs cannot wait for each other, so that the second one looks again and again until the frames are there, or its time is over.

use serde_json::{Value, json};

use super::{Farm, line};

/// Returns both, as documents of JSON, which is YAML, too.
pub(super) fn manifests(farm: &Farm, image: &str, claim: &str) -> anyhow::Result<String> {
    /// Seconds between looks, and in all.
    const PATIENCE: (u32, u32) = (30, 86_400);
    // Of the words, only this is to be replaced.
    const INDEX: (&str, &str) = ("SHARD_INDEX", "$(JOB_COMPLETION_INDEX)");
    let literal = |word: &String| word.replace("$(", "$$(").replace(INDEX.0, INDEX.1);
    let render: Vec<String> = farm.render(INDEX.0).iter().map(literal).collect();
    let looks = format!("until {}; do sleep {}; done", line(&farm.verify()), PATIENCE.0);
    let verify = ["sh", "-c", &looks].map(|word| literal(&word.to_owned()));
    let (render, verify) = (pod(image, claim, &render), pod(image, claim, &verify));
    let shards = json!({
        "apiVersion": "batch/v1",
        "kind": "Job",
        "metadata": { "name": farm.name },
        "spec": {
            "completionMode": "Indexed",
            "completions": farm.shards,
            "parallelism": farm.shards,
            // A shard that dies goes on with the frames that are left.
            "backoffLimitPerIndex": 6,
            "template": render,
        },
    });
    let verdict = json!({
        "apiVersion": "batch/v1",
        "kind": "Job",
        "metadata": { "name": format!("{}-verify", farm.name) },
        "spec": { "backoffLimit": 0, "activeDeadlineSeconds": PATIENCE.1, "template": verify },
    });
    let documents = [shards, verdict].map(|document| serde_json::to_string_pretty(&document));
    let [shards, verdict] = documents;
    Ok(format!(
        "# Renders in shards, which share the claim's folder, and waits until all frames are there: kubectl apply -f\n{}\n---\n{}\n",
        shards?, verdict?
    ))
}

/// Returns a pod that runs a command in the claim's folder.
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
