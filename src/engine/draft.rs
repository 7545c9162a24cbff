//! Quick pictures to begin with.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use super::report::FrameReport;
use super::run::{Engine, EngineError};
use crate::components::{FilmSettings, Sampling};
use crate::time::Time;
use crate::trace::{Exposure, Film};

impl Engine {
    /// Renders a quick picture of a moment, unless `cancelled` becomes true on the way: with 1 / `divisor` of the film's width
    /// and height, one pixel at least, and one sample a pixel, all at the moment itself. [`report`](Engine::report) then tells
    /// of it; [`plan`](Engine::plan) still tells of the last frame.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn render_draft_unless(
        &mut self,
        time: Time,
        divisor: u32,
        cancelled: &AtomicBool,
    ) -> Result<Option<Film>, EngineError> {
        if !self.seek_unless(time, cancelled)? {
            return Ok(None);
        }
        let Some(preparation) = &mut self.preparation else { return Ok(None) };
        let settings = preparation.exposure_settings();
        preparation.expose_with(drafted(settings, divisor), &self.world);
        let start = Instant::now();
        let (scene, camera, sampling) =
            (preparation.scene(), preparation.camera(), preparation.sampling(time));
        let kernel = preparation.plan(&self.world).kernel();
        let mut exposure = Exposure::new(camera.resolution(), sampling.samples);
        let exposed = exposure.add(scene, camera, sampling, (0, sampling.samples), kernel, cancelled);
        preparation.expose_with(settings, &self.world);
        if exposed.is_none() {
            return Ok(None);
        }
        let (film, effort) = exposure.develop();
        self.report = FrameReport {
            trace: start.elapsed(),
            rays: effort.rays,
            ends: effort.ends,
            guards: effort.guards,
            ..self.report
        };
        Ok(Some(film))
    }
}

fn drafted((film, sampling): (FilmSettings, Sampling), divisor: u32) -> (FilmSettings, Sampling) {
    let side = |pixels: u32| (pixels / divisor.max(1)).max(1);
    let film = FilmSettings { width: side(film.width), height: side(film.height), ..film };
    (film, Sampling { samples: 1, ..sampling })
}
