//! Tests of the README and the command manual: the scene is valid, and commands, options and passes exist.

use std::collections::BTreeSet;

use assert_cmd::Command;

use rayreel::trace::Pass;
use rayreel::{Engine, Scene};

use crate::root;

const README: &str = include_str!("../../README.md");
const MANUAL: &str = include_str!("../../src/cli/manual.md");
const TEXTS: [&str; 2] = [README, MANUAL];

fn rayreel(arguments: &[&str]) -> String {
    let output = Command::cargo_bin("rayreel").unwrap().args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Returns the parts of a text between single backticks.
fn code(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// Returns the options in a text, such as `--size`.
fn options(text: &str) -> BTreeSet<&str> {
    let words = text.split(|character: char| !character.is_alphanumeric() && character != '-');
    words.filter(|word| word.len() > 2 && word.starts_with("--")).collect()
}

/// Returns the rows of the command tables in a text.
fn rows(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter(|line| line.starts_with("| `rayreel "))
}

/// Returns the command that a row describes.
fn command(row: &str) -> &str {
    row.split([' ', '`']).skip_while(|word| *word != "rayreel").nth(1).unwrap()
}

#[test]
fn readme_scene_loads() {
    let blocks = TEXTS.into_iter().flat_map(|text| text.split("```ron\n").skip(1));
    let blocks = blocks.map(|rest| rest.split("```").next().unwrap());
    let scenes: Vec<&str> = blocks.filter(|block| block.contains("Scene(\n")).collect();
    assert_eq!(scenes.len(), 1);
    let scene = Scene::from_text("README.md", scenes[0].to_owned()).unwrap_or_else(|error| panic!("{error}"));
    Engine::from_scene(scene).render_frame(24).unwrap();
}

#[test]
fn commands_and_options_exist() {
    assert!(rows(MANUAL).count() >= 7);
    for row in TEXTS.into_iter().flat_map(rows) {
        let help = rayreel(&[command(row), "--help"]);
        let named: BTreeSet<&str> = code(row).flat_map(options).collect();
        let unknown: Vec<_> = named.difference(&options(&help)).copied().collect();
        assert_eq!(unknown, [""; 0], "rayreel {}", command(row));
    }
}

#[test]
fn every_option_is_an_option_of_some_command() {
    let help: String = rows(MANUAL).map(|row| rayreel(&[command(row), "--help"])).collect();
    let named = TEXTS.into_iter().flat_map(code).filter(|text| text.starts_with("--")).flat_map(options);
    let named: BTreeSet<&str> = named.collect();
    assert!(named.len() >= 30, "{named:?}");
    let unknown: Vec<_> = named.difference(&options(&help)).copied().collect();
    assert_eq!(unknown, [""; 0]);
}

#[test]
fn every_feature_is_documented() {
    let manifest = include_str!("../../Cargo.toml");
    let section = manifest.split("[features]\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let names = section.lines().filter(|line| line.starts_with(char::is_alphabetic));
    let names: Vec<&str> = names.filter_map(|line| Some(line.split_once(" = ")?.0)).collect();
    assert!(names.len() >= 5, "{names:?}");
    for name in names.into_iter().filter(|name| *name != "default") {
        assert!(README.contains(&format!("`{name}`")), "{name}");
        assert!(include_str!("../../src/lib.rs").contains(&format!("//! - `{name}`: ")), "{name}");
    }
}

#[test]
fn every_pass_is_documented() {
    let help = rayreel(&["render", "--help"]);
    for pass in Pass::ALL.map(Pass::name) {
        assert!(MANUAL.contains(&format!("| `{pass}` | ")), "{pass}");
        assert!(help.contains(&format!("{pass}:")), "rayreel render --help does not document {pass}");
    }
}

#[test]
fn command_lines_parse() {
    let lines = TEXTS.into_iter().flat_map(|text| text.lines().chain(code(text)));
    let lines = lines.map(|line| line.split(" #").next().unwrap_or(line).trim_end());
    let lines: Vec<&str> =
        lines.filter(|line| line.starts_with("rayreel ") && line.contains(".ron")).collect();
    assert!(lines.len() >= 15, "{lines:?}");
    for line in lines {
        let words: Vec<&str> = line.split(' ').skip(1).collect();
        for scene in words.iter().filter(|word| word.starts_with("scenes/")) {
            assert!(root().join(scene).is_file(), "there is no {scene}");
        }
        // `--help` comes last, so that all other arguments are parsed first.
        rayreel(&[&words[..], &["--help"]].concat());
    }
}
