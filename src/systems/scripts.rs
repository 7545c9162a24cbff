//! Evaluates scripts at a moment, after all tracks.
//!
//! A script runs until it reads a value that is not known. The value is then computed, and the script runs again from its start. At the
//! world's own moment, values are read from the world, after the scripts that drive them. At another moment they are computed from the
//! motions of the entity and from the scripts that drive them, which run at that moment and write nothing; all other values are the same at
//! every moment. A script can therefore read its own channel at another moment, and only the limit on operations ends such a recursion.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};

use hecs::{Entity, World};

use super::Changes;
use super::interrupted::{Interrupted, ScriptFailure};
use super::property::{Stored, declare, sources};
use super::property_access::{Parts, PartsQuery, value, value_after};
use super::value_error::value_error;
use crate::animation::Value;
use crate::components::{self, Animated, Channel, Motion, Name, Order, Property, ScriptId};
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

/// A moment at which scripts run.
#[derive(Clone, Copy, Debug)]
struct Moment {
    seconds: f64,
    frame: f64,
}

/// A channel that is evaluated at a moment.
#[derive(Clone, Copy, Debug)]
struct PendingChannel {
    /// The index of the channel.
    channel: usize,
    moment: Moment,
    /// The index of the channel at the world's moment to which operations are charged.
    charged: usize,
}

/// The progress of a channel at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ChannelState {
    /// The channel waits for another.
    Pending,
    /// The channel has this value.
    Done(Value),
}

impl Scripts {
    /// Creates the scripts of a scene.
    #[must_use]
    pub(crate) fn new(scripts: CompiledScripts) -> Self {
        if scripts.uses.is_empty() {
            return Self::default();
        }
        let timeline = Timeline::still();
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
    /// set in document order. If there are stepped systems, values that neither a track nor a script drives are not known at other moments.
    ///
    /// # Errors
    ///
    /// If a script fails, or if `cancelled` becomes true, which is checked before each of them. Then values may be left from
    /// another moment.
    pub(crate) fn run(
        &mut self,
        world: &mut World,
        time: Time,
        has_steps: bool,
        changes: &mut Changes,
        cancelled: &AtomicBool,
    ) -> Result<(), Interrupted> {
        let Some(running) = &mut self.running else { return Ok(()) };
        let Some(driven) = running.driven.take() else { return Ok(()) };
        running.context.clear_values();
        let (driven, result) = Evaluation {
            now: Moment { seconds: time.seconds(), frame: running.timeline.rate.frames_at(time) },
            states: vec![None; driven.channels.len()],
            states_elsewhere: HashMap::new(),
            charges: HashMap::new(),
            reads_elsewhere: 0,
            has_steps,
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

/// The evaluation of all scripts at the world's moment.
struct Evaluation<'a> {
    running: &'a mut Running,
    driven: Driven,
    /// The world's moment.
    now: Moment,
    /// The states of the channels at the world's moment, by index. `None` if the evaluation has not begun.
    states: Vec<Option<ChannelState>>,
    /// The states at other moments, by index and by the bits of the moment's seconds.
    states_elsewhere: HashMap<(usize, u64), ChannelState>,
    /// The number of operations per channel in runs that stopped at an unknown value, and in runs at other moments.
    charges: HashMap<usize, u64>,
    /// The number of reads at other moments since their values were last discarded.
    reads_elsewhere: usize,
    has_steps: bool,
    world: &'a mut World,
    changes: &'a mut Changes,
    cancelled: &'a AtomicBool,
}

impl Moment {
    fn key(self) -> u64 {
        self.seconds.to_bits()
    }
}

impl Evaluation<'_> {
    fn run(mut self) -> (Driven, Result<(), Interrupted>) {
        let result = (0..self.driven.channels.len()).try_for_each(|index| self.drive(index));
        (self.driven, result)
    }

    /// Sets a value, after the values that it depends on.
    fn drive(&mut self, index: usize) -> Result<(), Interrupted> {
        let mut stack = vec![self.pending(index, self.now, index)];
        while let Some(&pending) = stack.last() {
            if self.cancelled.load(Ordering::Relaxed) {
                return Err(Interrupted::Cancelled);
            }
            if matches!(self.state(pending.channel, pending.moment), Some(ChannelState::Done(_))) {
                stack.pop();
                continue;
            }
            self.set_state(pending, ChannelState::Pending);
            let channel = self.driven.channels[pending.channel].clone();
            let result = self.evaluate(&channel, pending.moment);
            let is_now = self.is_now(pending.moment);
            if !is_now || result.is_err() {
                *self.charges.entry(pending.charged).or_default() += self.running.context.operations();
            }
            match result {
                Ok(value) => {
                    if is_now {
                        self.write(&channel, value);
                    }
                    self.set_state(pending, ChannelState::Done(value));
                }
                Err(NoResult::Error(error)) => return Err(failure(&channel, pending.moment, error).into()),
                Err(NoResult::Needs(read)) => {
                    let next = self.resolve(&read, &stack);
                    stack.extend(next.map_err(|error| failure(&channel, pending.moment, error))?);
                }
            }
        }
        self.discard_other_moments();
        Ok(())
    }

    /// Returns a channel to be evaluated, charged to `reader` unless it is at the world's moment.
    fn pending(&self, channel: usize, moment: Moment, reader: usize) -> PendingChannel {
        PendingChannel { channel, moment, charged: if self.is_now(moment) { channel } else { reader } }
    }

    fn state(&self, channel: usize, moment: Moment) -> Option<ChannelState> {
        match self.is_now(moment) {
            true => self.states[channel],
            false => self.states_elsewhere.get(&(channel, moment.key())).copied(),
        }
    }

    fn set_state(&mut self, PendingChannel { channel, moment, .. }: PendingChannel, state: ChannelState) {
        if self.is_now(moment) {
            self.states[channel] = Some(state);
        } else {
            self.states_elsewhere.insert((channel, moment.key()), state);
        }
    }

    fn is_now(&self, moment: Moment) -> bool {
        moment.key() == self.now.key()
    }

    /// Discards the known values at other moments if there are many. Other channels that read them compute them again.
    fn discard_other_moments(&mut self) {
        if self.reads_elsewhere > limits::KNOWN_ELSEWHERE {
            self.reads_elsewhere = 0;
            self.running.context.clear_values();
            self.states_elsewhere.clear();
        }
    }

    fn evaluate(&mut self, channel: &ScriptChannel, moment: Moment) -> Result<Value, NoResult> {
        let base = self.base(channel, moment);
        let Running { scripts, context, prefix: last, .. } = &mut *self.running;
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
        let base = base.map_or(Data::Nothing, |base| notation.data(base, transfer));
        // Scripts of a part use names without the prefix of the part.
        let name = channel.name.strip_prefix(prefix).unwrap_or(&channel.name);
        context.set_owner(channel.order.map_or(0, |order| order.0), name, base);
        context.set_time(moment.seconds, moment.frame);
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

    /// Returns the value of a channel without its script.
    fn base(&self, channel: &ScriptChannel, moment: Moment) -> Option<Value> {
        let ScriptChannel { entity, property, on_track, .. } = *channel;
        let known = self.running.bases.get(&(entity, property)).filter(|_| !on_track);
        known.map(|base| base.value).or_else(|| self.value_at(entity, property, [], moment))
    }

    /// Returns a value of an entity at a moment, after the motions of its sources. The scripts of the sources must be done.
    fn value_at<const COUNT: usize>(
        &self,
        entity: Entity,
        property: Property,
        scripted: [Property; COUNT],
        moment: Moment,
    ) -> Option<Value> {
        if self.is_now(moment) {
            return value(self.world, entity, property);
        }
        let animated = self.world.get::<&Animated>(entity).ok();
        value_after(self.world, entity, property, |parts| {
            for Channel { property, motion, .. } in animated.iter().flat_map(|animated| &animated.0) {
                if let Some(value) = motion.at(moment.seconds) {
                    parts.set(*property, value);
                }
            }
            for property in scripted {
                let index = self.driven.indices.get(&(entity, property));
                let state = index.and_then(|index| self.state(*index, moment));
                if let Some(ChannelState::Done(value)) = state {
                    parts.set(property, value);
                }
            }
        })
    }

    fn write(&mut self, channel: &ScriptChannel, value: Value) {
        let Ok(parts) = self.world.query_one_mut::<PartsQuery<'_>>(channel.entity) else { return };
        let mut parts = Parts::new(parts);
        if parts.set(channel.property, value) {
            declare(channel.property, channel.entity, parts.camera.is_some(), self.changes);
        }
    }

    /// Stores a value that a script reads, or returns the channel that must be evaluated first.
    fn resolve(
        &mut self,
        read: &Read,
        stack: &[PendingChannel],
    ) -> Result<Option<PendingChannel>, Box<ScriptError>> {
        let Some(&reader) = stack.last() else { return Ok(None) };
        let moment = self.moment_of(read, reader);
        self.charge(read, moment, stack)?;
        let (entity, property) = self.owner_and_property(read, stack)?;
        let is_driven = |property| self.driven.indices.contains_key(&(entity, property));
        let sources = sources(self.world, entity, property, is_driven);
        for property in sources {
            let Some(&index) = self.driven.indices.get(&(entity, property)) else { continue };
            match self.state(index, moment) {
                None => return Ok(Some(self.pending(index, moment, reader.charged))),
                Some(ChannelState::Pending) => {
                    let message = self.ring(stack, self.pending(index, moment, index));
                    return Err(self.mistake(read, stack, message, "this closes the ring"));
                }
                Some(ChannelState::Done(_)) => {}
            }
        }
        if self.has_steps && !self.is_now(moment) && !self.is_animated(entity, sources) {
            let message = format!("{} of \"{}\" is not known at other moments", read.channel, read.target);
            let mistake = self.mistake(read, stack, message, "at another moment than the frame's");
            let help = "stepped systems may change it, since neither a track nor a script drives it: read it without a moment";
            return Err(Box::new(ScriptError { help: Some(help.to_owned()), ..*mistake }));
        }
        let Some(value) = self.value_at(entity, property, sources, moment) else {
            let message = format!("\"{}\" has no {}", read.target, read.channel);
            return Err(self.mistake(read, stack, message, "reads it"));
        };
        let data = property.notation().data(value, self.running.scripts.transfer);
        self.running.context.set_value(read, data);
        Ok(None)
    }

    /// Returns the moment of a read. The reader's own moment stays as it is.
    fn moment_of(&self, read: &Read, reader: PendingChannel) -> Moment {
        let given = [reader.moment, self.now].into_iter().find(|own| own.key() == read.seconds.to_bits());
        given.unwrap_or_else(|| {
            let (seconds, frame) = self.running.timeline.rate.moment_at(read.seconds);
            Moment { seconds, frame }
        })
    }

    /// Charges a read at another moment, and returns an error if the scripts of a channel take too long.
    fn charge(
        &mut self,
        read: &Read,
        moment: Moment,
        stack: &[PendingChannel],
    ) -> Result<(), Box<ScriptError>> {
        let is_elsewhere = !self.is_now(moment);
        let charged = stack.last().map_or(0, |reader| reader.charged);
        let operations = self.charges.entry(charged).or_default();
        if is_elsewhere {
            self.reads_elsewhere += 1;
            *operations += limits::READ_ELSEWHERE;
        }
        if *operations <= limits::OPERATIONS_UNTIL_KNOWN {
            return Ok(());
        }
        let mistake =
            self.mistake(read, stack, "this takes too long".to_owned(), "read after very many others");
        let help = is_elsewhere.then(|| {
            "does a script read its own value at other moments without end? End it: `if t <= 0 { base } else { .. }`"
                .to_owned()
        });
        Err(Box::new(ScriptError { help, ..*mistake }))
    }

    /// Returns whether a track or a script drives each of these values.
    fn is_animated(&self, entity: Entity, sources: [Property; 2]) -> bool {
        let animated = self.world.get::<&Animated>(entity);
        sources.into_iter().all(|source| {
            let of_source = |channel: &Channel| channel.property == source;
            animated.as_ref().is_ok_and(|animated| animated.0.iter().any(of_source))
        })
    }

    /// Returns the entity and the property that a script reads.
    fn owner_and_property(
        &mut self,
        read: &Read,
        stack: &[PendingChannel],
    ) -> Result<(Entity, Property), Box<ScriptError>> {
        let (_, prefix) = self.current_script(stack);
        let target = format!("{prefix}{}", read.target);
        let Some(entity) = self.driven.named(self.world, &target) else {
            let (_, prefix) = self.current_script(stack);
            let names = self.driven.names.iter().flat_map(HashMap::keys);
            let known = names.filter_map(|name| name.strip_prefix(prefix)).map(str::to_owned);
            let unknown = unknown(&read.target, "names", known.collect());
            if !prefix.is_empty() && ["camera", "scene"].contains(&read.target.as_str()) {
                let message = format!("a part has no \"{}\" to read from", read.target);
                let mistake = self.mistake(read, stack, message, "not available in included files");
                let help = "write such a script in the scene's own file".to_owned();
                return Err(Box::new(ScriptError { help: Some(help), ..*mistake }));
            }
            let message = format!("there is no entity \"{}\"", read.target);
            let mistake = self.mistake(read, stack, message, "reads from it");
            return Err(Box::new(ScriptError { unknown: Some(unknown), ..*mistake }));
        };
        let Some(property) = Property::named(&read.channel) else {
            let known = Property::ALL.into_iter().map(|property| property.name().to_owned());
            let unknown = unknown(&read.channel, "channels", known.collect());
            let message = format!("there is no channel {}", read.channel);
            let mistake = self.mistake(read, stack, message, "reads it");
            return Err(Box::new(ScriptError { unknown: Some(unknown), ..*mistake }));
        };
        Ok((entity, property))
    }

    /// Returns the text of the running script, and the prefix of the names that it reads.
    fn current_script(&self, stack: &[PendingChannel]) -> (&str, &str) {
        let script = stack.last().map(|pending| self.driven.channels[pending.channel].script);
        let used = script.and_then(|script| self.running.scripts.used(script.0));
        used.map_or(("", ""), |(script, prefix)| (script.text(), prefix))
    }

    fn mistake(
        &self,
        read: &Read,
        stack: &[PendingChannel],
        message: String,
        label: &str,
    ) -> Box<ScriptError> {
        let (text, _) = self.current_script(stack);
        let error = ScriptError::new(text, message, label, None);
        Box::new(ScriptError { span: read.span.clone(), ..error })
    }

    fn ring(&self, stack: &[PendingChannel], end: PendingChannel) -> String {
        let is_end = |pending: &PendingChannel| {
            (pending.channel, pending.moment.key()) == (end.channel, end.moment.key())
        };
        let start = stack.iter().position(is_end).unwrap_or(0);
        let title = |pending: &PendingChannel| {
            let title = self.driven.channels[pending.channel].title();
            if self.is_now(pending.moment) {
                title
            } else {
                format!("{title} at t = {}", pending.moment.seconds)
            }
        };
        let names: Vec<String> = stack[start..].iter().chain([&end]).map(title).collect();
        format!("a ring of scripts: {}", names.join(" reads "))
    }
}

fn failure(channel: &ScriptChannel, moment: Moment, error: Box<ScriptError>) -> ScriptFailure {
    ScriptFailure { script: channel.script, channel: channel.title(), seconds: moment.seconds, error }
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
