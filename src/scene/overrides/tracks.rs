//! The keys of tracks and the shots that are written in a scene, and changes of them.

use std::collections::BTreeMap;
use std::fs;
use std::ops::Range;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::Override;
use super::set_value::value_at;
use super::write_back::scene_files;
use super::written::{WrittenKind, WrittenValue, kind, written};
use crate::animation::Notation;
use crate::color::Transfer;
use crate::components::Property;
use crate::scene::document::{AnimationDocument, EasingDocument, SceneDocument};
use crate::scene::playback::easing;
use crate::scene::quote::short;
use crate::scene::spans::{Bracket, BracketMember, bracket, first_item, is_one_value, literal_text, root};
use crate::scene::spawn::value_text;
use crate::scene::{ScenePart, SourcePosition};

/// Maximum number of keys that are listed, so that a page can show them. Tracks of programs have many more.
const MAX_KEYS: usize = 4000;
/// Minimum interval between keys in seconds: keys that are closer have the same time.
const SAME_TIME: f64 = 1e-6;
/// Number of steps of the listed curves of easings: ten for each arc of a bounce.
const EASING_STEPS: u32 = 40;

/// The keys of a track, or the shots, in the text of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WrittenTrack {
    /// The path of the list of keys, as an [`Override`] has it before its `=`. The time of key 3 is at `path.3.0`, its easing, if it is
    /// written, at `path.3.2`.
    pub path: String,
    /// The animated thing, such as `ball` or `material clay`; `shots` for the shots.
    pub target: String,
    /// The animated part; `None` for the shots and the scene as a whole.
    pub part: Option<ScenePart>,
    /// The animated property; empty for the shots.
    pub channel: String,
    /// The time of the timeline at which the keys' time is 0, in seconds.
    pub offset: f64,
    /// Seconds of the keys per second of the timeline.
    pub speed: f64,
    /// True if the keys repeat.
    pub repeats: bool,
    /// True if every second pass of keys that repeat runs backwards.
    pub alternates: bool,
    /// Position of the track, as `ball.ron:12`.
    pub place: String,
    /// The keys, ascending.
    pub keys: Vec<WrittenKey>,
}

/// A key of a track in the text of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WrittenKey {
    /// Seconds of the keys' time.
    pub time: f64,
    /// The text of the value.
    pub text: String,
    /// The value, if it is of a kind that can be listed.
    pub value: Option<WrittenValue>,
    /// The text of the easing; `None` for the default.
    pub easing: Option<String>,
}

/// The tracks of a scene that have keys.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct WrittenTracks {
    /// The shots, if there are any, then the tracks, in the order of the text.
    pub tracks: Vec<WrittenTrack>,
    /// Number of tracks that are left out because they have too many keys.
    pub unlisted: usize,
    /// Names of the cameras that a shot can have.
    pub cameras: Vec<String>,
    /// The [progress](crate::animation::Easing::progress) of each written easing at equal steps of the time, by the easing's text.
    pub easings: BTreeMap<String, Vec<f64>>,
}

/// A change of the keys of a track, which is identified by the path of the list of its keys. A key is identified by its time: its index may be
/// that of another one by the time of the change.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum KeyChange {
    /// Adds a key at a time of the keys, with the value that the track has then.
    Add(String, f64),
    /// Removes the key at a time.
    Remove(String, f64),
    /// Sets the easing of the key at a time.
    Ease(String, f64, String),
    /// Sets the value of the key at a time. A missing key is added.
    Set(String, f64, String),
}

/// A list of keys in the text of a scene.
struct KeyList<'a> {
    text: &'a str,
    span: Range<usize>,
    keys: Vec<KeySpans>,
}

/// The spans of a key's parts.
struct KeySpans {
    time: f64,
    whole: Range<usize>,
    value: Range<usize>,
    easing: Option<Range<usize>>,
}

impl WrittenTracks {
    /// Returns the tracks in the scene file. Those of a scene that extends another are left out, since their indices count those of both.
    #[must_use]
    pub fn of(files: &[PathBuf]) -> Self {
        let mut found = Self::default();
        let Some((file, text)) = scene_text(files) else { return found };
        let Some(scene) = scene(&text) else { return found };
        // Lines are counted once, from track to track.
        let (mut line, mut counted) = (1, 0);
        let mut place = |at: usize| {
            line += text[counted.min(at)..at].matches('\n').count();
            counted = at;
            format!("{}:{line}", file.display())
        };
        if let Some(cameras) = scene.field(&text, "cameras").and_then(|span| bracket(&text, span.start)) {
            found.cameras = cameras
                .members
                .iter()
                .filter_map(|camera| literal_text(&text[camera.name.clone()?]))
                .collect();
        }
        let shots = scene.field(&text, "shots").and_then(|span| KeyList::at(&text, span));
        let mut count = 0;
        if let Some(shots) = shots.filter(|shots| (1..=MAX_KEYS).contains(&shots.keys.len())) {
            let line = SourcePosition::of(&text, shots.span.start).line;
            let place = format!("{}:{line}", file.display());
            let shots = WrittenTrack {
                path: "shots".to_owned(),
                target: "shots".to_owned(),
                part: None,
                channel: String::new(),
                offset: 0.0,
                speed: 1.0,
                repeats: false,
                alternates: false,
                place,
                keys: shots.written("shots", None),
            };
            count = shots.keys.len();
            found.tracks.push(shots);
        }
        let animate = scene.field(&text, "animate").and_then(|span| bracket(&text, span.start));
        for (index, animation) in animate.iter().flat_map(|animate| &animate.members).enumerate() {
            let Some(fields) = bracket(&text, animation.value.start) else { continue };
            let Some(list) = KeyList::of_track(&text, &fields) else { continue };
            if count + list.keys.len() > MAX_KEYS {
                found.unlisted += 1;
                continue;
            }
            count += list.keys.len();
            let place = place(animation.value.start);
            found.tracks.extend(WrittenTrack::of(&text, (index, &fields), &list, place, &found.cameras));
        }
        let easings = found.tracks.iter().flat_map(|track| &track.keys).filter_map(|key| key.easing.as_ref());
        found.easings = easings.filter_map(|easing| Some((easing.clone(), progress(easing)?))).collect();
        found
    }
}

impl WrittenTrack {
    /// Returns the time of the key for the frame at a moment: of the key that is in this frame, or of a new one. Keys that repeat have no key
    /// for frames outside them.
    ///
    /// # Errors
    ///
    /// If the keys repeat, and the frame is before the first or after the last.
    #[cfg(feature = "live")]
    pub(crate) fn key_time(&self, seconds: f64, interval: f64) -> Result<f64, String> {
        let time = (seconds - self.offset) * self.speed;
        let distance = |key: &f64| (key - time).abs();
        let nearest = self.keys.iter().map(|key| key.time).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some(key) = nearest.filter(|key| distance(key) < 0.5 * interval * self.speed.abs()) {
            return Ok(key);
        }
        let is_between = self.keys.first().is_some_and(|first| first.time < time)
            && self.keys.last().is_some_and(|last| time < last.time);
        if self.repeats && !is_between {
            return Err(format!(
                "the keys of {} repeat: go to a frame between the first and the last of them",
                self.channel
            ));
        }
        Ok(time)
    }

    /// Returns an animation, given its fields and its keys; `None` if it is incomplete.
    fn of(
        text: &str,
        (index, fields): (usize, &Bracket),
        list: &KeyList<'_>,
        place: String,
        cameras: &[String],
    ) -> Option<Self> {
        let field = |name: &str| fields.field(text, name);
        let number =
            |name: &str, default| field(name).map_or(Some(default), |span| ron::from_str(&text[span]).ok());
        let name = |name: &str| literal_text(&text[field(name)?]);
        let channel = text[field("channel")?].to_owned();
        let path = format!("animate.{index}.track.0");
        let keys = list.written(&path, Property::named(&channel).map(Property::notation));
        let (target, part) = match name("target") {
            Some(name) if name == SceneDocument::SCENE => (name, None),
            Some(name) if name == SceneDocument::CAMERA || cameras.contains(&name) => {
                (name.clone(), Some(ScenePart::Camera(name)))
            }
            Some(name) => (name.clone(), Some(ScenePart::Entity(name))),
            None => {
                let name = name("material")?;
                (format!("material {name}"), Some(ScenePart::Material(name)))
            }
        };
        Some(Self {
            target,
            part,
            offset: number("offset", 0.0)?,
            speed: number("speed", 1.0)?,
            repeats: field("repeat").is_some_and(|span| &text[span] != "Clamp"),
            alternates: field("repeat").is_some_and(|span| &text[span] == "PingPong"),
            place,
            path,
            channel,
            keys,
        })
    }
}

impl KeyChange {
    /// Returns the override that has the effect of the change. The list of keys differs from that in the file, or in the override of it among
    /// `tried`, only where it must.
    ///
    /// # Errors
    ///
    /// If there is no such track or key, or the change would leave no key or two of the same time.
    pub fn to_override(
        &self,
        files: &[PathBuf],
        tried: &[Override],
        transfer: Transfer,
    ) -> Result<Override, String> {
        let path = match self {
            Self::Add(path, _) | Self::Remove(path, _) | Self::Ease(path, ..) | Self::Set(path, ..) => path,
        };
        let path = format!("{path}=0").parse::<Override>().map_err(|error| error.to_string())?.path;
        let missing = || "the file has no such key any more".to_owned();
        let (_, file) = scene_text(files).ok_or_else(missing)?;
        let (text, span) = match tried.iter().find(|tried| tried.path == path) {
            Some(tried) => (&tried.value, Some(0..tried.value.len())),
            None => (&file, value_at(&file, &path)),
        };
        let list = span.and_then(|span| KeyList::at(text, span)).ok_or_else(missing)?;
        let key = |time: f64| list.keys.iter().position(|key| key.is_at(time)).ok_or_else(missing);
        let value = match self {
            Self::Add(_, time) => list.with_key(*time, &list.value(&path, *time, transfer)?)?,
            Self::Remove(_, time) => list.without_key(key(*time)?)?,
            Self::Ease(_, time, easing) if is_one_value(easing) => list.with_easing(key(*time)?, easing),
            Self::Ease(.., easing) => return Err(format!("`{}` is no easing", short(easing))),
            Self::Set(_, time, value) if is_one_value(value) => match key(*time) {
                Ok(key) => list.replaced(list.keys[key].value.clone(), value),
                Err(_) => list.with_key(*time, value)?,
            },
            Self::Set(.., value) => return Err(format!("`{}` is no value", short(value))),
        };
        Ok(Override { path, value })
    }
}

impl KeySpans {
    fn is_at(&self, time: f64) -> bool {
        (self.time - time).abs() < SAME_TIME
    }
}

impl<'a> KeyList<'a> {
    /// Returns the list of keys at a span; `None` if it is not a list of keys.
    fn at(text: &'a str, span: Range<usize>) -> Option<Self> {
        let list = bracket(text, span.start).filter(|list| list.opening == b'[')?;
        let keys = list.members.into_iter().map(|BracketMember { value: whole, .. }| {
            let parts = bracket(text, whole.start)?.members;
            let part = |index: usize| parts.get(index).map(|part| part.value.clone());
            Some(KeySpans {
                time: ron::from_str(&text[part(0)?]).ok()?,
                value: part(1)?,
                easing: part(2),
                whole,
            })
        });
        Some(Self { text, span, keys: keys.collect::<Option<_>>()? })
    }

    /// Returns the list in the `track` of an animation.
    fn of_track(text: &'a str, animation: &Bracket) -> Option<Self> {
        let track = animation.field(text, "track").filter(|span| text[span.clone()].starts_with("Keys"))?;
        let list = bracket(text, track.start)?.members.first()?.value.clone();
        Self::at(text, list)
    }

    /// Returns the keys of a list at a path, whose values have a notation.
    fn written(&self, path: &str, notation: Option<Notation>) -> Vec<WrittenKey> {
        let text = self.text;
        let keys = self.keys.iter().enumerate().map(|(index, KeySpans { time, value, easing, .. })| {
            let kind = if notation == Some(Notation::Color) {
                Some(WrittenKind::Color)
            } else {
                kind(text, "", value)
            };
            let path = format!("{path}.{index}.1");
            let value_text = text[value.clone()].to_owned();
            WrittenKey {
                time: *time,
                value: kind.map(|kind| written(path, value_text.clone(), kind)),
                text: value_text,
                easing: easing.clone().map(|easing| text[easing].to_owned()),
            }
        });
        keys.collect()
    }

    /// Returns the text of the value at a time: for shots, the camera.
    fn value(&self, path: &[String], time: f64, transfer: Transfer) -> Result<String, String> {
        let unknown = || "the value at this time is not known: write the key in the file".to_owned();
        if path.len() == 1 {
            let shot = self.keys.iter().rev().find(|key| key.time <= time).or(self.keys.first());
            return shot.map(|shot| self.text[shot.value.clone()].to_owned()).ok_or_else(unknown);
        }
        let animation = value_at(self.text, &path[..2]).ok_or_else(unknown)?;
        let options =
            ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
        let animation: AnimationDocument = options.from_str(&self.text[animation]).map_err(|_| unknown())?;
        value_text(&animation, transfer, time).ok_or_else(unknown)
    }

    /// Returns the text of the list with one more key.
    fn with_key(&self, time: f64, value: &str) -> Result<String, String> {
        let next = self.keys.partition_point(|key| key.time < time);
        if self.keys.iter().any(|key| key.is_at(time)) {
            return Err("there is a key at this time already".to_owned());
        }
        let easing = next.checked_sub(1).and_then(|previous| self.keys[previous].easing.clone());
        let easing = easing.map_or_else(String::new, |easing| format!(", {}", &self.text[easing]));
        // Rounded down: a key shortly after its frame would not apply to it where values are held.
        let key = format!("({}, {value}{easing})", (1e6 * time + 1e-3).floor() / 1e6);
        let space = self.space();
        let (at, added) = match (self.keys.get(next), self.keys.last()) {
            (Some(next), _) => (next.whole.start, format!("{key},{space}")),
            (None, Some(last)) => (last.whole.end, format!(",{space}{key}")),
            (None, None) => (self.span.start + 1, key),
        };
        Ok(self.replaced(at..at, &added))
    }

    /// Returns the white space before the second key.
    fn space(&self) -> &'a str {
        let [first, second, ..] = self.keys.as_slice() else { return " " };
        let between = &self.text[first.whole.end..second.whole.start];
        &between[between.trim_end().len()..]
    }

    /// Returns the text of the list without a key. Comments stay.
    fn without_key(&self, key: usize) -> Result<String, String> {
        if self.keys.len() == 1 {
            return Err("this is the only key: remove the track in the file".to_owned());
        }
        let Range { start, end } = self.keys[key].whole;
        let between = |from: usize, to: usize| self.text[from..to].trim().trim_start_matches(',').is_empty();
        let span = match (
            self.keys.get(key + 1),
            key.checked_sub(1).map(|previous| self.keys[previous].whole.end),
        ) {
            (Some(next), _) if between(end, next.whole.start) => start..next.whole.start,
            (None, Some(previous)) if between(previous, start) => previous..end,
            _ => {
                let next = first_item(self.text, end);
                start..if self.text[next..].starts_with(',') { next + 1 } else { end }
            }
        };
        Ok(self.replaced(span, ""))
    }

    /// Returns the text of the list with another easing of a key.
    fn with_easing(&self, key: usize, easing: &str) -> String {
        let KeySpans { value, easing: written, .. } = &self.keys[key];
        match written {
            Some(written) => self.replaced(written.clone(), easing),
            None => self.replaced(value.end..value.end, &format!(", {easing}")),
        }
    }

    /// Returns the text of the list with a part replaced.
    fn replaced(&self, part: Range<usize>, by: &str) -> String {
        [&self.text[self.span.start..part.start], by, &self.text[part.end..self.span.end]].concat()
    }
}

/// Returns the progress of an easing at equal steps of the time; `None` if the text is no easing.
fn progress(text: &str) -> Option<Vec<f64>> {
    let easing = easing(ron::from_str::<EasingDocument>(text).ok()?);
    let step = |step: u32| easing.progress(f64::from(step) / f64::from(EASING_STEPS));
    Some((0..=EASING_STEPS).map(step).collect())
}

/// Returns the scene file with its text.
fn scene_text(files: &[PathBuf]) -> Option<(&PathBuf, String)> {
    let file = scene_files(files).next()?;
    Some((file, fs::read_to_string(file).ok()?))
}

/// Returns the fields of a scene that extends no other.
fn scene(text: &str) -> Option<Bracket> {
    bracket(text, root(text)).filter(|scene| scene.field(text, "extends").is_none())
}
