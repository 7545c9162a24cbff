//! Warnings about parts of a scene that are not rendered as described.

use std::collections::HashSet;
use std::mem::discriminant;

use serde_json::{Value, json};

use rayreel::components::{Camera, Name, Order};
use rayreel::scene::{SceneWarning, SourceLine, Sources};
use rayreel::{Engine, Entity, Fault, World};

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
    listed: Vec<Warning>,
    /// Entities with faults that are not listed.
    others: HashSet<Entity>,
}

/// A fault that occurs at one or more moments.
#[derive(Debug)]
struct Warning {
    fault: Fault,
    owner: Owner,
    /// The first moment of the fault.
    moment: String,
    /// Number of further moments with the fault.
    more: usize,
}

/// The owner of a fault.
#[derive(Debug)]
enum Owner {
    /// An entity, with its name and its index in document order, if it has them.
    Entity(Option<String>, Option<usize>),
    /// A camera, by its name.
    Camera(String),
    Scene,
}

impl Owner {
    fn of(world: &World, entity: Entity) -> Self {
        let name = world.get::<&Name>(entity).ok().map(|name| name.0.clone());
        let order = world.get::<&Order>(entity).ok().and_then(|order| usize::try_from(order.0).ok());
        match (name, order) {
            (Some(name), None) if world.satisfies::<&Camera>(entity) => Self::Camera(name),
            (Some(_), None) => Self::Scene,
            (name, order) => Self::Entity(name, order),
        }
    }

    fn line<'a>(&self, sources: &'a Sources) -> Option<SourceLine<'a>> {
        match self {
            Self::Entity(_, order) => sources.entities(&[(*order)?]).next(),
            Self::Camera(name) => Some(sources.camera(name)),
            Self::Scene => None,
        }
    }

    fn text(&self) -> String {
        match self {
            // Quoted as in the scene file: a name may contain any character.
            Self::Entity(Some(name), _) => format!("{name:?}"),
            Self::Entity(None, Some(order)) => format!("entity #{order}"),
            Self::Entity(None, None) => "an entity".to_owned(),
            Self::Camera(name) if name == "camera" => "the camera".to_owned(),
            Self::Camera(name) => format!("camera {name:?}"),
            Self::Scene => "the scene".to_owned(),
        }
    }
}

impl Warning {
    /// Returns whether the fault counts after this number of moments.
    fn counts(&self, moments: usize) -> bool {
        !self.fault.may_pass() || self.more + 1 == moments
    }
}

impl Warnings {
    /// Creates a list without these warnings.
    pub(super) fn except(AllowArguments { warnings }: &AllowArguments) -> Self {
        Self { allowed: warnings.clone(), ..Self::default() }
    }

    /// Collects the faults at the engine's current moment, which is reported as `moment`.
    pub(super) fn collect(&mut self, engine: &Engine, moment: &str) {
        self.moments += 1;
        let is_allowed = |name: &str| self.allowed.contains(&name);
        if !is_allowed(SceneWarning::NAME) {
            self.files = engine.scene_warnings().to_vec();
        }
        for fault in engine.faults().into_iter().filter(|fault| !is_allowed(fault.consequence.name())) {
            let same = |known: &&mut Warning| {
                known.fault.entity == fault.entity
                    && discriminant(&known.fault.cause) == discriminant(&fault.cause)
            };
            if let Some(known) = self.listed.iter_mut().find(same) {
                known.more += 1;
            } else if self.listed.len() < MOST {
                let owner = Owner::of(engine.world(), fault.entity);
                self.listed.push(Warning { fault, owner, moment: moment.to_owned(), more: 0 });
            } else {
                self.others.insert(fault.entity);
            }
        }
    }

    /// Returns whether no warning refers to an entity.
    pub(super) fn are_of_files(&self) -> bool {
        self.faults().next().is_none()
    }

    /// Returns the listed faults.
    fn faults(&self) -> impl Iterator<Item = &Warning> {
        self.listed.iter().filter(|warning| warning.counts(self.moments))
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
        for SceneWarning { file, position, message, help } in &self.files {
            let about = [format!(" --> {file}:{position}"), format!("  = help: {help}")];
            print::warning(message, &about);
        }
        for Warning { fault, owner, moment, more } in self.faults() {
            let line = sources.and_then(|sources| owner.line(sources));
            let line = line.map_or_else(String::new, |line| format!("{line}, "));
            let more = match more {
                0 => String::new(),
                1 => " and one more".to_owned(),
                more => format!(" and {more} more"),
            };
            let about = [format!(" --> {line}{moment}{more}"), format!("  = help: {}", fault.remedy())];
            print::warning(&format!("{} {fault}", owner.text()), &about);
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
        let one = |Warning { fault, owner, moment, more }: &Warning| {
            let line = sources.and_then(|sources| owner.line(sources));
            json!({
                "name": fault.consequence.name(),
                "entity": owner.text(),
                "file": line.map(|line| line.file),
                "line": line.map(|line| line.line),
                "message": fault.to_string(),
                "help": fault.remedy(),
                "first": moment,
                "more": more,
            })
        };
        let of_file = |SceneWarning { file, position, message, help }: &SceneWarning| {
            json!({
                "name": SceneWarning::NAME,
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
