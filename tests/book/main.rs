//! Tests of the book: its scenes are valid, its commands print what it shows, and its table of contents is complete.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

mod output;
mod pictures;
#[path = "../../scenes/code/gallery/main.rs"]
#[allow(dead_code, reason = "its `main` is not called")]
mod program;

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use output::is_output;
use program::chapter::{blocks, folder_of, write_scene};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the chapters of the book that are files of its folder, with their texts.
fn chapters() -> Vec<(PathBuf, String)> {
    let folder = fs::read_dir(root().join("src/book")).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<PathBuf> =
        folder.filter(|path| path.extension().is_some_and(|end| end == "md")).collect();
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

/// Runs a command line, and returns what it prints; of `watch`, which does not end, only the arguments are parsed.
fn run(line: &str, folder: &Path) -> String {
    let mut words = shlex::split(line.strip_prefix("rayreel ").unwrap()).unwrap();
    let is_endless = words[0] == "watch";
    if is_endless {
        words.push("--help".to_owned());
    }
    let output = Command::cargo_bin("rayreel").unwrap().args(words).current_dir(folder).output().unwrap();
    if is_endless {
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        return String::new();
    }
    String::from_utf8([output.stdout, output.stderr].concat()).unwrap()
}

#[test]
fn scenes_are_valid_and_commands_print_what_is_shown() {
    let (mut scenes, mut commands, mut failures) = (0, 0, Vec::new());
    for (path, text) in chapters() {
        let chapter = path.file_name().unwrap().to_string_lossy().into_owned();
        let (folder, mut last) = (folder_of(root(), "").unwrap(), None);
        for block in blocks(&text) {
            let place = format!("src/book/{chapter}:{}", block.line);
            match block.language.as_str() {
                "ron" => {
                    let file = write_scene(&block, &mut last, folder.path()).unwrap();
                    let printed = run(&format!("rayreel check {file}"), folder.path());
                    if !printed.starts_with(&format!("{file}: ok")) || printed.lines().count() > 1 {
                        failures.push(format!("{place}: {printed}"));
                    }
                    scenes += 1;
                }
                "console" => {
                    for shown in format!("\n{}", block.text).split("\n$ ").skip(1) {
                        let (line, shown) = shown.split_once('\n').unwrap();
                        if !line.starts_with("rayreel ") {
                            continue;
                        }
                        let printed = run(line, folder.path());
                        if !is_output(shown, &printed) {
                            failures.push(format!("{place}: $ {line}\n{printed}instead of\n{shown}"));
                        }
                        commands += 1;
                    }
                }
                "rust" | "rust,no_run" | "sh" | "text" | "python" | "pov" => {}
                other => failures.push(format!("{place}: unknown language {other}")),
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
    assert!(scenes >= 10 && commands >= 10, "only {scenes} scenes and {commands} commands are found");
}

#[test]
fn table_of_contents_is_complete() {
    let contents = fs::read_to_string(root().join("src/book/README.md")).unwrap();
    let modules = fs::read_to_string(root().join("src/book/mod.rs")).unwrap();
    let entries =
        contents.lines().filter_map(|line| line.strip_prefix("- [")?.split_once("][")?.1.split_once(']'));
    let entries: Vec<&str> = entries.map(|(name, _)| name).collect();
    let definitions = contents.lines().filter_map(|line| line.strip_prefix('[')?.split_once("]: "));
    assert_eq!(entries, definitions.map(|(name, _)| name).collect::<Vec<_>>());
    for (path, _) in chapters() {
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert!(name == "README" || entries.contains(&name), "{name}");
        assert!(name == "README" || modules.split_whitespace().any(|word| word == name), "{name}");
    }
}
