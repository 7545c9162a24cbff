//! Warnings about parts of a scene that are not rendered as described.

use std::collections::HashSet;

use serde_json::{Value, json};

use rayreel::scene::{Owner, SceneWarning, Sources};
use rayreel::sequence::SequenceFault;
use rayreel::{Engine, Entity, Fault};

use super::args::AllowArguments;
use super::print;

/// Maximum number of warnings listed; further entities are only counted.
const MOST: usize = 10;

/// Warnings about a scene's files, and faults collected over several moments.
#[derive(Debug, Default)]
pub(super) struct Warnings {
    /// The names of the warnings that are not given.
    allowed: Vec<&'static str>,
    /// The number of moments so far.
    moments: usize,
    files: Vec<SceneWarning>,
    listed: Vec<SequenceFault>,
    /// The owners and the first moments of the listed faults.
    about: Vec<(Owner, String)>,
    /// Entities with faults that are not listed.
    others: HashSet<Entity>,
}

/// A fault at one or more moments.
#[derive(Debug)]
struct Warning<'a> {
    found: &'a SequenceFault,
    owner: &'a Owner,
    /// The first moment of the fault.
    first: &'a str,
}

impl Warnings {
    /// Creates a list without these warnings.
    pub(super) fn except(AllowArguments { warnings }: &AllowArguments) -> Self {
        Self { allowed: warnings.clone(), ..Self::default() }
    }

    /// Collects the faults at the engine's current moment, which is reported as `moment`.
    pub(super) fn collect(&mut self, engine: &Engine, moment: &str) {
        let is_allowed = |name: &str| self.allowed.contains(&name);
        let of_files = engine.scene_warnings().iter();
        self.files = of_files.filter(|warning| !is_allowed(warning.name)).cloned().collect();
        let index = u32::try_from(self.moments).unwrap_or(u32::MAX);
        let is_wanted = |fault: &Fault| !is_allowed(fault.consequence.name());
        let others = SequenceFault::collect(&mut self.listed, MOST, engine, index, is_wanted);
        self.others.extend(others.iter().map(|fault| fault.entity));
        let added = self.listed[self.about.len()..].iter();
        self.about
            .extend(added.map(|found| (Owner::of(engine.world(), found.fault.entity), moment.to_owned())));
        self.moments += 1;
    }

    /// Returns whether no warning refers to an entity.
    pub(super) fn are_of_files(&self) -> bool {
        self.faults().next().is_none()
    }

    /// Returns the listed faults.
    fn faults(&self) -> impl Iterator<Item = Warning<'_>> {
        let listed = self.listed.iter().zip(&self.about);
        let counting = listed.filter(|(found, _)| found.counts(self.moments));
        counting.map(|(found, (owner, first))| Warning { found, owner, first })
    }

    /// Formats the number of warnings as `, 3 warnings`, or as an empty string if there are none.
    pub(super) fn count(&self) -> String {
        match self.files.len() + self.faults().count() + self.others.len() {
            0 => String::new(),
            1 => ", 1 warning".to_owned(),
            count => format!(", {count} warnings"),
        }
    }

    /// Prints the warnings, with line numbers for entities found in `sources`.
    pub(super) fn print(&self, sources: Option<&Sources>) {
        for SceneWarning { file, position, message, help, .. } in &self.files {
            let about = [format!(" --> {file}:{position}"), format!("  = help: {help}")];
            print::warning(message, &about);
        }
        for Warning { found, owner, first } in self.faults() {
            let line = sources.and_then(|sources| owner.line(sources));
            let line = line.map_or_else(String::new, |line| format!("{line}, "));
            let (fault, moments) = (found.fault, found.moments(first));
            let about = [format!(" --> {line}{moments}"), format!("  = help: {}", fault.remedy())];
            print::warning(&format!("{owner} {fault}"), &about);
        }
        match self.others.len() {
            0 => {}
            1 => print::warning("one more entity has a fault", &[]),
            count => print::warning(&format!("{count} more entities have faults"), &[]),
        }
    }

    /// Prints the warnings like [`Self::print`], but each as a JSON object for programs that read the progress.
    pub(super) fn print_events(&self, sources: Option<&Sources>) {
        let Value::Array(warnings) = self.to_json(sources) else { return };
        for mut warning in warnings {
            warning["event"] = json!("warning");
            print::error_json(warning);
        }
        if !self.others.is_empty() {
            let message = format!("entities with further faults: {}", self.others.len());
            print::error_json(json!({ "event": "warning", "message": message }));
        }
    }

    /// Returns the warnings as JSON.
    pub(super) fn to_json(&self, sources: Option<&Sources>) -> Value {
        let one = |Warning { found, owner, first }: Warning<'_>| {
            let fault = found.fault;
            let line = sources.and_then(|sources| owner.line(sources));
            json!({
                "name": fault.consequence.name(),
                "entity": owner.to_string(),
                "file": line.map(|line| line.file),
                "line": line.map(|line| line.line),
                "message": fault.to_string(),
                "help": fault.remedy(),
                "first": first,
                "more": found.frames - 1,
            })
        };
        let of_file = |SceneWarning { name, file, position, message, help }: &SceneWarning| {
            json!({
                "name": name,
                "entity": null,
                "file": file,
                "line": position.line,
                "message": message,
                "help": help,
                "first": null,
                "more": 0,
            })
        };
        self.files.iter().map(of_file).chain(self.faults().map(one)).collect()
    }
}
