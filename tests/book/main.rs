//! Tests of the book: its scenes are valid, its commands print what it shows, and its table of contents is complete.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

mod output;

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use tempfile::TempDir;

use output::is_output;

/// A block of code: the language that it names, its text, and the line of the chapter where it starts.
struct Block {
    language: String,
    text: String,
    line: usize,
}

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

fn blocks(text: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut lines = text.lines().enumerate();
    while let Some((index, line)) = lines.next() {
        if let Some(language) = line.strip_prefix("```") {
            let text = lines.by_ref().map(|(_, line)| line).take_while(|line| *line != "```");
            let text = text.map(|line| format!("{line}\n")).collect();
            blocks.push(Block { language: language.to_owned(), text, line: index + 1 });
        }
    }
    blocks
}

/// Returns a folder in which the shipped scenes can be read.
fn folder_with_scenes() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    copy(&root().join("scenes"), &folder.path().join("scenes"));
    folder
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let (path, to) = (entry.as_ref().unwrap().path(), to.join(entry.unwrap().file_name()));
        if path.is_dir() {
            copy(&path, &to);
        } else {
            fs::copy(path, to).unwrap();
        }
    }
}

/// Writes a scene of a chapter, under the name in its first line, `// ball.ron`, if it has one. Fields of a scene extend the last whole
/// scene before them.
fn write_scene(block: &Block, last: &mut Option<String>, folder: &Path) -> String {
    let named = block.text.lines().next().and_then(|line| line.strip_prefix("// "));
    let named = named.filter(|name| name.ends_with(".ron") && !name.contains(' '));
    let file = named.map_or_else(|| format!("line_{}.ron", block.line), str::to_owned);
    let is_whole = block.text.lines().any(|line| line == "Scene(" || line == "(");
    if is_whole {
        fs::write(folder.join(&file), &block.text).unwrap();
        *last = Some(file.clone());
    } else {
        let base = last.as_ref().unwrap_or_else(|| panic!("line {}: no scene to extend", block.line));
        let text = format!("Scene(\n    extends: \"{base}\",\n{})\n", block.text);
        fs::write(folder.join(&file), text).unwrap();
    }
    file
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
        let (folder, mut last) = (folder_with_scenes(), None);
        for block in blocks(&text) {
            let place = format!("src/book/{chapter}:{}", block.line);
            match block.language.as_str() {
                "ron" => {
                    let file = write_scene(&block, &mut last, folder.path());
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
                "rust" | "sh" | "text" | "python" | "pov" => {}
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
    for (path, _) in chapters() {
        let name = path.file_stem().unwrap().to_string_lossy();
        assert!(name == "README" || contents.contains(&format!("\n[{name}]: {name}.md\n")), "{name}");
        assert!(name == "README" || modules.split_whitespace().any(|word| word == name), "{name}");
    }
}
