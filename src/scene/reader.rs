//! Reads a scene repeatedly while it is being edited.

use std::path::Path;

use super::files::Texts;
use super::{LoadError, Override, Scene, Sources};

/// Reads a scene again and again, and parses only what has changed: the cost of an edit among many entities is that of building
/// the world, not that of parsing the text.
///
/// The result is always that of [`Scene::load_overridden`], mistakes included. The texts and documents of the last scene that could be
/// parsed are kept, some 500 bytes an entity.
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

    /// Creates a reader that puts these values in the place of those in the files, every time.
    #[must_use]
    pub fn overriding(overrides: Vec<Override>) -> Self {
        Self { overrides, ..Self::default() }
    }

    /// Reads a scene file, and what it includes; returns the texts as well, in which places can be looked up.
    ///
    /// # Errors
    ///
    /// If a file cannot be read, or with everything that is wrong in any of them. The next time everything may be right.
    pub fn load(&mut self, path: &Path) -> Result<(Scene, Sources), LoadError> {
        Scene::load_again(path, &self.overrides, &mut self.texts)
    }
}
