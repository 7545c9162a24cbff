//! Tests that imports between files form no cycle.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use super::{code, source};
use crate::files_in;

/// The path of a module from the crate's root: `["trace", "query", "hit"]`.
type Module = Vec<String>;

/// A name in a file, and the path that it stands for.
#[derive(Clone, Debug)]
struct Use {
    name: String,
    path: Vec<String>,
}

/// The modules of a crate, and the names that each of them uses.
#[derive(Default)]
struct Modules {
    uses: BTreeMap<Module, Vec<Use>>,
    /// Paths in the code itself.
    paths: BTreeMap<Module, Vec<Vec<String>>>,
    /// Modules in files named `mod.rs` or `lib.rs`, which re-export from their folders.
    facades: BTreeSet<Module>,
}

/// Expands the alternatives of a `use`: `a::{b, c::d as e}` has two.
fn expand(prefix: &[String], tree: &str, found: &mut Vec<Use>) {
    let tree = tree.trim();
    let Some((head, group)) = tree.split_once('{') else {
        let (path, name) = tree.split_once(" as ").map_or((tree, None), |(path, name)| (path, Some(name)));
        let mut segments = prefix.to_vec();
        segments.extend(path.split("::").map(|segment| segment.trim().to_owned()));
        if segments.last().is_some_and(|last| last == "self") {
            segments.pop();
        }
        let last = segments.last().cloned().unwrap_or_default();
        let name = name.map_or(last, |name| name.trim().to_owned());
        found.push(Use { name, path: segments });
        return;
    };
    let mut prefix = prefix.to_vec();
    prefix.extend(head.split("::").map(str::trim).filter(|segment| !segment.is_empty()).map(str::to_owned));
    let mut depth = 0;
    let separate = |character: char| {
        depth += i32::from(character == '{') - i32::from(character == '}');
        character == ',' && depth == 0
    };
    let group = group.strip_suffix('}').unwrap_or(group);
    for part in group.split(separate).filter(|part| !part.trim().is_empty()) {
        expand(&prefix, part, found);
    }
}

/// Returns the paths that start at the crate or at a parent.
fn paths(code: &str) -> Vec<Vec<String>> {
    let is_path = |character: char| character.is_alphanumeric() || "_:".contains(character);
    code.split(|character| !is_path(character))
        .filter(|word| word.starts_with("crate::") || word.starts_with("super::"))
        .map(|word| word.split("::").map(str::to_owned).collect())
        .collect()
}

impl Modules {
    fn read(folder: &Path) -> Self {
        let mut modules = Self::default();
        for path in files_in(folder, "rs") {
            let relative = path.strip_prefix(folder).unwrap().with_extension("");
            let mut module: Module = relative.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
            if module.first().is_some_and(|first| first == "main") {
                continue;
            }
            if ["mod", "lib"].contains(&module.last().unwrap().as_str()) {
                module.pop();
                modules.facades.insert(module.clone());
            }
            modules.add(module, &fs::read_to_string(path).unwrap());
        }
        modules
    }

    fn add(&mut self, module: Module, text: &str) {
        // Imports for tests alone are no part of the structure.
        let code = code(text);
        let code = ["use", "pub(super) use", "pub(crate) use"]
            .iter()
            .fold(code, |code, form| code.replace(&format!("#[cfg(test)]\n{form} "), "\nno "));
        // The space in front distinguishes `use` from the end of `diffuse`.
        let code = format!(" {}", code.replace('\n', " "));
        let mut uses = Vec::new();
        let mut rest = String::new();
        let mut statements = code.split(" use ");
        rest.push_str(statements.next().unwrap_or_default());
        for statement in statements {
            let (tree, after) = statement.split_once(';').unwrap_or((statement, ""));
            expand(&[], tree, &mut uses);
            rest.push_str(after);
        }
        self.paths.insert(module.clone(), paths(&rest));
        self.uses.insert(module, uses);
    }

    /// Returns the path from the root, or `None` if it does not lead into this crate.
    fn absolute(&self, module: &Module, path: &[String]) -> Option<Vec<String>> {
        let first = path.first()?;
        match first.as_str() {
            "crate" => Some(path[1..].to_vec()),
            "self" => Some([module, &path[1..]].concat()),
            "super" => {
                let up = path.iter().take_while(|segment| *segment == "super").count();
                let parent = module.get(..module.len().checked_sub(up)?)?;
                Some([parent, &path[up..]].concat())
            }
            _ => {
                let child = [module.as_slice(), std::slice::from_ref(first)].concat();
                self.uses.contains_key(&child).then(|| [module, path].concat())
            }
        }
    }

    /// Returns the file that defines the target of a path from the root, through all re-exports.
    fn definition(&self, path: &[String]) -> Module {
        /// Maximum number of re-exports to follow. A name that is imported from its own importer would be followed forever.
        const LONGEST: usize = 8;
        self.follow(path, LONGEST)
    }

    fn follow(&self, path: &[String], steps: usize) -> Module {
        let mut module = Module::new();
        for (index, segment) in path.iter().enumerate() {
            let child = [module.as_slice(), std::slice::from_ref(segment)].concat();
            if self.uses.contains_key(&child) {
                module = child;
                continue;
            }
            let passed_on = self.uses[&module].iter().find(|passed| passed.name == *segment);
            let onwards = passed_on.and_then(|passed| self.absolute(&module, &passed.path));
            return match onwards {
                Some(onwards) if steps > 0 => {
                    self.follow(&[&onwards, &path[index + 1..]].concat(), steps - 1)
                }
                _ => module,
            };
        }
        module
    }

    /// Returns the other files from which each file imports. Facades are excluded.
    fn imports(&self) -> BTreeMap<Module, BTreeSet<Module>> {
        let imports = |module: &Module| {
            let used = self.uses[module].iter().map(|used| &used.path);
            let named = used.chain(&self.paths[module]);
            let from = named.filter_map(|path| Some(self.definition(&self.absolute(module, path)?)));
            from.filter(|other| other != module && !other.is_empty()).collect()
        };
        self.uses
            .keys()
            .filter(|module| !self.facades.contains(*module))
            .map(|module| (module.clone(), imports(module)))
            .collect()
    }
}

/// Returns the first cycle that is found, in the order of imports.
fn circle(imports: &BTreeMap<Module, BTreeSet<Module>>) -> Option<Vec<Module>> {
    fn visit(
        module: &Module,
        imports: &BTreeMap<Module, BTreeSet<Module>>,
        way: &mut Vec<Module>,
        done: &mut BTreeSet<Module>,
    ) -> Option<Vec<Module>> {
        if let Some(start) = way.iter().position(|before| before == module) {
            return Some(way[start..].to_vec());
        }
        if done.contains(module) {
            return None;
        }
        way.push(module.clone());
        let circle =
            imports.get(module).into_iter().flatten().find_map(|next| visit(next, imports, way, done));
        way.pop();
        done.insert(module.clone());
        circle
    }
    let mut done = BTreeSet::new();
    imports.keys().find_map(|module| visit(module, imports, &mut Vec::new(), &mut done))
}

fn shown(circle: &[Module]) -> String {
    circle.iter().map(|module| module.join("::")).collect::<Vec<_>>().join(" -> ")
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let imports = Modules::read(&source()).imports();
    assert!(imports.len() > 150 && imports.values().map(BTreeSet::len).sum::<usize>() > 500);
    if let Some(circle) = circle(&imports) {
        panic!("{}", shown(&circle));
    }
}

#[test]
fn the_kernel_s_folders_import_one_way() {
    let mut folders: BTreeMap<Module, BTreeSet<Module>> = BTreeMap::new();
    let folder =
        |module: &Module| module.get(..2).filter(|folder| folder[0] == "trace").map(<[String]>::to_vec);
    for (module, others) in Modules::read(&source()).imports() {
        let Some(from) = folder(&module) else { continue };
        let others = others.iter().filter_map(folder).filter(|other| *other != from);
        folders.entry(from.clone()).or_default().extend(others);
    }
    assert!(folders.len() >= 8);
    if let Some(circle) = circle(&folders) {
        panic!("{}", shown(&circle));
    }
}

#[test]
fn import_circles_are_found_through_reexports() {
    let modules = |texts: &[(&str, &str)]| {
        let mut modules = Modules::default();
        for (module, text) in texts {
            let module = module.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect();
            modules.add(module, text);
        }
        circle(&modules.imports()).map(|circle| shown(&circle))
    };
    let passing = ("a", "mod b;\nmod c;\npub use b::One;\npub use c::Two;");
    let root = ("", "pub mod a;");
    let both = [
        root,
        passing,
        ("a::b", "use super::Two;\npub struct One;"),
        ("a::c", "use crate::a::{One};\npub struct Two;"),
    ];
    assert_eq!(modules(&both).unwrap(), "a::b -> a::c");
    let in_code = [root, passing, ("a::b", "fn f() -> super::Two {}"), ("a::c", "use super::b::One as Uno;")];
    assert_eq!(modules(&in_code).unwrap(), "a::b -> a::c");
    let one_way = [
        root,
        passing,
        ("a::b", "use super::Two;"),
        ("a::c", "use std::fmt;\n#[cfg(test)]\nmod tests { use super::super::One; }"),
    ];
    assert_eq!(modules(&one_way), None);
}
