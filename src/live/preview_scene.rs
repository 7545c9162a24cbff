//! The displayed scene, ready to be rendered.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::commands::Detail;
use super::pixel_info::{PixelInfo, named};
use super::preview_level::{PreviewLevel, RequestedPicture, sized};
use super::state::{CurvePlace, Planned, Times};
use crate::accuracy::{Estimate, estimate};
use crate::components::{FilmSettings, Sampling};
use crate::engine::{Engine, EngineError, FrameReport};
use crate::scene::{LoadError, Reader, Scene, Sources};
use crate::systems::{Effect, EffectSet, RenderRequest, RenderSettings};
use crate::time::Timeline;
use crate::trace::{Film, RenderJob, Signals};

/// An engine, and the sources of its scene for looking up positions.
pub(super) struct PreviewScene {
    engine: Engine,
    sources: Sources,
}

/// A scene as it was read.
pub(super) struct LoadedScene {
    pub(super) scene: Scene,
    sources: Sources,
}

impl PreviewScene {
    pub(super) fn read(reader: &mut Reader, path: &Path) -> Result<LoadedScene, LoadError> {
        let (scene, sources) = reader.load(path)?;
        Ok(LoadedScene { scene, sources })
    }

    /// Replaces the displayed scene, if there is one. Parts that both scenes share are kept.
    pub(super) fn replace(
        stage: &mut Option<Self>,
        LoadedScene { scene, sources }: LoadedScene,
        without: EffectSet,
    ) {
        match stage {
            Some(stage) => {
                stage.engine.reload(scene);
                stage.sources = sources;
            }
            None => {
                let mut engine = Engine::from_scene(scene);
                engine.set_settings(RenderSettings { without, ..RenderSettings::default() });
                *stage = Some(Self { engine, sources });
            }
        }
    }

    pub(super) fn timeline(&self) -> Timeline {
        self.engine.timeline()
    }

    pub(super) fn film_settings(&self) -> FilmSettings {
        self.engine.film_settings()
    }

    /// Returns the report of the last picture.
    pub(super) fn report(&self) -> &FrameReport {
        self.engine.report()
    }

    /// Returns the size and sample count of a picture of this quality.
    pub(super) fn target(&self, detail: Detail) -> RequestedPicture {
        let FilmSettings { width, height, .. } = self.film_settings();
        let (divisor, samples) = match detail {
            Detail::Full => (1, self.least_samples()),
            Detail::Draft => (1, 1),
            Detail::Half => (2, 1),
        };
        RequestedPicture { film: (width, height), divisor, samples }
    }

    /// Returns the number of samples of each pixel of a full picture; 1, the minimum, if sampling is adaptive.
    fn least_samples(&self) -> u32 {
        let Sampling { samples, max_error, .. } = self.engine.sampling();
        if max_error > 0.0 { 1 } else { samples }
    }

    /// Returns the effects of a frame. `made` is true if the frame is the last full picture.
    pub(super) fn planned(&mut self, frame: u32, made: bool) -> Result<Vec<Planned>, EngineError> {
        let time = self.timeline().time_of(frame);
        let plan = if made { self.engine.report().plan.clone() } else { self.engine.plan_at(time)? };
        Ok(plan.as_ref().map(Planned::all).unwrap_or_default())
    }

    /// Renders a coarse picture of a frame. Returns `None` if it was cancelled. Calls `begin` once everything is ready for rays.
    pub(super) fn draft(
        &mut self,
        frame: u32,
        level: PreviewLevel,
        cancelled: &AtomicBool,
        begin: &(dyn Fn() + Sync),
    ) -> Result<Option<Film>, EngineError> {
        let time = self.timeline().time_of(frame);
        let pause = || {
            begin();
            false
        };
        let signals = Signals { cancelled, pause: &pause };
        let settings = level.settings(self.film_settings(), self.engine.quality());
        let settings = Some(settings.or(self.engine.settings()));
        let request = RenderRequest { settings, fingerprint: false, signals, ..RenderRequest::at(time) };
        Ok(self.engine.render(request)?.map(|image| image.film))
    }

    /// Renders a frame until it is finished or stopped; see [`Engine::render`].
    pub(super) fn render_on(
        &mut self,
        (frame, detail): (u32, Detail),
        begun: &mut Option<RenderJob>,
        signals: Signals<'_>,
        visit: &mut dyn FnMut(&RenderJob) -> ControlFlow<()>,
    ) -> Result<Option<Film>, EngineError> {
        let time = self.timeline().time_of(frame);
        let settings = match detail {
            Detail::Full => None,
            Detail::Draft => Some(sized(1, self.film_settings())),
            Detail::Half => Some(sized(2, self.film_settings())),
        };
        let request = RenderRequest {
            settings: settings.map(|settings| settings.or(self.engine.settings())),
            fingerprint: false,
            signals,
            on_pause: Some(visit),
            resume: Some(begun),
            ..RenderRequest::at(time)
        };
        Ok(self.engine.render(request)?.map(|image| image.film))
    }

    /// Returns the faults at the moment of the last picture, one line each, with remedies.
    pub(super) fn warnings(&self) -> Vec<String> {
        /// Maximum number of faults that are listed.
        const MOST: usize = 10;
        let faults = self.engine.faults();
        let mut warnings: Vec<String> = faults
            .iter()
            .take(MOST)
            .map(|fault| {
                let (name, place) = named(self.engine.world(), &self.sources, fault.entity);
                let place = place.map_or_else(String::new, |place| format!(" ({place})"));
                format!("{name:?}{place} {fault}; {}", fault.remedy())
            })
            .collect();
        if faults.len() > MOST {
            warnings.push(format!("and {} more", faults.len() - MOST));
        }
        warnings
    }

    /// Describes a pixel of a frame. `picture` is the full picture, if there is one.
    pub(super) fn pixel_info(
        &mut self,
        frame: u32,
        pixel: (u32, u32),
        picture: Option<&Film>,
    ) -> Result<Option<PixelInfo>, EngineError> {
        let time = self.timeline().time_of(frame);
        PixelInfo::of(&mut self.engine, &self.sources, time, pixel, picture)
    }

    /// Returns the fraction of a frame's time that is saved by disabling an effect, or `Some(None)` if the effect is not needed. Returns
    /// `None` after the last effect, or if cancelled.
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
        let base = self.engine.settings();
        let mut took = |effect: Option<Effect>| -> Result<Option<f64>, EngineError> {
            let without =
                RenderSettings { without: effect.into_iter().collect(), ..RenderSettings::default() };
            let request = RenderRequest {
                settings: Some(without.or(base)),
                fingerprint: false,
                signals: Signals::unless(cancelled),
                ..RenderRequest::at(time)
            };
            let image = self.engine.render(request)?;
            Ok(image.map(|_| Times::milliseconds(self.engine.report().trace)))
        };
        // Each picture is compared with a complete one rendered at the same time, since the speed of the machine may change.
        let (Some(whole), Some(part)) = (took(None)?, took(Some(effect))?) else { return Ok(None) };
        Ok(Some(Some((1.0 - part / whole.max(f64::MIN_POSITIVE)).max(0.0))))
    }

    /// Returns the error of a frame at a point of the curve: with the scene's own samples at point 0, then with 1, 2, 4 and so on samples
    /// per pixel. Returns `None` beyond the maximum, or if cancelled.
    pub(super) fn curve_point(
        &mut self,
        frame: u32,
        index: usize,
        cancelled: &AtomicBool,
    ) -> Result<Option<CurvePlace>, EngineError> {
        const MOST: u32 = 1024;
        let Sampling { samples, max_error, .. } = self.engine.sampling();
        let own = (max_error == 0.0).then_some(samples);
        let Some(exponent) = index.checked_sub(1) else {
            return self.measured(frame, (own, RenderSettings::default()), cancelled);
        };
        let samples = (0..).map(|exponent| 1 << exponent).take_while(|samples| *samples <= MOST);
        let Some(samples) = samples.filter(|samples| Some(*samples) != own).nth(exponent) else {
            return Ok(None);
        };
        let settings =
            RenderSettings { samples: Some(samples), max_error: Some(0.0), ..RenderSettings::default() };
        self.measured(frame, (Some(samples), settings), cancelled)
    }

    fn measured(
        &mut self,
        frame: u32,
        (samples, settings): (Option<u32>, RenderSettings),
        cancelled: &AtomicBool,
    ) -> Result<Option<CurvePlace>, EngineError> {
        let time = self.timeline().time_of(frame);
        let estimate = estimate(&mut self.engine, time, settings, cancelled)?;
        Ok(estimate.map(|Estimate { rms, seconds }| CurvePlace {
            samples,
            milliseconds: 1e3 * seconds,
            error: rms,
        }))
    }
}
