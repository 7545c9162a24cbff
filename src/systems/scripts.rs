//! Evaluates scripts at a moment, after all tracks.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};

use hecs::{Entity, World};

use super::Changes;
use super::interrupted::{Interrupted, ScriptFailure};
use super::property::{Stored, declare, sources};
use super::property_access::{Parts, PartsQuery, value};
use super::value_error::value_error;
use crate::animation::Value;
use crate::components::{self, Animated, Motion, Name, Order, Property, ScriptId};
use crate::script::{CompiledScripts, Data, NoResult, Read, ScriptContext, ScriptError, UnknownName, limits};
use crate::time::{Time, Timeline};

/// The scripts of a scene, and the values that they drive.
#[derive(Debug, Default)]
pub(crate) struct Scripts {
    running: Option<Box<Running>>,
}

#[derive(Debug)]
struct Running {
    scripts: CompiledScripts,
    timeline: Timeline,
    context: ScriptContext,
    /// The channels that scripts drive, in document order; `None` until looked up.
    driven: Option<Driven>,
    /// The values without the effect of scripts.
    bases: HashMap<(Entity, Property), Base>,
    /// The prefix of the entity names that the last script read.
    prefix: String,
}

/// A value without the effect of scripts.
#[derive(Clone, Copy, Debug)]
struct Base {
    value: Value,
    stored: Stored,
}

#[derive(Debug)]
struct Driven {
    channels: Vec<ScriptChannel>,
    indices: HashMap<(Entity, Property), usize>,
    /// The entities by name; `None` until a script reads one.
    names: Option<HashMap<String, Entity>>,
}

/// A value that a script drives.
#[derive(Clone, Debug)]
struct ScriptChannel {
    entity: Entity,
    property: Property,
    script: ScriptId,
    order: Option<Order>,
    name: String,
    /// True if a track of the material also drives the value. The base is then the value of the track. If the material has a script
    /// instead, that script is not run.
    on_track: bool,
}

/// The progress of a channel at a moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ChannelState {
    Waiting,
    /// The channel waits for another.
    Pending,
    Done,
}

impl Scripts {
    /// Creates the scripts of a scene.
    #[must_use]
    pub(crate) fn new(scripts: CompiledScripts, timeline: Timeline) -> Self {
        if scripts.uses.is_empty() {
            return Self::default();
        }
        let context = ScriptContext::new(timeline.rate.per_second(), timeline.duration);
        let (driven, bases, prefix) = (None, HashMap::new(), String::new());
        Self { running: Some(Box::new(Running { scripts, timeline, context, driven, bases, prefix })) }
    }
    /// Sets the frame rate and the duration.
    pub(crate) fn set_timeline(&mut self, timeline: Timeline) {
        if let Some(running) = &mut self.running {
            running.timeline = timeline;
            running.context = ScriptContext::new(timeline.rate.per_second(), timeline.duration);
        }
    }

    /// Discards the lookup of driven values, after entities were added or removed.
    pub(crate) fn discard_lookup(&mut self) {
        if let Some(running) = &mut self.running {
            running.driven = None;
        }
    }

    /// Restores all values that scripts drove; the world may then be edited.
    pub(crate) fn release(&mut self, world: &mut World) {
        let Some(running) = &mut self.running else { return };
        running.driven = None;
        #[expect(clippy::iter_over_hash_type, reason = "each value is stored on its own")]
        for ((entity, property), base) in running.bases.drain() {
            if let Ok(parts) = world.query_one_mut::<PartsQuery<'_>>(entity) {
                Parts::new(parts).put_back(property, base.stored);
            }
        }
    }

    /// Looks up the values that scripts drive, and their bases. Must be called before tracks write to the world.
    pub(crate) fn look_up(&mut self, world: &mut World) {
        if let Some(running) = &mut self.running
            && running.driven.is_none()
        {
            let driven = Driven::of(world);
            for channel in &driven.channels {
                // Tracks may drive the sources of the value, which must be restored too for the base to be the same again.
                let inputs = sources(world, channel.entity, channel.property, |_| false);
                for property in [channel.property].into_iter().chain(inputs) {
                    if let Some(base) = Base::of(world, channel.entity, property) {
                        running.bases.entry((channel.entity, property)).or_insert(base);
                    }
                }
            }
            running.driven = Some(driven);
        }
    }

    /// Sets every value that a script drives, and records the changes. Values that other scripts read are set first; otherwise values are
    /// set in document order.
    ///
    /// # Errors
    ///
    /// If a script fails, or if `cancelled` becomes true, which is checked before each of them. Then values may be left from
    /// another moment.
    pub(crate) fn run(
        &mut self,
        world: &mut World,
        time: Time,
        changes: &mut Changes,
        cancelled: &AtomicBool,
    ) -> Result<(), Interrupted> {
        let Some(running) = &mut self.running else { return Ok(()) };
        let Some(driven) = running.driven.take() else { return Ok(()) };
        running.context.set_time(time.seconds(), running.timeline.rate.frames_at(time));
        let (driven, result) = Evaluation {
            states: vec![ChannelState::Waiting; driven.channels.len()],
            wasted: HashMap::new(),
            seconds: time.seconds(),
            running,
            driven,
            world,
            changes,
            cancelled,
        }
        .run();
        running.driven = Some(driven);
        result
    }
}

impl Base {
    fn of(world: &World, entity: Entity, property: Property) -> Option<Self> {
        let value = value(world, entity, property)?;
        Some(Self { value, stored: Stored::of(world, entity, property)? })
    }
}

impl Driven {
    fn of(world: &mut World) -> Self {
        let mut channels = Vec::new();
        for (entity, animated, order, name) in
            world.query_mut::<(Entity, &Animated, Option<&Order>, Option<&Name>)>()
        {
            for (index, channel) in animated.0.iter().enumerate() {
                let Motion::Script(script) = channel.motion else { continue };
                let (before, after) = (&animated.0[..index], &animated.0[index + 1..]);
                let same = |other: &components::Channel| other.property == channel.property;
                let is_track =
                    |other: &components::Channel| same(other) && !matches!(other.motion, Motion::Script(_));
                // The motion of an entity overrides the motion of its material.
                if !after.iter().any(same) {
                    let name = name.map(|name| name.0.clone()).unwrap_or_default();
                    let (property, order, on_track) =
                        (channel.property, order.copied(), before.iter().any(is_track));
                    channels.push(ScriptChannel { entity, property, script, order, name, on_track });
                }
            }
        }
        channels.sort_by(|one, other| one.sort_key().cmp(&other.sort_key()));
        let indices = channels.iter().enumerate();
        let indices = indices.map(|(index, channel)| ((channel.entity, channel.property), index)).collect();
        Self { channels, indices, names: None }
    }

    fn named(&mut self, world: &World, name: &str) -> Option<Entity> {
        let names = self.names.get_or_insert_with(|| {
            let mut names = world.query::<(&Name, Entity)>();
            names.iter().map(|(name, entity)| (name.0.clone(), entity)).collect()
        });
        names.get(name).copied()
    }
}

/// The evaluation of all scripts at one moment.
struct Evaluation<'a> {
    running: &'a mut Running,
    driven: Driven,
    states: Vec<ChannelState>,
    /// The number of operations per channel in script runs that stopped at an unknown value.
    wasted: HashMap<usize, u64>,
    seconds: f64,
    world: &'a mut World,
    changes: &'a mut Changes,
    cancelled: &'a AtomicBool,
}

impl Evaluation<'_> {
    fn run(mut self) -> (Driven, Result<(), Interrupted>) {
        let result = (0..self.driven.channels.len()).try_for_each(|index| self.drive(index));
        (self.driven, result)
    }

    /// Sets a value, after the values that it depends on.
    fn drive(&mut self, index: usize) -> Result<(), Interrupted> {
        let mut stack = vec![index];
        while let Some(&index) = stack.last() {
            if self.cancelled.load(Ordering::Relaxed) {
                return Err(Interrupted::Cancelled);
            }
            if self.states[index] == ChannelState::Done {
                stack.pop();
                continue;
            }
            self.states[index] = ChannelState::Pending;
            let channel = self.driven.channels[index].clone();
            match self.evaluate(&channel) {
                Ok(value) => {
                    self.write(&channel, value);
                    self.states[index] = ChannelState::Done;
                }
                Err(NoResult::Error(error)) => return Err(self.failure(&channel, error).into()),
                Err(NoResult::Needs(read)) => {
                    let wasted = self.wasted.entry(index).or_default();
                    *wasted += self.running.context.operations();
                    if *wasted > limits::OPERATIONS_UNTIL_KNOWN {
                        let message = "this takes too long".to_owned();
                        let mistake =
                            self.mistake(&read, &stack, message, "read after very many others", None);
                        return Err(self.failure(&channel, mistake).into());
                    }
                    let next = self.resolve(&read, &stack).map_err(|error| self.failure(&channel, error))?;
                    stack.extend(next);
                }
            }
        }
        Ok(())
    }

    fn evaluate(&mut self, channel: &ScriptChannel) -> Result<Value, NoResult> {
        let Running { scripts, context, bases, prefix: last, .. } = &mut *self.running;
        let (notation, transfer) = (channel.property.notation(), scripts.transfer);
        let Some((script, prefix)) = scripts.used(channel.script.0) else {
            let error = ScriptError::new("", "there is no such script in the scene", "", None);
            return Err(NoResult::Error(Box::new(error)));
        };
        if last != prefix {
            // The same names refer to other entities.
            context.clear_values();
            prefix.clone_into(last);
        }
        let known = bases.get(&(channel.entity, channel.property)).filter(|_| !channel.on_track);
        let base =
            known.map(|base| base.value).or_else(|| value(self.world, channel.entity, channel.property));
        let base = base.map_or(Data::Nothing, |base| notation.data(base, transfer));
        // Scripts of a part use names without the prefix of the part.
        let name = channel.name.strip_prefix(prefix).unwrap_or(&channel.name);
        context.set_owner(channel.order.map_or(0, |order| order.0), name, base);
        let data = scripts.language.run(script, context)?;
        let value = notation.value(&data, transfer).ok_or_else(|| notation.mismatch(&data));
        let checked = |value| {
            value_error(channel.property, value)
                .map_or(Ok(value), |(message, help)| Err((message, Some(help))))
        };
        value.and_then(checked).map_err(|(message, help)| {
            let help = help.map(str::to_owned);
            NoResult::Error(Box::new(ScriptError::new(script.text(), message, "this is the value", help)))
        })
    }

    fn write(&mut self, channel: &ScriptChannel, value: Value) {
        let Ok(parts) = self.world.query_one_mut::<PartsQuery<'_>>(channel.entity) else { return };
        let mut parts = Parts::new(parts);
        if parts.set(channel.property, value) {
            declare(channel.property, channel.entity, parts.camera.is_some(), self.changes);
        }
    }

    /// Stores a value that a script reads, or returns the index of the channel that must be driven first.
    fn resolve(&mut self, read: &Read, stack: &[usize]) -> Result<Option<usize>, Box<ScriptError>> {
        let (_, prefix) = self.current_script(stack);
        let target = format!("{prefix}{}", read.target);
        let Some(entity) = self.driven.named(self.world, &target) else {
            let (_, prefix) = self.current_script(stack);
            let names = self.driven.names.iter().flat_map(HashMap::keys);
            let known = names.filter_map(|name| name.strip_prefix(prefix)).map(str::to_owned);
            let unknown = unknown(&read.target, "names", known.collect());
            if !prefix.is_empty() && ["camera", "scene"].contains(&read.target.as_str()) {
                let message = format!("a part has no \"{}\" to read from", read.target);
                let mistake = self.mistake(read, stack, message, "not available in included files", None);
                let help = "write such a script in the scene's own file".to_owned();
                return Err(Box::new(ScriptError { help: Some(help), ..*mistake }));
            }
            let message = format!("there is no entity \"{}\"", read.target);
            return Err(self.mistake(read, stack, message, "reads from it", Some(unknown)));
        };
        let Some(property) = Property::named(&read.channel) else {
            let known = Property::ALL.into_iter().map(|property| property.name().to_owned());
            let unknown = unknown(&read.channel, "channels", known.collect());
            let message = format!("there is no channel {}", read.channel);
            return Err(self.mistake(read, stack, message, "reads it", Some(unknown)));
        };
        let is_driven = |property| self.driven.indices.contains_key(&(entity, property));
        for property in sources(self.world, entity, property, is_driven) {
            let Some(&index) = self.driven.indices.get(&(entity, property)) else { continue };
            match self.states[index] {
                ChannelState::Waiting => return Ok(Some(index)),
                ChannelState::Pending => {
                    let message = self.ring(stack, index);
                    return Err(self.mistake(read, stack, message, "this closes the ring", None));
                }
                ChannelState::Done => {}
            }
        }
        let Some(value) = value(self.world, entity, property) else {
            let message = format!("\"{}\" has no {}", read.target, read.channel);
            return Err(self.mistake(read, stack, message, "reads it", None));
        };
        let data = property.notation().data(value, self.running.scripts.transfer);
        self.running.context.set_value(read, data);
        Ok(None)
    }

    /// Returns the text of the running script, and the prefix of the names that it reads.
    fn current_script(&self, stack: &[usize]) -> (&str, &str) {
        let script = stack.last().map(|index| self.driven.channels[*index].script);
        let used = script.and_then(|script| self.running.scripts.used(script.0));
        used.map_or(("", ""), |(script, prefix)| (script.text(), prefix))
    }

    fn mistake(
        &self,
        read: &Read,
        stack: &[usize],
        message: String,
        label: &str,
        unknown: Option<Box<UnknownName>>,
    ) -> Box<ScriptError> {
        let (text, _) = self.current_script(stack);
        let error = ScriptError::new(text, message, label, None);
        Box::new(ScriptError { span: read.span.clone(), unknown, ..error })
    }

    fn ring(&self, stack: &[usize], index: usize) -> String {
        let start = stack.iter().position(|pending| *pending == index).unwrap_or(0);
        let members = stack[start..].iter().chain([&index]);
        let names: Vec<String> = members.map(|index| self.driven.channels[*index].title()).collect();
        format!("a ring of scripts: {}", names.join(" reads "))
    }

    fn failure(&self, channel: &ScriptChannel, error: Box<ScriptError>) -> ScriptFailure {
        ScriptFailure { script: channel.script, channel: channel.title(), seconds: self.seconds, error }
    }
}

impl ScriptChannel {
    /// Returns the sort key for document order. Channels of cameras and settings have no order and come last, sorted by name.
    fn sort_key(&self) -> (bool, Option<Order>, &str) {
        (self.order.is_none(), self.order, &self.name)
    }

    fn title(&self) -> String {
        match (self.name.as_str(), self.order) {
            ("", Some(order)) => format!("{} of entity {}", self.property.name(), order.0),
            (name, _) => format!("{} of \"{name}\"", self.property.name()),
        }
    }
}

fn unknown(name: &str, kind: &'static str, mut known: Vec<String>) -> Box<UnknownName> {
    known.sort_unstable();
    Box::new(UnknownName { name: name.to_owned(), kind, known })
}
