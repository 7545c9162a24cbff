//! Schedules the systems added by the program that uses the library.

use std::sync::atomic::AtomicBool;

use hecs::World;

use super::order::order_newcomers;
use super::{Changes, Context, Halt, Registry, Scripts, Snapshot, animate, propagate};
use crate::time::Time;

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

struct Stepped {
    step: Step,
    system: System,
    /// The number of steps that the world has been through.
    done: u64,
}

/// Pure and stepped systems, and the copies of the world that let them start over.
///
/// A *pure* system is a function of the moment: its writes are undone before every frame. A *stepped* system carries state from
/// step to step; the state at `t` is that after `floor(t / step)` steps, each of which sees tracks at its own start. Going back
/// in time starts over from the beginning, so that a frame does not depend on what was rendered before it.
///
/// Where there are both, steps work on a world of their own, and pure systems on a fresh copy of it for every frame. World
/// transforms are up to date whenever a system runs.
#[derive(Default)]
pub(crate) struct Schedule {
    pure: Vec<System>,
    stepped: Vec<Stepped>,
    registry: Registry,
    /// The world before anything ran.
    start: Option<Snapshot>,
    /// The world that steps work on, where pure systems have the shown one.
    base: World,
    /// A copy of the base after its last step.
    state: Option<Snapshot>,
    /// The writes of tracks and pure systems over the state for the last frame.
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
        self.stepped.push(Stepped { step, system: Box::new(system), done: 0 });
    }

    /// Sets the scripts of the scene, which run after tracks.
    pub(crate) fn set_scripts(&mut self, scripts: Scripts) {
        self.scripts = scripts;
    }

    /// Returns the scripts of the scene.
    pub(crate) fn scripts_mut(&mut self) -> &mut Scripts {
        &mut self.scripts
    }

    /// Returns the registry of the component types that snapshots copy.
    pub(crate) fn registry_mut(&mut self) -> &mut Registry {
        &mut self.registry
    }

    /// Makes the world what it was before anything ran, and forgets that moment: the world may be edited now.
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

    /// Brings the world to a moment: tracks, scripts, steps, and pure systems.
    ///
    /// # Errors
    ///
    /// If the world holds a component that cannot be copied, and there are systems that need copies, or if a script fails, or
    /// before the next script if `cancelled` becomes true.
    pub(crate) fn advance(
        &mut self,
        world: &mut World,
        time: Time,
        changes: &mut Changes,
        cancelled: &AtomicBool,
    ) -> Result<(), Halt> {
        if changes.is_all() {
            self.scripts.look_up_again();
        }
        if self.pure.is_empty() && self.stepped.is_empty() {
            return animate_all(&mut self.scripts, world, time, changes, cancelled);
        }
        if self.start.is_none() {
            order_newcomers(world, &[]);
            propagate(world, &Changes::all());
            let start = Snapshot::take(world, &self.registry)?;
            // From here on ids are given out as they will be after every return to the start.
            start.restore(world);
            start.restore(&mut self.base);
            self.start = Some(start);
            changes.mark_all();
        }
        if self.pure.is_empty() {
            self.run_steps(world, time, changes, cancelled)?;
            let result = animate_all(&mut self.scripts, world, time, changes, cancelled);
            if result.is_err() {
                // The next step sees only what is written from then on.
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
            None => Snapshot::take(&self.base, &self.registry)?,
        };
        state.restore(world);
        self.state = Some(state);
        // What the last frame wrote is undone.
        changes.merge(&std::mem::take(&mut self.written));
        let result = self.run_pure(world, time, cancelled);
        changes.merge(&self.written);
        result
    }

    /// Runs all steps that end by `time`, in the order of their ends; of several with the same end, those of the system that was
    /// added first. So the steps until an earlier time are the first of the steps until a later one.
    fn run_steps(
        &mut self,
        world: &mut World,
        time: Time,
        changes: &mut Changes,
        cancelled: &AtomicBool,
    ) -> Result<(), Halt> {
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
        loop {
            let due = self.stepped.iter().enumerate().filter_map(|(index, stepped)| {
                let end = stepped.step.0.times(stepped.done + 1)?;
                (end <= time).then_some((end, index))
            });
            let Some((_, index)) = due.min() else { break };
            let stepped = &mut self.stepped[index];
            let Some(start) = stepped.step.0.times(stepped.done) else { break };
            let animated = animate_all(&mut self.scripts, world, start, &mut fresh, cancelled);
            // Tracks have written even where a script goes wrong.
            propagate(world, &fresh);
            changes.merge(&std::mem::take(&mut fresh));
            animated?;
            run(&stepped.system, world, start, Some(stepped.step.0.seconds()), &mut fresh);
            stepped.done += 1;
            self.state = None;
            if fresh.is_all() {
                self.scripts.look_up_again();
            }
        }
        propagate(world, &fresh);
        changes.merge(&fresh);
        Ok(())
    }

    fn run_pure(&mut self, world: &mut World, time: Time, cancelled: &AtomicBool) -> Result<(), Halt> {
        let mut fresh = Changes::default();
        let result = animate_all(&mut self.scripts, world, time, &mut fresh, cancelled);
        for system in &self.pure {
            propagate(world, &fresh);
            self.written.merge(&std::mem::take(&mut fresh));
            run(system, world, time, None, &mut fresh);
        }
        self.written.merge(&fresh);
        result
    }
}

/// Runs tracks, then scripts.
fn animate_all(
    scripts: &mut Scripts,
    world: &mut World,
    time: Time,
    changes: &mut Changes,
    cancelled: &AtomicBool,
) -> Result<(), Halt> {
    scripts.look_up(world);
    animate(world, time, changes);
    scripts.run(world, time, changes, cancelled)
}

/// Runs one system, trusts its declarations, and gives newcomers their positions in document order.
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
