//! Reloading: matches the entities of the old and the new scene and patches the differences.
//!
//! Entities keep their identity, so that a library user's references to them stay valid, and so that preparing an edited scene costs in
//! proportion to the edit.

mod matching;
mod patch;

use crate::engine::engine::Engine;
use crate::scene::Scene;
use patch::patch;

impl Engine {
    /// Replaces the scene, usually after an edit of its file. From the next frame on, all results are bit-identical to the results of an
    /// engine created with [`from_scene`](Engine::from_scene), independent of earlier frames, reloads and writes to the world.
    ///
    /// An entity in both scenes keeps its identity and its prepared data, so that the cost is proportional to the edit. Entities are
    /// matched by name; entities without names by transform and shape, and the remaining ones by position. The BVH over the shapes is
    /// rebuilt only if a shape, its transform or the order of the shapes differs.
    ///
    /// Custom systems are kept and start over on the world of the new scene, in which all entities are new. The settings are kept
    /// too. Until the next frame or [`seek`](Engine::seek), the engine reports on the last one.
    ///
    /// ```
    /// use rayreel::{Engine, Scene};
    ///
    /// let scene = |color: &str| {
    ///     let text = format!(
    ///         "(film: (width: 8, height: 8), camera: (position: (0, 0, -5), target: (0, 0, 0)), ambient: (1, 1, 1),
    ///         materials: {{ \"clay\": (k_a: 1, color: \"{color}\") }},
    ///         entities: [(name: \"ball\", shape: Sphere(radius: 1), material: \"clay\")])"
    ///     );
    ///     Scene::from_text("ball.ron", text)
    /// };
    /// let mut engine = Engine::from_scene(scene("#ff0000")?);
    /// engine.render_frame(0)?;
    /// assert_eq!(engine.report().bvh_builds, 1);
    ///
    /// engine.reload(scene("#0000ff")?);
    /// let film = engine.render_frame(0)?;
    /// assert_eq!(film, Engine::from_scene(scene("#0000ff")?).render_frame(0)?);
    /// assert_eq!(engine.report().bvh_builds, 0); // only the colour is another one
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn reload(&mut self, scene: Scene) {
        let Scene { world, timeline, scripts, warnings, .. } = scene;
        let simulation = &mut self.simulation;
        if simulation.schedule.is_empty() {
            simulation.changes.merge(&patch(&mut simulation.world, world));
        } else {
            // Custom systems may depend on the order in which the entities of a world were spawned.
            simulation.rewind();
            simulation.world = world;
        }
        self.start(timeline, scripts, warnings);
    }
}
