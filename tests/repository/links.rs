//! Tests that no link in the documentation is dead.
//!
//! Markdown files link to existing files and headings. Markdown files that are also the documentation of a module are read in two places:
//! next to the sources, and in the pages of rustdoc, which do not contain the linked files. They link by name, and the module defines the
//! name for its pages. Links to modules and types are checked by rustdoc, in `.ci/run`; rustdoc does not check links to files.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::{files_in, root};

fn texts() -> Vec<PathBuf> {
    let mut texts = vec![root().join("README.md"), root().join("CHANGELOG.md")];
    texts.extend(["src", "benches"].iter().flat_map(|folder| files_in(&root().join(folder), "md")));
    texts
}

/// Returns a text without its code.
fn prose(text: &str) -> String {
    let mut is_code = false;
    let mut prose = String::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            is_code = !is_code;
        } else if !is_code {
            prose += line;
            prose.push('\n');
        }
    }
    prose.split('`').step_by(2).collect::<Vec<_>>().join("`")
}

/// Returns the documentation in a source file.
fn documentation(source: &str) -> String {
    let lines = source.lines().map(str::trim_start);
    let lines = lines.filter_map(|line| line.strip_prefix("//!").or(line.strip_prefix("///")));
    prose(&lines.map(|line| format!("{line}\n")).collect::<String>())
}

/// Returns the targets of inline links, as in `[text](target)`.
fn targets(prose: &str) -> Vec<&str> {
    prose.split("](").skip(1).filter_map(|rest| rest.split([')', ' ']).next()).collect()
}

/// Returns the targets of link names, as in `[name]: target "title"`.
fn names(prose: &str) -> BTreeMap<&str, &str> {
    let lines = prose.lines().filter_map(|line| line.strip_prefix('[')?.split_once("]: "));
    lines.map(|(name, target)| (name, target.split(' ').next().unwrap_or(target))).collect()
}

fn is_elsewhere(target: &str) -> bool {
    target.contains("://") || target.starts_with("mailto:")
}

fn is_file(target: &str) -> bool {
    !is_elsewhere(target) && target.contains(['/', '.', '#'])
}

/// Returns the anchor of a heading.
fn anchor(heading: &str) -> String {
    let heading = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = heading.chars().filter(|character| character.is_alphanumeric() || " -_".contains(*character));
    kept.map(|character| if character == ' ' { '-' } else { character }).collect()
}

/// Returns true if the target of a link in a file exists in the repository.
fn leads_somewhere(from: &Path, target: &str) -> bool {
    let (path, heading) =
        target.split_once('#').map_or((target, None), |(path, heading)| (path, Some(heading)));
    let path = if path.is_empty() { from.to_owned() } else { from.parent().unwrap().join(path) };
    let Ok(path) = fs::canonicalize(path) else { return false };
    let has = |heading: &str| {
        let text = fs::read_to_string(&path).unwrap_or_default();
        text.lines().any(|line| line.starts_with('#') && anchor(line) == heading)
    };
    path.starts_with(fs::canonicalize(root()).unwrap()) && heading.is_none_or(has)
}

/// Returns the dead links of a text.
fn dead<'a>(from: &Path, prose: &'a str) -> Vec<&'a str> {
    let targets = targets(prose).into_iter().chain(names(prose).into_values());
    targets.filter(|target| !is_elsewhere(target) && !leads_somewhere(from, target)).collect()
}

#[test]
fn links_between_files_resolve() {
    let mut count = 0;
    for path in texts() {
        let prose = prose(&fs::read_to_string(&path).unwrap());
        assert_eq!(dead(&path, &prose), [""; 0], "{}", path.display());
        count += targets(&prose).len();
    }
    assert!(count > 20, "only {count} links are found");
}

#[test]
fn dead_links_are_found() {
    let text = "[a](README.md), [b](README.md#library), `[code](x.md)`, [c](https://example.org/x), [d][here]\n\
                ```\n[code](x.md)\n```\n[here]: src/scene/manual.md\n\
                [e](REDME.md) [f](#a-scene) [g](README.md#use-as-a-libary)\n\
                ![h](tests/goldens/none.png \"title\") [i](/etc) [j][there]\n[there]: src/language.md\n";
    let expected = [
        "REDME.md",
        "#a-scene",
        "README.md#use-as-a-libary",
        "tests/goldens/none.png",
        "/etc",
        "src/language.md",
    ];
    assert_eq!(dead(&root().join("CHANGELOG.md"), &prose(text)), expected);
}

#[test]
fn included_documentation_links_by_item_names() {
    let mut count = 0;
    for source in files_in(&root().join("src"), "rs") {
        let module = fs::read_to_string(&source).unwrap();
        for (start, rest) in module
            .match_indices("#![doc = include_str!(\"")
            .map(|(at, found)| (at, &module[at + found.len()..]))
        {
            let path = source.parent().unwrap().join(rest.split('"').next().unwrap());
            let prose = prose(&fs::read_to_string(&path).unwrap());
            let files: Vec<&str> = targets(&prose).into_iter().filter(|target| is_file(target)).collect();
            assert_eq!(files, [""; 0], "{} is documentation, where there are no files", path.display());
            for (name, target) in names(&prose).into_iter().filter(|(_, target)| is_file(target)) {
                let meaning = format!("#![doc = \"[{name}]: ");
                assert!(
                    module[..start].contains(&meaning),
                    "{} does not say what `{target}` is",
                    source.display()
                );
            }
            count += 1;
        }
    }
    assert!(count >= 3, "only {count} such texts are found");
}

#[test]
fn documentation_in_sources_links_to_no_files() {
    for source in files_in(&root().join("src"), "rs") {
        let documentation = documentation(&fs::read_to_string(&source).unwrap());
        let files: Vec<&str> = targets(&documentation).into_iter().filter(|target| is_file(target)).collect();
        assert_eq!(files, [""; 0], "{}", source.display());
    }
}

/// Checks the files that the kernel's documentation names, as `stages/surfaces`.
#[test]
fn files_named_by_the_kernel_s_documentation_exist() {
    let kernel = root().join("src/trace");
    let text = fs::read_to_string(kernel.join("mod.rs")).unwrap();
    let is_path = |name: &&str| {
        name.contains('/') && name.bytes().all(|byte| byte.is_ascii_lowercase() || b"_/".contains(&byte))
    };
    let named: Vec<&str> = text.split('`').skip(1).step_by(2).filter(is_path).collect();
    assert!(named.len() > 20);
    let is_missing = |name: &&&str| {
        !kernel.join(format!("{name}.rs")).exists()
            && !kernel.join(name).exists()
            && !root().join(name).exists()
    };
    assert_eq!(named.iter().filter(is_missing).collect::<Vec<_>>(), <[&&str; 0]>::default());
}
