//! Tests of job scripts, run and parsed as schedulers do.

use std::fs;
use std::path::Path;

use proptest::prelude::*;
use serde_json::Value;

use crate::{RAYREEL, command, output_of, pictures, rayreel, stdout_of, text};

const SCENE: &str = r#"Scene(
    timeline: (fps: 4, duration: 2),
    film: (width: 16, height: 9),
    camera: (position: (0, 0, -5), target: (0, 0, 0)),
    materials: { "clay": (k_a: 1, color: (255, 120, 60)) },
    entities: [(name: "ball", shape: Sphere(radius: 1), material: "clay")],
    animate: [(target: "ball", channel: Translation, track: Keys([(0, (0, 0, 0)), (2, (0, 4, 0))]))],
)"#;

/// Returns a folder with a scene whose name needs quotes.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("it's a $HOME.ron"), SCENE).unwrap();
    folder
}

/// Stand-in for `sbatch` that runs jobs at once: the shards of an array one after another, or a single job.
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
    let script = stdout_of(
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

/// Checks a file with the scheduler's own parser, if it is installed.
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
fn openjd_job_has_a_task_per_shard_and_a_verify_step() {
    let folder = folder();
    let folder = folder.path();
    let template =
        stdout_of(folder, ["farm", "openjd", "it's a $HOME.ron", "--shards", "4", "--", "--size", "8x8"]);
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
        // Sessions have their own working directories.
        assert_eq!((&action["command"], &words[0]), (&"sh".into(), &"-c".into()));
        assert_eq!(Path::new(words[2].as_str().unwrap()), folder.canonicalize().unwrap());
        words[3..].to_vec()
    };
    (0..4).for_each(|shard| run(folder, &words(&render, shard)));
    run(folder, &words(&verify, 0));
    checked_by("openjd", &["check", "job.json"], folder);
}

#[test]
fn kubernetes_job_has_an_index_per_shard() {
    let folder = folder();
    let folder = folder.path();
    let arguments = ["farm", "kubernetes", "it's a $HOME.ron", "--shards", "2"];
    let missing = rayreel(folder, arguments);
    assert!(text(&missing.stderr).contains("--image"), "{}", text(&missing.stderr));
    let manifests =
        stdout_of(folder, arguments.iter().chain(&["--image", "ours/rayreel:1", "--claim", "frames"]));
    let (_, documents) = manifests.split_once('\n').unwrap();
    let documents: Vec<Value> =
        documents.split("\n---\n").map(|document| serde_json::from_str(document).unwrap()).collect();
    let [shards, verify] = &documents[..] else { panic!("{manifests}") };
    let (spec, container) = (&shards["spec"], &shards["spec"]["template"]["spec"]["containers"][0]);
    assert_eq!((&spec["completionMode"], &spec["completions"]), (&"Indexed".into(), &2.into()));
    for index in ["0", "1"] {
        let put_in = |word: &Value| expanded(word.as_str().unwrap(), index).into();
        run(folder, &container["command"].as_array().unwrap().iter().map(put_in).collect::<Vec<Value>>());
    }
    let verify = verify["spec"]["template"]["spec"]["containers"][0]["command"].as_array().unwrap();
    run(
        folder,
        &verify[4..].iter().map(|word| expanded(word.as_str().unwrap(), "").into()).collect::<Vec<_>>(),
    );
}

#[test]
fn invalid_farm_arguments_are_reported() {
    let folder = folder();
    let few = r#"{"frames": [{"frame": 0, "time": 0, "samples": 1, "max_error": 0}]}"#;
    fs::write(folder.path().join("few.json"), few).unwrap();
    for (more, expected) in [
        (&["--shards", "9"][..], "9 shards of 8 frames leave some without any"),
        (&["--shards", "0"], "0 is not in 1..=10000"),
        (&["--shards", "2", "--", "--shard", "0/2"], "--shard is not for farms: each job gets its own"),
        (&["--shards", "2", "--", "--out", "x"], "--out is not for farms: write it before `--`"),
        (&["--shards", "2", "--", "--deadline", "9s"], "--deadline is not for farms"),
        (&["--shards", "2", "--", "--sise", "8x8"], "unexpected argument '--sise'"),
        (&["--shards", "2", "--", "--set", "camera.fow=3"], "fow"),
        (&["--shards", "2", "--", "--set", "camera.fov=/*\ntouch spoiled\n*/ 50"], "has a line end"),
        (&["--shards", "2", "--", "--settings", "none.json"], "cannot read `none.json`"),
        (&["--shards", "2", "--", "--settings", "few.json"], "has no settings for frame 1"),
        (&["--shards", "2", "--", "--help"], "--help and --version are not for farms"),
        (&["--shards", "2", "--out", "-"], "jobs share a folder, and not standard output"),
        (&["--shards", "2", "--image", ""], "a value is required for '--image <IMAGE>'"),
        (&["--shards", "2", "--claim", ""], "a value is required for '--claim <NAME>'"),
    ] {
        let output = rayreel(folder.path(), ["farm", "slurm", "it's a $HOME.ron"].iter().chain(more));
        assert!(!output.status.success() && output.stdout.is_empty(), "{more:?}");
        let stderr = text(&output.stderr);
        assert!(stderr.contains(expected), "{more:?}: {stderr}");
        assert!(!stderr.contains("\\n\\n") && stderr.matches("error:").count() == 1, "{more:?}: {stderr}");
    }
}

/// Expands a word of a container's command as Kubernetes does: `$$` becomes `$`, and `$(JOB_COMPLETION_INDEX)` the index.
fn expanded(word: &str, index: &str) -> String {
    let mut parts = word.split("$$");
    let first = parts.next().unwrap_or_default().to_owned();
    let replace = |part: &str| part.replace("$(JOB_COMPLETION_INDEX)", index);
    parts.fold(replace(&first), |text, part| text + "$" + replace(part).as_str())
}

/// Expands a log path as Slurm does: `%%` becomes `%`, and `%a` the index. A backslash would disable the expansion.
#[cfg(unix)]
fn log_path(pattern: &str, index: &str) -> String {
    assert!(!pattern.contains('\\'), "{pattern}");
    let mut parts = pattern.split("%%");
    let first = parts.next().unwrap_or_default().replace("%a", index);
    parts.fold(first, |text, part| text + "%" + part.replace("%a", index).as_str())
}

/// Parts of names and values that a shell, YAML or a scheduler interprets.
#[cfg(unix)]
const PARTS: [&str; 35] = [
    "'",
    "\"",
    "`touch spoiled`",
    "$(touch spoiled)",
    "$",
    "$$",
    "$(JOB_COMPLETION_INDEX)",
    "$((1))",
    "${HOME}",
    "SHARD_INDEX",
    "SLURM_INDEX",
    "%",
    "%%",
    "%a",
    "\\",
    "{{",
    "{{Task.Param.Shard}}",
    "}}",
    "\t",
    ";touch spoiled;",
    "&",
    "|",
    ">spoiled",
    " ",
    " #",
    "!",
    "*",
    "?",
    "~",
    "-",
    "--",
    ": ",
    "\u{e4}\u{1F600}",
    "\u{feff}",
    "\u{ffff}",
];

/// Parts that no script may contain.
#[cfg(unix)]
const REFUSED: [&str; 6] =
    ["\n", "\r", "\u{1b}[31m", "\ntouch spoiled\n", "\nRENDER\ntouch spoiled\n", "\u{2028}"];

#[cfg(unix)]
fn odd_text() -> impl Strategy<Value = String> {
    let part = prop_oneof![
        40 => proptest::sample::select(&PARTS[..]),
        1 => proptest::sample::select(&REFUSED[..]),
    ];
    proptest::collection::vec(part, 1..5).prop_map(|parts| parts.concat())
}

/// Script that records its arguments in its own file, each terminated by a zero byte.
#[cfg(unix)]
const RECORDER: &str = r#"#!/bin/sh
printf '%s\0' "$@" > "$RECORDS/rayreel.$$"
"#;

/// Script that records its arguments in the same way, and runs the job as `SBATCH` does.
#[cfg(unix)]
const RECORDING_SBATCH: &str = r#"#!/bin/sh
printf '%s\0' "$@" > "$RECORDS/sbatch.$$"
cat > "$RECORDS/job.$$"
for word in "$@"; do case $word in --array=0-*) last=${word#--array=0-};; esac; done
for index in $(seq 0 "${last-0}"); do
    SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID=$index sh "$RECORDS/job.$$" >&2 || exit
done
rm "$RECORDS/job.$$"
echo 7
"#;

/// Returns the recorded arguments of all runs of a command, sorted.
#[cfg(unix)]
fn recorded(records: &Path, program: &str) -> Vec<Vec<String>> {
    let mut all = Vec::new();
    for entry in fs::read_dir(records).unwrap().map(Result::unwrap) {
        if entry.file_name().to_str().unwrap().starts_with(program) {
            let words = text(&fs::read(entry.path()).unwrap());
            all.push(words.split_terminator('\0').map(str::to_owned).collect());
        }
    }
    all.sort();
    all
}

/// Returns the documents of a YAML stream, parsed as JSON. A YAML parser, if installed, must find the same.
#[cfg(unix)]
fn documents(folder: &Path, manifests: &str) -> Vec<Value> {
    const READ: &str = "import json, sys, yaml\nprint(json.dumps(list(yaml.safe_load_all(open(sys.argv[1], encoding='utf-8', newline='')))))";
    let (_, body) = manifests.split_once('\n').unwrap();
    let as_json: Vec<Value> =
        body.split("\n---\n").map(|document| serde_json::from_str(document).unwrap()).collect();
    let file = folder.join("manifests.yaml");
    fs::write(&file, manifests).unwrap();
    let has_yaml = |child| output_of(child).status.success();
    if command("python3", folder).args(["-c", "import yaml"]).spawn().is_ok_and(has_yaml) {
        let output = output_of(command("python3", folder).args(["-c", READ]).arg(&file).spawn().unwrap());
        assert!(output.status.success(), "{manifests}{}", text(&output.stderr));
        assert_eq!(serde_json::from_slice::<Vec<Value>>(&output.stdout).unwrap(), as_json, "{manifests}");
    } else {
        println!("there is no yaml for python3: YAML was read as JSON only");
    }
    fs::remove_file(&file).unwrap();
    as_json
}

#[cfg(unix)]
fn strings(words: &Value) -> Vec<String> {
    words.as_array().unwrap().iter().map(|word| word.as_str().unwrap().to_owned()).collect()
}

#[cfg(unix)]
proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    /// Checks that jobs get exactly these arguments and run nothing else for any names and values, or that nothing is printed.
    #[test]
    fn jobs_run_exactly_the_given_arguments(name in odd_text(), out in odd_text(), value in odd_text()) {
        use std::os::unix::fs::PermissionsExt;

        let root = tempfile::tempdir().unwrap();
        let (folder, records, bin) = (root.path().join("here"), root.path().join("records"), root.path().join("bin"));
        for folder in [&folder, &records, &bin] {
            fs::create_dir(folder).unwrap();
        }
        for (name, script) in [("rayreel", RECORDER), ("sbatch", RECORDING_SBATCH)] {
            fs::write(bin.join(name), script).unwrap();
            fs::set_permissions(bin.join(name), fs::Permissions::from_mode(0o755)).unwrap();
        }
        let scene = format!("./{name}.ron");
        fs::write(folder.join(&scene), SCENE).unwrap();
        let comment = format!("camera.fov=/*{value}*/ 50");
        let options = ["--frames=1-4", "--set", &comment];
        let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
        let has = |part: &str| [&name, &out, &value].iter().any(|text| text.contains(part));
        let is_refused = REFUSED.into_iter().any(has);
        let out_option = format!("--out={out}");
        let verified = if out.starts_with('-') { format!("./{out}") } else { out.clone() };
        let shard = |index: usize| {
            let words = ["render", &scene, &format!("--out={verified}"), &format!("--shard={index}/2")];
            words.iter().chain(&options).map(|word| (*word).to_owned()).collect::<Vec<_>>()
        };
        let verify = ["verify", &verified, "--frames=1-4"].map(str::to_owned).to_vec();

        for scheduler in ["slurm", "kubernetes", "openjd"] {
            let farm = ["farm", scheduler, &scene, "--shards=2", &out_option, "--image=i", "--claim=c", "--"];
            let output = rayreel(&folder, farm.iter().chain(&options));
            let refused = is_refused || out == "-"
                || scheduler == "slurm" && out.contains('\\')
                || scheduler == "openjd" && has("{{");
            prop_assert_eq!(!output.status.success(), refused, "{}: {}", scheduler, text(&output.stderr));
            if refused {
                prop_assert!(output.stdout.is_empty());
                continue;
            }
            let script = text(&output.stdout);
            let shell = |words: &[String]| {
                let mut shell = command(&words[0], &folder);
                shell.args(&words[1..]).env("PATH", &path).env("RECORDS", &records);
                let output = output_of(shell.spawn().unwrap());
                assert!(output.status.success(), "{script}{}", text(&output.stderr));
            };
            match scheduler {
                "slurm" => {
                    shell(&["sh".to_owned(), "-c".to_owned(), script.clone()]);
                    let logs: Vec<String> = recorded(&records, "sbatch").concat().iter()
                        .filter_map(|word| word.strip_prefix("--output=").map(|log| log_path(log, "1"))).collect();
                    prop_assert_eq!(logs.len(), 2);
                    prop_assert!(logs.iter().all(|log| log.starts_with(&format!("{verified}/rayreel"))), "{:?}", logs);
                    fs::remove_dir_all(folder.join(&verified)).unwrap();
                }
                "kubernetes" => {
                    let documents = documents(root.path(), &script);
                    for (document, index) in [(0, "0"), (0, "1"), (1, "")] {
                        let container = &documents[document]["spec"]["template"]["spec"]["containers"][0];
                        let words = strings(&container["command"]);
                        shell(&words.iter().map(|word| expanded(word, index)).collect::<Vec<_>>());
                    }
                }
                _ => {
                    let template: Value = serde_json::from_str(&script).unwrap();
                    for (step, index) in [(0, "0"), (0, "1"), (1, "")] {
                        let action = &template["steps"][step]["script"]["actions"]["onRun"];
                        let words = [vec![action["command"].as_str().unwrap().to_owned()], strings(&action["args"])].concat();
                        shell(&words.iter().map(|word| word.replace("{{Task.Param.Shard}}", index)).collect::<Vec<_>>());
                    }
                }
            }
            prop_assert_eq!(recorded(&records, "rayreel"), vec![shard(0), shard(1), verify.clone()], "{}", script);
            prop_assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "{}", script);
            fs::remove_dir_all(&records).unwrap();
            fs::create_dir(&records).unwrap();
        }
    }
}
