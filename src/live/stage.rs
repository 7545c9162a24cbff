//! The scene that is on show, ready to be rendered.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::spot::Spot;
use super::state::{Planned, Times};
use crate::components::FilmSettings;
use crate::engine::{Engine, EngineError, FrameReport};
use crate::scene::{LoadError, Reader, Scene, Sources};
use crate::systems::Effect;
use crate::time::Timeline;
use crate::trace::Film;

/// A scene, with what is needed to say where things are written.
pub(super) struct Stage {
    engine: Engine,
    sources: Sources,
}

/// Files that were read.
pub(super) struct Read {
    pub(super) scene: Scene,
    sources: Sources,
}

/// How to render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Render {
    /// As to a file.
    Full,
    /// One sample a pixel, of the film's width and height divided by this.
    Draft(u32),
    /// The same, to begin with.
    Coarse(u32),
}

impl Stage {
    pub(super) fn read(reader: &mut Reader, path: &Path) -> Result<Read, LoadError> {
        let (scene, sources) = reader.load(path)?;
        Ok(Read { scene, sources })
    }

    /// Puts a scene in the place of the one that is on show, if there is one: what is in both is kept.
    pub(super) fn take_over(stage: &mut Option<Self>, Read { scene, sources }: Read) {
        match stage {
            Some(stage) => {
                stage.engine.reload(scene);
                stage.sources = sources;
            }
            None => *stage = Some(Self { engine: Engine::from_scene(scene), sources }),
        }
    }

    pub(super) fn timeline(&self) -> Timeline {
        self.engine.timeline()
    }

    pub(super) fn film_settings(&self) -> FilmSettings {
        self.engine.film_settings()
    }

    /// Of the last picture.
    pub(super) fn report(&self) -> &FrameReport {
        self.engine.report()
    }

    /// How many samples a pixel of a full picture has.
    pub(super) fn samples(&self) -> u32 {
        self.engine.sampling().map_or(1, |sampling| sampling.samples)
    }

    /// What a frame calls for; `made` if it is the last full picture.
    pub(super) fn planned(&mut self, frame: u32, made: bool) -> Result<Vec<Planned>, EngineError> {
        let time = self.timeline().time_of(frame);
        let plan = if made { self.engine.plan() } else { self.engine.plan_at(time)? };
        Ok(plan.map(Planned::all).unwrap_or_default())
    }

    /// A picture of a frame; `None` if it was cancelled.
    pub(super) fn render(
        &mut self,
        frame: u32,
        render: Render,
        cancelled: &AtomicBool,
    ) -> Result<Option<Film>, EngineError> {
        let time = self.timeline().time_of(frame);
        match render {
            Render::Full => self.engine.render_unless(time, cancelled),
            Render::Draft(divisor) | Render::Coarse(divisor) => {
                self.engine.render_draft_unless(time, divisor, cancelled)
            }
        }
    }

    /// What a pixel sees.
    pub(super) fn spot(&mut self, frame: u32, pixel: (u32, u32)) -> Result<Option<Spot>, EngineError> {
        let time = self.timeline().time_of(frame);
        Spot::of(&mut self.engine, &self.sources, time, pixel)
    }

    /// The share of a frame's time that is saved without an effect, `None` for one that is not needed; nothing after the last
    /// effect, or if it was cancelled.
    pub(super) fn cost(
        &mut self,
        frame: u32,
        effect: usize,
        cancelled: &AtomicBool,
    ) -> Result<Option<Option<f64>>, EngineError> {
        let Some(effect) = Effect::ALL.get(effect).copied() else { return Ok(None) };
        let time = self.timeline().time_of(frame);
        if !self.engine.plan_at(time)?.is_some_and(|plan| plan.needs(effect)) {
            return Ok(Some(None));
        }
        let mut took = |left_out| -> Result<Option<f64>, EngineError> {
            self.engine.set_left_out(left_out);
            let film = self.engine.render_unless(time, cancelled);
            self.engine.set_left_out(None);
            Ok(film?.map(|_| Times::milliseconds(self.engine.report().trace)))
        };
        // Each beside the whole, so that a machine that becomes slower or faster does not tell on the effects.
        let (Some(whole), Some(part)) = (took(None)?, took(Some(effect))?) else { return Ok(None) };
        Ok(Some(Some((1.0 - part / whole.max(f64::MIN_POSITIVE)).max(0.0))))
    }
}
