//! Prepares the chapters of the book for the pages of rustdoc, which contain no files of the repository: links lead to modules, pictures
//! are data URLs, and links to other files become plain text.

use std::path::Path;
use std::{env, fs, io};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;

#[allow(clippy::print_stdout, reason = "Cargo reads it")]
fn main() -> io::Result<()> {
    println!("cargo:rerun-if-changed=src/book\ncargo:rerun-if-changed=src/cli/manual.md");
    let out = env::var_os("OUT_DIR").ok_or(io::ErrorKind::NotFound)?;
    let mut chapters = vec![(Path::new("src/cli/manual.md").to_owned(), "commands.md".into())];
    for entry in fs::read_dir("src/book")? {
        let entry = entry?;
        if entry.path().extension().is_some_and(|extension| extension == "md") {
            chapters.push((entry.path(), entry.file_name()));
        }
    }
    chapters
        .into_iter()
        .try_for_each(|(path, name)| fs::write(Path::new(&out).join(name), for_rustdoc(&path)?))
}

/// Returns a chapter with other definitions of its link names, as in `[name]: file "title"`.
fn for_rustdoc(path: &Path) -> io::Result<String> {
    let (mut chapter, mut is_code, mut plain) = (String::new(), false, Vec::new());
    for line in fs::read_to_string(path)?.lines() {
        let definition = line.strip_prefix('[').and_then(|line| line.split_once("]: ")).filter(|_| !is_code);
        if line.starts_with("```") {
            // To rustdoc, a block without a language is Rust.
            chapter += if line == "```" && !is_code { "```text" } else { line };
            is_code = !is_code;
        } else if let Some((name, target)) = definition {
            let file = target.split(' ').next().unwrap_or(target);
            match (module(file), file.rsplit_once('.')) {
                _ if file.contains("://") => chapter += line,
                (Some(module), _) => chapter += &format!("[{name}]: {module}"),
                (_, Some((_, kind @ ("png" | "gif" | "svg")))) => {
                    let kind = if kind == "svg" { "svg+xml" } else { kind };
                    let picture = BASE64_STANDARD.encode(fs::read(path.with_file_name(file))?);
                    chapter += &format!("[{name}]: data:image/{kind};base64,{picture}");
                }
                _ => plain.push(name.to_owned()),
            }
        } else {
            chapter += line;
        }
        chapter.push('\n');
    }
    for name in plain {
        while let Some(end) = chapter.find(&format!("][{name}]")) {
            let start = chapter[..end].rfind('[').ok_or(io::ErrorKind::InvalidData)?;
            chapter.replace_range(end..end + name.len() + 3, "");
            chapter.remove(start);
        }
    }
    Ok(chapter)
}

/// Returns the module whose documentation is this file, with the heading after a `#`.
fn module(file: &str) -> Option<String> {
    let (path, heading) = file.find('#').map_or((file, ""), |at| file.split_at(at));
    let module = match path {
        "README.md" | "../book/README.md" => "crate::book".to_owned(),
        "../scene/manual.md" => "crate::scene::manual".to_owned(),
        "../script/language.md" => "crate::scene::language".to_owned(),
        "../trace/numerics.md" => "crate::trace".to_owned(),
        "../book/editors.md" => "crate::book::editors".to_owned(),
        "../cli/manual.md" => "crate::book::commands".to_owned(),
        _ => format!("crate::book::{}", path.strip_suffix(".md").filter(|name| !name.contains('/'))?),
    };
    Some(module + heading)
}
