//! The parts of a scene that have a name in its text: settings, cameras, materials and entities.

use super::document::SceneDocument;
use super::files::Origin;
use super::overrides::ScenePart;
use super::source_text::{SourceLine, SourceText};
use super::sources::Sources;
use super::spans::{BracketMember, bracket, literal_text, own_name, root};

/// Fields of a scene that are not settings: they have parts of their own, or apply before values are set.
const OTHERS: [&str; 13] = [
    "include",
    "camera",
    "cameras",
    "shots",
    "space",
    "materials",
    "entities",
    "clouds",
    "overlay",
    "spawn",
    "animate",
    "extends",
    "without",
];
/// Settings that every scene has, whether or not they are written.
const ALWAYS: [&str; 5] = ["film", "sampling", "quality", "ambient", "background"];

/// A channel that a track or a script sets over time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct AnimatedChannel {
    pub(crate) name: String,
    /// The path that the list of the track's keys has if there is one, as [`WrittenTrack::path`](super::WrittenTrack::path).
    pub(crate) track: String,
    pub(crate) is_script: bool,
    /// Position of the track, or of the script's file.
    pub(crate) place: String,
}

/// A part of a scene whose text differs from an earlier one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum ChangedPart {
    /// A part with a name in the text.
    Named(ScenePart),
    /// An entity, by its index in document order.
    Entity(usize),
}

impl Sources {
    /// Returns the parts of the scene's text other than entities: cameras, settings, then materials, each in the order of the text.
    #[must_use]
    pub fn parts(&self) -> Vec<ScenePart> {
        let Some(text) = self.file(0).map(|source| source.text().as_str()) else { return Vec::new() };
        let members = members(text, root(text));
        let names = |list: &str| {
            let field = members.iter().find(|member| is_named(text, member, list));
            let entries = field.map_or_else(Vec::new, |field| self::members(text, field.value.start));
            entries.into_iter().filter_map(|entry| literal_text(&text[entry.name?])).collect::<Vec<_>>()
        };
        let written: Vec<&str> =
            members.iter().filter_map(|member| Some(&text[member.name.clone()?])).collect();
        let single = written.contains(&"camera").then(|| "camera".to_owned());
        let cameras = single.into_iter().chain(names("cameras")).map(ScenePart::Camera);
        let settings = written.iter().filter(|name| !OTHERS.contains(name));
        let omitted = ALWAYS.iter().filter(|name| !written.contains(name));
        let settings = settings.chain(omitted).map(|name| ScenePart::Setting((*name).to_owned()));
        cameras.chain(settings).chain(names("materials").into_iter().map(ScenePart::Material)).collect()
    }

    /// Returns whether the scene extends another.
    #[must_use]
    pub fn is_extension(&self) -> bool {
        self.file(0).is_some_and(SourceText::is_composed)
    }

    /// Returns the path of a part in the scene's text, as an [`Override`](super::Override) has it, and the line on which it starts. `None`
    /// for an entity, and for a part that is not written.
    pub(crate) fn written_part(&self, part: &ScenePart) -> Option<(Vec<String>, SourceLine<'_>)> {
        let source = self.file(0)?;
        let path = |steps: &[&str]| steps.iter().map(|step| (*step).to_owned()).collect::<Vec<_>>();
        let is_single = || {
            members(source.text(), root(source.text()))
                .iter()
                .any(|member| is_named(source.text(), member, "camera"))
        };
        let path = match part {
            ScenePart::Setting(name) => path(&[name]),
            ScenePart::Camera(name) if name == SceneDocument::CAMERA && is_single() => path(&[name]),
            ScenePart::Camera(name) => path(&["cameras", name]),
            ScenePart::Material(name) => path(&["materials", name]),
            ScenePart::Entity(_) => return None,
        };
        let mut at = root(source.text());
        let mut span = at..at;
        for step in &path {
            let name = |member: &BracketMember| {
                let written = &source.text()[member.name.clone()?];
                Some(literal_text(written).unwrap_or_else(|| written.to_owned()))
            };
            let found =
                members(source.text(), at).into_iter().find(|member| name(member).as_ref() == Some(step))?;
            (at, span) = (found.value.start, found.value);
        }
        Some((path, source.line(&span)))
    }

    /// Returns the path of an entity in the scene file, as an [`Override`](super::Override) has it: its list, and its name or its index there.
    /// `None` for an entity of another file, or of a script.
    pub(crate) fn entity_path(&self, order: usize) -> Option<Vec<String>> {
        let Origin { file, list, index } = self.origin(order);
        let source = self.file(0).filter(|_| file == 0)?;
        let text = source.text();
        let list_span =
            members(text, root(text)).into_iter().find(|member| is_named(text, member, list))?.value;
        let own = members(text, list_span.start).into_iter().nth(index)?.value;
        if source.line(&own).file != source.name() {
            return None;
        }
        let name = (list != "include").then(|| own_name(text, &own)).flatten();
        Some(vec![list.to_owned(), name.unwrap_or_else(|| index.to_string())])
    }

    /// Returns whether an entity is none of the lists of the scene's own text, but made by its scripts.
    pub(crate) fn is_spawned(&self, order: usize) -> bool {
        let Origin { file, list, index } = self.origin(order);
        let count = self.file(0).map_or(0, |source| {
            let list = members(source.text(), root(source.text()))
                .into_iter()
                .find(|member| is_named(source.text(), member, list));
            list.map_or(0, |list| members(source.text(), list.value.start).len())
        });
        file == 0 && index >= count
    }

    /// Returns the channels of a target, or of a material, that are animated by the scene's own text.
    pub(crate) fn animated_channels(&self, field: &str, target: &str) -> Vec<AnimatedChannel> {
        let Some(source) = self.file(0) else { return Vec::new() };
        let text = source.text();
        let animate = members(text, root(text)).into_iter().find(|member| is_named(text, member, "animate"));
        let all = animate.map_or_else(Vec::new, |animate| members(text, animate.value.start));
        let channel = |(index, animation): (usize, BracketMember)| {
            let fields = bracket(text, animation.value.start)?;
            let of = literal_text(&text[fields.field(text, field)?])?;
            if of != target {
                return None;
            }
            let track = fields.field(text, "track")?;
            let script = text[track.clone()].trim_start().starts_with("Script");
            let file = bracket(text, track.start)
                .filter(|_| text[track.clone()].trim_start().starts_with("ScriptFile"))
                .and_then(|script| literal_text(&text[script.members.first()?.value.clone()]));
            let place = match file {
                Some(file) => format!("{}:1", source.files().first()?.folder.join(file).display()),
                None => source.line(&track).to_string(),
            };
            let name = text[fields.field(text, "channel")?].to_owned();
            Some(AnimatedChannel {
                name,
                track: format!("animate.{index}.track.0"),
                is_script: script,
                place,
            })
        };
        all.into_iter().enumerate().filter_map(channel).collect()
    }

    /// Returns the part in which the first difference from an earlier text is; for an animation, the animated part.
    pub(crate) fn changed_since(&self, before: &Self) -> Option<ChangedPart> {
        let both = (0..).map_while(|file| Some((file, self.file(file)?, before.file(file)?)));
        let (file, source, old) =
            both.into_iter().find(|(_, new, old)| new.name() == old.name() && new.text() != old.text())?;
        let (text, old) = (source.text(), old.text());
        let at = text.bytes().zip(old.bytes()).take_while(|(new, old)| new == old).count();
        let holds = |member: &BracketMember| member.start() <= at && at <= member.value.end;
        let field = members(text, root(text)).into_iter().find(holds)?;
        let list = &text[field.name?];
        let entries = members(text, field.value.start);
        let index = entries.iter().position(holds);
        let name = || literal_text(&text[entries[index?].name.clone()?]);
        let named = |part: fn(String) -> ScenePart, name: String| Some(ChangedPart::Named(part(name)));
        match list {
            "entities" | "clouds" | "include" => self.order_of(file, list, index?).map(ChangedPart::Entity),
            _ if file > 0 => None,
            "camera" => named(ScenePart::Camera, SceneDocument::CAMERA.to_owned()),
            "cameras" => named(ScenePart::Camera, name()?),
            "materials" => named(ScenePart::Material, name()?),
            "animate" => {
                let fields = bracket(text, entries[index?].value.start)?;
                let of = |field: &str| literal_text(&text[fields.field(text, field)?]);
                match (of("material"), of("target")) {
                    (Some(material), _) => named(ScenePart::Material, material),
                    (None, Some(target)) if self.parts().contains(&ScenePart::Camera(target.clone())) => {
                        named(ScenePart::Camera, target)
                    }
                    (None, Some(target)) if target != SceneDocument::SCENE => {
                        named(ScenePart::Entity, target)
                    }
                    _ => None,
                }
            }
            _ if OTHERS.contains(&list) => None,
            _ => named(ScenePart::Setting, list.to_owned()),
        }
    }
}

/// Returns the members of the bracket of the value that starts at a byte; none for a value without one.
fn members(text: &str, start: usize) -> Vec<BracketMember> {
    bracket(text, start).map_or_else(Vec::new, |found| found.members)
}

fn is_named(text: &str, member: &BracketMember, name: &str) -> bool {
    member.name.as_ref().is_some_and(|span| &text[span.clone()] == name)
}
