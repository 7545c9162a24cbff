//! Tests that no output contains terminal control sequences, whatever names, paths and texts contain.
//!
//! `RAYREEL_CASES=100` sets the number of cases; the default is 5.

use std::fs;
use std::path::Path;
use std::process::Output;

use rayreel::Scene;

use crate::splitmix::Random;
use crate::{rayreel, text};

/// Colour and title sequences, introduced by two characters and by one, deletion, cursor movement, text direction, line separators, a
/// forged line, and harmless text.
const PARTS: [&str; 14] = [
    "\u{1b}[31m",
    "\u{1b}]0;title\u{7}",
    "\u{9b}31m",
    "\u{9d}0;title\u{9c}",
    "\u{7f}",
    "\r",
    "\u{8}\u{8}",
    "\u{202e}",
    "\u{2066}",
    "\u{2028}",
    "\u{85}",
    "\nSPOOF ",
    "plain",
    "\u{e4}\u{1F600}",
];

impl Random {
    fn hostile_text(&mut self) -> String {
        let count = 1 + self.index(4);
        (0..count).map(|_| PARTS[self.index(PARTS.len())]).collect()
    }

    /// Returns a text for a scene or a script, unchanged or escaped.
    fn quoted(&mut self, text: &str) -> String {
        if self.once_in(2) { text.to_owned() } else { text.chars().flat_map(char::escape_unicode).collect() }
    }
}

fn is_obeyed(character: char) -> bool {
    let turns = ['\u{61c}', '\u{200e}', '\u{200f}', '\u{2028}', '\u{2029}'].contains(&character)
        || ('\u{202a}'..='\u{202e}').contains(&character)
        || ('\u{2066}'..='\u{2069}').contains(&character);
    character.is_control() && !['\n', '\t'].contains(&character) || turns
}

fn assert_harmless(printed: &str, what: &str) {
    let obeyed = printed.chars().find(|character| is_obeyed(*character));
    assert_eq!(obeyed, None, "{what}: {printed:?}");
    assert!(!printed.lines().any(|line| line.starts_with("SPOOF")), "{what}: {printed:?}");
}

/// Removes colour sequences.
fn without_colors(text: &str) -> String {
    let mut parts = text.split("\u{1b}[");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + part.split_once('m').map_or(part, |(_, rest)| rest))
}

const CAMERA: &str = "camera: (position: (0, 0, -5), target: (0, 0, 0))";

/// Returns a valid scene and invalid ones.
fn scenes(random: &mut Random) -> (String, Vec<String>) {
    let evil = random.hostile_text();
    let name = random.quoted(&evil);
    let mut other = || {
        let evil = random.hostile_text();
        random.quoted(&evil)
    };
    let clay = "k_a: 1, k_d: 0.5, reflective: (k_r: 0.5)";
    let good = format!(
        "(timeline: (fps: 10, duration: 1), film: (width: 9, height: 9), ambient: (1, 1, 1),
        cameras: {{ \"{name}@\": (position: (0, 0, -5), target: (0, 0, 0)) }},
        materials: {{ \"{name}\": ({clay}) }},
        entities: [(name: \"{name}\", shape: Sphere(radius: 1), material: \"{name}\"),
            (name: \"{name}+\", shape: Sphere(radius: 1), material: \"{name}\"),
            (name: \"{name}'\", light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 5, -5)))])"
    );
    let animate = |track: String| {
        format!("({CAMERA}, animate: [(target: \"scene\", channel: Ambient, track: {track})])")
    };
    let bad = vec![
        format!(
            "({CAMERA}, materials: {{ \"{name}\": ({clay}) }}, entities: [(material: \"{name}+\", parent: \"{name}\")])"
        ),
        format!("({CAMERA}, entities: [(name: \"{name}\"), (name: \"{name}\")])"),
        format!("({CAMERA}, include: [(file: \"{name}\")])"),
        format!("({CAMERA}, include: [(file: \"{}\", name: \"{name}/\")])", other()),
        animate(format!("Script(\"throw \\\"{}\\\"\")", other().replace('\\', "\\\\"))),
        animate(format!("Script(\"{} {}\")", other().replace('\\', "\\\\"), other().replace('\\', "\\\\"))),
        animate(format!("ScriptFile(\"{}\")", other())),
        animate(format!("{evil}(1)")),
        format!(
            "({CAMERA}, spawn: [Script(\"spawn(#{{ name: `{evil}`, material: `{evil}` }}); spawn(#{{ `{evil}`: 1 }})\")])"
        ),
        format!("({CAMERA}, spawn: [Script(r#\"spawn(#{{ \"{}\": 1 }})\"#)])", other()),
        format!("({evil}: 1)"),
        evil.clone(),
        format!("({CAMERA}, /* {evil} */ ambient: \"{}\")", other()),
    ];
    (good, bad)
}

/// Returns all commands on a valid scene, some with invalid arguments or rays.
fn commands(scene: &str, other: &str) -> Vec<Vec<String>> {
    let on = |arguments: &[&str]| {
        let (command, more) = arguments.split_first().unwrap();
        [&[*command, scene], more].concat().into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    let free =
        |arguments: &[&str]| arguments.iter().map(|argument| (*argument).to_owned()).collect::<Vec<_>>();
    let svg = format!("{other}.svg");
    vec![
        on(&["check"]),
        on(&["check", "--json"]),
        on(&["explain"]),
        on(&["explain", "--json"]),
        on(&["explain", "--path", &svg]),
        on(&["explain", "--path", scene]),
        on(&["explain", "--path", &format!("no{other}/such.svg")]),
        on(&["probe", "--pixel", "4,4"]),
        on(&["probe", "--pixel", "4,4", "--json"]),
        on(&["probe", "--pixel", "99,4"]),
        on(&["probe", "--rays", "good.csv"]),
        on(&["probe", "--rays", "good.csv", "--json"]),
        on(&["probe", "--rays", &format!("{other}.csv")]),
        on(&["probe", "--rays", &format!("no{other}.csv")]),
        on(&["render", "--frames", "0-1"]),
        on(&["render", "--frames", "0-1", "--out", other, "--json"]),
        on(&["render", "--sheet", "2x1", "--out", other]),
        on(&["render", "--out", scene]),
        on(&["render", "--frames", other]),
        on(&["render", other]),
        on(&["watch", "--out", other]),
        on(&[other]),
        free(&["new", &format!("{other}.ron")]),
        free(&["new", &format!("{other}.ron")]),
        free(&["new", &format!("no{other}/such.ron")]),
        free(&["check", &format!("no{other}.ron")]),
        free(&["render", &format!("no{other}.ron"), "--json"]),
        free(&["completions", other]),
    ]
}

fn check(output: &Output, is_csv: bool, what: &str) {
    assert_harmless(&text(&output.stderr), what);
    // A quoted table cell may contain line breaks.
    let table = text(&output.stdout).replace("\nSPOOF", "\n");
    assert_harmless(if is_csv { &table } else { std::str::from_utf8(&output.stdout).unwrap() }, what);
    assert!(!text(&output.stderr).contains("panicked"), "{what}: {}", text(&output.stderr));
}

#[test]
fn control_characters_are_escaped() {
    let cases = std::env::var("RAYREEL_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(5);
    let random = &mut Random(1);
    let mut reported = 0;
    for case in 0..cases {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let (good, bad) = scenes(random);
        let [name, other] = [random.hostile_text(), random.hostile_text()].map(|name| format!("{name}x"));
        let scene = format!("{name}.ron");
        fs::write(folder.join(&scene), &good).unwrap();
        let loaded = Scene::load(&folder.join(&scene));
        assert!(loaded.is_ok(), "{good:?}: {}", loaded.err().unwrap());
        fs::write(folder.join("good.csv"), "0,0,-5,0,0,1\n0,9,0,0,1,0\n").unwrap();
        fs::write(folder.join(format!("{other}.csv")), format!("{},1,1,1,1,1\n", random.hostile_text()))
            .unwrap();
        for arguments in commands(&scene, &other) {
            let is_csv =
                arguments.contains(&"good.csv".to_owned()) && !arguments.contains(&"--json".to_owned());
            let output = rayreel(folder, &arguments);
            reported += usize::from(!output.stderr.is_empty());
            check(&output, is_csv, &format!("case {case}, {arguments:?}"));
            if arguments.contains(&"--json".to_owned())
                && output.status.success()
                && !arguments.contains(&"--rays".to_owned())
            {
                serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap();
            }
        }
        for text in bad {
            fs::write(folder.join(&scene), &text).unwrap();
            reported += check_bad(folder, &scene, &text);
        }
    }
    assert!(reported > 20 * cases, "{reported} of {cases} cases reported anything");
}

/// Checks an invalid scene, and returns the number of commands with messages.
fn check_bad(folder: &Path, scene: &str, text: &str) -> usize {
    if let Err(error) = Scene::load(&folder.join(scene)) {
        let (plain, colored) = (error.render(false), error.render(true));
        assert_harmless(&plain, text);
        assert_eq!(without_colors(&colored), plain, "{text:?}");
    }
    let commands: [&[&str]; 3] = [&["check"], &["check", "--json"], &["render", "--frames", "0"]];
    let run = |arguments: &&[&str]| {
        let output = rayreel(folder, arguments.iter().copied().chain([scene]));
        check(&output, false, text);
        !output.stderr.is_empty()
    };
    commands.iter().filter(|arguments| run(arguments)).count()
}

/// A scene with a mistake, and a scene with a warning.
const REPORTED: [(&str, &str); 2] = [
    ("wrong.ron", "(camera: (position: (0, 0, -5), target: (0, 0, 0)), ambent: 1)"),
    (
        "lost.ron",
        "(camera: (position: (0, 0, -5), target: (0, 0, 0)), materials: { \"m\": (k_a: 1) }, entities: [
            (name: \"far\", shape: Box(size: (1, 1, 1)), material: \"m\", transform: (translation: (1e17, 0, 0)))])",
    ),
];

/// Checks that the program's own line breaks, and on a terminal its own colours, are not escaped.
#[test]
fn own_messages_are_not_escaped() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (name, scene) in REPORTED {
        fs::write(folder.join(name), scene).unwrap();
        for command in ["check", "render", "explain"] {
            let stderr = text(&rayreel(folder, [command, name]).stderr);
            assert!(!stderr.contains("\\n") && !stderr.contains("\\u{"), "{command} {name}: {stderr}");
            let lines = stderr.lines().filter(|line| line.contains(name) || line.contains("help: "));
            assert!(lines.count() >= 2 || command == "explain", "{command} {name}: {stderr}");
            // A pseudo-terminal, where `script` is installed.
            let line = format!("{} {command} {name}", crate::RAYREEL);
            let mut terminal = crate::command("script", folder);
            terminal.args(["--quiet", "--return", "--command", &line, "/dev/null"]).env("TERM", "xterm");
            let Ok(child) = terminal.env_remove("NO_COLOR").spawn() else { continue };
            let colored = text(&crate::output_of(child).stdout);
            assert!(!colored.contains("\\u{") && !colored.contains("\\n"), "{command} {name}: {colored}");
            assert!(colored.contains("\u{1b}[1m") || command == "explain", "{command} {name}: {colored}");
        }
    }
}
