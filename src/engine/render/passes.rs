//! What pixels meet first, beside pictures of light.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use super::frame::Then;
use crate::engine::engine::{Engine, EngineError};
use crate::time::Time;
use crate::trace::PassPixel;

impl Engine {
    /// Returns what the ray through the middle of each pixel meets first, row by row from the top, on the current rayon pool's threads:
    /// at the moment or, while the shutter is open, at its first instant. The [report](Engine::report) and the plan stay those of the
    /// last picture; the time that this takes is added to that of tracing. `None` without a camera, and if `cancelled` became true
    /// meanwhile.
    ///
    /// ```
    /// use std::sync::atomic::AtomicBool;
    /// use rayreel::components::{Camera, FilmSettings, Material, Shape, Transform};
    /// use rayreel::{Engine, Rgb, Time, World};
    ///
    /// let mut world = World::new();
    /// let clay = Material { k_a: 0.5, k_d: 0.5, color: Rgb::ONE, ambient_color: None };
    /// world.spawn((Shape::Sphere { radius: 1.0 }, clay, Transform::default()));
    /// world.spawn((Camera::default(),));
    /// world.spawn((FilmSettings { width: 3, height: 3, ..FilmSettings::default() },));
    /// let never = AtomicBool::new(false);
    /// let passes = Engine::new(world).passes_unless(Time::ZERO, &never)?.unwrap();
    /// assert_eq!((passes[4].depth, passes[4].normal, passes[4].id), (4.0, [0.0, 0.0, -1.0], 1));
    /// # Ok::<(), rayreel::EngineError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn passes_unless(
        &mut self,
        time: Time,
        cancelled: &AtomicBool,
    ) -> Result<Option<Vec<PassPixel>>, EngineError> {
        let start = Instant::now();
        let instants = self.instants(time);
        let (report, plan) = (std::mem::take(&mut self.report), self.plan.take());
        let mut passes = None;
        let sought = self.seek_all(time, (&instants, vec![0]), cancelled, |preparation, _, _| {
            passes = preparation.scene().passes(preparation.camera(), cancelled);
            Then::Stop
        });
        (self.report, self.plan) = (report, plan);
        self.report.trace += start.elapsed();
        sought.map(|_| passes)
    }
}
