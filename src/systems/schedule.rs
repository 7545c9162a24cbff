//! Schedules custom systems.

use std::sync::atomic::{AtomicBool, Ordering};

use hecs::World;

use super::clouds::update_clouds;
use super::order::order_newcomers;
use super::{Changes, Context, Interrupted, Registry, Scripts, WorldSnapshot, animate, propagate};
use crate::time::{Time, Timeline};

type System = Box<dyn Fn(&mut Context<'_>) + Send>;

/// The exact length of a stepped system's step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step(Time);

impl Step {
    /// Returns a step of `1 / rate` seconds. A rate of 0 counts as 1.
    #[must_use]
    pub fn per_second(rate: u32) -> Self {
        Self(Time::from_ratio(1, u64::from(rate.max(1))).unwrap_or(Time::ZERO))
    }

    /// Returns a step of `numerator / denominator` seconds. `None` unless both are in 1..2^32.
    #[must_use]
    pub fn of_seconds(numerator: u32, denominator: u32) -> Option<Self> {
        (numerator > 0).then_some(())?;
        Time::from_ratio(u64::from(numerator), u64::from(denominator)).map(Self)
    }
}

struct SteppedSystem {
    step: Step,
    system: System,
    /// The number of completed steps.
    done: u64,
}

/// Pure and stepped systems, and the copies of the world that allow them to restart.
///
/// A *pure* system is a function of the moment: its writes are undone before every frame. A *stepped* system carries state from step to
/// step. The state at `t` is the state after `floor(t / step)` steps, each of which sees the tracks at its own start. Going back in time
/// restarts from the beginning, so that a frame does not depend on previously rendered frames.
///
/// If there are systems of both kinds, steps run in a separate world, and pure systems run on a fresh copy of it for every frame. World
/// transforms are up to date whenever a system runs.
#[derive(Default)]
pub(crate) struct Schedule {
    pure: Vec<System>,
    stepped: Vec<SteppedSystem>,
    registry: Registry,
    /// The world before any system ran.
    start: Option<WorldSnapshot>,
    /// The separate world in which steps run if there are pure systems.
    base: World,
    /// A copy of `base` after its last step.
    state: Option<WorldSnapshot>,
    /// The writes of tracks and pure systems to the copy of `state` for the last frame.
    written: Changes,
    scripts: Scripts,
}

impl Schedule {
    /// Returns whether there are no systems.
    #[must_use]
    pub(crate) fn is_empty(&self) -> bool {
        self.pure.is_empty() && self.stepped.is_empty()
    }

    /// Adds a pure system.
    pub(crate) fn add(&mut self, system: impl Fn(&mut Context<'_>) + Send + 'static) {
        self.pure.push(Box::new(system));
    }

    /// Adds a stepped system.
    pub(crate) fn add_stepped(&mut self, step: Step, system: impl Fn(&mut Context<'_>) + Send + 'static) {
        self.stepped.push(SteppedSystem { step, system: Box::new(system), done: 0 });
    }

    /// Sets the scripts of the scene, which run after tracks.
    pub(crate) fn set_scripts(&mut self, scripts: Scripts) {
        self.scripts = scripts;
    }

    /// Sets the frame rate and the duration that scripts read.
    pub(crate) fn set_timeline(&mut self, timeline: Timeline) {
        self.scripts.set_timeline(timeline);
    }

    /// Returns the registry of the component types that snapshots copy.
    pub(crate) fn registry_mut(&mut self) -> &mut Registry {
        &mut self.registry
    }

    /// Restores the world before any system ran, and discards the copies: the world may then be edited.
    pub(crate) fn rewind(&mut self, world: &mut World) {
        if let Some(start) = self.start.take() {
            start.restore(world);
        }
        self.scripts.release(world);
        self.base = World::new();
        self.state = None;
        self.written = Changes::default();
        for stepped in &mut self.stepped {
            stepped.done = 0;
        }
    }

    /// Advances the world to a moment: runs steps, tracks, scripts and pure systems.
    ///
    /// # Errors
    ///
    /// If systems need copies of the world and it holds a component that cannot be copied, if a script fails, or if `cancelled` becomes
    /// true before a step or a script.
    pub(crate) fn advance(
        &mut self,
        world: &mut World,
        time: Time,
        changes: &mut Changes,
        cancelled: &AtomicBool,
    ) -> Result<(), Interrupted> {
        if changes.is_all() {
            self.scripts.discard_lookup();
        }
        if self.pure.is_empty() && self.stepped.is_empty() {
            return animate_all(&mut self.scripts, world, time, false, changes, cancelled);
        }
        if self.start.is_none() {
            order_newcomers(world, &[]);
            propagate(world, &Changes::all());
            let start = WorldSnapshot::take(world, &self.registry)?;
            // Restoring resets the allocation of ids, which then proceeds as after every later restart.
            start.restore(world);
            start.restore(&mut self.base);
            self.start = Some(start);
            changes.mark_all();
        }
        if self.pure.is_empty() {
            self.run_steps(world, time, changes, cancelled)?;
            let result = animate_all(&mut self.scripts, world, time, true, changes, cancelled);
            if result.is_err() {
                // Propagates now, since the next step propagates only later writes.
                propagate(world, changes);
            }
            return result;
        }
        let mut base = std::mem::take(&mut self.base);
        let stepped = self.run_steps(&mut base, time, changes, cancelled);
        self.base = base;
        stepped?;
        let state = match self.state.take() {
            Some(state) => state,
            None => WorldSnapshot::take(&self.base, &self.registry)?,
        };
        state.restore(world);
        self.state = Some(state);
        // The writes of the last frame are undone.
        changes.merge(&std::mem::take(&mut self.written));
        let result = self.run_pure(world, time, cancelled);
        changes.merge(&self.written);
        result
    }

    /// Runs all steps that end by `time`, in the order of their ends. Steps with the same end run in the order in which their systems were
    /// added. The steps up to an earlier time are therefore a prefix of the steps up to a later time.
    fn run_steps(
        &mut self,
        world: &mut World,
        time: Time,
        changes: &mut Changes,
        cancelled: &AtomicBool,
    ) -> Result<(), Interrupted> {
        if self.stepped.iter().any(|stepped| stepped.done > time.whole_steps(stepped.step.0)) {
            if let Some(start) = &self.start {
                start.restore(world);
            }
            for stepped in &mut self.stepped {
                stepped.done = 0;
            }
            self.state = None;
            changes.mark_all();
        }
        let mut fresh = Changes::default();
        let mut result = Ok(());
        loop {
            let due = self.stepped.iter().enumerate().filter_map(|(index, stepped)| {
                let end = stepped.step.0.times(stepped.done + 1)?;
                (end <= time).then_some((end, index))
            });
            let Some((_, index)) = due.min() else { break };
            if cancelled.load(Ordering::Relaxed) {
                // The steps so far count: the next call continues with them.
                result = Err(Interrupted::Cancelled);
                break;
            }
            let stepped = &mut self.stepped[index];
            let Some(start) = stepped.step.0.times(stepped.done) else { break };
            let animated = animate_all(&mut self.scripts, world, start, true, &mut fresh, cancelled);
            // Tracks have written their values even if a script fails.
            propagate(world, &fresh);
            changes.merge(&std::mem::take(&mut fresh));
            animated?;
            run(&stepped.system, world, start, Some(stepped.step.0.seconds()), &mut fresh);
            stepped.done += 1;
            self.state = None;
            if fresh.is_all() {
                self.scripts.discard_lookup();
            }
        }
        propagate(world, &fresh);
        changes.merge(&fresh);
        result
    }

    fn run_pure(&mut self, world: &mut World, time: Time, cancelled: &AtomicBool) -> Result<(), Interrupted> {
        let mut fresh = Changes::default();
        let has_steps = !self.stepped.is_empty();
        let result = animate_all(&mut self.scripts, world, time, has_steps, &mut fresh, cancelled);
        for system in &self.pure {
            propagate(world, &fresh);
            self.written.merge(&std::mem::take(&mut fresh));
            run(system, world, time, None, &mut fresh);
        }
        self.written.merge(&fresh);
        result
    }
}

/// Updates clouds, then runs tracks, then scripts.
fn animate_all(
    scripts: &mut Scripts,
    world: &mut World,
    time: Time,
    has_steps: bool,
    changes: &mut Changes,
    cancelled: &AtomicBool,
) -> Result<(), Interrupted> {
    update_clouds(world, time, changes)?;
    scripts.look_up(world);
    animate(world, time, changes);
    scripts.run(world, time, has_steps, changes, cancelled)
}

/// Runs one system, records its declarations, and assigns document order to new entities.
fn run(system: &System, world: &mut World, time: Time, step: Option<f64>, changes: &mut Changes) {
    let mut spawned = Vec::new();
    changes.watch(|changes| {
        let mut context = Context { world: &mut *world, time, changes, step, spawned: Vec::new() };
        system(&mut context);
        spawned = context.spawned;
    });
    if changes.is_all() {
        order_newcomers(world, &spawned);
    }
}

impl std::fmt::Debug for Schedule {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Schedule")
            .field("pure", &self.pure.len())
            .field("stepped", &self.stepped.len())
            .finish_non_exhaustive()
    }
}
