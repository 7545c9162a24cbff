//! Tests of the README: its scene is valid, and its commands and options exist.

use assert_cmd::Command;

use rayreel::trace::Pass;
use rayreel::{Engine, Scene};

use crate::root;

const README: &str = include_str!("../../README.md");

fn rayreel(arguments: &[&str]) -> String {
    let output = Command::cargo_bin("rayreel").unwrap().args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Returns the parts of a text between single backticks.
fn code(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

#[test]
fn the_scene_is_a_scene() {
    let blocks = README.split("```ron\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    let scenes: Vec<&str> = blocks.filter(|block| block.starts_with("Scene(")).collect();
    assert_eq!(scenes.len(), 1);
    let scene = Scene::from_text("README.md", scenes[0].to_owned()).unwrap_or_else(|error| panic!("{error}"));
    Engine::from_scene(scene).render_frame(24).unwrap();
}

#[test]
fn every_command_and_every_option_of_the_table_is_there() {
    let rows: Vec<&str> = README.lines().filter(|line| line.starts_with("| `rayreel ")).collect();
    assert!(rows.len() >= 7);
    for row in rows {
        let words: Vec<&str> = code(row).collect();
        let command = words[0].split(' ').nth(1).unwrap();
        let help = rayreel(&[command, "--help"]);
        for option in words.iter().filter_map(|word| word.split(' ').next()?.strip_prefix("--")) {
            assert!(help.contains(&format!("--{option}")), "rayreel {command} knows no --{option}");
        }
    }
}

#[test]
fn every_pass_is_documented() {
    let help = rayreel(&["render", "--help"]);
    for pass in Pass::ALL.map(Pass::name) {
        assert!(README.contains(&format!("| `{pass}` | ")), "{pass}");
        assert!(help.contains(&format!("{pass}:")), "rayreel render --help does not document {pass}");
    }
}

#[test]
fn every_command_line_is_understood() {
    let texts = README.lines().filter(|line| line.starts_with("rayreel ")).chain(code(README));
    let lines: Vec<&str> =
        texts.filter(|text| text.starts_with("rayreel ") && text.contains(".ron")).collect();
    assert!(lines.len() >= 5, "{lines:?}");
    for line in lines {
        let words: Vec<&str> = line.split(' ').skip(1).collect();
        let scene = words.iter().find(|word| word.ends_with(".ron")).unwrap();
        assert!(root().join(scene).is_file(), "there is no {scene}");
        // `--help` comes last, so that all other arguments are parsed first.
        rayreel(&[&words[..], &["--help"]].concat());
    }
}
