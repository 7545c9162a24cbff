//! First-hit passes: depth, normals and other data of the surface seen by each pixel.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use super::frame::NextInstants;
use crate::engine::engine::{Engine, EngineError};
use crate::time::Time;
use crate::trace::PassPixel;

impl Engine {
    /// Returns the first hit of the ray through the centre of each pixel, row by row from the top, computed on the threads of the current
    /// rayon pool. The scene is at the moment or, while the shutter is open, at the frame's first instant. The [report](Engine::report) and
    /// the plan of the last image are kept; the time taken is added to the report's tracing time. `None` if `cancelled` became true.
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
            NextInstants::Stop
        });
        (self.report, self.plan) = (report, plan);
        self.report.trace += start.elapsed();
        sought.map(|_| passes)
    }
}
