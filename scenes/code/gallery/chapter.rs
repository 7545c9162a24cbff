//! Chapters of the book: their blocks of code, and the folders in which their scenes and commands work.

use std::fs;
use std::io::Result;
use std::path::Path;

use tempfile::TempDir;

/// A block of code: the language that it names, its text, and the line of the chapter where it starts.
pub(crate) struct Block {
    pub(crate) language: String,
    pub(crate) text: String,
    pub(crate) line: usize,
}

pub(crate) fn blocks(text: &str) -> Vec<Block> {
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

/// Returns a folder with the shipped scenes and the scenes of a chapter.
pub(crate) fn folder_of(repository: &Path, chapter: &str) -> Result<TempDir> {
    let folder = tempfile::tempdir()?;
    copy(&repository.join("scenes"), &folder.path().join("scenes"))?;
    let mut last = None;
    for block in blocks(chapter).iter().filter(|block| block.language == "ron") {
        write_scene(block, &mut last, folder.path())?;
    }
    Ok(folder)
}

/// Writes a scene of a chapter, under the name in its first line, `// ball.ron`, if it has one. Fields of a scene extend the
/// scene before them. Returns the name of the file.
pub(crate) fn write_scene(block: &Block, last: &mut Option<String>, folder: &Path) -> Result<String> {
    let named = block.text.lines().next().and_then(|line| line.strip_prefix("// "));
    let named = named.filter(|name| name.ends_with(".ron") && !name.contains(' '));
    let file = named.map_or_else(|| format!("line_{}.ron", block.line), str::to_owned);
    if block.text.lines().any(|line| line == "Scene(" || line == "(") {
        fs::write(folder.join(&file), &block.text)?;
    } else {
        let base = last.as_deref().unwrap_or("(no scene to extend)");
        fs::write(folder.join(&file), format!("Scene(\n    extends: \"{base}\",\n{})\n", block.text))?;
    }
    *last = Some(file.clone());
    Ok(file)
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let to = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &to)?;
        } else {
            fs::copy(entry.path(), to)?;
        }
    }
    Ok(())
}
