//! Job scripts, held against what schedulers make of them.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::{RAYREEL, command, output_of, pictures, rayreel, text, told};

const SCENE: &str = r#"Scene(
    timeline: (fps: 4, duration: 2),
    film: (width: 16, height: 9),
    camera: (position: (0, 0, -5), target: (0, 0, 0)),
    materials: { "clay": (k_a: 1, color: (255, 120, 60)) },
    entities: [(name: "ball", shape: Sphere(radius: 1), material: "clay")],
    animate: [(target: "ball", channel: Translation, track: Keys([(0, (0, 0, 0)), (2, (0, 4, 0))]))],
)"#;

/// A folder whose scene has a name that needs quotes.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("it's a $HOME.ron"), SCENE).unwrap();
    folder
}

/// What a scheduler does: runs what it is given, a shard after the other, and then what depends on them.
#[cfg(unix)]
const SBATCH: &str = r#"#!/bin/sh
echo "$@" >> "$LOG"
script=$(cat)
for word in "$@"; do case $word in --array=0-*) last=${word#--array=0-};; esac; done
if [ -n "${last-}" ]; then
    for index in $(seq 0 "$last"); do
        printf '%s\n' "$script" | SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID=$index sh >&2 || exit
    done
    echo '7;cluster'
else
    printf '%s\n' "$script" | sh >&2 || exit
    echo 8
fi
"#;

#[cfg(unix)]
#[test]
fn a_cluster_renders_every_shard_and_verifies_them() {
    use std::os::unix::fs::PermissionsExt;

    let folder = folder();
    let folder = folder.path();
    let script = told(
        folder,
        [
            "farm",
            "slurm",
            "it's a $HOME.ron",
            "--shards",
            "3",
            "--out",
            "o u t",
            "--",
            "--frames=0-5",
            "--samples",
            "2",
        ],
    );
    fs::create_dir(folder.join("bin")).unwrap();
    fs::write(folder.join("bin/sbatch"), SBATCH).unwrap();
    fs::set_permissions(folder.join("bin/sbatch"), fs::Permissions::from_mode(0o755)).unwrap();
    std::os::unix::fs::symlink(RAYREEL, folder.join("bin/rayreel")).unwrap();
    fs::write(folder.join("script"), &script).unwrap();
    let path = format!("{}:{}", folder.join("bin").display(), std::env::var("PATH").unwrap());
    let mut shell = command("sh", folder);
    let output =
        output_of(shell.arg("script").env("PATH", path).env("LOG", folder.join("log")).spawn().unwrap());
    assert!(output.status.success(), "{script}{}", text(&output.stderr));
    assert_eq!(text(&output.stdout), "shards are job 7; job 8 verifies them\n");
    assert!(text(&output.stderr).contains("6 of 6 frames"), "{}", text(&output.stderr));
    assert_eq!(pictures(&folder.join("o u t")).len(), 6);
    let log = fs::read_to_string(folder.join("log")).unwrap();
    for option in ["--array=0-2", "--requeue", "--dependency=afterany:7"] {
        assert!(log.contains(option), "{log}");
    }
}

fn run(folder: &Path, words: &[Value]) {
    let words: Vec<&str> = words.iter().map(|word| word.as_str().unwrap()).collect();
    assert_eq!(words[0], "rayreel");
    let output = rayreel(folder, &words[1..]);
    assert!(output.status.success(), "{words:?}: {}", text(&output.stderr));
}

/// As its own parser takes it, where that is installed.
fn checked_by(program: &str, arguments: &[&str], folder: &Path) {
    match command(program, folder).args(arguments).spawn() {
        Ok(child) => {
            let output = output_of(child);
            assert!(output.status.success(), "{}{}", text(&output.stdout), text(&output.stderr));
        }
        Err(_) => println!("there is no {program}: its own parser was not tried"),
    }
}

#[test]
fn a_job_description_has_a_task_a_shard_and_verifies_them() {
    let folder = folder();
    let folder = folder.path();
    let template =
        told(folder, ["farm", "openjd", "it's a $HOME.ron", "--shards", "4", "--", "--size", "8x8"]);
    fs::write(folder.join("job.json"), &template).unwrap();
    let template: Value = serde_json::from_str(&template).unwrap();
    assert_eq!(template["specificationVersion"], "jobtemplate-2023-09");
    let [render, verify] = [0, 1].map(|step| template["steps"][step].clone());
    assert_eq!(render["parameterSpace"]["taskParameterDefinitions"][0]["range"], "0-3");
    assert_eq!(verify["dependencies"][0]["dependsOn"], render["name"]);
    let words = |step: &Value, shard: usize| -> Vec<Value> {
        let action = &step["script"]["actions"]["onRun"];
        let arguments = action["args"].as_array().unwrap().iter();
        let put_in =
            |word: &Value| word.as_str().unwrap().replace("{{Task.Param.Shard}}", &shard.to_string()).into();
        let words: Vec<Value> = arguments.map(put_in).collect();
        // Sessions have working directories of their own.
        assert_eq!((&action["command"], &words[0]), (&"sh".into(), &"-c".into()));
        assert_eq!(Path::new(words[2].as_str().unwrap()), folder.canonicalize().unwrap());
        words[3..].to_vec()
    };
    (0..4).for_each(|shard| run(folder, &words(&render, shard)));
    run(folder, &words(&verify, 0));
    checked_by("openjd", &["check", "job.json"], folder);
}

#[test]
fn a_kubernetes_job_has_an_index_a_shard() {
    let folder = folder();
    let folder = folder.path();
    let arguments = ["farm", "kubernetes", "it's a $HOME.ron", "--shards", "2"];
    let missing = rayreel(folder, arguments);
    assert!(text(&missing.stderr).contains("--image"), "{}", text(&missing.stderr));
    let manifests = told(folder, arguments.iter().chain(&["--image", "ours/rayreel:1", "--claim", "frames"]));
    let (_, documents) = manifests.split_once('\n').unwrap();
    let documents: Vec<Value> =
        documents.split("\n---\n").map(|document| serde_json::from_str(document).unwrap()).collect();
    let [shards, verify] = &documents[..] else { panic!("{manifests}") };
    let (spec, container) = (&shards["spec"], &shards["spec"]["template"]["spec"]["containers"][0]);
    assert_eq!((&spec["completionMode"], &spec["completions"]), (&"Indexed".into(), &2.into()));
    for index in ["0", "1"] {
        let put_in = |word: &Value| word.as_str().unwrap().replace("$(JOB_COMPLETION_INDEX)", index).into();
        run(folder, &container["command"].as_array().unwrap().iter().map(put_in).collect::<Vec<Value>>());
    }
    let script = &verify["spec"]["template"]["spec"]["containers"][0]["command"][2];
    assert!(
        script.as_str().unwrap().starts_with("until rayreel verify 'out/it'\\''s a $HOME'; do"),
        "{script}"
    );
}

#[test]
fn what_jobs_would_stumble_over_is_told_before() {
    let folder = folder();
    for (more, said) in [
        (&["--shards", "9"][..], "9 shards of 8 frames leave some without any"),
        (&["--shards", "0"], "0 is not in 1..=10000"),
        (&["--shards", "2", "--", "--shard", "0/2"], "--shard is not for farms: each job gets its own"),
        (&["--shards", "2", "--", "--out", "x"], "--out is not for farms: write it before `--`"),
        (&["--shards", "2", "--", "--deadline", "9s"], "--deadline is not for farms"),
        (&["--shards", "2", "--", "--sise", "8x8"], "unexpected argument '--sise'"),
        (&["--shards", "2", "--", "--set", "camera.fow=3"], "fow"),
    ] {
        let output = rayreel(folder.path(), ["farm", "slurm", "it's a $HOME.ron"].iter().chain(more));
        assert!(!output.status.success() && output.stdout.is_empty(), "{more:?}");
        assert!(text(&output.stderr).contains(said), "{more:?}: {}", text(&output.stderr));
    }
}
