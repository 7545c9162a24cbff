//! Incremental loading of a scene during editing.

use std::path::Path;

use super::files::Texts;
use super::{LoadError, Override, Scene, Sources};

/// An incremental scene loader, which parses only the changed parts of a scene. After an edit among many entities, most of the time goes
/// into building the world, not into parsing the text.
///
/// The result always equals the result of [`Scene::load_overridden`], including errors. The reader keeps the texts and documents of the
/// last scene that could be parsed, about 500 bytes per entity.
///
/// ```
/// use rayreel::scene::Reader;
///
/// # let folder = tempfile::tempdir()?;
/// let path = folder.path().join("scene.ron");
/// let scene = |radius: u32| {
///     format!(
///         "(camera: (position: (0, 0, -5), target: (0, 0, 0)), materials: {{ \"clay\": (k_d: 1) }},
///         entities: [(shape: Sphere(radius: {radius}), material: \"clay\"), (name: \"other\")])"
///     )
/// };
/// let mut reader = Reader::new();
/// for radius in 1..4 {
///     std::fs::write(&path, scene(radius))?;
///     let (scene, _) = reader.load(&path)?;
///     assert_eq!(scene.world.len(), 4); // with the camera and the settings
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct Reader {
    texts: Texts,
    overrides: Vec<Override>,
}

impl Reader {
    /// Creates a reader that has read nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Creates a reader that applies these overrides on every load.
    #[must_use]
    pub fn overriding(overrides: Vec<Override>) -> Self {
        Self { overrides, ..Self::default() }
    }

    /// Applies other overrides from the next load on.
    pub fn set_overrides(&mut self, overrides: Vec<Override>) {
        self.overrides = overrides;
    }

    /// Loads a scene file and its includes. Also returns the sources, for looking up locations.
    ///
    /// # Errors
    ///
    /// Returns all errors in the files, including files that cannot be read. Later calls may succeed.
    pub fn load(&mut self, path: &Path) -> Result<(Scene, Sources), LoadError> {
        Scene::load_again(path, &self.overrides, &mut self.texts)
    }
}
