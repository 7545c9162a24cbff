//! Controls of an engine, whose values a page changes as it changes the values of a scene.

use std::collections::{BTreeMap, HashSet};

use hecs::{Entity, World};

use super::commands::SceneEdit;
use super::edits::{EditState, MAX_UNDO};
use super::outline::{PartInfo, PartSection};
use crate::color::{Rgb, Transfer, hex};
use crate::components::Control;
use crate::scene::{WrittenKind, WrittenValue};

/// The controls of an engine, with the history of their values.
#[derive(Debug, Default)]
pub(super) struct Controls {
    all: Vec<ControlEntity>,
    /// The values that the engine has now.
    values: Vec<ControlValue>,
    /// The values after each change, the first ones at the start.
    history: Vec<Vec<ControlValue>>,
    /// Index of the last change that is not taken back.
    last: usize,
}

/// A control, without its current value.
#[derive(Clone, Copy, Debug)]
struct ControlEntity {
    entity: Entity,
    name: &'static str,
    initial: ControlValue,
    range: (f64, f64),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum ControlValue {
    Number(f64),
    Switch(bool),
    Color(Rgb),
}

/// The error for a [`Control`] that cannot be shown.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
pub enum InvalidControl {
    /// The name is empty, or has a character that is used between names and values.
    #[error("the name of a control must not be empty, and must have no `=`, found `{0}`")]
    Name(&'static str),
    /// Another control has the same name.
    #[error("two controls are named `{0}`: give each its own name")]
    Duplicate(&'static str),
    /// The range is empty or infinite.
    #[error("the range of `{name}` must be finite, and its end above its start, found {range}")]
    Range {
        /// Name of the control.
        name: &'static str,
        /// The range, as `0 to 20`.
        range: String,
    },
    /// The value is not one that the page could give.
    #[error("`{name}` must be {expected}, found {found}")]
    Value {
        /// Name of the control.
        name: &'static str,
        /// The possible values, as `between 0 and 20`.
        expected: String,
        /// The value.
        found: String,
    },
    /// There is no such control.
    #[error("there is no control `{0}`")]
    Unknown(String),
}

debug_as_message!(InvalidControl);

impl Controls {
    /// Finds the controls of a world, in the order in which they were spawned.
    pub(super) fn of(world: &World) -> Result<Self, InvalidControl> {
        let mut all = found(world, ControlValue::Number);
        all.extend(found(world, ControlValue::Switch));
        all.extend(found(world, ControlValue::Color));
        all.sort_unstable_by_key(|control| control.entity.id());
        let mut names = HashSet::new();
        for control in &all {
            control.check()?;
            if !names.insert(control.name) {
                return Err(InvalidControl::Duplicate(control.name));
            }
        }
        let values: Vec<ControlValue> = all.iter().map(|control| control.initial).collect();
        Ok(Self { all, history: vec![values.clone()], values, last: 0 })
    }

    /// Changes values. Returns whether some differ afterwards, or the reason why the change is not possible.
    pub(super) fn edit(&mut self, edit: &SceneEdit) -> Result<bool, String> {
        let before = self.values.clone();
        match edit {
            SceneEdit::Try(values, keys) if keys.is_empty() => {
                self.attempt(values).map_err(|error| error.to_string())?;
            }
            SceneEdit::Keep if self.is_tried() => {
                self.history.truncate(self.last + 1);
                self.history.push(self.values.clone());
                if self.history.len() > MAX_UNDO + 1 {
                    self.history.remove(0);
                }
                self.last = self.history.len() - 1;
            }
            SceneEdit::Keep => {}
            SceneEdit::Drop => self.return_to(self.last),
            SceneEdit::Undo => self.return_to(self.last.saturating_sub(1)),
            SceneEdit::Redo => self.return_to((self.last + 1).min(self.history.len().saturating_sub(1))),
            SceneEdit::Try(..) | SceneEdit::TryKey(_) | SceneEdit::DropPaths(_) | SceneEdit::Look(_) => {
                return Err("this world is built by a program: it is changed there".to_owned());
            }
        }
        Ok(self.values != before)
    }

    /// Sets values, all or none.
    fn attempt(&mut self, texts: &[String]) -> Result<(), InvalidControl> {
        let mut values = self.values.clone();
        for text in texts {
            let (name, value) = text.split_once('=').unwrap_or((text, ""));
            let index = self.all.iter().position(|control| control.name == name);
            let index = index.ok_or_else(|| InvalidControl::Unknown(name.to_owned()))?;
            values[index] = self.all[index].parse(value)?;
        }
        self.values = values;
        Ok(())
    }

    fn return_to(&mut self, index: usize) {
        if let Some(values) = self.history.get(index) {
            self.values.clone_from(values);
            self.last = index;
        }
    }

    fn is_tried(&self) -> bool {
        self.history.get(self.last) != Some(&self.values)
    }

    /// Writes the values into the world at the start of the timeline.
    pub(super) fn apply(&self, world: &mut World) {
        for (control, value) in self.all.iter().zip(&self.values) {
            // A program cannot remove the entity of an engine that it has given away.
            let _ = match *value {
                ControlValue::Number(value) => set(world, control.entity, value),
                ControlValue::Switch(value) => set(world, control.entity, value),
                ControlValue::Color(value) => set(world, control.entity, value),
            };
        }
    }

    pub(super) fn state(&self) -> EditState {
        let tried = if self.is_tried() { self.changed(self.last) } else { BTreeMap::new() };
        EditState {
            tried: tried.keys().cloned().collect(),
            undoable: self.last,
            redoable: self.history.len().saturating_sub(self.last + 1),
            ..EditState::default()
        }
    }

    /// Returns the names of the values that differ from those after a change, with the latter.
    fn changed(&self, index: usize) -> BTreeMap<String, String> {
        let former = self.history.get(index).into_iter().flatten();
        let all = self.all.iter().zip(&self.values).zip(former);
        let changed = all.filter(|((_, value), former)| value != former);
        changed.map(|((control, _), former)| (control.name.to_owned(), former.text())).collect()
    }

    /// Describes the controls; `None` if there are none.
    pub(super) fn info(&self) -> Option<PartInfo> {
        let rows = self.all.iter().zip(&self.values).map(|(control, value)| control.row(*value));
        let values: Vec<WrittenValue> = rows.collect();
        let initial = self.all.iter().zip(&self.values).filter(|(control, value)| control.initial != **value);
        let initial = initial.map(|(control, _)| (control.name.to_owned(), control.initial.text())).collect();
        let title = "Controls".to_owned();
        let section = PartSection { title: title.clone(), values, animated: Vec::new(), initial };
        (!self.all.is_empty()).then(|| PartInfo { title, place: None, sections: vec![section], note: None })
    }
}

/// Finds the controls of a type.
fn found<T: Copy + Send + Sync + 'static>(
    world: &World,
    value: impl Fn(T) -> ControlValue,
) -> Vec<ControlEntity> {
    let mut query = world.query::<(Entity, &Control<T>)>();
    let control = |(entity, control): (Entity, &Control<T>)| {
        let Control { name, range, .. } = *control;
        ControlEntity { entity, name, initial: value(control.value), range }
    };
    query.iter().map(control).collect()
}

fn set<T: Copy + Send + Sync + 'static>(
    world: &World,
    entity: Entity,
    value: T,
) -> Result<(), hecs::ComponentError> {
    world.get::<&mut Control<T>>(entity).map(|mut control| control.value = value)
}

impl ControlEntity {
    fn check(&self) -> Result<(), InvalidControl> {
        let Self { name, range: (least, most), .. } = *self;
        if name.is_empty() || name.contains('=') {
            return Err(InvalidControl::Name(name));
        }
        if !(least.is_finite() && most.is_finite() && least < most) {
            return Err(InvalidControl::Range { name, range: format!("{least} to {most}") });
        }
        let is_valid = match self.initial {
            ControlValue::Number(number) => (least..=most).contains(&number),
            ControlValue::Switch(_) => true,
            ControlValue::Color(color) => color.is_finite() && color.cmpge(Rgb::ZERO).all(),
        };
        if is_valid { Ok(()) } else { Err(self.wrong(&self.initial.text())) }
    }

    /// Parses a value. The text of the initial one is that value, also of a colour between those of eight bits.
    fn parse(&self, text: &str) -> Result<ControlValue, InvalidControl> {
        if text == self.initial.text() {
            return Ok(self.initial);
        }
        let (least, most) = self.range;
        let value = match self.initial {
            ControlValue::Number(_) => {
                let number = text.parse().ok().filter(|number| (least..=most).contains(number));
                number.map(ControlValue::Number)
            }
            ControlValue::Switch(_) => text.parse().ok().map(ControlValue::Switch),
            ControlValue::Color(_) => hex(text.trim_matches('"')).ok().map(ControlValue::Color),
        };
        value.ok_or_else(|| self.wrong(text))
    }

    fn wrong(&self, found: &str) -> InvalidControl {
        let (least, most) = self.range;
        let expected = match self.initial {
            ControlValue::Number(_) => format!("between {least} and {most}"),
            ControlValue::Switch(_) => "true or false".to_owned(),
            ControlValue::Color(_) => "a colour such as \"#ff783c\", of finite numbers".to_owned(),
        };
        InvalidControl::Value { name: self.name, expected, found: found.to_owned() }
    }

    fn row(&self, value: ControlValue) -> WrittenValue {
        let (least, most) = self.range;
        let (kind, range) = match self.initial {
            ControlValue::Number(_) => (WrittenKind::Number, Some((least, most))),
            ControlValue::Switch(_) => (WrittenKind::Flag, None),
            ControlValue::Color(_) => (WrittenKind::Color, None),
        };
        WrittenValue {
            path: self.name.to_owned(),
            text: value.text(),
            kind,
            about: range.map_or_else(String::new, |(least, most)| format!("{least} to {most}")),
            least: range.map(|(least, _)| least),
            most: range.map(|(_, most)| most),
            is_default: false,
        }
    }
}

impl ControlValue {
    /// Returns the value as the page shows it; a number so that parsing returns its bits.
    fn text(self) -> String {
        match self {
            Self::Number(number) => number.to_string(),
            Self::Switch(value) => value.to_string(),
            Self::Color(color) => {
                let [red, green, blue] = Transfer::Srgb.encode(color);
                format!("\"#{red:02x}{green:02x}{blue:02x}\"")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRAVITY: Control = Control::number("gravity", 9.81, 0.0..=20.0);

    fn controls() -> Controls {
        let mut world = World::new();
        world.spawn((GRAVITY,));
        world.spawn((Control::switch("glass", false),));
        world.spawn((Control::color("sky", Rgb::splat(0.1234)),));
        Controls::of(&world).unwrap()
    }

    fn texts(controls: &Controls) -> Vec<String> {
        controls.values.iter().map(|value| value.text()).collect()
    }

    fn attempt(controls: &mut Controls, values: &[&str]) -> Result<bool, String> {
        controls.edit(&SceneEdit::Try(values.iter().map(|value| (*value).to_owned()).collect(), Vec::new()))
    }

    #[test]
    fn invalid_controls_report_the_valid_form() {
        let message = |controls: &[Control]| {
            let mut world = World::new();
            controls.iter().for_each(|control| _ = world.spawn((*control,)));
            Controls::of(&world).unwrap_err().to_string()
        };
        for (controls, expected) in [
            (&[GRAVITY, GRAVITY][..], "two controls are named `gravity`: give each its own name"),
            (
                &[Control::number("", 0.0, 0.0..=1.0)],
                "the name of a control must not be empty, and must have no `=`, found ``",
            ),
            (
                &[Control::number("a=b", 0.0, 0.0..=1.0)],
                "the name of a control must not be empty, and must have no `=`, found `a=b`",
            ),
            (
                &[Control::number("x", 1.0, 1.0..=1.0)],
                "the range of `x` must be finite, and its end above its start, found 1 to 1",
            ),
            (
                &[Control::number("x", 1.0, 0.0..=f64::INFINITY)],
                "the range of `x` must be finite, and its end above its start, found 0 to inf",
            ),
            (
                &[Control::number("x", 1.0, f64::NAN..=2.0)],
                "the range of `x` must be finite, and its end above its start, found NaN to 2",
            ),
            (&[Control::number("x", 3.0, 0.0..=2.0)], "`x` must be between 0 and 2, found 3"),
            (&[Control::number("x", f64::NAN, 0.0..=2.0)], "`x` must be between 0 and 2, found NaN"),
        ] {
            assert_eq!(message(controls), expected);
        }
        let mut world = World::new();
        world.spawn((GRAVITY,));
        world.spawn((Control::switch("gravity", true),));
        assert_eq!(Controls::of(&world).unwrap_err(), InvalidControl::Duplicate("gravity"));
        let mut world = World::new();
        world.spawn((Control::color("sky", Rgb::new(0.0, f32::NAN, 0.0)),));
        assert!(matches!(Controls::of(&world), Err(InvalidControl::Value { name: "sky", .. })));
    }

    #[test]
    fn refused_values_change_nothing() {
        let mut controls = controls();
        let before = texts(&controls);
        for (values, expected) in [
            (&["glass=true", "gravity=20.5"][..], "`gravity` must be between 0 and 20, found 20.5"),
            (&["gravity=NaN"], "`gravity` must be between 0 and 20, found NaN"),
            (&["gravity=-1e-9"], "`gravity` must be between 0 and 20, found -1e-9"),
            (&["glass=1"], "`glass` must be true or false, found 1"),
            (&["sky=red"], "`sky` must be a colour such as \"#ff783c\", of finite numbers, found red"),
            (&["mass=1"], "there is no control `mass`"),
            (&["gravity"], "`gravity` must be between 0 and 20, found "),
        ] {
            assert_eq!(attempt(&mut controls, values).unwrap_err(), expected);
            assert_eq!((texts(&controls), controls.is_tried()), (before.clone(), false));
        }
    }

    #[test]
    fn history_is_walked_both_ways_and_initial_values_return_exactly() {
        let mut controls = controls();
        let initial = controls.values.clone();
        attempt(&mut controls, &["gravity=3"]).unwrap();
        attempt(&mut controls, &["gravity=4"]).unwrap();
        assert_eq!(controls.state().tried, ["gravity"]);
        controls.edit(&SceneEdit::Keep).unwrap();
        controls.edit(&SceneEdit::Keep).unwrap();
        attempt(&mut controls, &["sky=\"#102030\"", "glass=true"]).unwrap();
        controls.edit(&SceneEdit::Drop).unwrap();
        assert_eq!(texts(&controls), ["4", "false", "\"#626262\""]);
        attempt(&mut controls, &["sky=\"#102030\"", "glass=true"]).unwrap();
        controls.edit(&SceneEdit::Keep).unwrap();
        let last = controls.values.clone();
        let counts = |controls: &Controls| (controls.state().undoable, controls.state().redoable);
        assert_eq!(counts(&controls), (2, 0));
        for expected in [(1, 1), (0, 2), (0, 2)] {
            controls.edit(&SceneEdit::Undo).unwrap();
            assert_eq!(counts(&controls), expected);
        }
        assert_eq!(controls.values, initial);
        for expected in [(1, 1), (2, 0), (2, 0)] {
            controls.edit(&SceneEdit::Redo).unwrap();
            assert_eq!(counts(&controls), expected);
        }
        assert_eq!(controls.values, last);
        // A change after another one that was taken back.
        controls.edit(&SceneEdit::Undo).unwrap();
        let shown = controls.info().unwrap().sections.remove(0).initial;
        assert_eq!(shown, BTreeMap::from([("gravity".to_owned(), "9.81".to_owned())]));
        attempt(&mut controls, &["gravity=9.81", "sky=\"#626262\"", "glass=true"]).unwrap();
        controls.edit(&SceneEdit::Keep).unwrap();
        assert_eq!(
            (counts(&controls), &controls.values[..1], controls.values[2]),
            ((2, 0), &initial[..1], initial[2])
        );
    }
}
