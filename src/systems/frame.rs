//! The frame loop, over the instants of a frame: schedule, animate, scripts, propagate, prepare, plan, trace.
//!
//! A frame is rendered at one instant or, while the shutter is open, at several. [`Simulation::visit`] advances the world to each of them
//! and hands its prepared data to the tracer ([`trace`](super::trace())).

use std::collections::VecDeque;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use hecs::World;

use super::prepare::{FrameSettings, Shutter, Shutters};
use super::{
    Changes, Effect, FrameReport, Interrupted, Need, Plan, Preparation, RenderSettings, Schedule, Scripts,
    order_newcomers, propagate,
};
use crate::components::{Animated, CloudSource, FilmSettings, Sampling};
use crate::time::{Time, Timeline};
use crate::trace::{BvhUpdate, Effects, InstantOrder, Lighting, SamplePlan, SceneChanges};

/// A world with its systems, and the kernel's data of the moment to which they have advanced.
pub(crate) struct Simulation {
    pub(crate) world: World,
    pub(crate) schedule: Schedule,
    /// The writes since the last preparation.
    pub(crate) changes: Changes,
    /// The kernel's data. `None` before the first moment.
    pub(crate) preparation: Option<Preparation>,
    /// The exposure of frames. It is read from the world before custom systems run, since the instants of a frame must not depend on the
    /// state of the world at those instants.
    shutters: Option<Shutters>,
}

/// A frame to be rendered: its moment, and the instants at which samples are taken.
#[derive(Debug)]
pub(crate) struct FrameInstants {
    pub(crate) time: Time,
    pub(crate) settings: RenderSettings,
    /// The frame's moment, or several instants while the shutter is open.
    instants: Vec<Time>,
    shutter: Shutter,
    is_adaptive: bool,
}

/// The prepared data of an instant.
#[derive(Clone, Copy)]
pub(crate) struct PreparedInstant<'a> {
    pub(crate) data: &'a Preparation,
    /// The effects that the instant needs.
    pub(crate) effects: Effects,
    /// The index of the instant among the frame's instants.
    pub(crate) index: u32,
}

/// The action after an instant of a frame.
pub(crate) enum NextInstants {
    /// Continues with the next instant, if any.
    Continue,
    /// Visits these instants next, in this order.
    Visit(Vec<u32>),
    /// Ends the frame.
    Stop,
}

impl Simulation {
    pub(crate) fn new(world: World) -> Self {
        Self {
            world,
            schedule: Schedule::default(),
            changes: Changes::all(),
            preparation: None,
            shutters: None,
        }
    }

    /// Returns to the world before any system ran, and forgets all that was derived from it: the world and its systems may then be edited.
    pub(crate) fn rewind(&mut self) {
        self.schedule.rewind(&mut self.world);
        self.changes.mark_all();
        self.shutters = None;
    }

    /// Starts with the scripts of a scene, after its world has been set.
    pub(crate) fn start(&mut self, scripts: Scripts) {
        self.schedule.set_scripts(scripts);
        self.shutters = None;
    }

    /// Returns the frame at a moment of a timeline, with the overrides applied.
    pub(crate) fn frame(
        &mut self,
        time: Time,
        timeline: Timeline,
        settings: RenderSettings,
    ) -> FrameInstants {
        self.schedule.set_timeline(timeline);
        let is_adaptive = settings.effective(&self.world).sampling.is_adaptive();
        let shutter = self.shutters.get_or_insert_with(|| Shutters::of(&self.world)).at(time, &settings);
        let instants = match shutter {
            _ if settings.without.contains(Effect::MotionBlur) => vec![time],
            Shutter::Open(open, count) if settings.all_effects || self.may_move() => {
                let count = if is_adaptive { InstantOrder::MOST } else { count };
                timeline.instants(time, open, count)
            }
            _ => vec![time],
        };
        FrameInstants { time, settings, instants, shutter, is_adaptive }
    }

    /// Returns whether any entity can move.
    fn may_move(&self) -> bool {
        let animated = |archetype: &hecs::Archetype| !archetype.is_empty() && archetype.has::<Animated>();
        let has_moving_cloud =
            || self.world.query::<&CloudSource>().iter().any(|source| !source.particles.is_still());
        !self.schedule.is_empty() || self.world.archetypes().any(animated) || has_moving_cloud()
    }

    /// Visits instants of a frame, given by their indices, and calls `each` with the prepared data of each instant; its result determines
    /// the next instant. All instants use the film and the sampling of the first one. Adds the costs of animation and
    /// preparation to `report`, and stores the plan there.
    ///
    /// # Errors
    ///
    /// If the world cannot be advanced to an instant, or if `cancelled` becomes true.
    pub(crate) fn visit(
        &mut self,
        frame: &FrameInstants,
        first: Vec<u32>,
        report: &mut FrameReport,
        cancelled: &AtomicBool,
        mut each: impl FnMut(PreparedInstant<'_>) -> NextInstants,
    ) -> Result<(), Interrupted> {
        let most_elaborate = frame.lighting();
        let mut plan: Option<Plan> = None;
        let (mut is_moving, mut of_frame) = (false, None);
        let (mut next, mut is_first) = (VecDeque::from(first), true);
        while let Some(index) = next.pop_front() {
            let Some(instant) = frame.instants.get(index as usize) else { continue };
            let changes = self.advance_to(*instant, frame, report, cancelled)?;
            is_moving |= !std::mem::take(&mut is_first) && !changes.is_empty();
            let Some(own) = self.apply_settings(&frame.settings, &mut of_frame) else { continue };
            let Some(preparation) = &self.preparation else { continue };
            let shown = preparation.without(frame.settings.without);
            let needed = shown.plan(&self.world);
            let mut effects = if frame.settings.all_effects { Effects::ALL } else { needed.effects() };
            effects.lighting = effects.lighting.min(most_elaborate);
            match &mut plan {
                Some(plan) => plan.join(&needed),
                None => plan = Some(needed),
            }
            let instant = PreparedInstant { data: &shown, effects, index };
            let mut then = each(instant);
            // With a single instant, the world stays where it is.
            while frame.instants.len() == 1 && matches!(then, NextInstants::Visit(_)) {
                then = each(instant);
            }
            drop(shown);
            if let Some(preparation) = &mut self.preparation {
                preparation.replace_frame_settings(&own, &self.world);
            }
            match then {
                NextInstants::Continue => {}
                NextInstants::Visit(instants) => next = instants.into(),
                NextInstants::Stop => break,
            }
        }
        if let Some(plan) = &mut plan {
            plan.set_motion_blur(frame.motion_blur(is_moving));
            plan.disable(frame.settings.without);
        }
        report.plan = plan;
        Ok(())
    }

    /// Advances to the instant of sample `index` of a frame, and applies the frame's settings until the next update.
    pub(crate) fn seek_sample(
        &mut self,
        frame: &FrameInstants,
        index: u32,
        cancelled: &AtomicBool,
    ) -> Result<(), Interrupted> {
        let is_spread = frame.is_adaptive && frame.count() > 1;
        let wanted = is_spread.then(|| InstantOrder::new(true).instants(index..index + 1));
        let mut of_frame = None;
        for (at, instant) in (0..).zip(&frame.instants) {
            self.advance_to(*instant, frame, &mut FrameReport::default(), cancelled)?;
            self.apply_settings(&frame.settings, &mut of_frame);
            let Some(preparation) = &self.preparation else { continue };
            let belongs = match &wanted {
                Some(wanted) => wanted.contains(&at),
                None => crate::trace::block(preparation.samples(), frame.count(), at).contains(&index),
            };
            if belongs {
                break;
            }
        }
        Ok(())
    }

    /// Applies the overrides to the prepared instant, and the film and the sampling of the frame's first instant, which `of_frame` stores.
    /// Returns the instant's own settings.
    pub(super) fn apply_settings(
        &mut self,
        overrides: &RenderSettings,
        of_frame: &mut Option<(FilmSettings, Sampling)>,
    ) -> Option<FrameSettings> {
        let preparation = self.preparation.as_mut()?;
        let mut settings = preparation.frame_settings();
        (settings.film, settings.sampling) = *of_frame.get_or_insert((settings.film, settings.sampling));
        overrides.apply(&mut settings);
        Some(preparation.replace_frame_settings(&settings, &self.world))
    }

    /// Advances the world to a moment. The kernel's data stay those of another moment until the next instant of a frame.
    #[cfg(feature = "live")]
    pub(crate) fn advance_world(&mut self, time: Time, cancelled: &AtomicBool) -> Result<(), Interrupted> {
        self.schedule.advance(&mut self.world, time, &mut self.changes, cancelled)?;
        if self.changes.is_all() {
            order_newcomers(&mut self.world, &[]);
        }
        propagate(&mut self.world, &self.changes);
        self.changes.deduplicate();
        Ok(())
    }

    /// Advances the world and the kernel's data to an instant of a frame. Returns the changes of the kernel's data.
    pub(crate) fn advance_to(
        &mut self,
        instant: Time,
        frame: &FrameInstants,
        report: &mut FrameReport,
        cancelled: &AtomicBool,
    ) -> Result<SceneChanges, Interrupted> {
        let start = Instant::now();
        self.schedule.advance(&mut self.world, instant, &mut self.changes, cancelled)?;
        let animated = Instant::now();
        let changes = std::mem::take(&mut self.changes);
        if changes.is_all() {
            order_newcomers(&mut self.world, &[]);
        }
        let moved = propagate(&mut self.world, &changes);
        let changed = match &mut self.preparation {
            Some(preparation) => preparation.update(&mut self.world, frame.time, &changes, &moved),
            None => {
                self.preparation = Some(Preparation::of(&mut self.world, frame.time));
                SceneChanges::remade()
            }
        };
        if let Some(preparation) = &mut self.preparation {
            preparation.configure(&frame.settings);
            // Tracks and scripts declare all their changes.
            preparation.relies_on_declarations &= !self.schedule.is_empty();
        }
        report.bvh_builds += u32::from(changed.bvh == BvhUpdate::Built);
        report.bvh_refits += u32::from(changed.bvh == BvhUpdate::Refitted);
        report.animate += animated - start;
        report.prepare += animated.elapsed();
        Ok(changed)
    }
}

impl FrameInstants {
    /// Returns the number of instants. Without adaptive sampling, it is never more than the number of samples.
    pub(crate) fn count(&self) -> u32 {
        u32::try_from(self.instants.len()).unwrap_or(u32::MAX)
    }

    /// Returns the indices of the instants that the first round visits.
    pub(crate) fn first_instants(&self) -> Vec<u32> {
        match self.instants.len() > 1 && self.is_adaptive {
            true => InstantOrder::new(true).first(),
            false => (0..self.count()).collect(),
        }
    }

    /// Returns the indices of the instants that identify the frame: all of them or, if sampling is adaptive, the default number of
    /// instants.
    pub(crate) fn identifying_instants(&self) -> Vec<u32> {
        match self.instants.len() > 1 && self.is_adaptive {
            true => InstantOrder::new(true).instants(0..Sampling::default().instants),
            false => (0..self.count()).collect(),
        }
    }

    /// Returns the most elaborate lighting that is enabled. The other disabled effects are absent from the prepared data.
    pub(crate) fn lighting(&self) -> Lighting {
        match self.settings.without.contains(Effect::TransparentShadows) {
            true => Lighting::Shadows,
            false => Lighting::TransparentShadows,
        }
    }

    /// Returns the sample plan of an image of the frame.
    pub(crate) fn sample_plan(&self, data: &Preparation, alpha: bool) -> SamplePlan {
        let target = data.error_target(self.count() > 1);
        let starts_wide = data.camera().has_lens();
        SamplePlan { target, starts_wide, alpha, ..SamplePlan::uniform(data.samples(), self.count()) }
    }

    fn motion_blur(&self, is_moving: bool) -> Need {
        match self.shutter {
            Shutter::None => Need::Omitted("the camera has no shutter"),
            Shutter::OneInstant => Need::Omitted("all samples are taken at one instant"),
            Shutter::Open(..) if is_moving => Need::Needed("something moves while the shutter is open"),
            Shutter::Open(..) => Need::Omitted("nothing moves while the shutter is open"),
        }
    }
}
