//! The language server in an editor: Neovim with its own client, without a screen.

use std::fs;

use crate::{RAYREEL, command, output_of, text};

const SCENE: &str = r#"(
    film: (width: 32, height: 18), camera: (position: (0, 0, -5), target: (0, 0, 0)), ambient: (1, 1, 1),
    materials: {
        "clay": (k_a: 0.3, k_d: 0.7, color: (255, 120, 60)),
    },
    entities: [
        (name: "ball", shape: Sphere(radius: 1), material: "clay"),
        (shape: Box(size: (1, 1, 1)), material: "cly", transform: (translation: (1, 0, 0))),
    ],
)"#;

#[test]
fn neovim_shows_diagnostics_descriptions_and_completions() {
    let folder = tempfile::tempdir().unwrap();
    if command("nvim", folder.path()).arg("--version").output().is_err() {
        println!("there is no nvim: it was not tried");
        return;
    }
    fs::write(folder.path().join("ball.ron"), SCENE).unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/command/neovim.lua");
    let mut starting = command("nvim", folder.path());
    starting.args(["--headless", "-u", "NONE", "-n", "-c", &format!("luafile {script}")]);
    starting.env("HOME", folder.path()).env("RAYREEL", RAYREEL);
    let output = output_of(starting.spawn().unwrap());
    let shown = fs::read_to_string(folder.path().join("shown"));
    let shown = shown.unwrap_or_else(|_| panic!("{}{}", text(&output.stdout), text(&output.stderr)));
    assert_eq!(
        shown.lines().collect::<Vec<_>>(),
        [
            "diagnostic: 7:48 there is no material \"cly\" / help: did you mean `clay`?",
            "hover: **k_d of Material** /  / diffuse reflection coefficient, 0 to 1",
            "completion: Sphere -> Sphere(radius: 1)",
            "completion: Plane -> Plane(normal: (0, 1, 0))",
            "completion: Box -> Box(size: (1, 1, 1))",
            "completion: Cylinder -> Cylinder(radius: 0.2, from: (0, 0, 0), to: (0, 2, 0))",
            "completion: Capsule -> Capsule(radius: 0.2, from: (0, 0, 0), to: (0, 2, 0))",
            "definition:         \"clay\": (k_a: 0.3, k_d: 0.7, color: (255, 120, 60)),",
            "diagnostics: 0",
        ]
    );
}
