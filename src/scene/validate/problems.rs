//! Errors and warnings with their paths in the document.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use crate::scene::document::SceneDocument;
use crate::scene::quote::short;
use crate::scene::spans::{PathStep, inside_text, locate};
use crate::scene::suggest::remedy;
use crate::scene::{Diagnostic, Source};
use crate::script::ScriptError;

/// The errors and warnings found so far.
#[derive(Debug, Default)]
pub(in crate::scene) struct Problems {
    errors: ProblemList,
    /// Values that are valid and surely not meant.
    warnings: ProblemList,
    spawned: SpawnCalls,
}

/// Problems of one kind. Beyond [`ProblemList::MOST`] they are only counted.
#[derive(Debug, Default)]
pub(in crate::scene) struct ProblemList {
    listed: Vec<Problem>,
    unlisted: usize,
    /// The number of problems counted with the last of [`ProblemList::EQUAL`] equal ones.
    repeated: usize,
}

/// A call of `spawn` in a script.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SpawnCall {
    /// The script's index in the list.
    script: u32,
    /// The byte offset of the call in the script's text.
    byte: u32,
}

/// The origins of the entities that scripts spawned, which are not in the file.
#[derive(Debug, Default)]
struct SpawnCalls {
    /// The document index of the first entity that is a cloud, if there is one.
    clouds_from: Option<usize>,
    /// The document index of the first spawned entity.
    first: usize,
    /// The call that spawned each entity.
    calls: Vec<SpawnCall>,
    /// The script files, by the script's index in the list.
    files: BTreeMap<u32, Arc<Source>>,
}

/// A span in the text of a script.
#[derive(Debug)]
struct Inside {
    /// The script's own file; `None` if the script is written in the scene file.
    source: Option<Arc<Source>>,
    span: Range<usize>,
}

/// The identity of an error in a spawned entity, which one call in a loop may repeat many times.
#[derive(Debug, PartialEq)]
struct Repeatable {
    call: SpawnCall,
    /// The path of the value within the entity.
    value: Vec<PathStep>,
    label: String,
}

/// A kind of named scene element.
#[derive(Clone, Copy, Debug)]
pub(super) enum Named {
    Material,
    Entity,
    Camera,
}

#[derive(Debug)]
struct Problem {
    path: Vec<PathStep>,
    /// The span in the file's text, if it is known already.
    span: Option<Range<usize>>,
    inside: Option<Inside>,
    message: String,
    label: String,
    help: Option<String>,
    /// The identity of an error that may be repeated.
    repeatable: Option<Repeatable>,
    /// The number of occurrences.
    times: usize,
    /// The number of equal errors elsewhere that are not listed.
    more: usize,
}

impl Problem {
    /// Creates a problem at a value of the file.
    fn new(path: Vec<PathStep>, message: String, label: String, help: Option<String>) -> Self {
        Self { path, span: None, inside: None, message, label, help, repeatable: None, times: 1, more: 0 }
    }
}

/// The path from the scene to a value, kept on the stack while the document is traversed.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene) struct At<'a> {
    step: Option<(&'a At<'a>, PathStep)>,
}

impl<'a> At<'a> {
    pub(in crate::scene) fn scene() -> Self {
        Self { step: None }
    }

    pub(in crate::scene) fn field(&'a self, name: &'static str) -> Self {
        Self { step: Some((self, PathStep::Field(name))) }
    }

    pub(in crate::scene) fn index(&'a self, index: usize) -> Self {
        Self { step: Some((self, PathStep::Index(index))) }
    }

    pub(super) fn key(&'a self, index: usize) -> Self {
        Self { step: Some((self, PathStep::Key(index))) }
    }

    pub(in crate::scene) fn path(&self) -> Vec<PathStep> {
        let mut path = Vec::new();
        let mut at = self;
        while let Some((above, step)) = &at.step {
            path.push(*step);
            at = above;
        }
        path.reverse();
        path
    }
}

impl Problems {
    /// The label for an unknown name.
    const UNKNOWN: &'static str = "unknown";

    /// Adds an error.
    pub(in crate::scene) fn add(
        &mut self,
        at: &At<'_>,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.errors.add(&self.spawned, at, message.into(), label.into(), help.into());
    }

    /// Adds a warning, which does not prevent the scene from loading.
    pub(in crate::scene) fn warn(
        &mut self,
        at: &At<'_>,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.warnings.add(&self.spawned, at, message.into(), label.into(), help.into());
    }

    /// Adds an error in a script, which is written at this position or in a file of its own.
    pub(in crate::scene) fn add_script(
        &mut self,
        at: &At<'_>,
        source: Option<Arc<Source>>,
        error: &ScriptError,
    ) {
        let (message, label) = (error.message.clone(), error.label.clone());
        let inside = Some(Inside { source, span: error.span.clone() });
        let (path, help) = (at.index(0).path(), help_for(error));
        self.errors.push(Problem { inside, ..Problem::new(path, message, label, help) });
    }

    /// Adds errors whose positions in the text are known. Returns the one that has none, if there is one.
    pub(in crate::scene) fn add_located(&mut self, diagnostics: Vec<Diagnostic>) -> Option<Diagnostic> {
        let mut without_position = None;
        for diagnostic in diagnostics {
            if diagnostic.span.is_none() {
                without_position = Some(diagnostic);
                continue;
            }
            let Diagnostic { message, label, help, span, .. } = diagnostic;
            self.errors.push(Problem { span, ..Problem::new(Vec::new(), message, label, help) });
        }
        without_position
    }

    /// Sets the document index of the first entity spawned by a script.
    pub(in crate::scene) fn spawned_from(&mut self, first: usize) {
        self.spawned.first = first;
    }

    /// Sets the document index of the first entity that is a cloud.
    pub(in crate::scene) fn clouds_from(&mut self, first: usize) {
        self.spawned.clouds_from = Some(first);
    }

    /// Adds an error at a part of a text.
    pub(in crate::scene) fn add_inside(
        &mut self,
        at: &At<'_>,
        span: Range<usize>,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) {
        let inside = Some(Inside { source: None, span });
        let problem = Problem::new(at.path(), message.into(), label.into(), Some(help.into()));
        self.errors.push(Problem { inside, ..problem });
    }

    /// Records the call that spawned the next entity: the script's index in the list, and the byte offset of the call in its text.
    pub(in crate::scene) fn spawned_at(&mut self, script: usize, source: Option<&Arc<Source>>, byte: usize) {
        let index = |index: usize| u32::try_from(index).unwrap_or(u32::MAX);
        if let Some(source) = source {
            self.spawned.files.entry(index(script)).or_insert_with(|| Arc::clone(source));
        }
        self.spawned.calls.push(SpawnCall { script: index(script), byte: index(byte) });
    }

    /// Adds the error for an unknown name. The known names are collected only if the error is listed.
    pub(super) fn add_unknown<'n>(
        &mut self,
        at: &At<'_>,
        kind: Named,
        name: &str,
        known: impl FnOnce() -> Vec<Cow<'n, str>>,
    ) {
        let (singular, plural) = match kind {
            Named::Material => ("material", "materials"),
            Named::Entity => ("entity", "entities"),
            Named::Camera => ("camera", "cameras"),
        };
        let message = format!("there is no {singular} \"{}\"", short(name));
        let repeatable = self.spawned.repeatable(&at.path(), Self::UNKNOWN);
        if self.errors.is_repeated(repeatable.as_ref(), &message, Self::UNKNOWN) || self.errors.is_unlisted()
        {
            return;
        }
        let known = known();
        let known: Vec<&str> = known.iter().map(AsRef::as_ref).collect();
        self.add(at, message, Self::UNKNOWN, remedy(name, &known, plural));
    }

    /// Counts errors that are not listed.
    pub(super) fn add_unlisted(&mut self, count: usize) {
        self.errors.unlisted += count;
    }

    /// Returns whether further errors are only counted.
    pub(super) fn is_full(&self) -> bool {
        self.errors.is_full()
    }

    /// Returns whether there are no errors.
    pub(in crate::scene) fn is_empty(&self) -> bool {
        self.errors.listed.is_empty()
    }

    /// Returns the errors.
    pub(in crate::scene) fn into_errors(self) -> ProblemList {
        self.errors
    }

    /// Returns the warnings.
    pub(in crate::scene) fn into_warnings(self) -> ProblemList {
        self.warnings
    }
}

impl ProblemList {
    /// Maximum number of listed problems.
    pub(in crate::scene) const MOST: usize = 50;

    /// Maximum number of listed problems that are equal.
    const EQUAL: usize = 3;

    fn add(&mut self, spawned: &SpawnCalls, at: &At<'_>, message: String, label: String, help: String) {
        let path = spawned.written(at.path());
        let repeatable = spawned.repeatable(&path, &label);
        let (path, inside) = match &repeatable {
            Some(Repeatable { call, .. }) => (call.path(), Some(spawned.inside(*call))),
            None => (path, None),
        };
        let problem = Problem::new(path, message, label, Some(help));
        self.push(Problem { inside, repeatable, ..problem });
    }

    /// Adds a problem, unless it is only counted.
    fn push(&mut self, problem: Problem) {
        let Problem { repeatable, message, label, .. } = &problem;
        if !self.is_repeated(repeatable.as_ref(), message, label) && !self.is_unlisted() {
            self.listed.push(problem);
        }
    }

    /// Counts a problem as repeated if it was found before in the same call, or if [`Self::EQUAL`] equal ones are listed. Returns whether
    /// it is repeated.
    fn is_repeated(&mut self, repeatable: Option<&Repeatable>, message: &str, label: &str) -> bool {
        let is_same =
            |problem: &&mut Problem| repeatable.is_some() && problem.repeatable.as_ref() == repeatable;
        if let Some(same) = self.listed.iter_mut().find(is_same) {
            same.times += 1;
            return true;
        }
        let is_equal = |problem: &&mut Problem| problem.message == message && problem.label == label;
        let Some(last) = self.listed.iter_mut().filter(is_equal).nth(Self::EQUAL - 1) else { return false };
        last.more += 1;
        self.repeated += 1;
        true
    }

    /// Counts a problem if the list is full. Returns whether the list is full.
    fn is_unlisted(&mut self) -> bool {
        self.unlisted += usize::from(self.is_full());
        self.is_full()
    }

    fn is_full(&self) -> bool {
        self.listed.len() == Self::MOST
    }

    /// Returns the number of problems that are counted with equal ones.
    pub(in crate::scene) fn repeated(&self) -> usize {
        self.repeated
    }

    /// Returns the problems with their positions in the text, in text order, and the number of unlisted ones.
    pub(in crate::scene) fn locate(self, text: &str) -> (Vec<Diagnostic>, usize) {
        let paths: Vec<Vec<PathStep>> = self.listed.iter().map(|problem| problem.path.clone()).collect();
        let spans = locate(text, &paths);
        let mut ordered = BTreeMap::new();
        for (index, (problem, span)) in self.listed.into_iter().zip(spans).enumerate() {
            let Problem { message, mut label, help, inside, times, more, span: known, .. } = problem;
            let span = known.unwrap_or(span);
            if times > 1 {
                label += &format!(" ({times} times)");
            }
            if more > 0 {
                label += &format!(" (and {more} more like this)");
            }
            let (start, end) = (span.start, span.end);
            let (span, source) = match inside {
                Some(Inside { source: Some(source), span }) => (span, Some(source)),
                Some(Inside { source: None, span: inside }) => (inside_text(text, span, &inside), None),
                None => (span, None),
            };
            let key = (start, end, span.start, index);
            ordered.insert(key, Diagnostic::new(message, label, help, Some(span)).within(source));
        }
        (ordered.into_values().collect(), self.unlisted)
    }
}

impl SpawnCall {
    /// Returns the path of the script.
    fn path(self) -> Vec<PathStep> {
        vec![PathStep::Field("spawn"), PathStep::Index(self.script as usize), PathStep::Index(0)]
    }
}

impl SpawnCalls {
    /// Returns the path at which the value of an entity is written: clouds are in a list of their own.
    fn written(&self, mut path: Vec<PathStep>) -> Vec<PathStep> {
        if let ([PathStep::Field(SceneDocument::ENTITIES), PathStep::Index(index), ..], Some(first)) =
            (&path[..], self.clouds_from)
            && let Some(cloud) = index.checked_sub(first)
        {
            path[0] = PathStep::Field(SceneDocument::CLOUDS);
            path[1] = PathStep::Index(cloud);
        }
        path
    }

    /// Returns the identity of an error, given its path; `None` if it is not in a spawned entity.
    fn repeatable(&self, path: &[PathStep], label: &str) -> Option<Repeatable> {
        let [PathStep::Field("entities"), PathStep::Index(index), value @ ..] = path else { return None };
        let call = *self.calls.get(index.checked_sub(self.first)?)?;
        Some(Repeatable { call, value: value.to_vec(), label: label.to_owned() })
    }

    fn inside(&self, call: SpawnCall) -> Inside {
        let start = call.byte as usize;
        Inside { source: self.files.get(&call.script).cloned(), span: start..start + "spawn".len() }
    }
}

/// Returns the remedy for a script error. For an unknown name, it suggests a known one.
pub(in crate::scene) fn help_for(error: &ScriptError) -> Option<String> {
    let Some(unknown) = &error.unknown else { return error.help.clone() };
    let known: Vec<&str> = unknown.known.iter().map(String::as_str).collect();
    Some(remedy(&unknown.name, &known, unknown.kind))
}

/// Checks of values that are shared by many fields.
pub(super) mod check {
    use super::{At, Problems};
    use crate::animation::limits::{LARGEST, MOST_LIGHT, SMALLEST};
    use crate::color::{Rgb, Transfer, to_f32};
    use crate::components::{Quantity, ValidRange};
    use crate::scene::document::Triple;
    use crate::scene::quote::Figure;

    /// Checks that a number is finite, and within the limits of coordinates.
    pub(crate) fn number(value: f64, at: &At<'_>, problems: &mut Problems) -> bool {
        if !value.is_finite() {
            let message = if value.is_nan() { "this is not a number" } else { "this number is too large" };
            problems.add(at, message, "not finite", measure());
            return false;
        }
        if value.abs() > LARGEST {
            problems.add(at, format!("{} is too large", Figure(value)), "out of range", measure());
            return false;
        }
        true
    }

    fn measure() -> String {
        format!("write a number between -{LARGEST:e} and {LARGEST:e}")
    }

    /// Checks three numbers like [`number`].
    pub(crate) fn vector(value: Triple, at: &At<'_>, problems: &mut Problems) -> bool {
        let mut good = true;
        for (index, value) in value.into_iter().enumerate() {
            good &= number(value, &at.index(index), problems);
        }
        good
    }

    /// Checks a direction: three numbers, not all of them too close to zero.
    pub(crate) fn direction(value: Triple, what: &str, at: &At<'_>, problems: &mut Problems) -> bool {
        if !vector(value, at, problems) {
            return false;
        }
        if value.iter().all(|part| part.abs() < SMALLEST) {
            let label = if value == [0.0; 3] { "zero" } else { "too close to zero" };
            let help = "write a vector of any length but zero, as (0, 1, 0)";
            problems.add(at, format!("{what} has no direction"), label, help);
            return false;
        }
        true
    }

    /// Checks a number against its range.
    pub(crate) fn range(
        value: f64,
        range: ValidRange,
        what: &str,
        help: &str,
        at: &At<'_>,
        problems: &mut Problems,
    ) -> bool {
        use ValidRange::{Any, NotNegative, Positive};
        if matches!(range, Any | NotNegative | Positive) && !number(value, at, problems) {
            return false;
        }
        let Err(error) = range.check(value) else { return true };
        let label = match range {
            NotNegative => "below 0",
            Positive => "too small",
            _ => "out of range",
        };
        problems.add(at, format!("{what} {error}"), label, help);
        false
    }

    /// Checks a length, which must be greater than zero.
    pub(crate) fn size(value: f64, what: &str, at: &At<'_>, problems: &mut Problems) -> bool {
        range(value, ValidRange::Positive, what, "write a length in scene units, as 1", at, problems)
    }

    /// Checks an integer in 1..=`most`.
    pub(crate) fn count(value: u64, most: u32, what: &str, help: &str, at: &At<'_>, problems: &mut Problems) {
        if !(1..=u64::from(most)).contains(&value) {
            let message = format!("{what} must be from 1 to {most}, not {value}");
            problems.add(at, message, "out of range", help);
        }
    }

    /// Checks a coefficient.
    pub(crate) fn coefficient(value: f64, what: &str, at: &At<'_>, problems: &mut Problems) {
        range(
            value,
            Quantity::Coefficient.range(),
            what,
            "write the share of the light, as 0.7",
            at,
            problems,
        );
    }

    /// Checks the exponent of specular highlights.
    pub(crate) fn shininess(value: f64, at: &At<'_>, problems: &mut Problems) {
        let help = "write 10 for a dull surface, 100 for a polished one";
        range(value, Quantity::Shininess.range(), "shininess", help, at, problems);
    }

    /// Checks a refractive index.
    pub(crate) fn ior(value: f64, at: &At<'_>, problems: &mut Problems) {
        let help = "write the refractive index, as 1.33 for water, 1.5 for glass";
        range(value, Quantity::RefractiveIndex.range(), "ior", help, at, problems);
    }

    /// Checks absorption per channel, from 0 to `MOST_LIGHT`.
    pub(crate) fn absorption(value: Triple, at: &At<'_>, problems: &mut Problems) {
        let help = "exp(-absorption l) is left after a length l inside; 0 is perfectly clear";
        channels(value, "absorption", help, "too much", at, problems);
    }

    /// Checks light per channel, from 0 to `MOST_LIGHT`.
    pub(crate) fn intensity(value: Triple, what: &str, at: &At<'_>, problems: &mut Problems) {
        channels(value, what, "write 0 or more; 1 is full light", "too much light", at, problems);
    }

    fn channels(value: Triple, what: &str, help: &str, excess: &str, at: &At<'_>, problems: &mut Problems) {
        for (index, value) in value.into_iter().enumerate() {
            let at = at.index(index);
            if range(value, ValidRange::NotNegative, what, help, &at, problems) && value > MOST_LIGHT {
                let message = format!("{what} of {} is {excess}", Figure(value));
                problems.add(&at, message, "out of range", format!("write at most {MOST_LIGHT:e}"));
            }
        }
    }

    /// Checks colour channels in 0..=255. Warns of colours that are written from 0 to 1.
    pub(crate) fn color(value: Triple, at: &At<'_>, problems: &mut Problems) {
        if value != [0.0; 3] && value.iter().all(|channel| (0.0..=1.0).contains(channel)) {
            let [red, green, blue] = value.map(|channel| (255.0 * channel).round());
            let linear = Transfer::Srgb
                .encode(Rgb::from_array(value.map(to_f32)))
                .map(|byte| byte.to_string())
                .join(", ");
            let bytes = format!("({red}, {green}, {blue}), or ({linear}) for linear light as in POV-Ray");
            let help = format!("channels are from 0 to 255: write {bytes}");
            problems.warn(at, "a colour that is almost black", "no channel is above 1", help);
        }
        for (index, value) in value.into_iter().enumerate() {
            if !(0.0..=255.0).contains(&value) {
                let message = format!("a colour's channels are from 0 to 255, not {}", Figure(value));
                problems.add(
                    &at.index(index),
                    message,
                    "out of range",
                    "write three numbers as (255, 120, 60), or \"#ff783c\"",
                );
            }
        }
    }
}
