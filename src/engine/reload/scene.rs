//! Another scene in place of the one before.

use super::patch::patch;
use crate::engine::engine::Engine;
use crate::scene::Scene;

impl Engine {
    /// Continues with another scene, usually the same one after an edit: from the next frame on everything is as if the engine
    /// had been made [`from_scene`](Engine::from_scene), to the last bit, whatever was rendered, reloaded or written to the world
    /// before.
    ///
    /// What is in both scenes stays the same entity, and what was prepared for it is kept, so that the cost is proportional to
    /// the edit. Entities are recognised by their names; those without one by their transforms and shapes, and the rest by
    /// position. The BVH over the shapes is rebuilt only if any of them is different, elsewhere or in another order.
    ///
    /// Custom systems stay and start over, on the new scene's world as it is: all entities are new then. Precision and the effect
    /// left out stay too. Until the next frame or [`seek`](Engine::seek), the engine reports on the last one.
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
        let Scene { world, timeline, scripts, .. } = scene;
        if self.systems.is_empty() {
            self.changes.merge(&patch(&mut self.world, world));
        } else {
            // They may depend on the order in which a world has come about.
            self.systems.rewind(&mut self.world);
            self.world = world;
            self.changes.mark_all();
        }
        self.start(timeline, scripts);
    }
}
